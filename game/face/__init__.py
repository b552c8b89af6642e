"""The anime face: parts and what they mean, the face for an emotion, its life over time, its triangles."""

from game.face.drawing import tessellate
from game.face.mesh import DrawList, Layer
from game.face.params import FIELDS, INDEX, REGIONS, FaceParams, Field, face_params
from game.face.style import DEFAULT_STYLE, FaceStyle

__all__ = [
    "DEFAULT_STYLE",
    "FIELDS",
    "INDEX",
    "REGIONS",
    "DrawList",
    "FaceParams",
    "FaceStyle",
    "Field",
    "Layer",
    "face_params",
    "tessellate",
]
