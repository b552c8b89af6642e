"""The player's settings: a small JSON file in the user's configuration folder. A broken one is set aside, not lost."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import platformdirs

from game.app.input import COMMANDS
from game.core.errors import BadInput
from game.formats.files import read_bytes, write_text

__all__ = ["CHOICES", "TIMERS", "Settings", "load_settings", "save_settings", "user_folder"]

APP = "mental-communication-game"
_MAX_BYTES = 100_000

CHOICES: dict[str, tuple[Any, ...]] = {
    "language": ("en", "ja"),
    "text_speed": ("slow", "normal", "fast", "instant"),
    "auto_forward": ("off", "slow", "normal", "fast"),
    "skip_unread": (False, True),
    "fullscreen": (False, True),
    "ui_scale": (1.0, 1.25, 1.5, 2.0),
    "captions": (False, True),
    "reduced_motion": (False, True),
    "high_contrast": (False, True),
    "timers": ("off", "slow", "normal"),
    "quality": ("auto", "low", "medium", "default", "high", "ultra"),
}
"""Every setting with the values it may have; the first is not always the default."""

TIMERS: dict[str, float] = {"off": 0.0, "slow": 2.5, "normal": 1.0}
"""How much of a timed choice's own time the player has; 0: no choice is timed."""


@dataclass(frozen=True)
class Settings:
    """What the player has chosen. captions: describe in words what the body shows. reduced_motion: the camera cuts.

    auto_forward: lines go on by themselves; skip_unread: skipping does not stop at what is new; keys: command -> the
    key it has instead of its usual one.
    """

    language: str = "en"
    text_speed: str = "normal"
    auto_forward: str = "off"
    skip_unread: bool = False
    fullscreen: bool = False
    ui_scale: float = 1.0
    captions: bool = False
    reduced_motion: bool = False
    high_contrast: bool = False
    quality: str = "auto"
    timers: str = "off"
    keys: Mapping[str, str] = field(default_factory=dict)

    def next(self, name: str) -> Settings:
        """The setting's following value, around the circle."""
        values = CHOICES[name]
        at = values.index(getattr(self, name))
        return replace(self, **{name: values[(at + 1) % len(values)]})


def user_folder() -> Path:
    """Where settings and saves live; the environment variable MCG_USER_FOLDER puts them elsewhere (tests)."""
    return Path(os.environ.get("MCG_USER_FOLDER") or platformdirs.user_data_path(APP, appauthor=False))


def load_settings(folder: Path | None = None) -> tuple[Settings, str | None]:
    """The settings and, where the file was unreadable, one line that says so. Never raises, never deletes."""
    path = (folder or user_folder()) / "settings.json"
    try:
        if not path.exists():
            return Settings(), None
        data = json.loads(read_bytes(path, max_bytes=_MAX_BYTES, what="settings"))
        if not isinstance(data, dict):
            raise ValueError("not a mapping")
    except BadInput as error:
        return Settings(), f"{error}; using the defaults"
    except (OSError, ValueError, RecursionError) as error:
        return Settings(), f"{path}: settings not readable ({str(error)[:80]}), using the defaults"
    known = {f.name for f in fields(Settings)}
    data_keys = data.pop("keys", {})
    good = {k: v for k, v in data.items() if k in known and v in CHOICES[k] and type(v) is type(CHOICES[k][0])}
    return replace(Settings(), **good, keys=_keys(data_keys)), None


def _keys(data: Any) -> dict[str, str]:
    """Commands with other keys than usual; what makes no sense is left out."""
    if not isinstance(data, dict):
        return {}
    return {k: v for k, v in data.items() if k in COMMANDS and isinstance(v, str) and 0 < len(v) < 20}


def save_settings(settings: Settings, folder: Path | None = None) -> str | None:
    """Write the settings atomically; returns one line where that is impossible (the game goes on without)."""
    path = (folder or user_folder()) / "settings.json"
    try:
        write_text(path, json.dumps(asdict(settings), indent=1), make_folder=True, durable=True)
    except BadInput as error:
        return f"settings could not be saved: {error}"
    return None
