"""The feelings' part of ``dialogue/rules.yaml``: temperaments, and how each act is taken by what is felt."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.core.emotion_space import EMOTION_INDEX, EMOTIONS, SIX
from game.core.errors import BadInput
from game.core.paths import DIALOGUE
from game.formats.yaml_source import Node, load_yaml, nearest

__all__ = ["FeelingRules", "Quality", "Temperament", "feeling_rules_from", "load_feeling_rules", "vector_of"]

Floats = NDArray[np.float64]
NEGATIVES = ("anger", "fear", "sadness", "disgust")


class Quality:
    """How a line was taken: the three values as they stand in rules and dialogue."""

    RIGHT = "right"
    NEUTRAL = "neutral"
    WRONG = "wrong"
    ALL = (RIGHT, NEUTRAL, WRONG)


_LETTERS = {"R": Quality.RIGHT, "W": Quality.WRONG, ".": Quality.NEUTRAL}


@dataclass(frozen=True, eq=False)
class Temperament:
    """One person's way of feeling.

    habit_units: mannerisms they show whatever they feel, at least with the factor habit_rate; habit_label: what
    strangers take them for. mask in [0, 1]: how much of what is felt the face hides (0 nothing, 1 all). leak in
    [0, 1]: how much of it the body gives away. mood_prior: (7,) probabilities of the mood a talk starts in. negative:
    (6,) shares in which a hurt is felt (sum 1). baseline: (6,) what the feelings decay toward. sensitivity: (6,)
    factors on feelings that a dialogue line adds. quality: act -> (7 labels) how the act is taken.
    """

    id: str
    patience: float
    mask: float
    leak: float
    habit_label: str
    habit_rate: float
    habit_units: tuple[str, ...]
    mood_prior: Floats
    negative: Floats
    baseline: Floats
    sensitivity: Floats
    quality: Mapping[str, tuple[str, ...]]

    # The same as plain floats, for the rules that run in every round.
    @cached_property
    def calm(self) -> tuple[float, ...]:
        """``baseline`` by emotion."""
        return tuple(self.baseline.tolist())

    @cached_property
    def hurt_shares(self) -> tuple[float, ...]:
        """``negative`` by emotion."""
        return tuple(self.negative.tolist())

    @cached_property
    def sensitivities(self) -> tuple[float, ...]:
        """``sensitivity`` by emotion."""
        return tuple(self.sensitivity.tolist())

    @cached_property
    def mood_shares(self) -> tuple[float, ...]:
        """Running sums of ``mood_prior``, the last one 1: where a number in [0, 1) falls is the mood drawn."""
        return _running_shares(self.mood_prior)


@dataclass(frozen=True, eq=False)
class FeelingRules:
    """Constants of appraisal, and the temperaments by name. Arrays are over the six emotions."""

    label_threshold: float
    acts: tuple[str, ...]
    once_right: frozenset[str]
    right_negative_factor: float
    right_joy: float
    wrong_negative: float
    wrong_joy_factor: float
    insult_gain: float
    insult_base: float
    insult_slope: float
    refused_joy_base: float
    refused_joy_slope: float
    mood_start: tuple[float, float]
    half_life_rounds: Floats
    turn_chance: float
    turn_size: float
    mask_shows: Floats
    temperaments: Mapping[str, Temperament]

    @cached_property
    def left_after_a_round(self) -> tuple[float, ...]:
        """What share of a feeling is left after a round, by emotion."""
        return tuple(np.exp2(-1.0 / self.half_life_rounds).tolist())

    @cached_property
    def mask_shares(self) -> tuple[float, ...]:
        """Running sums of ``mask_shows``, the last one 1."""
        return _running_shares(self.mask_shows)


def _running_shares(weights: Floats) -> tuple[float, ...]:
    sums = np.cumsum(weights / weights.sum())
    return tuple((sums / sums[-1]).tolist())


def vector_of(node: Node, names: tuple[str, ...], *, default: float | None = None) -> Floats:
    """A mapping emotion -> number as an array over ``names``; all are required unless a default is given."""
    node.only(*names)
    out = np.zeros(len(names))
    for i, name in enumerate(names):
        item = node.get(name)
        if item is None:
            if default is None:
                raise BadInput(
                    where=node.where,
                    expected=f"the key {name}",
                    seen=", ".join(key.as_str() for key, _ in node.items()),
                )
            out[i] = default
        else:
            out[i] = item.as_float()
    return out


def _qualities(node: Node, base: tuple[str, ...] | None) -> tuple[str, ...]:
    row = list(base) if base is not None else [Quality.NEUTRAL] * len(EMOTIONS)
    for key, value in node.items():
        label = key.as_str()
        if label not in EMOTION_INDEX:
            raise BadInput(where=key.where, expected=" | ".join(EMOTIONS), seen=label, hint=nearest(label, EMOTIONS))
        letter = value.raw
        if letter not in _LETTERS:
            raise BadInput(where=value.where, expected="R (right), W (wrong) or . (neutral)", seen=letter)
        row[EMOTION_INDEX[label]] = _LETTERS[letter]
    return tuple(row)


def _temperament(name: str, node: Node, acts: Mapping[str, tuple[str, ...]]) -> Temperament:
    node.only("patience", "mask", "leak", "habit", "mood_prior", "negative", "baseline", "sensitivity", "acts")
    quality = dict(acts)
    exceptions = node.get("acts")
    if exceptions is not None:
        for key, row in exceptions.items():
            act = key.as_str()
            if act not in acts:
                raise BadInput(where=key.where, expected="a known act", seen=act, hint=nearest(act, acts))
            quality[act] = _qualities(row, acts[act])
    prior = vector_of(node["mood_prior"], EMOTIONS, default=0.0)
    if prior.min() < 0 or prior.sum() <= 0:
        raise BadInput(where=node["mood_prior"].where, expected="shares of at least 0 with a sum above 0", seen="none")
    negative = vector_of(node["negative"], SIX, default=0.0)
    if abs(negative.sum() - 1) > 1e-6:
        raise BadInput(
            where=node["negative"].where, expected="shares with the sum 1", seen=round(float(negative.sum()), 4)
        )
    habit = node["habit"].only("looks_like", "rate", "units")
    baseline, sensitivity = node.get("baseline"), node.get("sensitivity")
    return Temperament(
        id=name,
        patience=node["patience"].as_float(0.5, 100),
        mask=node["mask"].as_float(0, 1),
        leak=node["leak"].as_float(0, 1),
        habit_label=habit["looks_like"].as_str(),
        habit_rate=habit["rate"].as_float(0, 1),
        habit_units=tuple(item.as_str() for item in habit["units"].as_list()) if "units" in habit else (),
        mood_prior=prior / prior.sum(),
        negative=negative,
        baseline=np.zeros(6) if baseline is None else vector_of(baseline, SIX, default=0.0),
        sensitivity=np.ones(6) if sensitivity is None else vector_of(sensitivity, SIX, default=1.0),
        quality=quality,
    )


def feeling_rules_from(root: Node) -> FeelingRules:
    """Read the feelings' rules from the parsed rules file. Raises BadInput with file:line:col."""
    root.only("constants", "acts", "once_right", "people", "mask_shows")
    constants = root["constants"]
    acts = {key.as_str(): _qualities(row, None) for key, row in root["acts"].items()}
    right, wrong = constants["right_line"], constants["wrong_line"]
    insult, refused, mood = constants["insult"], constants["refused_fair_offer"], constants["mood"]
    low, high = (item.as_float(0, 1) for item in mood["start"].as_list())
    once = [item.as_str() for item in root["once_right"].as_list()]
    return FeelingRules(
        label_threshold=constants["label_threshold"].as_float(0, 1),
        acts=tuple(acts),
        once_right=frozenset(once),
        right_negative_factor=right["negative_factor"].as_float(0, 1),
        right_joy=right["joy"].as_float(0, 1),
        wrong_negative=wrong["negative"].as_float(0, 1),
        wrong_joy_factor=wrong["joy_factor"].as_float(0, 1),
        insult_gain=insult["feeling_gain"].as_float(0),
        insult_base=insult["feeling_base"].as_float(0),
        insult_slope=insult["feeling_slope"].as_float(0),
        refused_joy_base=refused["joy_base"].as_float(0),
        refused_joy_slope=refused["joy_slope"].as_float(0),
        mood_start=(low, high),
        half_life_rounds=vector_of(mood["half_life_rounds"], SIX),
        turn_chance=mood["turn_chance"].as_float(0, 1),
        turn_size=mood["turn_size"].as_float(0, 1),
        mask_shows=vector_of(root["mask_shows"], EMOTIONS, default=0.0),
        temperaments={key.as_str(): _temperament(key.as_str(), person, acts) for key, person in root["people"].items()},
    )


def load_feeling_rules(path: Path = DIALOGUE / "rules.yaml") -> FeelingRules:
    """The shipped rules, or those of another file of the same form."""
    return feeling_rules_from(load_yaml(path))


def label_index(felt_six: Sequence[float], threshold: float) -> int:
    """Index of the felt label: the largest of the six if at least the threshold, else neutral (6)."""
    most = max(felt_six)
    return felt_six.index(most) if most >= threshold else EMOTION_INDEX["neutral"]
