"""The 52 blend shapes of ARKit ("perfect sync" avatars) from the numbers of the painted face."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from game.face.params import FIELDS, INDEX, FaceParams

__all__ = ["ARKIT", "arkit_weights", "find_arkit"]

Floats = NDArray[np.float64]

_SIDED = (
    *("browDown", "browOuterUp", "cheekSquint", "noseSneer"),
    *("eyeBlink", "eyeLookDown", "eyeLookIn", "eyeLookOut", "eyeLookUp", "eyeSquint", "eyeWide"),
    *("mouthDimple", "mouthFrown", "mouthLowerDown", "mouthPress", "mouthSmile", "mouthStretch", "mouthUpperUp"),
)
_SINGLE = (
    *("browInnerUp", "cheekPuff", "tongueOut", "jawForward", "jawLeft", "jawOpen", "jawRight"),
    *("mouthClose", "mouthFunnel", "mouthLeft", "mouthPucker", "mouthRight", "mouthRollLower", "mouthRollUpper"),
    *("mouthShrugLower", "mouthShrugUpper"),
)
ARKIT: tuple[str, ...] = (*(f"{name}{side}" for name in _SIDED for side in ("Left", "Right")), *_SINGLE)
"""ARFaceAnchor.BlendShapeLocation, by Apple's names."""

_LEAST = 20
"""With fewer of the names an avatar merely happens to share some of them."""
_STANDARD = {field.name: field.standard for field in FIELDS}


def find_arkit(names: Sequence[str]) -> dict[str, int]:
    """Which of an avatar's expressions are ARKit's: name -> place. Empty unless most of them are there.

    Spelling differs between programs: browDownLeft, BrowDownLeft, browDown_L are one.
    """
    wanted = {_plain(name): name for name in ARKIT}
    found = {wanted[_plain(name)]: i for i, name in reversed(list(enumerate(names))) if _plain(name) in wanted}
    return found if len(found) >= _LEAST else {}


def _plain(name: str) -> str:
    low = name.lower().replace("_", "").replace(" ", "").removeprefix("arkit")
    for short, side in (("l", "left"), ("r", "right")):
        stem = low.removesuffix(short)
        if stem != low and any(stem == single.lower() for single in _SIDED):
            return stem + side
    return low


def arkit_weights(places: Mapping[str, int], params: FaceParams, weight: Floats) -> None:
    """Write 0..1 at the places of the ARKit shapes. params: (K,) of the painted face, with blink, look and speech."""

    def p(name: str) -> float:
        return float(params[INDEX[name]])

    opening = p("eye_open")
    shut = {"Left": max(p("eye_uneven") * -1.0, 0.0), "Right": max(p("eye_uneven"), 0.0)}
    rise, angle, corner = p("brow_raise") / 26.0, p("brow_angle") / 35.0, p("mouth_corner") - _STANDARD["mouth_corner"]
    wide = (p("mouth_width") - _STANDARD["mouth_width"]) / 31.0
    mouth = p("mouth_open") / 52.0
    values = {
        "browInnerUp": max(rise - angle, 0.0),
        "jawOpen": 1.1 * mouth,
        "mouthFunnel": max(-1.6 * wide, 0.0) * min(3.0 * mouth, 1.0),
        "mouthPucker": max(p("mouth_pout"), -1.6 * wide * (1.0 - min(3.0 * mouth, 1.0))),
        "mouthRollLower": 0.5 * abs(p("mouth_wave")),
        "mouthShrugLower": 0.6 * max(p("mouth_peak"), 0.0),
        "mouthShrugUpper": max(p("mouth_top"), 0.0) / 20.0,
        "mouthLeft": max(p("mouth_skew"), 0.0) / 16.0,
        "mouthRight": max(-p("mouth_skew"), 0.0) / 16.0,
        "tongueOut": p("tongue_out"),
        "cheekPuff": 0.5 * p("mouth_pout"),
    }
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        lift = -sign * p("brow_uneven") / 40.0
        smile = (corner + 0.5 * sign * p("mouth_asym")) / 15.0
        look = sign * p("look_x")
        values |= {
            f"eyeBlink{side}": 1.0 - min(opening * (1.0 - shut[side]), 1.0),
            f"eyeWide{side}": max(opening - 1.0, 0.0) / 0.3,
            f"eyeSquint{side}": max(p("eye_squint"), p("eye_flat")),
            f"eyeLookOut{side}": look,
            f"eyeLookIn{side}": -look,
            f"eyeLookUp{side}": p("look_y"),
            f"eyeLookDown{side}": -p("look_y"),
            f"browDown{side}": max(angle, 0.0) + max(-rise, 0.0) + 0.4 * p("brow_knit"),
            f"browOuterUp{side}": max(rise + 0.4 * angle + lift, 0.0),
            f"cheekSquint{side}": 0.7 * p("eye_squint"),
            f"noseSneer{side}": p("sneer"),
            f"mouthSmile{side}": smile,
            f"mouthFrown{side}": -smile,
            f"mouthStretch{side}": max(wide, 0.0) + 0.5 * p("mouth_square"),
            f"mouthUpperUp{side}": 0.6 * p("teeth"),
            f"mouthLowerDown{side}": 0.5 * p("teeth") * min(3.0 * mouth, 1.0),
            f"mouthPress{side}": p("teeth_clench"),
            f"mouthDimple{side}": 0.5 * p("mouth_cat"),
        }
    for name, value in values.items():
        if name in places:
            weight[places[name]] = min(max(value, 0.0), 1.0)
