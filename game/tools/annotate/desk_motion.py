"""The motion on the desk: the character drawn by the game's renderer, or a stick figure; a camera that goes round."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import atan, cos, degrees, radians, sin, tan

import moderngl
import numpy as np
from imgui_bundle import imgui
from numpy.typing import NDArray

from game.animation import Pose
from game.app.stage import StageAssets, StageShow, load_stage
from game.core import quaternion as quat
from game.core.humanoid import HEAD_CENTRE_OFFSET, REFERENCE, TABLE_FRONT_Z_M, TABLE_TOP_M
from game.embos.clips import TakeClip
from game.face import load_face, start_face
from game.render import Camera, Device, Renderer, level_named
from game.render.camera import DESIGN_ASPECT
from game.tools.windows.imgui_backend import ImguiBackend, ImguiTexture
from game.tools.windows.style import colour

__all__ = ["VIEWS", "MotionPictures", "Orbit", "draw_stick", "pose_at"]

VIEWS = {"front": 0.0, "left": 90.0, "back": 180.0, "right": -90.0}
"""Where the camera stands, degrees about the person; left is the person's own."""
_HALF_TABLE_M = 0.75
_FOV_DEG, _LEAST_ASPECT = 29.0, 0.6
_CUT_S = 0.2
"""A jump of the play head by more than this starts hair and ribbons anew."""


@dataclass
class Orbit:
    """A camera about the person: yaw and pitch in degrees, metres away from ``target``."""

    yaw_deg: float = 25.0
    pitch_deg: float = 8.0
    distance_m: float = 3.25
    target: tuple[float, float, float] = (0.0, 0.76, 0.05)

    def turn(self, right_px: float, down_px: float) -> None:
        """The person turns with the mouse."""
        self.yaw_deg = (self.yaw_deg - 0.4 * right_px + 180.0) % 360.0 - 180.0
        self.pitch_deg = min(max(self.pitch_deg + 0.3 * down_px, -20.0), 80.0)

    def pan(self, right_px: float, down_px: float, height_px: float) -> None:
        """The picture goes with the mouse."""
        metres = 2.0 * self.distance_m * 0.26 / max(height_px, 1.0)
        yaw = radians(self.yaw_deg)
        x, y, z = self.target
        x, z = x - right_px * metres * cos(yaw), z + right_px * metres * sin(yaw)
        y += down_px * metres
        self.target = (min(max(x, -1.5), 1.5), min(max(y, 0.0), 1.8), min(max(z, -1.5), 1.5))

    def zoom(self, notches: float) -> None:
        """Nearer or further."""
        self.distance_m = min(max(self.distance_m * 0.88**notches, 0.7), 8.0)

    def look_from(self, view: str) -> None:
        """One of VIEWS, level with the person; the whole of it in sight."""
        self.yaw_deg, self.pitch_deg = VIEWS[view], 4.0
        self.distance_m, self.target = Orbit().distance_m, Orbit().target

    def camera(self, aspect: float) -> Camera:
        """For a picture of width/height ``aspect``: the person is as tall in a narrow one, as long as it fits."""
        yaw, pitch = radians(self.yaw_deg), radians(self.pitch_deg)
        x, y, z = self.target
        out = self.distance_m * cos(pitch)
        half = tan(radians(_FOV_DEG / 2.0)) * max(1.0, _LEAST_ASPECT / aspect) / max(1.0, DESIGN_ASPECT / aspect)
        fov_deg = degrees(2.0 * atan(half))
        return Camera((x + out * sin(yaw), y + self.distance_m * sin(pitch), z + out * cos(yaw)), self.target, fov_deg)


def pose_at(clip: TakeClip, time_s: float) -> Pose:
    """The take's pose at a time, blended between two frames; its last one beyond the end."""
    place = min(max(time_s / clip.frame_time_s, 0.0), len(clip.rotation) - 1.0)
    first = min(int(place), len(clip.rotation) - 2)
    share = np.float32(place - first)
    rotation = quat.nlerp(clip.rotation[first], clip.rotation[first + 1], share)
    root = clip.root[first] + (clip.root[first + 1] - clip.root[first]) * share
    nothing = np.zeros(1, dtype=np.float32)
    return Pose(
        np.asarray(rotation[None], dtype=np.float32), root[None], np.zeros((1, 2), np.float32), nothing, nothing + 0.5
    )


@dataclass
class _Puppet:
    """One take's character: its hair swings from picture to picture."""

    show: StageShow
    time_s: float | None = None
    shown: tuple[object, ...] = ()
    texture: ImguiTexture | None = None


@dataclass
class MotionPictures:
    """The takes' pictures as textures; drawn anew only where something has changed."""

    context: moderngl.Context
    backend: ImguiBackend
    _stage: StageAssets | None = None
    _renderer: Renderer | None = None
    _puppets: dict[int, _Puppet] = field(default_factory=dict)
    _face: NDArray[np.float64] | None = None

    def draw(
        self, index: int, clip: TakeClip, time_s: float, camera: Camera, size: tuple[int, int], *, stall: bool
    ) -> bool:
        """See that the picture of take ``index`` is up to date; True where it had to be drawn."""
        wanted: tuple[object, ...] = (time_s, camera, size, stall)
        puppet = self._puppets.get(index)
        if puppet is not None and puppet.shown == wanted:
            return False
        renderer = self._renderer_of(size)
        assert self._stage is not None
        puppet = self._puppets.setdefault(index, _Puppet(StageShow(self._stage)))
        pose = pose_at(clip, time_s)
        step_s = _CUT_S if puppet.time_s is None else time_s - puppet.time_s
        if not 0.0 <= step_s < _CUT_S:
            puppet.show.puppet = None
        puppet.show.tick(pose, max(step_s, 0.0))
        puppet.time_s, puppet.shown = time_s, wanted
        assert self._face is not None
        view = replace(puppet.show.frame(self._face, camera=camera), show_stall=stall)
        renderer.draw(view)
        pixels = renderer.read_pixels()
        if puppet.texture is not None and puppet.texture.size == size:
            puppet.texture.write(pixels)
        else:
            if puppet.texture is not None:
                puppet.texture.release()
            puppet.texture = ImguiTexture(self.backend, pixels)
        return True

    def texture(self, index: int) -> ImguiTexture | None:
        """The picture of a take, once it has been drawn."""
        puppet = self._puppets.get(index)
        return None if puppet is None else puppet.texture

    def _renderer_of(self, size: tuple[int, int]) -> Renderer:
        if self._renderer is None:
            self._stage, self._face = load_stage(), start_face(load_face(), 0).params
            device = Device(self.context, size, windowed=False)
            level = level_named("low" if device.software else "high")
            self._renderer = Renderer(device, self._stage.model, self._stage.stall, self._stage.backdrop, level=level)
        self._renderer.device.size = size
        return self._renderer

    def release(self) -> None:
        """Give the GL objects back."""
        for puppet in self._puppets.values():
            if puppet.texture is not None:
                puppet.texture.release()
        self._puppets.clear()
        if self._renderer is not None:
            self._renderer.release()


_LEFT = np.array([name.startswith("left") for name in REFERENCE.names])
_RIGHT = np.array([name.startswith("right") for name in REFERENCE.names])


def draw_stick(
    lines: imgui.ImDrawList, pose: Pose, camera: Camera, corner: tuple[float, float], size: tuple[float, float]
) -> None:
    """A figure of lines over floor and table; the person's left is blue, the right red."""
    to_clip = camera.view_projection(size[0] / size[1])

    def place(points: NDArray[np.floating]) -> NDArray[np.float64]:
        """(n, 3) metres -> (n, 2) pixels; NaN behind the camera."""
        clip = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ to_clip.T
        depth = np.where(clip[:, 3:] > 0.05, clip[:, 3:], np.nan)
        flat = clip[:, :2] / depth
        return np.stack(
            [corner[0] + (flat[:, 0] + 1) * size[0] / 2, corner[1] + (1 - flat[:, 1]) * size[1] / 2], axis=1
        )

    def stroke(a: NDArray[np.float64], b: NDArray[np.float64], tint: int, width: float) -> None:
        if np.isfinite(a).all() and np.isfinite(b).all():
            lines.add_line(imgui.ImVec2(*a.tolist()), imgui.ImVec2(*b.tolist()), tint, width)

    steps = np.linspace(-1.0, 1.0, 9)
    for s in steps:
        ends = place(np.array([[s, 0, -1], [s, 0, 1], [-1, 0, s], [1, 0, s]], dtype=np.float64))
        stroke(ends[0], ends[1], colour("line", 0.16), 1.0)
        stroke(ends[2], ends[3], colour("line", 0.16), 1.0)
    w, y, near, far = _HALF_TABLE_M, TABLE_TOP_M, 0.16, TABLE_FRONT_Z_M
    table = place(np.array([[-w, y, near], [w, y, near], [w, y, far], [-w, y, far]]))
    for i in range(4):
        stroke(table[i], table[(i + 1) % 4], colour("line", 0.55), 1.5)

    shift = REFERENCE.rest_translation[None].astype(np.float64)
    shift[:, 0] = pose.root
    joints, turned = REFERENCE.to_model(pose.rotation.astype(np.float64), shift)
    at = place(joints[0])
    scale = size[1] / 420.0
    for joint, parent in enumerate(REFERENCE.parents.tolist()):
        if parent < 0:
            continue
        tint = colour("blue") if _LEFT[joint] else colour("red") if _RIGHT[joint] else colour("ink")
        finger = any(word in REFERENCE.names[joint] for word in ("Thumb", "Index", "Middle", "Ring", "Little"))
        stroke(at[parent], at[joint], tint, (1.2 if finger else 4.0) * scale)
        if np.isfinite(at[joint]).all() and not finger:
            lines.add_circle_filled(imgui.ImVec2(*at[joint].tolist()), 3.2 * scale, tint)
    head = REFERENCE.index["head"]
    centre = joints[0, head] + quat.rotate(turned[0, head], np.asarray(HEAD_CENTRE_OFFSET))
    nose = centre + quat.rotate(turned[0, head], np.array([0.0, 0.0, 0.17]))
    spots = place(np.stack([centre, centre + (0.0, 0.17, 0.0), nose]))
    if np.isfinite(spots).all():
        radius = float(np.linalg.norm(spots[1] - spots[0]))
        lines.add_circle(imgui.ImVec2(*spots[0].tolist()), radius, colour("ink"), 0, 2.5 * scale)
        stroke(spots[0], spots[2], colour("ink"), 2.0 * scale)
