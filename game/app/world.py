"""The world: one dataclass that owns everything that changes, and what the player asks of the next tick."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from game.app.talk import Choice, TalkAssets, TalkState
from game.core.emotion_space import EMOTIONS, with_neutral
from game.embos import Decisions, GestureCues, PlannerSignal, PlannerState, greet, habit_of
from game.emotion import shown_emotion
from game.emotion.rules import label_index
from game.face import FaceSignal, VisemeTrack
from game.story import Spoken, TimedText

if TYPE_CHECKING:
    from game.animation import Mode, PerformerState, Pose
    from game.app.step import StepAssets
    from game.face import FaceParams, FaceState

__all__ = [
    "TEXT_SPEED", "TICK_S", "Body", "Intent", "Mark", "Speech", "World", "enter_talk", "first_mark", "leave_talk",
    "next_mark",
]  # fmt: skip

Floats = NDArray[np.float64]

TICK_S = 1.0 / 30.0
"""The fixed step of the simulation, seconds."""

TEXT_SPEED: dict[str, float | None] = {"slow": 0.5, "normal": 0.75, "fast": 1.4, "instant": None}
"""How fast lines are spoken, as a factor on the language's reading speed; normal leaves the hands time to speak too.

None shows a line at once."""


@dataclass(frozen=True)
class Intent:
    """What the player asks of a tick: a choice, or to go on to the next line (or finish the one being spoken).

    guess: the token laid before the choice: the feeling the player believes in, none where empty."""

    choice: Choice | None = None
    proceed: bool = False
    guess: str = ""


@dataclass(frozen=True, eq=False)
class Speech:
    """A line being spoken. started_s: world time; hurried: the player has seen enough, the text stands whole."""

    line: Spoken
    timed: TimedText
    started_s: float
    cues: GestureCues | None = None
    visemes: VisemeTrack | None = None
    hurried: bool = False


@dataclass(frozen=True)
class Mark:
    """A point on the talk's curve: what was felt and shown, and the player's move that led there.

    before: the talk as it stood when the player chose (None at the greeting); time_s: world time of the choice;
    guess: the token laid; label, face: what was felt and what the face showed most just before.
    """

    round: int
    act: str
    quality: str
    felt: tuple[float, ...]
    shown: tuple[float, ...]
    text_en: str = ""
    text_ja: str = ""
    before: TalkState | None = field(default=None, compare=False)
    choice: Choice | None = None
    guess: str = ""
    label: str = ""
    face: str = ""
    ask: float = 1.0
    time_s: float = 0.0

    def text(self, language: str) -> str:
        """The player's words, as they stood on the button."""
        return self.text_ja if language == "ja" and self.text_ja else self.text_en


@dataclass(frozen=True, eq=False)
class Body:
    """The character's body over time: planner, performer and face, each with its last output."""

    planner: PlannerState
    decisions: Decisions
    performer: PerformerState | None = None
    pose: Pose | None = None
    face: FaceState | None = None
    face_params: FaceParams | None = None
    face_signal: FaceSignal | None = None
    signal: PlannerSignal | None = None


@dataclass(frozen=True, eq=False)
class World:
    """Everything that changes while the game runs; ``step`` makes the next one from it.

    tick: fixed steps done. felt, shown: (6,) and (7,) as they stand in the body and on the face now, following
    ``felt_target`` and ``shown_target``. burst_s: world time at which the present reaction peaks. habit: a
    feeling that a habit of the person looks like, seen while they greet. timers: factor on
    the time that timed choices give, 0 for none; waited: ticks for which the present choice has stood.
    """

    seed: int
    body: Body
    tick: int = 0
    language: str = "en"
    text_speed: str = "normal"
    mode: Mode = "full"
    talk: TalkState | None = None
    speech: Speech | None = None
    queue: tuple[Spoken, ...] = ()
    backlog: tuple[Spoken, ...] = ()
    felt: Floats = field(default_factory=lambda: np.zeros(6))
    shown: Floats = field(default_factory=lambda: with_neutral(np.zeros(6)))
    felt_target: Floats = field(default_factory=lambda: np.zeros(6))
    shown_target: Floats = field(default_factory=lambda: with_neutral(np.zeros(6)))
    burst_s: float = -1e9
    timers: float = 0.0
    waited: int = 0
    marks: tuple[Mark, ...] = ()
    habit: str = ""

    @property
    def time_s(self) -> float:
        """Simulated seconds since the world began."""
        return self.tick * TICK_S

    @property
    def waiting(self) -> bool:
        """Whether the player may choose: a talk goes on and nobody is speaking."""
        return self.talk is not None and not self.talk.ended and self.speech is None and not self.queue

    @property
    def time_left(self) -> float | None:
        """Share of the time left for a timed choice, in [0, 1]; None where there is no hurry."""
        timer = self.talk.beat.timer if self.waiting and self.timers > 0 and self.talk is not None else None
        return None if timer is None else max(1.0 - self.waited * TICK_S / (timer.seconds * self.timers), 0.0)

    @property
    def over(self) -> bool:
        """Whether the talk has ended and its last line has been spoken."""
        return self.talk is not None and self.talk.ended and self.speech is None and not self.queue


def first_mark(assets: TalkAssets, talk: TalkState, time_s: float = 0.0) -> Mark:
    """The curve's first point: the greeting."""
    shown = shown_emotion(assets.person, talk.feeling)
    return Mark(0, "", "", tuple(talk.feeling.felt7), tuple(shown), time_s=time_s)


def next_mark(
    assets: TalkAssets, before: TalkState, after: TalkState, move: Choice, guess: str, number: int, time_s: float = 0.0
) -> Mark:
    """The curve's point after a move, from the talk before and after it."""
    said, record = before.beat.choice(move.id), dict(after.record)
    shown = shown_emotion(assets.person, before.feeling)
    return Mark(
        round=number,
        act=str(record["act"]),
        quality=str(record["quality"]),
        felt=tuple(float(v) for v in record["felt"]),
        shown=tuple(float(v) for v in record["shown"]),
        text_en=said.en,
        text_ja=said.ja,
        before=before,
        choice=move,
        guess=guess,
        label=str(record["felt_label"]),
        face=EMOTIONS[label_index(shown[:6].tolist(), assets.feelings.label_threshold)],
        ask=after.bargain.ask,
        time_s=time_s,
    )


def enter_talk(assets: StepAssets, world: World, talk: TalkState) -> World:
    """The player steps up to the table: the first lines are queued, the feelings are those of the talk, and what the
    shopkeeper does out of habit is seen early."""
    from game.app.step import targets_of

    felt, shown = targets_of(assets, talk)
    person, planner = assets.talk.person, assets.planner
    met = greet(world.body.planner, habit_of(planner, person.habit_units, person.habit_rate), world.time_s)
    return replace(
        world,
        body=replace(world.body, planner=met),
        talk=talk,
        speech=None,
        queue=talk.beat.lines,
        waited=0,
        backlog=(),
        felt_target=felt,
        shown_target=shown,
        marks=(first_mark(assets.talk, talk, world.time_s),),
        habit="",
    )


def leave_talk(world: World) -> World:
    """Nobody is talked to: calm, with a host's small smile."""
    calm = np.zeros(6)
    calm[2] = 0.25
    return replace(world, talk=None, speech=None, queue=(), felt_target=calm, shown_target=with_neutral(calm), marks=())
