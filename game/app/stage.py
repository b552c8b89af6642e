"""What is seen: the shopkeeper's model and rig, the stall, and turning a world into a frame for the renderer."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import radians, tan
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from game.animation import Pose, Rig, SpringState
from game.app.rig import load_rig
from game.core.humanoid import REFERENCE
from game.core.paths import ASSETS
from game.face import (
    DEFAULT_STYLE,
    DrawList,
    FaceLeak,
    FaceParams,
    FaceSignal,
    FaceStyle,
    read_style,
    tessellate,
)
from game.formats import Node, load_yaml
from game.render import (
    DESIGN_SHARE,
    HERO,
    Camera,
    Card,
    CharacterModel,
    CrowdView,
    FrameView,
    Hud,
    ItemView,
    StaticMesh,
)
from game.render.assets import load_character, load_picture, load_stall
from game.render.avatar_model import AvatarLook, AvatarModel
from game.render.face_planes import face_planes
from game.render.mood import MARKET_MOOD, read_mood

if TYPE_CHECKING:
    from game.app.avatar import Avatar
    from game.app.world import Body

__all__ = ["Puppet", "StageAssets", "StageShow", "load_stage", "raised"]

_HEAD = REFERENCE.index["head"]
_STALL_SEEN_M, _FACE_SEEN_M = 1.25, 0.99
"""Height of what a shot of the stall sees at its target, and of what a close-up does."""


@dataclass(frozen=True, eq=False)
class StageAssets:
    """Everything drawn: the person's meshes and rig, the stall, the painted backdrop (h, w, 3) uint8.

    carries: item -> the item that stands on it; cards: item -> its price card. face: how the person's face is drawn.
    lift_m: how much higher the person's head is than the reference's. avatar: the foreign one in the shopkeeper's
    place, if any.
    """

    model: CharacterModel | AvatarModel
    rig: Rig
    stall: StaticMesh
    backdrop: NDArray[np.uint8]
    carries: Mapping[str, str]
    cards: Mapping[str, Card]
    face: FaceStyle = DEFAULT_STYLE
    lift_m: float = 0.0
    avatar: Avatar | None = None

    def gone(self, sold: frozenset[str]) -> frozenset[str]:
        """The stall's groups that are no longer there; what still carries something waits for it to go first."""
        return frozenset(f"item:{item}" for item in sold if self.carries.get(item, item) in sold)

    def framed(self, camera: Camera) -> Camera:
        """The camera as high as the person asks: a shot of the face follows the head, one of the stall stays."""
        return raised(camera, self.lift_m)


def raised(camera: Camera, lift_m: float) -> Camera:
    """A camera for a person whose head is so much higher than the reference's."""
    seen_m = 2.0 * camera.distance_m(camera.target) * tan(radians(camera.fov_deg / 2.0))
    share = min(max((_STALL_SEEN_M - seen_m) / (_STALL_SEEN_M - _FACE_SEEN_M), 0.0), 1.0)
    if share == 0.0 or lift_m == 0.0:
        return camera
    (ex, ey, ez), (tx, ty, tz) = camera.eye, camera.target
    return replace(camera, eye=(ex, ey + share * lift_m, ez), target=(tx, ty + share * lift_m, tz))


def load_stage(
    person: str = "mira",
    stall: str = "flea",
    folder: Path = ASSETS,
    models: Path | None = None,
    avatar: Avatar | None = None,
) -> StageAssets:
    """Read a person and a stall. models: where the person's model lies, if not in ``folder``/characters; avatar:
    stands in the person's place.

    Raises BadInput with file and JSON pointer, or line and column of the person's YAML.
    """
    characters, stalls = folder / "characters", folder / "stalls"
    model: CharacterModel | AvatarModel
    style = _style(characters / f"{person}.yaml")
    if avatar is not None:
        model, rig, lift_m = avatar.model, avatar.rig, avatar.lift_m
    else:
        vrm = (models or characters) / f"{person}.vrm"
        model, rig = replace(load_character(vrm), planes=face_planes(style)), load_rig(vrm)
        head = rig.skeleton.rest_model[rig.driven[rig.source == _HEAD], 1, 3]
        lift_m = float(head[0] - REFERENCE.rest_model[_HEAD, 1, 3]) if len(head) else 0.0
    told = load_yaml(stalls / f"{stall}.yaml")
    mood = told.get("mood")
    return StageAssets(
        model=model,
        rig=rig,
        face=style,
        lift_m=lift_m,
        avatar=avatar,
        stall=load_stall(stalls / f"{stall}.glb", MARKET_MOOD if mood is None else read_mood(mood)),
        backdrop=load_picture(stalls / f"{stall}_backdrop.png"),
        carries=_carries(told["goods"]),
        cards=_cards(told["goods"]),
    )


def _style(path: Path) -> FaceStyle:
    """The section ``face`` of a person's YAML; the standard face where there is none."""
    section = load_yaml(path).get("face") if path.is_file() else None
    return DEFAULT_STYLE if section is None else read_style(section)


def _carries(goods: Node) -> dict[str, str]:
    return {row["on"].as_str(): row["item"].as_str() for row in goods.as_list() if row.get("on") is not None}


def _cards(goods: Node) -> dict[str, Card]:
    """Item -> where its price card stands."""
    cards = {}
    for row in goods:
        card = row.get("card")
        if card is not None:
            x, z, turn_deg = (value.as_float() for value in card)
            cards[row["item"].as_str()] = (x, z, radians(turn_deg))
    return cards


@dataclass
class Puppet:
    """The rig in motion between ticks: spring bones advance once per tick, poses are blended for frames between."""

    rig: Rig
    state: SpringState
    before: NDArray[np.float32]
    after: NDArray[np.float32]

    @staticmethod
    def of(rig: Rig, pose: Pose) -> Puppet:
        """A puppet at rest in a pose."""
        state = rig.start(len(pose))
        state, matrices = rig.advance(state, pose, 0.0)
        return Puppet(rig, state, matrices, matrices)

    def tick(self, pose: Pose, dt_s: float) -> None:
        """One tick on: the last skin matrices become those before."""
        self.before = self.after
        self.state, self.after = self.rig.advance(self.state, pose, dt_s)

    def matrices(self, share: float) -> NDArray[np.float32]:
        """(J, 4, 4) skin matrices at a share in [0, 1] between the last two ticks."""
        # Ticks are a thirtieth of a second apart: blending matrices linearly is exact enough to be invisible.
        mixed = self.before[0] + (self.after[0] - self.before[0]) * np.float32(share)
        return np.asarray(mixed)


@dataclass
class StageShow:
    """Turns poses and faces into frames; keeps the face's triangles until its numbers change."""

    assets: StageAssets
    puppet: Puppet | None = None
    _face: DrawList | None = None
    _params: FaceParams | None = None
    _looks: tuple[AvatarLook, AvatarLook] | None = None

    def tick(self, pose: Pose, dt_s: float, body: Body | None = None) -> None:
        """Follow the world by one tick; body: of that world, for an avatar's face."""
        avatar = self.assets.avatar
        moment = None if avatar is None or body is None else _Moment.of(body)
        if avatar is not None and moment is not None:
            look, gaze = avatar.look(moment.signal, moment.params, moment.visemes, moment.leak)
            self._looks = (look if self._looks is None else self._looks[1], look)
            pose = replace(pose, gaze=pose.gaze * np.float32(gaze))
        if self.puppet is None:
            self.puppet = Puppet.of(self.assets.rig, pose)
        else:
            self.puppet.tick(pose, dt_s)

    def frame(
        self,
        params: FaceParams,
        *,
        matrices: NDArray[np.float32] | None = None,
        camera: Camera = HERO,
        share: float = 1.0,
        show_face: bool = True,
        hidden_items: frozenset[str] = frozenset(),
        time_s: float = 0.0,
        day_share: float = DESIGN_SHARE,
        crowd: CrowdView | None = None,
        item: ItemView | None = None,
        hud: Callable[[Hud], None] | None = None,
    ) -> FrameView:
        """The frame as the renderer wants it. matrices (j, 4, 4): another moment's body instead of the present one."""
        assert self.puppet is not None, "tick comes before frame"
        stale = self._face is None or self._params is None or np.abs(params - self._params).max() > 1e-3
        if stale and self.assets.avatar is None:
            self._face, self._params = tessellate(params, self.assets.face), params.copy()
        return FrameView(
            skin_matrices=self.puppet.matrices(share) if matrices is None else matrices,
            camera=self.assets.framed(camera),
            face=self._face,
            look=self._look(share, show_face),
            show_face=show_face,
            hidden_items=hidden_items,
            time_s=time_s,
            day_share=day_share,
            crowd=crowd,
            item=item,
            hud=hud,
        )

    def _look(self, share: float, show_face: bool) -> AvatarLook | None:
        """The avatar's expression at a share between the last two ticks; none at all where faces are hidden."""
        if self._looks is None:
            return None
        before, after = self._looks
        if not show_face:
            return replace(after, morph=np.zeros_like(after.morph), colours={}, shifts={})
        return replace(after, morph=before.morph + (after.morph - before.morph) * np.float32(share))


@dataclass(frozen=True)
class _Moment:
    """What drives an avatar's face in one tick: what reached the painted face, its numbers (K,), visemes (6,), and
    what breaks through the mask."""

    signal: FaceSignal
    params: FaceParams
    visemes: NDArray[np.float64]
    leak: FaceLeak | None

    @staticmethod
    def of(body: Body) -> _Moment | None:
        """Of a world's body; None before its first tick."""
        if body.face_signal is None or body.face_params is None or body.face is None:
            return None
        return _Moment(body.face_signal, body.face_params, body.face.visemes, body.face.leak)
