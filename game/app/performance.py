"""One body in one feeling, run through the game's own step: every start with its reason, and what was on stage.

Nothing here acts on the planner. A start is explained from the state before its tick, so the table is the one
that decided, and its source is the take and span of the variant that really plays.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log2
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.animation import Mode
from game.app.step import StepAssets, new_world, step
from game.app.world import TICK_S, Intent, Speech, World
from game.embos import LAYERS, Candidate, Decisions, GestureCues, Planner, PlannerSignal, PlannerState, UnitLibrary
from game.story import Spoken, TimedText

__all__ = [
    "Event", "Performance", "Script", "correlations", "explain_starts", "factors_of", "fixed_world", "line_entropy",
    "line_motions", "perform", "played_span", "take_rates",
]  # fmt: skip

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Event:
    """A unit begins. table: its layer's candidates, the chosen one first; stroke_s: world time, None but for gestures.

    source: take and span of the variant that plays, strongest of the mixture of eq. 5.
    """

    time_s: float
    duration_s: float
    chosen: Candidate
    table: tuple[Candidate, ...]
    source: str
    stroke_s: float | None

    def row(self, table: bool = False) -> dict[str, Any]:
        """For logs: rounded, JSON-ready."""
        row: dict[str, Any] = {
            "time_s": round(self.time_s, 3),
            "layer": self.chosen.layer,
            "unit": self.chosen.name,
            "duration_s": round(self.duration_s, 3),
            "factors": factors_of(self.chosen),
            "reason": self.chosen.reason,
            "source": self.source,
        }
        if self.stroke_s is not None:
            row["stroke_s"] = round(self.stroke_s, 3)
        if table:
            row["candidates"] = [{"unit": c.name, **factors_of(c), "reason": c.reason} for c in self.table]
        return row


def factors_of(candidate: Candidate) -> dict[str, float]:
    """The four factors of eq. 1 and their product."""
    names = ("continuity", "linkage", "time", "state", "score")
    return {name: round(float(getattr(candidate, name)), 6) for name in names}


@dataclass(frozen=True)
class Script:
    """What is said: text again and again, pause_s apart; or, with every_word, all gesture words all the time."""

    text: str = ""
    pause_s: float = 2.0
    every_word: bool = False


@dataclass(frozen=True, eq=False)
class Performance:
    """What happened. share: (U,) of the time on stage; rate: (U,) starts a minute; lines: when each line began.

    speed_rad_s: mean speed of a joint, 0 where no pose was made.
    """

    seconds: float
    events: tuple[Event, ...]
    share: Floats
    rate: Floats
    lines: tuple[float, ...]
    speed_rad_s: float = 0.0


class EveryWord(GestureCues):
    """A line in which every gesture word stands at every moment: what the emotion does with it is all that counts."""

    def factors(self, time_s: float, lead_s: Floats | None = None, window_s: float = 0.1) -> Floats:
        """(G,) ones."""
        return np.ones(self.count)


def fixed_world(assets: StepAssets, emotion: Floats, seed: int, *, mode: Mode = "full", language: str = "en") -> World:
    """Nobody is talked to and the feeling (7,) stands, in body and face, from the first tick on."""
    six = np.asarray(emotion, dtype=np.float64)[:6]
    return replace(
        new_world(assets, seed, language=language),
        mode=mode, felt=six, felt_target=six, shown=np.asarray(emotion), shown_target=np.asarray(emotion),
    )  # fmt: skip


def perform(
    assets: StepAssets,
    emotion: Floats,
    seconds: float,
    seed: int,
    *,
    mode: Mode = "full",
    language: str = "en",
    script: Script = Script(),
) -> Performance:
    """Run the step at its own rate with a fixed feeling. The pose is made where the assets have a performer."""
    library = assets.planner.library
    world = fixed_world(assets, emotion, seed, mode=mode, language=language)
    if script.every_word:
        line = Spoken(id="every_word", speaker="shopkeeper", en="", ja="")
        cues = EveryWord(np.zeros(0, dtype=np.intp), np.zeros(0), len(library.gestures))
        world = replace(world, speech=Speech(line, TimedText("", language), 0.0, cues))
    events: list[Event] = []
    lines: list[float] = []
    on, starts, turned = np.zeros(len(library)), np.zeros(len(library)), 0.0
    ticks, silent_since = max(round(seconds / TICK_S), 1), 0.0
    for _ in range(ticks):
        speech, intent = world.speech, Intent()
        if speech is not None:
            silent_since = world.time_s
            over = world.time_s - speech.started_s > speech.timed.length_s + 0.5
            intent = Intent(proceed=over and not script.every_word)
        elif script.text and world.time_s - silent_since >= script.pause_s:
            said = Spoken(id=f"line {len(lines)}", speaker="shopkeeper", en=script.text, ja=script.text)
            lines.append(world.time_s)
            world = replace(world, queue=(said,))
        before = world
        world = step(assets, world, intent)
        decisions = world.body.decisions
        on[decisions.unit[0]] += 1.0
        if decisions.started.any():
            assert world.body.signal is not None
            new = explain_starts(assets.planner, before.body.planner, world.body.signal, decisions)
            events += new
            for event in new:
                starts[event.chosen.unit] += 1.0
        if before.body.pose is not None and world.body.pose is not None:
            turned += _turned_rad(before.body.pose.rotation[0], world.body.pose.rotation[0])
    length_s = ticks * TICK_S
    return Performance(length_s, tuple(events), on / ticks, starts * 60.0 / length_s, tuple(lines), turned / length_s)


def _turned_rad(before: Floats, after: Floats) -> float:
    """Mean angle between two poses' joints, (J, 4) each."""
    dot = np.abs((before.astype(np.float64) * after).sum(axis=-1))
    return float(np.mean(2.0 * np.arccos(np.minimum(dot, 1.0))))


def explain_starts(
    planner: Planner, before: PlannerState, signal: PlannerSignal, decisions: Decisions, character: int = 0
) -> list[Event]:
    """The units (not rest) that started in this tick; before: the planner's state from before it."""
    library, events = planner.library, []
    layers = [
        at for at in np.flatnonzero(decisions.started[character]) if not library.is_rest[decisions.unit[character, at]]
    ]
    if not layers:
        return []
    tables = planner.explain(before, signal, character)
    for at in layers:
        unit = int(decisions.unit[character, at])
        table = tuple(tables[at])
        is_gesture = library.units[unit].layer == "gesture"
        start_s = float(decisions.start_time_s[character, at])
        events.append(
            Event(
                time_s=start_s,
                duration_s=float(decisions.duration_s[character, at]),
                chosen=table[0],
                table=table,
                source=played_span(library, decisions, character, int(at)),
                stroke_s=start_s + float(decisions.stroke_s[character, at]) if is_gesture else None,
            )
        )
    return events


def played_span(library: UnitLibrary, decisions: Decisions, character: int, layer: int) -> str:
    """``take start–end s``: the span that leads the mixture now playing, "" for rest."""
    weights = decisions.emotion_weights[character, layer]
    if not weights.any():
        return ""
    pick = float(decisions.variant_pick[character, layer])
    variant = library.variant(int(decisions.unit[character, layer]), int(weights.argmax()), pick)
    return "" if variant is None else f"{variant.take} {variant.start_s:.2f}–{variant.end_s:.2f} s"


def take_rates(library: UnitLibrary) -> tuple[Floats, Floats]:
    """(U, 7) share of the annotated time and (U, 7) occurrences a minute of every unit in the takes."""
    period = library.duration_s + library.waiting_s  # L_e / occurrences, by eq. 3
    safe = np.where(library.exists, period, 1.0)
    return (
        np.where(library.exists, library.duration_s / safe, 0.0),
        np.where(library.exists, 60.0 / safe, 0.0),
    )


def correlations(library: UnitLibrary, performance: Performance, emotion: int) -> dict[str, float]:
    """r between performance and take in a pure emotion: shares of time for postures, rates for what is done.

    Over all units of a layer but rest, also those the emotion never shows; layers in which nothing played (no
    words, no gestures) are left out.
    """
    take_share, take_rate = take_rates(library)
    result: dict[str, float] = {}
    for layer in LAYERS:
        own = [i for i in library.of_layer(layer) if not library.is_rest[i]]
        take = (take_share if layer == "posture" else take_rate)[own, emotion]
        mine = (performance.share if layer == "posture" else performance.rate)[own]
        if mine.std() > 0.0 and take.std() > 0.0:
            result[layer] = float(np.corrcoef(take, mine)[0, 1])
    return result


def line_motions(performance: Performance) -> list[tuple[str, ...]]:
    """For every repetition of the line: what began from its start to the next line, layer and unit and span."""
    ends = (*performance.lines[1:], performance.seconds)
    return [
        tuple(f"{e.chosen.name}@{e.source}" for e in performance.events if begin <= e.time_s < end)
        for begin, end in zip(performance.lines, ends, strict=True)
    ]


def line_entropy(motions: Sequence[tuple[str, ...]]) -> dict[str, float]:
    """How varied the motion after one and the same line is.

    bits: Shannon entropy of the whole motion; most: log2 of the repetitions, its greatest value;
    repeated: share of repetitions with the same motion as the one before.
    """
    counts = Counter(motions)
    total = sum(counts.values())
    bits = -sum(n / total * log2(n / total) for n in counts.values()) if total else 0.0
    same = sum(a == b for a, b in itertools.pairwise(motions))
    return {
        "lines": float(total),
        "bits": round(bits, 3) + 0.0,
        "most": round(log2(total), 3) if total else 0.0,
        "repeated": round(same / max(total - 1, 1), 4),
    }
