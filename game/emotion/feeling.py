"""What the shopkeeper feels, and what the face shows of it.

The six felt values live in the paper's emotion space; neutral is derived (eq. 4). Feelings change at three
moments: a line is judged (right, neutral, wrong) against the *felt* label and then changes it; an offer is
answered; a round passes (decay toward the temperament's baseline, or a turn of mood). Time is counted in rounds,
not seconds, so that a slow reader loses nothing.

Six numbers are too few for array operations to pay: plain floats are ten times as fast.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from game.core.emotion_space import EMOTION_INDEX, EMOTIONS
from game.core.streams import Draws
from game.emotion.rules import NEGATIVES, FeelingRules, Quality, Temperament, label_index

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
    "shown_values",
    "start_feeling",
]

Floats = NDArray[np.float64]
_IS_NEGATIVE = tuple(name in NEGATIVES for name in EMOTIONS[:6])
_JOY = EMOTION_INDEX["joy"]
_POLITE_SMILE = 0.55
"""What a mask shows: a polite smile, not a laugh."""


class Feeling(NamedTuple):
    """six: felt values in [0, 1]. mask_shows: the emotion index (joy or neutral) behind which this talk's mask hides.

    last_right: the act that was last taken well at once before (repeating it is only neutral); used: acts already
    taken well that are right only once.
    """

    six: tuple[float, ...]
    mask_shows: int
    last_right: str = ""
    used: frozenset[str] = frozenset()

    @property
    def felt(self) -> Floats:
        """(6,) as an array of its own."""
        return np.array(self.six)

    @property
    def felt7(self) -> tuple[float, ...]:
        """Seven values with the derived neutral, eq. 4."""
        return _seven(self.six)

    def felt_as(self, six: Sequence[float]) -> Feeling:
        """The same with other felt values, held to [0, 1]."""
        return Feeling(_held(six), self.mask_shows, self.last_right, self.used)


def _held(values: Sequence[float]) -> tuple[float, ...]:
    return tuple([0.0 if v < 0.0 else 1.0 if v > 1.0 else v for v in values])


def _seven(six: tuple[float, ...]) -> tuple[float, ...]:
    a, b, c, d, e, f = six
    total = a + b + c + d + e + f
    return (a, b, c, d, e, f, 1.0 - total if total < 1.0 else 0.0)


def start_feeling(rules: FeelingRules, person: Temperament, rng: Draws) -> Feeling:
    """The mood a talk starts in: one emotion drawn from the temperament's prior, at a strength from the rules."""
    mood = bisect_right(person.mood_shares, rng.random())
    low, high = rules.mood_start
    strength = low + (high - low) * rng.random()
    felt = list(person.calm)
    if mood < 6:
        felt[mood] = strength
    return Feeling(_held(felt), bisect_right(rules.mask_shares, rng.random()))


def felt_label(rules: FeelingRules, feeling: Feeling) -> str:
    """The name of what is felt most, or neutral below the threshold."""
    return EMOTIONS[label_index(feeling.six, rules.label_threshold)]


def shown_values(person: Temperament, feeling: Feeling) -> tuple[float, ...]:
    """Seven values: what the face shows, the felt emotion behind the mask."""
    mask, open_share = person.mask, 1.0 - person.mask
    shown = [v * open_share for v in feeling.six]
    if feeling.mask_shows < 6:
        shown[feeling.mask_shows] += _POLITE_SMILE * mask
    return _seven(_held(shown))


def shown_emotion(person: Temperament, feeling: Feeling) -> Floats:
    """(7,) what the face shows, as an array."""
    return np.array(shown_values(person, feeling))


def appraise(rules: FeelingRules, person: Temperament, feeling: Feeling, act: str) -> str:
    """How an act is taken now: by the felt label, by the person, and by what was said just before."""
    row = person.quality.get(act)
    if row is None:
        return Quality.NEUTRAL
    quality = row[label_index(feeling.six, rules.label_threshold)]
    if quality == Quality.RIGHT and (act == feeling.last_right or act in feeling.used):
        return Quality.NEUTRAL
    return quality


def after_line(rules: FeelingRules, person: Temperament, feeling: Feeling, act: str, quality: str) -> Feeling:
    """A right line calms what hurts and warms; a wrong one hurts after the person's own profile."""
    used, last, felt = feeling.used, "", feeling.six
    if quality == Quality.RIGHT:
        factor = rules.right_negative_factor
        calmed = [v * factor if negative else v for v, negative in zip(felt, _IS_NEGATIVE, strict=True)]
        calmed[_JOY] += rules.right_joy
        felt, last = _held(calmed), act
        if act in rules.once_right:
            used = used | {act}
    elif quality == Quality.WRONG:
        amount = rules.wrong_negative
        hurt = [v + amount * share for v, share in zip(felt, person.hurt_shares, strict=True)]
        hurt[_JOY] *= rules.wrong_joy_factor
        felt = _held(hurt)
    return Feeling(felt, feeling.mask_shows, last, used)


def add_feelings(person: Temperament, feeling: Feeling, values: Mapping[str, Any]) -> Feeling:
    """A dialogue line's own ``feel: {joy: +0.2}``, scaled by the temperament and by what is felt already.

    A feeling that rises grows into the room left above it; one that falls shrinks in proportion to what is there.
    """
    if not values:
        return feeling
    felt = list(feeling.six)
    for name, amount in values.items():
        at = EMOTION_INDEX[name]
        change = float(amount) * person.sensitivities[at]
        v = felt[at]
        felt[at] = v + change * (1.0 - v) if change > 0 else v * min(max(1.0 + change, 0.0), 1.0)
    return feeling.felt_as(felt)


def after_insult(rules: FeelingRules, person: Temperament, feeling: Feeling, excess: float) -> Feeling:
    """An offer far below the lowest price, by ``excess`` of the list price beyond the margin."""
    amount = rules.insult_gain * (rules.insult_base + rules.insult_slope * excess)
    return feeling.felt_as([v + amount * share for v, share in zip(feeling.six, person.hurt_shares, strict=True)])


def after_refusal(rules: FeelingRules, feeling: Feeling, above_lowest: float) -> Feeling:
    """A refused offer that was fair (``above_lowest`` >= 0, share of the list price) pleases all the same."""
    felt = list(feeling.six)
    felt[_JOY] += rules.refused_joy_base + rules.refused_joy_slope * above_lowest
    return feeling.felt_as(felt)


def pass_round(rules: FeelingRules, person: Temperament, feeling: Feeling, rng: Draws) -> Feeling:
    """A round goes by: feelings decay toward the baseline by their half-lives, or the mood turns."""
    turn, pick = rng.random(), rng.random()
    felt = [
        calm + (v - calm) * left
        for calm, v, left in zip(person.calm, feeling.six, rules.left_after_a_round, strict=True)
    ]
    if turn < rules.turn_chance:
        mood = bisect_right(person.mood_shares, pick)
        felt = [v * (1.0 - rules.turn_size) for v in felt]
        if mood < 6:
            felt[mood] = max(felt[mood], rules.turn_size)
    return feeling.felt_as(felt)
