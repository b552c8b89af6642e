"""The C sources of the compiled loops (game.core.compiled) -> one WebAssembly module each."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from game.core.errors import BadInput
from game.core.paths import ROOT

__all__ = ["COMMON", "build_compiled", "compile_module", "sources"]

COMMON = ROOT / "game" / "core"
"""Headers that every module may include, and what is linked to each."""

_FLAGS = (
    # musl's mathematics come with wasi; nothing of the system does: a module that asks for more cannot be loaded.
    "-target", "wasm32-wasi", "-mexec-model=reactor", "-std=c17", "-O3", "-msimd128", "-ffp-contract=off", "-s",
    "-Wall", "-Wextra", "-Werror", f"-I{COMMON}", "-Wl,--no-entry", "-Wl,--export=parameters",
    "-Wl,--export=__heap_base", "-Wl,-z,stack-size=262144",
)  # fmt: skip


def sources() -> dict[str, list[Path]]:
    """Module file -> its C sources: every folder of game/<package>/ that holds some."""
    folders = sorted({path.parent for path in (ROOT / "game").glob("*/*/*.c")})
    return {str(folder.with_suffix(".wasm").relative_to(ROOT)): sorted(folder.glob("*.c")) for folder in folders}


def compile_module(files: list[Path], module: Path) -> None:
    """Compile C files into one module. Raises BadInput with the compiler's first finding."""
    command = [sys.executable, "-m", "ziglang", "cc", *_FLAGS, *map(str, files), str(COMMON / "compiled.c")]
    done = subprocess.run([*command, "-o", str(module)], capture_output=True, text=True, timeout=300, check=False)
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if "error:" in line]
        raise BadInput(
            module.stem, expected="C that compiles", seen=(lines or done.stderr.splitlines() or ["nothing"])[0]
        )


def build_compiled(out: Path) -> list[Path]:
    """Make all modules in a folder."""
    made = []
    for name, files in sources().items():
        module = out / name
        module.parent.mkdir(parents=True, exist_ok=True)
        compile_module(files, module)
        made.append(module)
    return made
