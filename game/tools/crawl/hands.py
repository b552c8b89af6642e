"""Whether the hands stay in the picture: the body is the message, its hands most of all."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from game.animation import Pose, Rig
from game.app.performance import fixed_world
from game.app.rig import load_rig
from game.app.shots import SHOTS
from game.app.stage import raised
from game.app.step import StepAssets, step
from game.app.world import Intent
from game.core.emotion_space import EMOTIONS
from game.core.humanoid import REFERENCE
from game.core.paths import ASSETS
from game.render import Camera
from game.story import Spoken

__all__ = ["Hands", "Outside", "hands_outside", "on_picture"]

ASPECT = 16.0 / 9.0
SETTLE_TICKS = 45
"""The feeling has this long to reach the body before anything is measured."""
ALLOWED = 0.02
"""A hand may leave the picture for this share of the time: on its way, not to stay."""


@dataclass(frozen=True)
class Outside:
    """A hand out of the picture in one feeling: share of the time, and how far at most, in halves of the picture."""

    emotion: str
    hand: str
    share: float
    far: float


def on_picture(camera: Camera, points: NDArray[np.float64], aspect: float = ASPECT) -> NDArray[np.float64]:
    """(n, 2) places of points (n, 3) in model space, in [-1, 1] across and up the picture."""
    whole = np.concatenate([points, np.ones((len(points), 1))], axis=1)
    clip = whole @ np.asarray(camera.view_projection(aspect), np.float64).T
    return np.asarray(clip[:, :2] / clip[:, 3:4])


@dataclass(frozen=True, eq=False)
class Hands:
    """Where a person's own hands are, of whatever size the person is.

    joints: wrist and fingers of the left hand and of the right, places in the rig's skeleton; lift_m: how much higher
    than the reference's the head is.
    """

    rig: Rig
    joints: tuple[NDArray[np.intp], NDArray[np.intp]]
    lift_m: float

    @staticmethod
    def of(rig: Rig) -> Hands:
        """The hands of a rig: every joint below a wrist, the wrist too."""
        sides: list[NDArray[np.intp]] = []
        for side in ("left", "right"):
            wrist = int(rig.driven[rig.source == REFERENCE.index[f"{side}Hand"]][0])
            below = {wrist}
            for joint, parent in enumerate(rig.skeleton.parents):
                if int(parent) in below:
                    below.add(joint)
            sides.append(np.array(sorted(below)))
        head = REFERENCE.index["head"]
        place = rig.skeleton.rest_model[rig.driven[rig.source == head], 1, 3]
        lift_m = float(place[0] - REFERENCE.rest_model[head, 1, 3]) if len(place) else 0.0
        return Hands(rig, (sides[0], sides[1]), lift_m)

    def places(self, pose: Pose) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(n, 3) of the left hand and of the right in a pose, metres."""
        whole = self.rig.joint_matrices(pose)[0, :, :3, 3]
        left, right = (np.asarray(whole[joints], np.float64) for joints in self.joints)
        return left, right


def hands_outside(
    assets: StepAssets, seconds: float = 8.0, seed: int = 1, emotions: Iterable[str] = EMOTIONS, shot: str = "talk"
) -> list[Outside]:
    """Hands that leave a shot of a person who speaks, to the last finger, by feeling. ``assets`` with a performer.

    The body is that of the stall's person, the camera as high as that person asks.
    """
    found: list[Outside] = []
    hands = Hands.of(load_rig(ASSETS / "characters" / f"{assets.talk.script.person.id}.vrm"))
    camera = raised(SHOTS[shot], hands.lift_m)
    line = next(iter(assets.talk.script.all_lines()))
    said = Spoken(id="crawl", speaker="shopkeeper", en=line.text.en, ja=line.text.ja)
    for emotion in emotions:
        felt = np.zeros(7)
        felt[EMOTIONS.index(emotion)] = 0.9
        world, off = fixed_world(assets, felt, seed), []
        for tick in range(SETTLE_TICKS + round(seconds * 30)):
            if world.speech is None and not world.queue:
                world = replace(world, queue=(said,))
            world = step(assets, world, Intent(proceed=tick % 150 == 149))
            assert world.body.pose is not None
            if tick >= SETTLE_TICKS:
                places = hands.places(world.body.pose)
                off.append([np.abs(on_picture(camera, points)).max() - 1.0 for points in places])
        for name, by in zip(("left", "right"), np.array(off).T, strict=True):
            share = float((by > 0).mean())
            if share > ALLOWED:
                found.append(Outside(emotion, name, share, float(by.max())))
    return found
