"""Quaternions, skeletons, clips, springs, the error tree and the emotion space: pure mathematics, no I/O."""

from game.core.clip import Clip
from game.core.emotion_space import EMOTION_INDEX, EMOTIONS, SIX, emotion_vector, parse_emotion, with_neutral
from game.core.errors import BadInput, GameError, MissingPart, Where
from game.core.paths import ASSETS, DIALOGUE, ROOT
from game.core.skeleton import Skeleton

__all__ = [
    "ASSETS",
    "DIALOGUE",
    "EMOTIONS",
    "EMOTION_INDEX",
    "ROOT",
    "SIX",
    "BadInput",
    "Clip",
    "GameError",
    "MissingPart",
    "Skeleton",
    "Where",
    "emotion_vector",
    "parse_emotion",
    "with_neutral",
]
