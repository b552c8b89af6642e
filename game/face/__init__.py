"""The anime face: parts and what they mean, the face for an emotion, its life over time, its triangles."""

from game.face.arkit import ARKIT
from game.face.asset import FaceAsset, FaceTiming, load_face
from game.face.avatar_face import AvatarFace, AvatarFaceWeights, emotion_recipes
from game.face.drawing import tessellate
from game.face.inverse import FaceSearch, Proposal
from game.face.mesh import DrawList, Layer
from game.face.model import FaceModel, Weights, load_weights, log_density, whole_face
from game.face.params import FIELDS, INDEX, REGIONS, FaceParams, Field, face_params
from game.face.parts import Face, NamedExpression, Parts, load_expressions, load_parts
from game.face.rated import RatedExpression, load_rated, rated_scores, rated_text
from game.face.ratings import AxisFit, fit_gaussian, fit_weights
from game.face.speech import VISEMES, VisemeTrack, viseme_track
from game.face.state import FaceDecision, FaceLeak, FaceSignal, FaceState, advance_face, explain_face, start_face
from game.face.style import DEFAULT_STYLE, FaceStyle, read_style

__all__ = [
    "ARKIT",
    "DEFAULT_STYLE",
    "FIELDS",
    "INDEX",
    "REGIONS",
    "VISEMES",
    "AvatarFace",
    "AvatarFaceWeights",
    "AxisFit",
    "DrawList",
    "Face",
    "FaceAsset",
    "FaceDecision",
    "FaceLeak",
    "FaceModel",
    "FaceParams",
    "FaceSearch",
    "FaceSignal",
    "FaceState",
    "FaceStyle",
    "FaceTiming",
    "Field",
    "Layer",
    "NamedExpression",
    "Parts",
    "Proposal",
    "RatedExpression",
    "VisemeTrack",
    "Weights",
    "advance_face",
    "emotion_recipes",
    "explain_face",
    "face_params",
    "fit_gaussian",
    "fit_weights",
    "load_expressions",
    "load_face",
    "load_parts",
    "load_rated",
    "load_weights",
    "log_density",
    "rated_scores",
    "rated_text",
    "read_style",
    "start_face",
    "tessellate",
    "viseme_track",
    "whole_face",
]
