"""Whether the hands stay in the picture: the body is the message, its hands most of all."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from game.animation import Pose
from game.app.performance import fixed_world
from game.app.shots import SHOTS
from game.app.step import StepAssets, step
from game.app.world import Intent
from game.core.emotion_space import EMOTIONS
from game.core.humanoid import REFERENCE
from game.render import Camera
from game.story import Spoken

__all__ = ["Outside", "hands_outside", "on_picture"]

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


def hands_of(pose: Pose) -> NDArray[np.float64]:
    """(2, 3) wrists, left and right, metres."""
    shift = np.broadcast_to(REFERENCE.rest_translation, (1, len(REFERENCE), 3)).copy()
    shift[:, REFERENCE.index["hips"]] = pose.root
    places = REFERENCE.to_model(pose.rotation.astype(np.float64), shift)[0][0]
    return np.asarray(places[[REFERENCE.index["leftHand"], REFERENCE.index["rightHand"]]], np.float64)


def hands_outside(
    assets: StepAssets, seconds: float = 8.0, seed: int = 1, emotions: Iterable[str] = EMOTIONS, shot: str = "talk"
) -> list[Outside]:
    """Hands that leave a shot of a person who speaks, in every feeling. ``assets`` with a performer."""
    found: list[Outside] = []
    line = next(iter(assets.talk.script.all_lines()))
    said = Spoken(id="crawl", speaker="shopkeeper", en=line.text.en, ja=line.text.ja)
    for emotion in emotions:
        felt = np.zeros(7)
        felt[EMOTIONS.index(emotion)] = 0.9
        world, places = fixed_world(assets, felt, seed), []
        for tick in range(SETTLE_TICKS + round(seconds * 30)):
            if world.speech is None and not world.queue:
                world = replace(world, queue=(said,))
            world = step(assets, world, Intent(proceed=tick % 150 == 149))
            assert world.body.pose is not None
            if tick >= SETTLE_TICKS:
                places.append(hands_of(world.body.pose))
        for at, hand in enumerate(("left", "right")):
            off = np.abs(on_picture(SHOTS[shot], np.array(places)[:, at])).max(axis=1) - 1.0
            share = float((off > 0).mean())
            if share > ALLOWED:
                found.append(Outside(emotion, hand, share, float(off.max())))
    return found
