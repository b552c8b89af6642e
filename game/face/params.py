"""The numbers that describe one drawn expression: every one is continuous, so every two expressions interpolate.

An expression is a vector (K,) float64 in the order of ``FIELDS``. Lengths are mm in head-rest space (x to the
character's left, y up, origin at the head's centre), angles degrees because designers type them, amounts 0..1
(some reach a little further for effect). Sides: a positive ``uneven``/``asym`` number favours the side named there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput

__all__ = ["FIELDS", "INDEX", "REGIONS", "FaceParams", "Field", "clamp", "face_params", "field_bounds", "region_mask"]

FaceParams = NDArray[np.float64]
REGIONS: tuple[str, ...] = ("eyes", "eyebrows", "mouth", "skin")


@dataclass(frozen=True)
class Field:
    """One number of an expression: its region, its range and its value on the standard face."""

    name: str
    region: str
    low: float
    high: float
    standard: float
    meaning: str


FIELDS: tuple[Field, ...] = (
    Field("eye_open", "eyes", 0.0, 1.3, 1.0, "0 closed, 1 standard, above 1 wide"),
    Field("eye_squint", "eyes", 0.0, 1.0, 0.0, "lower lid pushed up"),
    Field("eye_slant", "eyes", -1.0, 1.0, 0.0, "+ inner corners down (fierce), - outer corners down (sad)"),
    Field("eye_flat", "eyes", 0.0, 1.0, 0.0, "upper lid flattened (bored, smug)"),
    Field("eye_arc", "eyes", -1.0, 1.0, -0.55, "line where the lids meet: + arch of a happy eye, - sleeping"),
    Field("eye_squeeze", "eyes", 0.0, 1.0, 0.0, "closed eyes squeezed to > <"),
    Field("eye_uneven", "eyes", -1.0, 1.0, 0.0, "share of opening taken from the right (+) or left (-) eye"),
    Field("look_x", "eyes", -1.0, 1.0, 0.0, "iris toward the character's left (+)"),
    Field("look_y", "eyes", -1.0, 1.0, 0.0, "iris up (+)"),
    Field("iris_size", "eyes", 0.4, 1.3, 1.0, "iris radius factor"),
    Field("iris_alpha", "eyes", 0.0, 1.0, 1.0, "0 = blank white eyes"),
    Field("pupil_size", "eyes", 0.1, 1.6, 1.0, "pupil radius factor"),
    Field("highlight", "eyes", 0.0, 1.6, 1.0, "size of the light spots"),
    Field("sparkle", "eyes", 0.0, 1.0, 0.0, "star-shaped lights"),
    Field("tear_well", "eyes", 0.0, 1.0, 0.0, "water along the lower lid"),
    Field("brow_raise", "eyebrows", -22.0, 26.0, 0.0, "mm"),
    Field("brow_angle", "eyebrows", -35.0, 35.0, 0.0, "degrees, + inner ends down"),
    Field("brow_curve", "eyebrows", -1.5, 2.5, 1.0, "arch"),
    Field("brow_inner", "eyebrows", -12.0, 12.0, 0.0, "mm of the inner ends toward the nose (-) or away (+)"),
    Field("brow_thick", "eyebrows", 0.4, 1.8, 1.0, "thickness factor"),
    Field("brow_uneven", "eyebrows", -20.0, 20.0, 0.0, "mm by which the character's right brow is higher"),
    Field("brow_knit", "eyebrows", 0.0, 1.0, 0.0, "furrows between the brows"),
    Field("mouth_width", "mouth", 5.0, 58.0, 27.0, "half width in mm"),
    Field("mouth_corner", "mouth", -22.0, 22.0, 7.0, "mm by which the corners lie above the line"),
    Field("mouth_open", "mouth", 0.0, 52.0, 0.0, "mm by which the lower lip falls"),
    Field("mouth_top", "mouth", -6.0, 20.0, 0.0, "mm by which the upper lip arches when open"),
    Field("mouth_square", "mouth", 0.0, 1.0, 0.0, "0 round, 1 box-shaped opening"),
    Field("mouth_peak", "mouth", -1.0, 1.0, 0.0, "line peaks to a tent (+) or a valley (-)"),
    Field("mouth_cat", "mouth", 0.0, 1.0, 0.0, "ω shape"),
    Field("mouth_wave", "mouth", -1.0, 1.0, 0.0, "wobbling line"),
    Field("mouth_asym", "mouth", -18.0, 18.0, 0.0, "mm by which the left corner is higher"),
    Field("mouth_skew", "mouth", -16.0, 16.0, 0.0, "mm to the character's left"),
    Field("mouth_y", "mouth", -14.0, 14.0, 0.0, "mm up"),
    Field("mouth_pout", "mouth", 0.0, 1.0, 0.0, "lips pushed out"),
    Field("teeth", "mouth", 0.0, 1.0, 0.0, "upper row"),
    Field("teeth_clench", "mouth", 0.0, 1.0, 0.0, "both rows shut"),
    Field("tongue", "mouth", 0.0, 1.0, 0.0, "tongue inside the mouth"),
    Field("tongue_out", "mouth", 0.0, 1.0, 0.0, "tongue hanging out"),
    Field("sneer", "mouth", 0.0, 1.0, 0.0, "wrinkled nose and the fold beside it"),
    Field("sigh", "mouth", 0.0, 1.0, 0.0, "a puff of breath beside the mouth"),
    Field("blush", "skin", 0.0, 1.6, 0.25, "soft red on the cheeks"),
    Field("blush_lines", "skin", 0.0, 1.0, 0.0, "short strokes on the cheeks"),
    Field("red", "skin", 0.0, 1.0, 0.0, "the whole face flushed"),
    Field("pale", "skin", 0.0, 1.0, 0.0, "colour gone from the face"),
    Field("gloom", "skin", 0.0, 1.0, 0.0, "blue shade from above"),
    Field("gloom_lines", "skin", 0.0, 1.0, 0.0, "vertical lines of dread"),
    Field("sick", "skin", 0.0, 1.0, 0.0, "green tinge"),
    Field("tear", "skin", 0.0, 1.0, 0.0, "drop at the outer corner"),
    Field("tear_stream", "skin", 0.0, 1.0, 0.0, "tears running down the cheeks"),
    Field("sweat", "skin", 0.0, 1.0, 0.0, "drop at the temple, over the hair"),
    Field("vein", "skin", 0.0, 1.0, 0.0, "cross of anger, over the hair"),
    Field("warm", "skin", 0.0, 1.0, 0.0, "wide peach glow, as after a bath"),
    Field("bags", "skin", 0.0, 1.0, 0.0, "dark rings under the eyes"),
    Field("snooze", "skin", 0.0, 1.0, 0.0, "z z z beside the head, over the hair"),
)  # fmt: skip

INDEX: Mapping[str, int] = MappingProxyType({field.name: i for i, field in enumerate(FIELDS)})


def field_bounds() -> tuple[FaceParams, FaceParams]:
    """Lowest and highest allowed expression, two (K,) arrays."""
    return np.array([f.low for f in FIELDS]), np.array([f.high for f in FIELDS])


_LOW, _HIGH = field_bounds()


def region_mask(region: str) -> NDArray[np.bool_]:
    """(K,) bool: which numbers belong to the region."""
    return np.array([f.region == region for f in FIELDS])


def face_params(**values: float) -> FaceParams:
    """The standard expression with some numbers changed, (K,). Raises BadInput for an unknown name or a wrong range."""
    result = np.array([f.standard for f in FIELDS])
    for name, value in values.items():
        if name not in INDEX:
            near = get_close_matches(name, INDEX, 1)
            raise BadInput(
                "face parameter",
                expected="a known name",
                seen=name,
                hint=f"did you mean {near[0]}?" if near else None,
            )
        field = FIELDS[INDEX[name]]
        if not field.low <= value <= field.high:
            raise BadInput(f"face parameter {name}", expected=f"{field.low:g} to {field.high:g}", seen=value)
        result[INDEX[name]] = value
    return result


def clamp(params: FaceParams) -> FaceParams:
    """Params (..., K) forced into the allowed ranges."""
    return np.asarray(np.minimum(np.maximum(params, _LOW), _HIGH))
