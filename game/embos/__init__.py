"""EMBOS: motion units, the four factors of eq. 1, the planner, the statistics of takes and the mixing of variants."""

from game.embos.clips import ClipBank, KnownClips, TakeClip, load_clips, pack_clips
from game.embos.config import PlannerConfig, load_config
from game.embos.cues import GestureCues, beat_columns, timed_tokens
from game.embos.explain import Candidate
from game.embos.habits import check_habit, greet, habit_of
from game.embos.library import UnitLibrary
from game.embos.mixing import mix, mix_weights
from game.embos.planner import Planner
from game.embos.planner_state import TICK_S, Course, Decisions, Habit, PlannerSignal, PlannerState, Told
from game.embos.stress import StressRule, stressed_moments
from game.embos.units import LAYERS, LAYERS_WITH_REST, MotionUnit, Variant, rest_unit

__all__ = [
    "LAYERS",
    "LAYERS_WITH_REST",
    "TICK_S",
    "Candidate",
    "ClipBank",
    "Course",
    "Decisions",
    "GestureCues",
    "Habit",
    "KnownClips",
    "MotionUnit",
    "Planner",
    "PlannerConfig",
    "PlannerSignal",
    "PlannerState",
    "StressRule",
    "TakeClip",
    "Told",
    "UnitLibrary",
    "Variant",
    "beat_columns",
    "check_habit",
    "greet",
    "habit_of",
    "load_clips",
    "load_config",
    "mix",
    "mix_weights",
    "pack_clips",
    "rest_unit",
    "stressed_moments",
    "timed_tokens",
]
