"""Remake the generated assets with the code that made them, or check that they are what it makes.

examples:
  run_game.py build                  remake everything
  run_game.py build takes units      only the performed takes and the motion units
  run_game.py build compiled         only the loops written in C
  run_game.py build --check          build beside, compare, write nothing; exit 1 where something differs

On one machine the same code makes the same bytes. Other CPUs differ in the last bits of a float; --check therefore
compares numbers: positions within 0.5 mm, angles within 0.05 degrees, colours within 2 of 255 on average. Needs the
`build` extra: pip install -e '.[build]'. Where node has the module gltf-validator (npm install -g gltf-validator),
--check also lists what the Khronos validator finds wrong with our .vrm and .glb files.
"""

from __future__ import annotations

import argparse
import importlib.util
import re
import shutil
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from game.app.gltf_check import validate
from game.core.errors import BadInput, MissingPart
from game.core.paths import ASSETS, ROOT
from game.formats import read_gltf

__all__ = ["STEPS", "add_arguments", "check_models", "differences", "run"]

LENGTH_TOLERANCE = 5e-4
"""Metres, and everything else that glTF files count in units about as large."""
TEXT_TOLERANCE = 0.06
"""Numbers in BVH and YAML text: degrees, and far more than the metres and seconds among them ever differ."""
PICTURE_TOLERANCE = 2.0
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")


def _characters(out: Path) -> list[Path]:
    from game.tools.modelling import build_character

    return [p for source in sorted((ASSETS / "characters").glob("*.yaml")) for p in build_character(source, out)]


def _stalls(out: Path) -> list[Path]:
    from game.tools.modelling import build_stall

    return [p for source in sorted((ASSETS / "stalls").glob("*.yaml")) for p in build_stall(source, out)]


def _compiled(out: Path) -> list[Path]:
    from game.tools.compiling import build_compiled

    return build_compiled(out)


def _takes(out: Path) -> list[Path]:
    from game.tools.perform import build_takes

    return build_takes(out)


def _units(out: Path) -> list[Path]:
    from game.app.cli import main

    code = main(["analyse", str(ASSETS / "motion" / "takes"), "--out", str(out / "units.yaml")])
    if code:
        raise BadInput("units", expected="takes without findings", seen=f"exit code {code} of analyse")
    return [out / "units.yaml", out / "clips.npz"]


STEPS: dict[str, tuple[Path, Callable[[Path], list[Path]]]] = {
    "compiled": (ROOT, _compiled),
    "takes": (ASSETS / "motion" / "takes", _takes),
    "units": (ASSETS / "motion", _units),
    "characters": (ASSETS / "characters", _characters),
    "stalls": (ASSETS / "stalls", _stalls),
}
"""Name -> where the files live, and what makes them; in the order in which one builds on the other."""

_COMPILERS = ("ziglang",)
_MODELLERS = ("skimage", "fast_simplification")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``build``."""
    parser.add_argument("what", nargs="*", metavar="WHAT", help=f"of {' '.join(STEPS)} (default: all)")
    parser.add_argument("--check", action="store_true", help="compare with the committed files, write nothing")


def differences(made: Path, kept: Path) -> str | None:
    """One line on how a made file differs from the kept one beyond the tolerance, None where it does not."""
    if not kept.exists():
        return "is new"
    if made.read_bytes() == kept.read_bytes():
        return None
    compare = {".bvh": _text, ".yaml": _text, ".npz": _arrays, ".glb": _gltf, ".vrm": _gltf, ".png": _picture}
    return compare.get(made.suffix, lambda a, b: "differs")(made, kept)


def _text(made: Path, kept: Path) -> str | None:
    a, b = made.read_text(encoding="utf-8"), kept.read_text(encoding="utf-8")
    if _NUMBER.sub("#", a) != _NUMBER.sub("#", b):
        return "differs in its words"
    mine, theirs = (np.array(_NUMBER.findall(t), dtype=np.float64) for t in (a, b))
    worst = float(np.abs(mine - theirs).max(initial=0.0))
    return f"differs by {worst:g}" if worst > TEXT_TOLERANCE else None


def _arrays(made: Path, kept: Path) -> str | None:
    with np.load(made, allow_pickle=False) as a, np.load(kept, allow_pickle=False) as b:
        if sorted(a.files) != sorted(b.files):
            return "holds other arrays"
        for name in a.files:
            if a[name].shape != b[name].shape:
                return f"{name} has another shape"
            gap = np.abs(a[name].astype(np.float64) - b[name].astype(np.float64)).max(initial=0.0)
            # Quaternions are stored as 16-bit integers: 40 of 32767 are 0.1 degrees.
            if gap > (40 if a[name].dtype.kind == "i" else LENGTH_TOLERANCE):
                return f"{name} differs by {gap:g}"
    return None


def _gltf(made: Path, kept: Path) -> str | None:
    a, b = read_gltf(made), read_gltf(kept)
    if [n.name for n in a.nodes] != [n.name for n in b.nodes] or len(a.meshes) != len(b.meshes):
        return "has other nodes or meshes"
    for mesh, other in zip(a.meshes, b.meshes, strict=True):
        for part, twin in zip(mesh.primitives, other.primitives, strict=True):
            mine, theirs = part.attributes["POSITION"], twin.attributes["POSITION"]
            # Simplification may pick another edge where two cost the same: shapes are compared, not vertex lists.
            if abs(len(mine) - len(theirs)) > 0.03 * len(theirs) + 8:
                return f"{mesh.name} has {len(mine)} vertices instead of {len(theirs)}"
            for corner in (mine.min(axis=0) - theirs.min(axis=0), mine.max(axis=0) - theirs.max(axis=0)):
                if np.abs(corner).max() > 4 * LENGTH_TOLERANCE:
                    return f"{mesh.name} differs by {np.abs(corner).max():.5f} m"
    return None


def _picture(made: Path, kept: Path) -> str | None:
    from game.render.assets import load_picture

    a, b = load_picture(made), load_picture(kept)
    if a.shape != b.shape:
        return "has another size"
    mean = float(np.abs(a.astype(np.int16) - b.astype(np.int16)).mean())
    return f"differs by {mean:.1f} of 255 on average" if mean > PICTURE_TOLERANCE else None


def check_models(models: Sequence[Path]) -> int:
    """Print what the Khronos validator finds wrong with model files, or why it did not run; -> how many findings."""
    if not models:
        return 0
    try:
        findings = validate(models)
    except MissingPart as reason:
        print(reason)
        return 0
    for finding in findings:
        print(finding)
    return len(findings)


def run(args: argparse.Namespace) -> int:
    """Build into a folder of its own first; only whole, successful steps replace what is there."""
    unknown = [name for name in args.what if name not in STEPS]
    if unknown:
        raise BadInput("build", expected=" | ".join(STEPS), seen=unknown[0])
    wanted = args.what or list(STEPS)
    needed = (*_COMPILERS * ("compiled" in wanted), *_MODELLERS * (wanted != ["compiled"]))
    for module in needed:
        if importlib.util.find_spec(module) is None:
            raise MissingPart(f"the module {module} is missing; install the builders: pip install -e '.[build]'")
    different = 0
    for name, (folder, make) in STEPS.items():
        if name not in wanted:
            continue
        start = time.perf_counter()
        with tempfile.TemporaryDirectory(prefix="build-") as scratch:
            made = make(Path(scratch))
            for path in made:
                kept = folder / path.relative_to(scratch)
                found = differences(path, kept)
                if found is not None:
                    different += 1
                    print(f"{kept.relative_to(ASSETS.parent)}: {found}")
                if not args.check:
                    shutil.copyfile(path, kept)
        if args.check:
            different += check_models(sorted(p for p in folder.iterdir() if p.suffix in {".vrm", ".glb"}))
        verb = "checked" if args.check else "built"
        print(f"{name}: {verb} {len(made)} files in {time.perf_counter() - start:.1f} s")
    return 1 if args.check and different else 0
