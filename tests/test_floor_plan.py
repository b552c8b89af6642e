"""The floor plan is law: which package may import which, read from the imports themselves."""

from __future__ import annotations

import ast
import importlib
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
GAME = ROOT / "game"

# package -> packages of this project it may import (itself always).
PLAN: dict[str, set[str]] = {
    "core": set(),
    "formats": {"core"},
    "story": {"core", "formats"},
    "emotion": {"core", "formats"},
    "market": {"core", "formats"},
    "embos": {"core", "formats"},
    "animation": {"core", "embos"},
    "face": {"core", "formats"},
    "render": {"core", "formats", "face"},
    "app": {"core", "formats", "story", "emotion", "market", "embos", "animation", "face", "render", "tools"},
    "tools": {"core", "formats", "story", "emotion", "market", "embos", "animation", "face", "render", "app"},
}
# Only these touch the window and the GPU (offline tools draw through game.render).
MAY_DRAW = {"app", "render"}
# What the runtime may import besides the standard library and this project.
RUNTIME = {
    "numpy", "scipy", "yaml", "pygame", "moderngl", "wasmtime", "platformdirs", "font_source_sans_pro",
    "font_fredoka_one",
}  # fmt: skip

MODULES = sorted(path for path in GAME.rglob("*.py") if path.parent != GAME)


def _package(path: Path) -> str:
    return path.relative_to(GAME).parts[0]


def _imports(path: Path) -> list[tuple[int, str]]:
    found: list[tuple[int, str]] = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: imports are absolute"
            found.append((node.lineno, node.module or ""))
            found += [(node.lineno, f"{node.module}.{alias.name}") for alias in node.names]
    return found


def test_every_package_is_in_the_plan() -> None:
    assert {path.name for path in GAME.iterdir() if path.is_dir() and path.name != "__pycache__"} == set(PLAN)


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(GAME)))
def test_imports_follow_the_plan(path: Path) -> None:
    package = _package(path)
    for line, name in _imports(path):
        parts = name.split(".")
        if parts[0] != "game" or len(parts) < 2:
            continue
        if parts[1] in PLAN:
            assert parts[1] == package or parts[1] in PLAN[package], f"{path}:{line}: {package} may not import {name}"


def test_the_running_game_never_loads_the_tools() -> None:
    """Offline code is reached from its own commands alone: playing, autoplay and pictures do without it."""
    code = (
        "import sys, game.app.play, game.app.autoplay, game.app.snapshot, game.app.film\n"
        "print([name for name in sys.modules if name.startswith('game.tools')])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True, timeout=120
    )
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(GAME)))
def test_third_parties(path: Path) -> None:
    package = _package(path)
    for line, name in _imports(path):
        top = name.split(".")[0]
        if top in sys.stdlib_module_names or top in {"game", "__future__"}:
            continue
        if package == "tools":
            continue
        assert top in RUNTIME, f"{path}:{line}: {top} is no runtime dependency"
        if top in {"pygame", "moderngl"}:
            assert package in MAY_DRAW, f"{path}:{line}: only {sorted(MAY_DRAW)} touch {top}"


@pytest.mark.parametrize("package", sorted(PLAN))
def test_public_names_exist(package: str) -> None:
    module = importlib.import_module(f"game.{package}")
    for name in getattr(module, "__all__", []):
        assert hasattr(module, name), f"game.{package}.__all__ names {name}, which is not there"


def test_modules_stay_readable() -> None:
    for path in MODULES:
        lines = len(path.read_text(encoding="utf-8").splitlines())
        assert lines <= 400, f"{path.relative_to(ROOT)} has {lines} lines: split it where two topics share a file"


def test_nothing_names_this_machine() -> None:
    """No committed text may name the folder this checkout happens to lie in."""
    here = str(ROOT)
    for path in [*MODULES, *ROOT.glob("*.md"), *ROOT.glob("*.toml")]:
        assert here not in path.read_text(encoding="utf-8"), f"{path} names {here}"
