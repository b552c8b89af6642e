"""A score becomes a take: a clip and its annotation, and both become files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from game.core import EMOTIONS, Clip
from game.core.errors import BadInput
from game.formats.bvh import write_bvh
from game.tools.annotate.document import Document, Mark, on_grid
from game.tools.annotate.files import document_text
from game.tools.perform.act import Act
from game.tools.perform.carriage import CARRIAGE
from game.tools.perform.data import MOTION, Behaviour, Cue, Score, load_effort, load_hands, load_repertoire, load_score
from game.tools.perform.gestures import GESTURES
from game.tools.perform.performer import render_stage
from game.tools.perform.postures import POSTURES, take_posture
from game.tools.perform.self_touch import SELF_TOUCH
from game.tools.perform.stage import Move, Stage
from game.tools.perform.timing import DT_S

__all__ = ["Annotation", "Span", "annotation_yaml", "build_takes", "perform_score", "perform_take"]

_AUTHOR = "procedural performance"
_BREATHER_S = 0.06
_TAKEN = 0.8
_LANDED_S, _LANDED = 0.4, 0.3
"""An annotator calls a posture taken after 80 % of the way, a quick one once it has also settled; the way is none's."""


@dataclass(frozen=True)
class Span:
    """One annotated stretch of a take, seconds."""

    layer: str
    behaviour: str
    start_s: float
    end_s: float
    stroke_s: float | None = None
    words: str | None = None


@dataclass(frozen=True)
class Annotation:
    """What an annotator of the take would have written down."""

    take: str
    emotion: str
    spans: tuple[Span, ...]


class _Occupied:
    """Until when every part and layer is taken; a cue waits until what it uses is free."""

    def __init__(self) -> None:
        self.parts: dict[str, float] = {}
        self.layers: dict[str, float] = {}
        self.posture: Behaviour | None = None

    def free_from(self, what: Behaviour, at_s: float) -> float:
        busy = [self.parts.get(part, 0.0) for part in what.uses]
        if what.layer != "posture":
            busy.append(self.layers.get(what.layer, 0.0))
            clash = what.uses & (self.posture.uses if self.posture else frozenset())
            if clash:
                raise BadInput(
                    f"{what.name} at {at_s:.1f} s",
                    expected="parts that the posture leaves free",
                    seen=f"{', '.join(sorted(clash))} used by {self.posture.name if self.posture else ''}",
                )
        return max([at_s, *busy])

    def take(self, what: Behaviour, until_s: float) -> None:
        if what.layer == "posture":
            self.posture = what
            return
        for part in what.uses:
            self.parts[part] = until_s + _BREATHER_S
        self.layers[what.layer] = until_s + _BREATHER_S


def _side(what: Behaviour, cue: Cue) -> str:
    """One-handed behaviours have their side in the repertoire; for the others the score says which hand leads."""
    hands = {side for side in ("left", "right") if {f"{side}_arm", f"{side}_hand"} & what.uses}
    return hands.pop() if len(hands) == 1 and what.layer != "posture" else cue.side


def _vary(cue: Cue, rng: np.random.Generator) -> Cue:
    """Nobody does the same thing twice in the same time or the same size."""
    at, hold, size, tempo = rng.uniform(-1.0, 1.0, 4)
    return replace(
        cue,
        at_s=cue.at_s if cue.at_s == 0.0 else cue.at_s + 0.12 * (at + 1.0),
        hold_s=cue.hold_s * (1.0 + 0.10 * hold),
        size=cue.size * (1.0 + 0.07 * size),
        tempo=cue.tempo * (1.0 + 0.08 * tempo),
    )


def perform_score(score: Score, seed: int, length_s: float | None = None) -> tuple[Clip, Annotation]:
    """Perform a score (or its first length_s seconds) with the effort of its emotion.

    Raises BadInput where the score asks for what the repertoire does not know or for parts that a posture holds.
    """
    rng = np.random.default_rng([seed, EMOTIONS.index(score.emotion)])
    variation, always_on = rng.spawn(2)
    effort, repertoire = load_effort(score.emotion), load_repertoire()
    targets, presets = load_hands()
    acts: Mapping[str, Act] = {**SELF_TOUCH, **CARRIAGE, **GESTURES}
    length = score.length_s if length_s is None else min(length_s, score.length_s)
    stage = Stage(np.arange(round(length / DT_S)) * DT_S, effort, targets, presets)
    occupied = _Occupied()
    spans: list[Span] = []
    postures: list[tuple[float, float, str]] = []
    for owner, planned in enumerate(score.cues):
        cue = _vary(planned, variation)
        if cue.do not in repertoire or (cue.do not in POSTURES and cue.do not in acts):
            raise BadInput(f"score {score.take}", expected="a behaviour of the repertoire", seen=cue.do)
        if cue.at_s >= length:
            continue
        what = repertoire[cue.do]
        cue = replace(cue, side=_side(what, cue), at_s=occupied.free_from(what, cue.at_s))
        if cue.at_s >= length:
            continue
        if what.layer == "posture":
            reached = take_posture(stage, cue, owner)
            way_s = reached - cue.at_s
            taken = cue.at_s + (max(_TAKEN * way_s, _LANDED_S + _LANDED * way_s) if postures else 0.0)
            postures.append((cue.at_s, taken, cue.do))
            occupied.take(what, cue.at_s)
            continue
        act = acts[cue.do]
        move = Move(stage, cue, owner, act.reach_s, act.release_s)
        act.lay(move)
        move.close()
        occupied.take(what, move.shown_until)
        stroke = None
        if what.layer == "gesture":
            stroke = round(move.arrive if move.stroke is None else move.stroke, 3)
        spans.append(Span(what.layer, cue.do, cue.at_s, min(move.shown_until, length), stroke, cue.words))
    ends = [left for left, _, _ in postures[1:]] + [length]
    spans += [
        Span("posture", name, taken, end) for (_, taken, name), end in zip(postures, ends, strict=True) if taken < end
    ]
    spans.sort(key=lambda span: (span.start_s, span.layer))
    clip = render_stage(stage, always_on, score.take)
    return clip, Annotation(score.take, score.emotion, tuple(spans))


def perform_take(emotion: str, seed: int | None = None, length_s: float | None = None) -> tuple[Clip, Annotation]:
    """The flea-market scene in one emotion -> clip at 30 fps and annotation. seed None: the score's own."""
    score = load_score(emotion)
    return perform_score(score, score.seed if seed is None else seed, length_s)


def annotation_yaml(annotation: Annotation, frames: int) -> str:
    """The annotation of a motion of so many frames as the text of a take's YAML file."""
    marks = []
    for span in annotation.spans:
        stroke_s = None if span.stroke_s is None else on_grid(span.stroke_s)
        place = on_grid(span.start_s), on_grid(span.end_s)
        marks.append(Mark(*place, span.layer, span.behaviour, stroke_s, span.words or ""))
    document = Document(
        take=annotation.take, bvh=f"{annotation.take}.bvh", fps=round(1.0 / DT_S), frames=frames,
        emotion=annotation.emotion, author=_AUTHOR,
    )  # fmt: skip
    return document_text(document.with_marks(marks))


def build_takes(out_dir: Path = MOTION / "takes") -> list[Path]:
    """Perform all seven takes and write <emotion>.bvh and <emotion>.yaml; returns the files written."""
    out_dir.mkdir(parents=True, exist_ok=True)
    written = []
    for emotion in EMOTIONS:
        clip, annotation = perform_take(emotion)
        motion, notes = out_dir / f"{emotion}.bvh", out_dir / f"{emotion}.yaml"
        write_bvh(clip, motion, decimals=4)
        notes.write_text(annotation_yaml(annotation, len(clip)), encoding="utf-8")
        written += [motion, notes]
    return written
