"""Photo mode: time stands still, the camera is free, the picture is saved without the interface.

F9 enters and leaves. Drag or arrows orbit, with shift (or the middle button) they pan, the wheel or + and − zoom;
space or Enter takes the picture, 2 switches the finer picture, H hides the help, 0 goes back to where one began.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import platformdirs
from numpy.typing import NDArray

from game.app.input import Action
from game.app.shots import camera_of, numbers_of
from game.app.strings import Strings
from game.app.ui import PALETTE, Canvas, Rect, fade
from game.core.errors import BadInput
from game.core.springs import damp
from game.render import Camera

__all__ = ["PhotoMode", "PhotoView", "fine_factor", "photo_folder", "photo_path", "smaller"]

Floats = NDArray[np.floating[Any]]

EYE_LOW, EYE_HIGH = np.array([-2.4, 0.45, 1.35]), np.array([2.4, 2.1, 5.5])
"""The eye stays before the stall, above the ground and out of table, awning and posts, the near plane with it."""
TARGET_LOW, TARGET_HIGH = np.array([-1.2, 0.35, -0.5]), np.array([1.2, 1.65, 0.7])
YAW_RAD, PITCH_LOW_RAD, PITCH_HIGH_RAD = 1.05, -0.35, 0.75
FOV_LOW_DEG, FOV_HIGH_DEG = 9.0, 48.0
TURN_STEP_RAD, PAN_STEP_M, ZOOM_STEP = 0.05, 0.03, 0.93
DRAG_TURN_RAD, DRAG_PAN_M = 2.6, 1.6  # of a drag across the picture's height
HALF_LIFE_S = 0.06
SAID_S = 5.0
FINEST_PX = 18_000_000  # of the finer picture before it is made smaller
PICTURES = "Mental Communication Game"


@dataclass(frozen=True)
class PhotoView:
    """Where the photographer stands: yaw and pitch around the target (radians), distance (m), field of view."""

    yaw: float
    pitch: float
    distance_m: float
    target: tuple[float, float, float]
    fov_deg: float

    @staticmethod
    def of(camera: Camera) -> PhotoView:
        """The view of a camera."""
        away = np.subtract(camera.eye, camera.target)
        distance = float(np.linalg.norm(away))
        yaw, pitch = float(np.arctan2(away[0], away[2])), float(np.arcsin(away[1] / distance))
        return PhotoView(yaw, pitch, distance, camera.target, camera.fov_deg)

    def within_limits(self) -> PhotoView:
        """The nearest view that is allowed."""
        x, y, z = (float(v) for v in np.clip(self.target, TARGET_LOW, TARGET_HIGH))
        return PhotoView(
            yaw=min(max(self.yaw, -YAW_RAD), YAW_RAD),
            pitch=min(max(self.pitch, PITCH_LOW_RAD), PITCH_HIGH_RAD),
            distance_m=min(max(self.distance_m, 0.8), 6.0),
            target=(x, y, z),
            fov_deg=min(max(self.fov_deg, FOV_LOW_DEG), FOV_HIGH_DEG),
        )

    def camera(self) -> Camera:
        """The camera, its eye kept out of everything."""
        c = np.cos(self.pitch)
        way = np.array([np.sin(self.yaw) * c, np.sin(self.pitch), np.cos(self.yaw) * c])
        eye = np.clip(np.array(self.target) + way * self.distance_m, EYE_LOW, EYE_HIGH)
        x, y, z = (float(v) for v in eye)
        return Camera((x, y, z), self.target, self.fov_deg)


class PhotoMode:
    """The state of photo mode. ``wants_picture`` is set by the shutter and cleared by who takes the picture."""

    def __init__(self, camera: Camera, *, reduced_motion: bool = False) -> None:
        self._first = PhotoView.of(camera)
        self.view = self._first
        self._shown = numbers_of(camera)
        self._calm = reduced_motion
        self._moved = False
        self.fine = True
        self.help = True
        self.wants_picture = False
        self.said = ""
        self._said_s = 0.0

    def handle(self, action: Action, height_px: float) -> bool:
        """One action of the player; False where it leaves photo mode."""
        if action.kind == "back" or (action.kind == "key" and action.key == "f9"):
            return False
        if action.kind == "confirm":
            self.wants_picture = True
        elif action.kind == "key":
            self._key(action)
        else:
            self._move(action, max(height_px, 1.0))
        return True

    def _key(self, action: Action) -> None:
        if action.key == "2":
            self.fine = not self.fine
        elif action.key == "h":
            self.help = not self.help
        elif action.key == "0":
            self.view, self._moved = self._first, True
        elif action.key in {"+", "=", "-"}:
            self._zoom(-1 if action.key == "-" else 1)

    def _move(self, action: Action, height_px: float) -> None:
        steps = {"left": (1.0, 0.0), "right": (-1.0, 0.0), "up": (0.0, 1.0), "down": (0.0, -1.0)}
        if action.kind in steps:
            across, up = steps[action.kind]
            turn, pan = TURN_STEP_RAD, PAN_STEP_M
        elif action.kind == "pointer" and action.held:
            across, up = action.move[0] / height_px, action.move[1] / height_px
            turn, pan = DRAG_TURN_RAD, DRAG_PAN_M * self.view.fov_deg / 25.0
        elif action.kind == "wheel":
            self._zoom(action.amount)
            return
        else:
            return
        view = self.view
        if action.fast or action.held == "middle":
            side = np.array([np.cos(view.yaw), 0.0, -np.sin(view.yaw)])
            x, y, z = (float(v) for v in np.array(view.target) - side * (across * pan) + (0.0, up * pan, 0.0))
            view = replace(view, target=(x, y, z))
        else:
            view = replace(view, yaw=view.yaw - across * turn, pitch=view.pitch + up * turn)
        self.view, self._moved = view.within_limits(), True

    def _zoom(self, notches: int) -> None:
        view = replace(self.view, fov_deg=self.view.fov_deg * ZOOM_STEP**notches)
        self.view, self._moved = view.within_limits(), True

    def advance(self, elapsed_s: float) -> None:
        """The camera glides to where it is wanted; nothing else moves."""
        self._said_s = max(self._said_s - elapsed_s, 0.0)
        if not self._moved:
            return
        wanted = numbers_of(self.view.camera())
        self._shown = wanted if self._calm else damp(self._shown, wanted, HALF_LIFE_S, elapsed_s)
        if np.abs(self._shown - wanted).max() < 1e-3:
            self._shown, self._moved = wanted, False

    def camera(self) -> Camera:
        """Where the picture is taken from now."""
        return camera_of(self._shown)

    def say(self, text: str) -> None:
        """A line for the photographer, for a few seconds."""
        self.said, self._said_s = text, SAID_S

    def draw(self, strings: Strings, canvas: Canvas) -> None:
        """The help, and where the last picture went."""
        lines = [self.said] if self._said_s > 0.0 else []
        if self.help:
            lines.append(strings("photo_help", fine=strings("on" if self.fine else "off")))
        for i, line in enumerate(reversed(lines)):
            width = min(canvas.measure(line, 16) + 40, canvas.width - 40)
            box = Rect((canvas.width - width) / 2, canvas.height - 56 - 46 * i, width, 38)
            canvas.panel(box, fade(PALETTE["shade"], 1.25), radius=19)
            canvas.text(canvas.width / 2, box.y + 9, line, 16, PALETTE["white"], align="center")


def photo_folder() -> Path:
    """Where photographs go: the user's pictures; beside settings and saves where MCG_USER_FOLDER is set (tests)."""
    own = os.environ.get("MCG_USER_FOLDER")
    return Path(own) / "pictures" if own else Path(platformdirs.user_pictures_path()) / PICTURES


def photo_path(folder: Path) -> Path:
    """The next free name in the folder, which is made where it is missing. Raises BadInput."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInput(f"{folder}: {error.strerror}") from None
    taken = {path.name for path in folder.glob("photo-*.png")}
    number = next(n for n in range(1, len(taken) + 2) if f"photo-{n:04d}.png" not in taken)
    return folder / f"photo-{number:04d}.png"


def fine_factor(size: tuple[int, int], fine: bool) -> int:
    """How much larger than the window a picture is drawn: 2 where that is wanted and not too much."""
    return 2 if fine and size[0] * size[1] * 4 <= FINEST_PX else 1


def smaller(pixels: NDArray[np.uint8], factor: int) -> NDArray[np.uint8]:
    """(h·factor, w·factor, 3) -> (h, w, 3), every pixel the mean of those it covers."""
    if factor == 1:
        return pixels
    height, width = pixels.shape[0] // factor, pixels.shape[1] // factor
    blocks = pixels.reshape(height, factor, width, factor, 3).astype(np.uint16).sum(axis=(1, 3))
    return np.asarray((blocks + factor * factor // 2) // (factor * factor), dtype=np.uint8)
