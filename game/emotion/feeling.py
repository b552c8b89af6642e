"""What the shopkeeper feels, and what the face shows of it.

The six felt values live in the paper's emotion space; neutral is derived (eq. 4). Feelings change at three
moments: a line is judged (right, neutral, wrong) against the *felt* label and then changes it; an offer is
answered; a round passes (decay toward the temperament's baseline, or a turn of mood). Time is counted in rounds,
not seconds, so that a slow reader loses nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.emotion_space import EMOTION_INDEX, EMOTIONS, with_neutral
from game.emotion.rules import NEGATIVES, FeelingRules, Quality, Temperament, label_index, scaled

__all__ = [
    "Feeling",
    "add_feelings",
    "after_insult",
    "after_line",
    "after_refusal",
    "appraise",
    "felt_label",
    "pass_round",
    "shown_emotion",
    "start_feeling",
]

Floats = NDArray[np.float64]
_NEGATIVE = np.array([name in NEGATIVES for name in EMOTIONS[:6]])
_JOY = EMOTION_INDEX["joy"]


@dataclass(frozen=True, eq=False)
class Feeling:
    """felt: (6,) in [0, 1]. mask_shows: the emotion index (joy or neutral) behind which this talk's mask hides.

    last_right: the act that was last taken well at once before (repeating it is only neutral); used: acts already
    taken well that are right only once.
    """

    felt: Floats
    mask_shows: int
    last_right: str = ""
    used: frozenset[str] = frozenset()

    @property
    def felt7(self) -> Floats:
        """(7,) with the derived neutral, eq. 4."""
        return with_neutral(self.felt)


def start_feeling(rules: FeelingRules, person: Temperament, rng: np.random.Generator) -> Feeling:
    """The mood a talk starts in: one emotion drawn from the temperament's prior, at a strength from the rules."""
    mood = int(rng.choice(len(EMOTIONS), p=person.mood_prior))
    strength = float(rng.uniform(*rules.mood_start))
    felt = person.baseline.copy()
    if mood < 6:
        felt[mood] = strength
    shows = int(rng.choice(len(EMOTIONS), p=rules.mask_shows / rules.mask_shows.sum()))
    return Feeling(felt=np.clip(felt, 0.0, 1.0), mask_shows=shows)


def felt_label(rules: FeelingRules, feeling: Feeling) -> str:
    """The name of what is felt most, or neutral below the threshold."""
    return EMOTIONS[label_index(feeling.felt, rules.label_threshold)]


def shown_emotion(person: Temperament, feeling: Feeling, extra: Floats | None = None) -> Floats:
    """(7,) what the face shows: the felt emotion behind the mask. ``extra``: (6,) a passing reaction on top."""
    mask = np.zeros(6)
    if feeling.mask_shows < 6:
        # A polite smile, not a laugh.
        mask[feeling.mask_shows] = 0.55
    shown = feeling.felt * (1.0 - person.mask) + mask * person.mask
    if extra is not None:
        shown = shown + extra
    return with_neutral(np.clip(shown, 0.0, 1.0))


def appraise(rules: FeelingRules, person: Temperament, feeling: Feeling, act: str) -> str:
    """How an act is taken now: by the felt label, by the person, and by what was said just before."""
    if act not in person.quality:
        return Quality.NEUTRAL
    quality = person.quality[act][label_index(feeling.felt, rules.label_threshold)]
    if quality == Quality.RIGHT and (act == feeling.last_right or act in feeling.used):
        return Quality.NEUTRAL
    return quality


def after_line(rules: FeelingRules, person: Temperament, feeling: Feeling, act: str, quality: str) -> Feeling:
    """A right line calms what hurts and warms; a wrong one hurts after the person's own profile."""
    felt = feeling.felt.copy()
    if quality == Quality.RIGHT:
        felt[_NEGATIVE] *= rules.right_negative_factor
        felt[_JOY] += rules.right_joy
    elif quality == Quality.WRONG:
        felt += rules.wrong_negative * person.negative
        felt[_JOY] *= rules.wrong_joy_factor
    used = feeling.used
    if quality == Quality.RIGHT and act in rules.once_right:
        used = used | {act}
    last = act if quality == Quality.RIGHT else ""
    return replace(feeling, felt=np.clip(felt, 0.0, 1.0), last_right=last, used=used)


def add_feelings(person: Temperament, feeling: Feeling, values: Mapping[str, Any]) -> Feeling:
    """A dialogue line's own ``feel: {joy: +0.2}``, scaled by the temperament and by what is felt already.

    A feeling that rises grows into the room left above it; one that falls shrinks in proportion to what is there.
    """
    change = scaled(values, person.sensitivity)
    felt = feeling.felt
    grown = np.where(change > 0, felt + change * (1.0 - felt), felt * np.clip(1.0 + change, 0.0, 1.0))
    return replace(feeling, felt=np.clip(grown, 0.0, 1.0))


def after_insult(rules: FeelingRules, person: Temperament, feeling: Feeling, excess: float) -> Feeling:
    """An offer far below the lowest price, by ``excess`` of the list price beyond the margin."""
    hurt = rules.insult_gain * (rules.insult_base + rules.insult_slope * excess) * person.negative
    return replace(feeling, felt=np.clip(feeling.felt + hurt, 0.0, 1.0))


def after_refusal(rules: FeelingRules, feeling: Feeling, above_lowest: float) -> Feeling:
    """A refused offer that was fair (``above_lowest`` >= 0, share of the list price) pleases all the same."""
    felt = feeling.felt.copy()
    felt[_JOY] += rules.refused_joy_base + rules.refused_joy_slope * above_lowest
    return replace(feeling, felt=np.clip(felt, 0.0, 1.0))


def pass_round(rules: FeelingRules, person: Temperament, feeling: Feeling, rng: np.random.Generator) -> Feeling:
    """A round goes by: feelings decay toward the baseline by their half-lives, or the mood turns."""
    turn, pick = float(rng.random()), float(rng.random())
    felt = person.baseline + (feeling.felt - person.baseline) * np.exp2(-1.0 / rules.half_life_rounds)
    if turn < rules.turn_chance:
        mood = int(np.searchsorted(np.cumsum(person.mood_prior), pick, side="right"))
        felt = felt * (1.0 - rules.turn_size)
        if mood < 6:
            felt[mood] = max(felt[mood], rules.turn_size)
    return replace(feeling, felt=np.clip(felt, 0.0, 1.0))
