"""Real people, other data: does what the observer learnt from our takes hold for acted styles it has never seen?

Two motion capture sets that label their takes with a style; styles that are one of our seven are asked about. Their
actors stand in a room without a table and, in one set, do one action in every style, so much of what our observer
has learnt means nothing there: chance and score are both told.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.emotion_space import EMOTION_INDEX
from game.formats import read_bvh
from game.tools.observer.features import describe
from game.tools.observer.keypoints import keypoints_of_clip
from game.tools.observer.learner import Observer, windows
from game.tools.observer.scoring import Score, accustomed, score_of
from game.tools.retarget import Options, retarget

__all__ = ["SETS", "Foreign", "StyleSet", "read_set", "score_set"]

Floats = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class StyleSet:
    """A folder of files whose names tell the style; styles: theirs -> ours (others are seen, not asked about)."""

    folder: str
    name: re.Pattern[str]
    styles: Mapping[str, str]


SETS = {
    "bandai1": StyleSet(
        "bandai1",
        re.compile(r"dataset-1_(?P<action>[a-z]+)_(?P<style>[a-z\-]+)_\d+\.bvh"),
        {"angry": "anger", "happy": "joy", "sad": "sadness", "normal": "neutral"},
    ),
    "zeroeggs": StyleSet(
        "zeroeggs_talk",
        re.compile(r"(?P<action>\d+)_(?P<style>[A-Za-z]+)_\d+_part\d+__.*\.bvh"),
        {"Angry": "anger", "Happy": "joy", "Sad": "sadness", "Scared": "fear", "Neutral": "neutral"},
    ),
}


@dataclass(frozen=True, eq=False)
class Foreign:
    """features: (N, D), one row per file; emotion: (N,) ours, -1 where the style is none of the seven."""

    features: Floats
    emotion: NDArray[np.intp]


def read_set(folder: Path, styles: StyleSet, tell: Callable[[str], None] = lambda _: None) -> Foreign | None:
    """Retarget every file of a set; None where it is not there."""
    features, emotions = [], []
    for path in sorted((folder / styles.folder).glob("*.bvh")):
        match = styles.name.fullmatch(path.name)
        if match is None:
            continue
        tell(path.name)
        clip = retarget(read_bvh(path).clip, options=Options(), path=str(path)).clip
        features.append(describe(windows(keypoints_of_clip(clip))[:1]))
        ours = styles.styles.get(match["style"])
        emotions.append(-1 if ours is None else EMOTION_INDEX[ours])
    return Foreign(np.concatenate(features), np.array(emotions)) if features else None


def score_set(observer: Observer, training: Floats, foreign: Foreign) -> dict[str, Score]:
    """``as_is``: the observer as it is, all seven names allowed. ``among``: only the names the set has.
    ``accustomed``: also used to the actor, from all files of the set."""
    asked = foreign.emotion >= 0
    felt, own = foreign.emotion[asked], np.unique(foreign.emotion[asked])
    cases = int(asked.sum())
    plain = observer.judge(foreign.features[asked])
    used = observer.judge(accustomed(foreign.features, training)[asked])
    return {
        "as_is": score_of(felt, plain.argmax(axis=1), cases),
        "among": score_of(felt, own[plain[:, own].argmax(axis=1)], cases, len(own)),
        "accustomed": score_of(felt, own[used[:, own].argmax(axis=1)], cases, len(own)),
    }
