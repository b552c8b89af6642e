"""Feelings: appraisal by temperament and by the present emotion, decay and mood, felt versus shown."""

from game.emotion.circumplex import to_valence_arousal
from game.emotion.feeling import (
    Feeling,
    add_feelings,
    after_insult,
    after_line,
    after_refusal,
    appraise,
    felt_label,
    pass_round,
    shown_emotion,
    shown_values,
    start_feeling,
)
from game.emotion.rules import FeelingRules, Quality, Temperament, feeling_rules_from, load_feeling_rules

__all__ = [
    "Feeling",
    "FeelingRules",
    "Quality",
    "Temperament",
    "add_feelings",
    "after_insult",
    "after_line",
    "after_refusal",
    "appraise",
    "feeling_rules_from",
    "felt_label",
    "load_feeling_rules",
    "pass_round",
    "shown_emotion",
    "shown_values",
    "start_feeling",
    "to_valence_arousal",
]
