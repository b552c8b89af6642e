"""The places where a game can be kept: quick, autosave and six slots, each with a small picture and what it holds."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.app.save_reader import MAX_BYTES
from game.app.saves import SavedGame, save_game
from game.core.errors import BadInput
from game.formats.files import read_bytes
from game.render.assets import load_picture, save_png

__all__ = ["AUTOSAVE", "QUICK", "SLOTS", "SlotInfo", "keep", "look_into", "small"]

AUTOSAVE, QUICK = "autosave", "quick"
SLOTS = (AUTOSAVE, QUICK, *(f"slot{i}" for i in range(1, 7)))
THUMB = (256, 144)


@dataclass(frozen=True)
class SlotInfo:
    """What a slot holds, as far as can be seen from outside; day 0: nothing. unreadable: one line, why."""

    name: str
    day: int = 0
    minutes: float = 0.0
    purse: int = 0
    stall: str = ""
    talking: bool = False
    picture: NDArray[np.uint8] | None = None
    unreadable: str = ""


def keep(folder: Path, name: str, game: SavedGame, picture: NDArray[np.uint8] | None) -> None:
    """Save a game and its picture (h, w, 3). Raises BadInput where the folder cannot be written."""
    save_game(folder / f"{name}.json", game)
    if picture is not None:
        part = folder / f".{name}.part.png"
        try:
            save_png(part, small(picture))
            part.replace(folder / f"{name}.png")
        except OSError:
            part.unlink(missing_ok=True)


def look_into(folder: Path, name: str) -> SlotInfo:
    """What a slot holds. Never raises: a broken save says so in its place."""
    path = folder / f"{name}.json"
    if not path.is_file():
        return SlotInfo(name)
    try:
        data = json.loads(read_bytes(path, max_bytes=MAX_BYTES, what="save"))
        afternoon = data["afternoon"]
        info = SlotInfo(
            name,
            day=int(afternoon.get("day", 1)),
            minutes=float(afternoon.get("minutes", 0.0)),
            purse=int(afternoon["purse"]),
            stall=str(data.get("stall", "flea"))[:40],
            talking=data.get("talk") is not None,
            picture=_picture(folder / f"{name}.png"),
        )
    except (BadInput, ValueError, KeyError, TypeError, AttributeError, RecursionError, OverflowError) as error:
        return SlotInfo(name, unreadable=" ".join(str(error).split())[:80] or type(error).__name__)
    return info


def small(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """(h, w, 3) averaged down to a thumbnail, its edges cut to 16:9."""
    height, width = picture.shape[:2]
    step = max(min(width // THUMB[0], height // THUMB[1]), 1)
    wide, high = min(width // step, THUMB[0]) * step, min(height // step, THUMB[1]) * step
    left, top = (width - wide) // 2, (height - high) // 2
    cut = picture[top : top + high, left : left + wide].astype(np.float32)
    mean = cut.reshape(high // step, step, wide // step, step, 3).mean(axis=(1, 3))
    return np.ascontiguousarray(mean.round().astype(np.uint8))


def _picture(path: Path) -> NDArray[np.uint8] | None:
    try:
        return load_picture(path) if path.is_file() and path.stat().st_size < 2_000_000 else None
    except BadInput:
        return None
