"""A stage collects what a performance consists of: keys for the trunk and the hands, waves on top, breath, tremor."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.errors import BadInput
from game.tools.perform.arms import SIDES
from game.tools.perform.body import CHANNELS, MIRRORED
from game.tools.perform.data import Cue, Effort, Target
from game.tools.perform.timing import Ease, blend_scalar, smooth_window

__all__ = ["Curve", "HandKey", "Move", "Stage", "other_side"]

Floats = NDArray[np.floating[Any]]
Curve = Callable[[Floats], Any]
"""Time since the wave's start (F,) -> one value, or three (arrays or numbers)."""


def other_side(side: str) -> str:
    """left <-> right."""
    return SIDES[1 - SIDES.index(side)]


@dataclass(frozen=True)
class HandKey:
    """A hand sets out for a target; ``target`` None = back to where the posture has it."""

    start_s: float
    duration_s: float
    target: Target | None
    ease: Ease
    arc: float
    owner: int


@dataclass
class HandTrack:
    """Keys of one hand and the waves added to its path."""

    home: list[HandKey]
    keys: list[HandKey]
    shift: Floats  # (F, 3) metres, in a left hand's mirrored model space
    turn_deg: Floats  # (F, 3) about the hand's y, z and x axes
    curl_deg: Floats  # (F,)


@dataclass
class Stage:
    """Everything that is to be performed, on one time axis (F,) of 30 frames per second."""

    time: Floats
    effort: Effort
    targets: Mapping[str, Target]
    presets: Mapping[str, Floats]
    base: dict[str, Floats] = field(default_factory=dict)
    added: dict[str, Floats] = field(default_factory=dict)
    waves: dict[str, Floats] = field(default_factory=dict)
    hands: dict[str, HandTrack] = field(default_factory=dict)
    tremor: Floats = field(default_factory=lambda: np.zeros(0))
    lungs: list[tuple[float, float, tuple[tuple[float, float], ...]]] = field(default_factory=list)

    def __post_init__(self) -> None:
        frames = len(self.time)
        for tracks in (self.base, self.added, self.waves):
            tracks.update({name: np.zeros(frames) for name in CHANNELS})
        for side in SIDES:
            self.hands[side] = HandTrack([], [], np.zeros((frames, 3)), np.zeros((frames, 3)), np.zeros(frames))
        self.tremor = np.full(frames, self.effort.tremor)

    def target(self, name: str, shift: Sequence[float] | None = None, preset: str | None = None) -> Target:
        """A named target, moved or with other fingers."""
        if name not in self.targets:
            raise BadInput("hand target", expected=f"one of {', '.join(self.targets)}", seen=name)
        found = self.targets[name]
        if shift is not None:
            found = replace(found, at=found.at + np.array(shift))
        if preset is not None:
            found = replace(found, curls=self.presets[preset])
        return found

    def posture(self, cue: Cue, channels: Mapping[str, float], duration_s: float, how: Ease) -> None:
        """From now on the trunk stands like this: the posture, the emotion's carriage and what the score adds."""
        carriage = self.effort.carriage
        for name in CHANNELS:
            value = channels.get(name, 0.0) * cue.size + carriage.get(name, 0.0) + cue.channels.get(name, 0.0)
            if cue.at_s <= 0.0:
                self.base[name][:] = value
            else:
                blend_scalar(self.base[name], self.time, cue.at_s, duration_s, value, how)


class Move:
    """One cue being laid out: a start, a reach, a hold and a release, in seconds of the take.

    ``start`` -> reach -> ``arrive`` -> hold -> ``leave`` -> release -> ``end``. Behaviours are written for the left
    hand; with ``side`` right, everything that has a side is mirrored. ``main`` and ``other`` name the hands.
    """

    def __init__(self, stage: Stage, cue: Cue, owner: int, reach_s: float, release_s: float) -> None:
        self.stage, self.cue, self.owner = stage, cue, owner
        self.tempo = stage.effort.tempo * cue.tempo
        self.start = cue.at_s
        self.arrive = self.start + reach_s * self.tempo
        self.leave = self.arrive + cue.hold_s
        self.end = self.leave + release_s * self.tempo
        self.release_s = release_s
        self.main, self.other = cue.side, other_side(cue.side)
        self.size = cue.size
        self.stroke: float | None = None
        self._tracks: dict[str, Floats] = {}
        self._used: set[str] = set()

    def after(self, seconds: float) -> float:
        """A moment after the start, in the emotion's tempo."""
        return self.start + seconds * self.tempo

    def body(self, at: float, duration: float, ease: Ease | None = None, **channels: float) -> None:
        """Lead trunk channels to these amounts on top of the posture, for the length of this move."""
        for name, value in channels.items():
            if name not in CHANNELS:
                raise BadInput("trunk channel", expected=f"one of {', '.join(CHANNELS)}", seen=name)
            track = self._tracks.setdefault(name, np.zeros(len(self.stage.time)))
            sign = -1.0 if self.main == "right" and name in MIRRORED else 1.0
            how = ease or self.stage.effort.ease
            blend_scalar(track, self.stage.time, at, duration * self.tempo, sign * value * self.size, how)

    def hand(
        self,
        which: str,
        at: float,
        duration: float,
        target: str,
        *,
        shift: Sequence[float] | None = None,
        preset: str | None = None,
        ease: Ease | None = None,
        arc: float | None = None,
    ) -> None:
        """Send a hand (``main``, ``other`` or ``both``) to a target; the other one of two sets out a little later."""
        sides = (self.main, self.other) if which == "both" else (self.main if which == "main" else self.other,)
        for i, side in enumerate(sides):
            effort = self.stage.effort
            self._used.add(side)
            self.stage.hands[side].keys.append(
                HandKey(
                    at + 0.04 * i * self.tempo,
                    duration * self.tempo * (1.0 + 0.06 * i),
                    self.stage.target(target, shift, preset),
                    ease or effort.ease,
                    effort.arc if arc is None else arc,
                    self.owner,
                )
            )

    def wave(
        self,
        start: float,
        end: float,
        *,
        fade: float = 0.15,
        hand: str | None = None,
        shift: Curve | None = None,
        turn: Curve | None = None,
        curl: Curve | None = None,
        **channels: Curve,
    ) -> None:
        """Something that repeats: curves of the time since ``start``, faded in and out, times this move's size."""
        stage = self.stage
        if end <= start:
            return
        window = smooth_window(stage.time, start, end, min(fade, 0.5 * (end - start))) * self.size
        t = np.maximum(stage.time - start, 0.0)
        for name, curve in channels.items():
            sign = -1.0 if self.main == "right" and name in MIRRORED else 1.0
            stage.waves[name] += sign * window * curve(t)
        if hand is None:
            return
        sides = (self.main, self.other) if hand == "both" else (self.main if hand == "main" else self.other,)
        for side in sides:
            track = stage.hands[side]
            if shift is not None:
                track.shift += window[:, None] * np.stack([np.broadcast_to(v, t.shape) for v in shift(t)], -1)
            if turn is not None:
                track.turn_deg += window[:, None] * np.stack([np.broadcast_to(v, t.shape) for v in turn(t)], -1)
            if curl is not None:
                track.curl_deg += window * curl(t)

    def tremble(self, start: float, end: float, amount: float) -> None:
        """More tremor for a while (1 = wrists 2.4 mm)."""
        self.stage.tremor += amount * self.size * smooth_window(self.stage.time, start, end, 0.15)

    def breathe(self, *keys: tuple[float, float]) -> None:
        """Lead the lungs through (moment, level) instead of the usual breath; 0 empty, 1 a usual full breath."""
        self.stage.lungs.append((keys[0][0], keys[-1][0], keys))

    def close(self) -> None:
        """Let go: the trunk and the hands return to the posture."""
        stage = self.stage
        for name, track in self._tracks.items():
            blend_scalar(track, stage.time, self.leave, self.release_s * self.tempo, 0.0, stage.effort.settle)
            stage.added[name] += track
        for i, side in enumerate(sorted(self._used, key=(self.main, self.other).index)):
            stage.hands[side].keys.append(
                HandKey(
                    self.leave + 0.05 * i * self.tempo,
                    self.release_s * self.tempo * (1.0 + 0.08 * i),
                    None,
                    stage.effort.settle,
                    0.6 * stage.effort.arc,
                    self.owner,
                )
            )

    @property
    def shown_until(self) -> float:
        """When an annotator would end the span: most of the way back."""
        return self.leave + 0.75 * (self.end - self.leave)
