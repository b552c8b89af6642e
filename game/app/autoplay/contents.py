"""What a run is made of, as one hash: rules, dialogue, units, strategies, own policies, and the code itself.

A run that is gone on with, and workers on other machines, must be made of the same.
"""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path

from game.app.content import stall_path
from game.app.policies import mixture_of
from game.core.paths import ASSETS, DIALOGUE, ROOT

__all__ = ["code_hash", "content_hash", "there"]


def there(folder: str, name: str) -> str:
    """A stall or policy that is a file, from the folder where it was asked for; another name stays."""
    script = name.startswith("script:")
    path = name.removeprefix("script:")
    if not folder or not (script or path.endswith((".py", ".yaml", ".yml"))):
        return name
    return f"{'script:' * script}{Path(folder) / path}"


@lru_cache(maxsize=1)
def code_hash() -> str:
    """Of the code that this process runs, compiled loops included: looked at once, for code that is edited later is not
    read again."""
    digest = hashlib.sha256()
    for path in sorted(path for path in (ROOT / "game").rglob("*") if path.suffix in {".py", ".wasm"}):
        digest.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def content_hash(stalls: tuple[str, ...], populations: tuple[str, ...], folder: str = "") -> str:
    """Of everything that talks are made of, the code aside. folder: where names of files start."""
    digest = hashlib.sha256()
    files = {stall_path(there(folder, stall)).resolve() for stall in stalls}
    for place in {path.parent for path in files} | {DIALOGUE}:
        files |= {path.resolve() for path in place.rglob("*.yaml")}
    files |= {ASSETS / "motion" / "units.yaml", ASSETS / "autoplay" / "strategies.yaml"}
    files |= {ASSETS / "market" / "market.yaml"}
    for population in populations:
        for name, _ in mixture_of(population).shares:
            if name.startswith("script:") or name.endswith(".py"):
                files.add(Path(there(folder, name).removeprefix("script:")).resolve())
    for path in sorted(files, key=lambda path: (path.name, str(path))):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()
