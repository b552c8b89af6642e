"""Autoplay's players. Each decides from a view that has what its name allows and nothing else."""

from game.app.policies.beliefs import Acquaintance, Belief, BodyReading, FaceReading
from game.app.policies.custom import OwnPolicy
from game.app.policies.eyes import Eyes, FaceEye
from game.app.policies.players import Player
from game.app.policies.registry import (
    COMPARED,
    NAMES,
    TUNED,
    Mixture,
    Seat,
    Tuned,
    load_tuned,
    mixture_of,
    seat,
    seat_exists,
)
from game.app.policies.scripted import load_moves
from game.app.policies.strategy import FixedPlan, Strategy, money
from game.app.policies.views import (
    BodyView,
    FaceView,
    Line,
    OracleView,
    ReaderView,
    Sign,
    Table,
    View,
    WordsView,
)

__all__ = [
    "COMPARED",
    "NAMES",
    "TUNED",
    "Acquaintance",
    "Belief",
    "BodyReading",
    "BodyView",
    "Eyes",
    "FaceEye",
    "FaceReading",
    "FaceView",
    "FixedPlan",
    "Line",
    "Mixture",
    "OracleView",
    "OwnPolicy",
    "Player",
    "ReaderView",
    "Seat",
    "Sign",
    "Strategy",
    "Table",
    "Tuned",
    "View",
    "WordsView",
    "load_moves",
    "load_tuned",
    "mixture_of",
    "money",
    "seat",
    "seat_exists",
]
