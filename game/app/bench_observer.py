"""Can the feeling be told from the body? An observer learns from the takes' visible points and judges performances.

It sees windows of 8 s of upper-body points, nothing else (no units, no numbers). It is asked about performances of
seeds nobody has looked at, in the four modes of comparison, and about the acted styles of real people where that
data lies beside the checkout.

Where the body is held still (``gestures``, ``face``) an observer of whole performances may just see "neutral"
everywhere. Two more questions tell what there is to be seen at all: the same observer used to the mode (features
centred and scaled, without labels), and another one that has learnt from labelled performances in that same mode.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from game.animation import MODES, Mode, Performer
from game.app.bench_rows import Row
from game.app.loading import load_planner
from game.core.emotion_space import EMOTION_INDEX, EMOTIONS
from game.core.paths import ASSETS, ROOT
from game.embos.annotations import read_takes
from game.embos.findings import Findings
from game.embos.repertoire import read_repertoire
from game.formats import read_bvh
from game.tools.observer import (
    SETS,
    Observer,
    Score,
    Training,
    play_scenes,
    read_set,
    score_of,
    score_scenes,
    score_set,
    training_windows,
)
from game.tools.observer.scoring import accustomed, scene_features

__all__ = ["Plan", "rows", "show"]

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.intp]


class Plan(NamedTuple):
    """seeds: how many per mode; seconds: length of a performance; own_seeds: for the mode's own observer."""

    seeds: int
    seconds: float
    own_seeds: int


FULL, QUICK = Plan(8, 40.0, 6), Plan(3, 24.0, 0)
_FIRST_SEED = {"full": 5000, "gestures": 6000, "body": 7000, "face": 8000}
"""Seeds set aside for the test."""
_OWN_SEED, _HALF_SEED = 9000, 10_000
_WANTED = {"full": ">= 0.90", "body": ">= 0.90", "gestures": "<= 0.35", "face": ""}
_SHARED = ROOT.parent / "shared" / "data"
_OWN_PENALTY = 0.02


def rows(quick: bool = False, data: Path = _SHARED) -> list[Row]:
    """One row per question; ``median`` is the share named right."""
    plan = QUICK if quick else FULL
    training = _training()
    observer = Observer(training)
    _tell(f"learnt from {len(training.emotion)} windows of {len(EMOTIONS)} emotions")
    result = [
        _row("takes: stretches left out", Observer.left_out(training), windows=len(training.emotion))
    ] if not quick else []  # fmt: skip
    planner = load_planner()
    performer = Performer(planner.library, layers=planner.tables.layers, radius=planner.config.radius)
    for mode in MODES:
        scenes = play_scenes(planner, performer, mode, _FIRST_SEED[mode], plan.seeds, plan.seconds)
        features, felt = scene_features(scenes)

        def ask(who: Observer, seen: Floats, felt: Ints = felt, cases: int = len(scenes)) -> Score:
            return score_of(felt, who.judge(seen).argmax(axis=1), cases)

        score = ask(observer, features)
        result.append(_score_row(f"{mode}: learnt from the takes", score, _WANTED[mode]))
        _tell(f"{mode}: {score.share:.3f}")
        if mode in ("gestures", "face"):
            used = ask(observer, accustomed(features, training.features))
            result.append(_score_row(f"{mode}: learnt from the takes, used to the mode", used, _WANTED[mode]))
        if plan.own_seeds and mode in ("gestures", "face"):
            own = _own_observer(planner, performer, mode, plan)
            result.append(_score_row(f"{mode}: learnt from other performances in this mode", ask(own, features)))
    if not quick:
        scenes = play_scenes(planner, performer, "body", _HALF_SEED, plan.own_seeds, plan.seconds, felt=0.5)
        result.append(_score_row("body, felt half as strong: learnt from the takes", score_scenes(observer, scenes)))
    for name, styles in SETS.items():
        foreign = read_set(data, styles)
        if foreign is None:
            _tell(f"{name}: not beside the checkout, left out")
            continue
        scores = score_set(observer, training.features, foreign)
        for kind, what in (
            ("as_is", "all seven names"),
            ("among", "only its own names"),
            ("accustomed", "only its own names, used to the actor"),
        ):
            result.append(_score_row(f"{name}: {what}", scores[kind]))
    return result


def _training() -> Training:
    """The shipped takes; foreign ones of the same emotion beside them are not learnt from."""
    folder = ASSETS / "motion" / "takes"
    findings = Findings()
    takes = read_takes(folder, read_repertoire(ASSETS / "motion" / "behaviours.yaml", findings), findings)
    names = {EMOTIONS[take.emotion]: take.name for take in reversed(takes)}
    return training_windows({EMOTION_INDEX[e]: read_bvh(folder / f"{name}.bvh").clip for e, name in names.items()})


def _own_observer(planner: Any, performer: Performer, mode: Mode, plan: Plan) -> Observer:
    scenes = play_scenes(planner, performer, mode, _OWN_SEED, plan.own_seeds, plan.seconds)
    features, felt = scene_features(scenes)
    return Observer(Training(features, felt, np.zeros(len(felt), dtype=np.intp)), _OWN_PENALTY)


def _row(name: str, share: float, wanted: str = "", **more: Any) -> Row:
    return {"name": name, "unit": "", "median": share, "min": None, "spread": None, "floor": None, "ratio": None,
            "wanted": wanted, **more}  # fmt: skip


def _score_row(name: str, score: Score, wanted: str = "") -> Row:
    # Chance is the floor; the least the interval allows stands as the minimum.
    return _row(name, score.share, wanted) | {
        "min": score.interval[0],
        "floor": score.chance,
        "ratio": score.share / score.chance,
        **score.row(),
    }


def _tell(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def show(results: list[Row]) -> None:
    """Confusion matrices as text."""
    for item in results:
        if "confusion" not in item:
            continue
        low, high = item["interval"]
        print(f"\n{item['name']}: {item['share']:.0%} right (95 %: {low:.0%} to {high:.0%}, "
              f"chance {item['chance']:.0%}, {item['performances']} performances)")  # fmt: skip
        print(" " * 12 + "".join(f"{name[:8]:>9}" for name in item["named"]))
        for emotion, counts in zip(item["emotions"], item["confusion"], strict=True):
            print(f"  {emotion:10}" + "".join(f"{count or '·':>9}" for count in counts))
