"""A small made-up repertoire: three emotions, postures that differ, gestures with strokes, a periodic mannerism."""

from __future__ import annotations

import numpy as np
import pytest

from game.core import quaternion as quat
from game.core.emotion_space import EMOTIONS
from game.core.humanoid import REFERENCE
from game.embos import ClipBank, MotionUnit, TakeClip, UnitLibrary, Variant

FPS = 30.0
J = REFERENCE.index
SEEN = ("anger", "joy", "neutral")


def turned(degrees: np.ndarray, axis: tuple[float, float, float]) -> np.ndarray:
    return quat.from_axis_angle(np.array(axis), np.radians(degrees))


def make_take(emotion: int) -> TakeClip:
    """20 s: 0–5 upright, 5–10 lean with the left hand down before it, 10–12 point, 12–14 nod-and-touch, 14–20 tap."""
    t = np.arange(int(20 * FPS)) / FPS
    size = 1.0 + 0.25 * emotion
    q = np.tile(quat.IDENTITY, (len(t), len(REFERENCE), 1))
    wave = np.sin(2 * np.pi * 0.4 * t)

    def bump(a: float, b: float) -> np.ndarray:
        u = np.clip(np.minimum((t - a) / 0.5, (b - t) / 0.5), 0, 1)
        return u * u * (3 - 2 * u)

    leaning, pointing, touching, tapping = bump(4.8, 9.9), bump(10, 12), bump(12, 14), bump(14, 20)
    q[:, J["spine"]] = turned(2 * size * wave + 12 * leaning, (1, 0, 0))
    q[:, J["chest"]] = turned(4 * size + 3 * wave + 6 * pointing, (1, 0, 0))
    q[:, J["head"]] = turned(6 * wave * size + 15 * touching, (0.5, 1, 0))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        q[:, J[f"{side}UpperArm"]] = quat.multiply(
            turned(-72 * sign + 4 * wave, (0, 0, 1)), turned(-15 * sign * np.ones_like(t), (0, 1, 0))
        )
        q[:, J[f"{side}LowerArm"]] = turned(-(95 + 8 * size * wave) * sign, (0, 1, 0))
        for finger in ("Index", "Middle", "Ring", "Little"):
            q[:, J[f"{side}{finger}Proximal"]] = turned(20 * sign * np.ones_like(t), (0, 0, -1))
    q[:, J["leftLowerArm"]] = quat.slerp(
        q[:, J["leftLowerArm"]], np.tile(turned(np.array(-125.0), (0, 1, 0)), (len(t), 1)), leaning
    )
    raised = quat.multiply(turned(60 * pointing * size / 1.5, (0, 1, 0)), q[:, J["rightUpperArm"]])
    q[:, J["rightUpperArm"]] = raised
    q[:, J["rightLowerArm"]] = quat.multiply(turned(-35 * touching, (0, 1, 0)), q[:, J["rightLowerArm"]])
    tap = tapping * np.sin(2 * np.pi * 2.0 * t)
    q[:, J["leftHand"]] = turned(14 * tap, (0, 0, 1))
    root = np.tile(REFERENCE.rest_translation[0], (len(t), 1))
    root[:, 1] -= 0.012
    root[:, 0] += 0.01 * wave * size
    root[:, 2] += 0.03 * leaning
    return TakeClip(q.astype(np.float32), root.astype(np.float32), 1.0 / FPS)


def _unit(name: str, layer: str, start: float, end: float, clean: tuple[float, float], **more: object) -> MotionUnit:
    stroke = more.pop("stroke", None)
    seen = [EMOTIONS.index(e) for e in SEEN]
    variants = tuple(
        Variant(k, EMOTIONS[k], start, end, *clean, None if stroke is None else float(stroke)) for k in seen
    )
    intensity, duration, waiting = np.zeros(7), np.zeros(7), np.zeros(7)
    intensity[seen], duration[seen], waiting[seen] = 0.9, end - start, 2.0
    return MotionUnit(name, layer, intensity, duration, waiting, 0.3, variants=variants, **more)  # type: ignore[arg-type]


def make_library() -> UnitLibrary:
    arm = frozenset({"right_arm", "right_hand"})
    return UnitLibrary(
        [
            _unit("upright", "posture", 0.0, 4.8, (0.2, 4.6), uses=frozenset({"legs"})),
            _unit(
                "hand_on_table",
                "posture",
                5.0,
                10.0,
                (5.6, 9.2),
                uses=frozenset({"left_arm", "left_hand"}),
                contacts={"left_hand": "table"},
            ),
            _unit("point", "gesture", 10.0, 12.0, (10.0, 12.0), stroke=10.7, uses=arm, words={"en": ("this",)}),
            _unit(
                "touch_face",
                "mannerism",
                12.0,
                14.0,
                (12.0, 14.0),
                uses=arm | {"head"},
                contacts={"right_hand": "head"},
            ),
            _unit("tap", "mannerism", 14.0, 20.0, (14.0, 20.0), uses=frozenset({"left_arm", "left_hand"})),
        ],
        ClipBank({EMOTIONS[k]: make_take(k) for k in (EMOTIONS.index(e) for e in SEEN)}),
    )


@pytest.fixture(scope="session")
def library() -> UnitLibrary:
    return make_library()
