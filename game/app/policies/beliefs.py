"""Reading a person: a belief over the seven felt labels, carried from round to round by the rules that all know.

A hidden Markov filter (Rabiner 1989): the belief goes through what the player's line did and what a round does to
moods, then meets what is seen. The rules are common knowledge; the numbers of the present talk are not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import ne

import numpy as np
from numpy.typing import NDArray

from game.app.policies.eyes import Drawn, FaceEye
from game.app.policies.views import Sign
from game.app.talk import TalkAssets
from game.core.emotion_space import EMOTIONS
from game.embos import UnitLibrary
from game.emotion import Feeling, after_insult, after_line, after_refusal, pass_round, shown_values
from game.face import REGIONS

__all__ = ["Acquaintance", "Belief", "BodyReading", "FaceReading"]

Floats = NDArray[np.float64]
_QUALITIES = ("right", "neutral", "wrong")
_ANSWERS = ("none", "refused", "insult")
_SAMPLES = 160
_LEAST = 0.004
"""Below this no belief falls: a script's own lines move feelings in ways that no rule tells."""
_STRENGTHS = (0.25, 0.4, 0.55, 0.7)
_OTHER_PART = 0.35
_DIFFERING = tuple(_OTHER_PART**count for count in range(len(REGIONS) + 1))
"""How well a face fits of which so many parts are others."""


class Acquaintance:
    """What anybody knows who has dealt with a person before: how they take lines, their moods, their mask."""

    def __init__(self, assets: TalkAssets) -> None:
        self.rules, self.person = assets.feelings, assets.person
        self.once_right = assets.feelings.once_right
        self.prior: Floats = np.asarray(assets.person.mood_prior, dtype=np.float64)
        self.quality: Mapping[str, tuple[str, ...]] = assets.person.quality
        self._labels: dict[tuple[str, str], tuple[int, ...]] = {}

    def taken(self, act: str, label: int) -> str:
        """How an act is taken by who feels a label (0..6)."""
        row = self.quality.get(act)
        return "neutral" if row is None else row[label]

    def labels(self, act: str, quality: str) -> tuple[int, ...]:
        """The labels (0..6) by which an act is taken so."""
        found = self._labels.get((act, quality))
        if found is None:
            found = tuple(label for label in range(7) if self.taken(act, label) == quality)
            self._labels[act, quality] = found
        return found

    def feeling(self, label: int, strength: float) -> Feeling:
        """Somebody of this temperament who feels a label so strongly."""
        felt = list(self.person.calm)
        if label < 6:
            felt[label] = strength
        return Feeling(tuple(felt), 6)

    @cached_property
    def carry(self) -> Mapping[tuple[str, str], Floats]:
        """(quality, answer) -> (7, 7): from the label before a line to the label a round later, by simulation."""
        rng = np.random.default_rng(7)
        carry = {}
        for quality in _QUALITIES:
            for answer in _ANSWERS:
                table = np.zeros((7, 7))
                for label in range(7):
                    for _ in range(_SAMPLES):
                        table[label, self._after(label, quality, answer, rng)] += 1.0
                carry[quality, answer] = (table + 0.5) / (table.sum(axis=1, keepdims=True) + 3.5)
        return carry

    def _after(self, label: int, quality: str, answer: str, rng: np.random.Generator) -> int:
        rules, person = self.rules, self.person
        feeling = self.feeling(label, 0.3 + 0.5 * rng.random())
        feeling = after_line(rules, person, feeling, "", quality)
        if answer == "insult":
            feeling = after_insult(rules, person, feeling, 0.15 * rng.random())
        elif answer == "refused" and rng.random() < 0.6:
            feeling = after_refusal(rules, feeling, 0.15 * rng.random())
        six = pass_round(rules, person, feeling, rng).six
        most = max(six)
        return six.index(most) if most >= rules.label_threshold else 6


class Belief:
    """(7,) probabilities of the felt label."""

    def __init__(self, known: Acquaintance) -> None:
        self.known = known
        self.now: Floats = known.prior.copy()

    def see(self, log_likelihood: Floats) -> None:
        """Meet evidence: (7,) log-likelihoods up to a constant."""
        weighed = np.log(self.now) + log_likelihood
        self._set(np.exp(weighed - weighed.max()))

    def pass_line(self, act: str, told: str, answer: str) -> None:
        """A line of an act was said, the words told how it landed (or nothing), an offer was answered."""
        landed = [self.known.taken(act, label) for label in range(7)]
        after = np.zeros(7)
        for label in range(7):
            share = self.now[label]
            if told and landed[label] != told:
                share *= 0.05  # a repeated line counts as neutral, and a mood may have turned unseen
            after += share * self.known.carry[told or landed[label], answer][label]
        self._set(after)

    def _set(self, weights: Floats) -> None:
        self.now = np.maximum(weights / weights.sum(), _LEAST)
        self.now /= self.now.sum()

    def chance(self, act: str, quality: str) -> float:
        """How likely an act is taken so."""
        total, now = 0.0, self.now.tolist()
        for label in self.known.labels(act, quality):
            total += now[label]
        return total


@dataclass(frozen=True)
class FaceReading:
    """Likelihood of a drawn face by felt label, from the faces that the same model draws for each label.

    exemplars: by what a mask hides behind (joy, neutral), by label, for a few strengths.
    """

    exemplars: tuple[tuple[tuple[Drawn, ...], ...], ...]

    SPREAD = 0.13

    @staticmethod
    def of(known: Acquaintance, eye: FaceEye, *, masked: bool) -> FaceReading:
        """Learn the faces that go with feelings; masked: behind the mask that this person wears."""
        per_mask = []
        for shows in (2, 6):
            labels = []
            for label in range(7):
                drawn = []
                for strength in _STRENGTHS if label < 6 else (0.0,):
                    six = known.feeling(label, strength).six
                    if masked:
                        shown = shown_values(known.person, Feeling(six, shows))
                    else:
                        shown = (*six, 0.0)
                    drawn.append(eye.drawn(shown))
                labels.append(tuple(drawn))
            per_mask.append(tuple(labels))
        return FaceReading(tuple(per_mask))

    def log_likelihood(self, drawn: Drawn) -> Floats:
        """(2, 7) by what the mask shows and by label."""
        return np.array([[self._fit(drawn, own) for own in labels] for labels in self.exemplars])

    def _fit(self, drawn: Drawn, exemplars: Sequence[Drawn]) -> float:
        parts, valence, arousal = drawn
        spread, total = 2.0 * self.SPREAD**2, 0.0
        for own, v, a in exemplars:
            away = ((valence - v) ** 2 + (arousal - a) ** 2) / spread
            total += math.exp(-away) * _DIFFERING[sum(map(ne, parts, own))]
        return math.log(total / len(exemplars) + 1e-4)


class BodyReading:
    """Likelihood of units by felt label from the repertoire's intensities (eq. 2), by Bayes' rule.

    Nobody feels one thing alone: what is not the felt emotion is neutral (eq. 4), and bodies show that too.
    habit: by unit, the share of its appearances that has nothing to do with feelings, learnt from earlier visits.
    """

    FLOOR = 0.06
    STRENGTH = 0.5
    """How much of somebody's emotion the felt label makes up, typically."""

    def __init__(self, library: UnitLibrary, habit: Mapping[str, float] | None = None) -> None:
        layers = np.array([unit.layer for unit in library.units])
        weights = library.intensity + self.FLOOR
        self._log: dict[Sign, Floats] = {}
        for layer in sorted(set(layers.tolist())):
            rows = np.flatnonzero(layers == layer)
            share = weights[rows] / weights[rows].sum(axis=0)
            share = self.STRENGTH * share + (1.0 - self.STRENGTH) * share[:, 6:]
            for row, own in zip(rows.tolist(), share, strict=True):
                name = library.units[row].name
                constant = (habit or {}).get(name, 0.0)
                self._log[layer, name] = np.log((1.0 - constant) * own + constant * own.mean())
        self.silent: Floats = np.zeros(len(EMOTIONS))

    def log_likelihood(self, signs: Sequence[Sign]) -> Floats:
        """(7,) of the units seen."""
        return np.asarray(sum((self._log[sign] for sign in signs), start=self.silent))

    def expected(self, label_shares: Floats) -> dict[str, float]:
        """By unit, how often it appears within its layer among feelings of these shares."""
        return {name: float(np.exp(log) @ label_shares) for (_, name), log in self._log.items()}
