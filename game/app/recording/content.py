"""What a recording was made with: a hash for every file that decides what happens."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from pathlib import Path

from game.core.errors import BadInput, Where
from game.core.paths import ASSETS, DIALOGUE, ROOT

__all__ = ["content_hashes", "content_note"]

SHIPPED = ("market/market.yaml", "motion/units.yaml", "motion/planner.yaml", "motion/clips.npz", "motion/hands.yaml")


def content_hashes(more: Iterable[Path] = ()) -> dict[str, str]:
    """File (from the checkout's root where it lies in it) -> first 16 hex digits of its SHA-256.

    Dialogue, rules, market, motion units, planner and face; more: a designer's own files. Raises BadInput where one
    cannot be read.
    """
    files = [*sorted(DIALOGUE.rglob("*.yaml")), *(ASSETS / name for name in SHIPPED)]
    files += [*sorted((ASSETS / "face").glob("*.yaml")), *more]
    found: dict[str, str] = {}
    for path in files:
        whole = path.resolve()
        name = whole.relative_to(ROOT).as_posix() if whole.is_relative_to(ROOT) else str(whole)
        try:
            found[name] = hashlib.sha256(whole.read_bytes()).hexdigest()[:16]
        except OSError as error:
            raise BadInput(where=Where(path), expected="a readable file", seen=error.strerror) from None
    return found


def content_note(recorded: Mapping[str, str], present: Mapping[str, str]) -> str:
    """One line that says what has changed since; "" where nothing has."""
    changed = sorted(name for name in recorded if name in present and present[name] != recorded[name])
    gone = sorted(name for name in recorded if name not in present)
    new = sorted(name for name in present if name not in recorded)
    parts = [("changed", changed), ("gone", gone), ("new", new)]
    return "; ".join(f"{what}: {', '.join(names[:6])}{' …' * (len(names) > 6)}" for what, names in parts if names)
