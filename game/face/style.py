"""How one character's face is drawn: colours and places of the features; expressions are the same for all."""

from __future__ import annotations

from dataclasses import dataclass, fields

from game.face.params import INDEX
from game.formats import Node

__all__ = ["DEFAULT_STYLE", "FaceStyle", "read_style"]


@dataclass(frozen=True)
class FaceStyle:
    """Colours are ``#RRGGBB`` (sRGB); places mm from the head's centre, for the character's left side."""

    iris: tuple[str, str, str, str] = ("#0C2B3A", "#12566A", "#1F9C98", "#8DEBCB")  # top to bottom
    iris_glow: str = "#C8FFE6"
    iris_rim: str = "#0A2230"
    pupil: str = "#071620"
    eye_white: str = "#FFFCF7"
    lid_shadow: str = "#2B1630"
    lash: str = "#3B1A1C"
    lower_lash: str = "#6B3030"
    crease: str = "#C0705C"
    brow: str = "#5B2A22"
    nose: str = "#D98468"
    lip: str = "#7A2A2A"
    lip_soft: str = "#E39A82"
    mouth_deep: str = "#5E1520"
    mouth_light: str = "#A83A3E"
    tongue: str = "#F58A83"
    tooth: str = "#FFFDF6"
    tooth_line: str = "#8B3A3A"
    eye_x: float = 63.0
    eye_y: float = -36.0
    eye_scale: float = 1.13
    eye_height: float = 1.0  # of the eye's own height
    lash_weight: float = 1.0  # of the upper lash's thickness
    lash_wing: float = 1.0  # of the wing at its outer end, 0 = none
    brow_x: float = 63.0
    brow_y: float = 21.0
    brow_scale: float = 1.16
    brow_weight: float = 1.42
    nose_scale: float = 1.0
    nose_y: float = 0.0  # mm up
    mouth_y: float = -110.0
    mouth_scale: float = 1.0
    line_weight: float = 1.0
    age: float = 0.0  # 0 … 1: lines on brow and cheeks, beside and under the eyes
    ruddy: float = 0.0  # 0 … 1: red on cheeks and nose at all times
    rest: tuple[tuple[str, float], ...] = ()  # numbers of an expression (params.py) that this face adds to each


DEFAULT_STYLE = FaceStyle()

_LIMITS = {"eye_x": (30.0, 90.0), "eye_y": (-90.0, 40.0), "brow_x": (30.0, 90.0), "brow_y": (-30.0, 80.0)} | {
    "mouth_y": (-150.0, -70.0),
    "nose_y": (-40.0, 40.0),
    "age": (0.0, 1.0),
    "ruddy": (0.0, 1.0),
    "lash_wing": (0.0, 2.0),
}


def read_style(node: Node) -> FaceStyle:
    """A style from a mapping of what differs from the standard one. Raises BadInput with the place."""
    node.only(*(f.name for f in fields(FaceStyle)))
    given: dict[str, object] = {}
    for name, value in node.as_mapping().items():
        standard = getattr(DEFAULT_STYLE, name)
        if name == "rest":
            bodies = value.only(*INDEX).as_mapping()
            given[name] = tuple((key, body.as_float(-60.0, 60.0)) for key, body in bodies.items())
        elif isinstance(standard, str):
            given[name] = _colour(value)
        elif isinstance(standard, tuple):
            items = value.as_list()
            if len(items) != len(standard):
                raise value.error(expected=f"{len(standard)} colours, top to bottom")
            given[name] = tuple(_colour(item) for item in items)
        else:
            given[name] = value.as_float(*_LIMITS.get(name, (0.3, 3.0)))
    return FaceStyle(**given)  # type: ignore[arg-type]  # every value has been read by its field's type


def _colour(node: Node) -> str:
    text = node.as_str()
    if len(text) != 7 or text[0] != "#" or not all(c in "0123456789ABCDEFabcdef" for c in text[1:]):
        raise node.error(expected='a colour "#rrggbb"')
    return text
