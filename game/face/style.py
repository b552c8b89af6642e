"""How one character's face is drawn: colours and places of the features; expressions are the same for all."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["DEFAULT_STYLE", "FaceStyle"]


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
    brow_x: float = 63.0
    brow_y: float = 21.0
    brow_scale: float = 1.16
    brow_weight: float = 1.42
    mouth_y: float = -110.0
    line_weight: float = 1.0


DEFAULT_STYLE = FaceStyle()
