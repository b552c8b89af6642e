"""The heart: one fixed tick of the world, as a visible list of stages. No I/O, no drawing, no wall clock.

    choice          -> story, market, appraisal (game.app.talk) -> lines + feelings
    feelings        -> felt (leaks into the body), shown (behind the mask)
    felt + words    -> embos.planner  -> one unit per layer
    units + felt    -> animation      -> pose
    shown           -> face           -> one part per region

The window, headless autoplay, snapshot and film all call this same step with the same dt.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from game.animation import Performer, PerformSignal
from game.app.talk import Choice, TalkAssets, TalkState, choose
from game.app.world import TEXT_SPEED, TICK_S, Body, Intent, Speech, World, next_mark
from game.core.emotion_space import EMOTIONS, SIX, with_neutral
from game.core.springs import damp
from game.embos import GestureCues, Planner, PlannerSignal, beat_columns, habit_of
from game.emotion import Temperament, shown_emotion
from game.face import FaceAsset, FaceSignal, advance_face, start_face, viseme_track
from game.story import Spoken, TimedText
from game.story.timing import CHARS_PER_S

__all__ = [
    "FELT_HALF_LIFE_S", "PEAK_S", "SHOWN_HALF_LIFE_S", "STAGES", "StepAssets", "feelings_after", "forget_planners",
    "leaked_emotion", "line_cues", "new_world", "reaction_to", "speech_stage", "step", "targets_of", "timed_line",
]  # fmt: skip

Floats = NDArray[np.float64]

FELT_HALF_LIFE_S = 0.28
"""How fast the body's emotion follows what is felt: a jump is there within a second."""
SHOWN_HALF_LIFE_S = 0.12
BURST_S = 1.2
"""A reaction leaks strongest for about this long …"""
PEAK_S = 0.3
"""A reaction is at its peak so long after its line has begun."""
BURST_GAIN = 0.45
"""… by this share of the felt emotion on top, and leaves a residue in the posture."""
AFTER_LINE_S = 0.35
"""A breath after each line before the next may begin by itself."""
LIPS_LEAD_S = 0.04
"""Lips set off before the sound is heard, and their spring takes as long."""
NAMED_GESTURE_S = 0.4
"""When the stroke of a gesture that the script names falls, seconds into its line: on the first words."""
PRESENT = 0.15
"""A gesture that less than this of the felt emotion knows does not hold a line up and competes with no beat."""
KNOWN_LINES = 4096
"""The same lines are spoken again and again; so many are remembered with their timing and cues."""
HABIT_S, HABIT_SHARE = 5.0, 0.75
"""A greeting habit is seen for so long, and moves the body by this share: it is learnt before it can mislead."""
CUSTOMER_GAZE = np.array([0.0, 1.16, 3.0])


@dataclass(frozen=True, eq=False)
class StepAssets:
    """What a step needs and never changes. performer and face are None where nobody looks (autoplay)."""

    talk: TalkAssets
    planner: Planner
    performer: Performer | None = None
    face: FaceAsset | None = None


def targets_of(assets: StepAssets, talk: TalkState) -> tuple[Floats, Floats]:
    """(6,) felt and (7,) shown as the talk has them now."""
    return talk.feeling.felt, shown_emotion(assets.talk.person, talk.feeling)


def new_world(assets: StepAssets, seed: int, *, language: str = "en", text_speed: str = "normal") -> World:
    """A world before its first tick: the shopkeeper calm behind the table."""
    planner = assets.planner.start(1, seed)
    performer = None if assets.performer is None else assets.performer.start(1, seed)
    face = None if assets.face is None else start_face(assets.face, seed)
    body = Body(planner=planner, decisions=planner.decisions, performer=performer, face=face)
    return World(seed=seed, body=body, language=language, text_speed=text_speed)


# --- stages: each (assets, world, intent) -> world ---------------------------------------------------------------
def story_stage(assets: StepAssets, world: World, intent: Intent) -> World:
    """The player's choice, or that of a timer that ran out, goes through story, appraisal and market to lines."""
    if world.talk is None or not world.waiting:
        return world
    choice = intent.choice
    if choice is None:
        left = world.time_left
        if left is None:
            return world
        if left > 0.0:
            return replace(world, waited=world.waited + 1)
        assert world.talk.beat.timer is not None
        choice = Choice(world.talk.beat.timer.choice)
    talk = choose(assets.talk, world.talk, choice)
    mark = next_mark(assets.talk, world.talk, talk, choice, intent.guess, number=len(world.marks), time_s=world.time_s)
    return replace(world, talk=talk, queue=talk.beat.lines, marks=(*world.marks, mark), waited=0)


def speech_stage(assets: StepAssets, world: World, intent: Intent) -> World:
    """One line after another; each begins when the one before has been spoken and the player goes on."""
    speech = world.speech
    if speech is not None:
        spoken = world.time_s - speech.started_s >= speech.timed.length_s + AFTER_LINE_S
        if intent.proceed and not (spoken or speech.hurried):
            return replace(world, speech=replace(speech, hurried=True))
        if not intent.proceed:
            return world
        world = replace(world, speech=None)
        if not world.queue:
            # Everything is said: what is felt now is what the next line will be judged by.
            return _settle(assets, world)
    if not world.queue:
        return world
    line, rest = world.queue[0], world.queue[1:]
    world = replace(world, queue=rest, speech=_speech(assets, world, line), backlog=(*world.backlog[-99:], line))
    # Cause before effect: the reaction shows when the shopkeeper begins to answer.
    reaction = reaction_to(world.talk, line, world.felt_target)
    if reaction is None:
        return world
    felt, shown = reaction
    return replace(world, felt_target=felt, shown_target=shown, burst_s=world.time_s + PEAK_S)


def reaction_to(talk: TalkState | None, line: Spoken, felt_target: Floats) -> tuple[Floats, Floats] | None:
    """(6,) felt and (7,) shown from a line on; None where it changes nothing. felt_target: (6,) before it."""
    if talk is None or line.speaker == "player" or not talk.record:
        return None
    record = dict(talk.record)
    felt = np.asarray(record["felt"])[:6]
    return None if np.array_equal(felt, felt_target) else (felt, np.asarray(record["shown"]))


def _settle(assets: StepAssets, world: World) -> World:
    if world.talk is None:
        return world
    felt, shown = targets_of(assets, world.talk)
    return replace(world, felt_target=felt, shown_target=shown)


def _speech(assets: StepAssets, world: World, line: Spoken) -> Speech:
    timed = timed_line(line, world.language, world.text_speed)
    cues, visemes, start_s = None, None, world.time_s
    if line.speaker == "shopkeeper":
        emotion = body_emotion(assets, world)
        lead_s = assets.planner.library.stroke_lead_s(emotion[None, :])[0]
        cues, start_s = line_cues(assets.planner, timed, line.gesture, emotion, lead_s, world.time_s)
        if assets.face is not None:
            visemes = viseme_track(timed.text, timed.language, timed.char_s, timed.length_s)
    return Speech(line, timed, start_s, cues, visemes, hurried=TEXT_SPEED[world.text_speed] is None)


def timed_line(line: Spoken, language: str, text_speed: str) -> TimedText:
    """A line in time."""
    factor = TEXT_SPEED[text_speed]
    return _timed(line.text(language), language, CHARS_PER_S[language] * (1.0 if factor is None else factor))


@lru_cache(maxsize=KNOWN_LINES)
def _timed(text: str, language: str, chars_per_s: float | None) -> TimedText:
    return TimedText(text, language, chars_per_s)


def line_cues(
    planner: Planner, timed: TimedText, named: str | None, emotion: Floats, lead_s: Floats, now_s: float
) -> tuple[GestureCues, float]:
    """What the line's words call up, and when it begins: hands set out before the voice (preparation).

    named: a gesture that the script asks for by name; it falls on the line's first words. emotion: (7,) in the body;
    lead_s: (G,) from start to stroke in that emotion.
    """
    shown = planner.library.known_gestures @ emotion > PRESENT
    line = (planner, timed.text, timed.language, timed.chars_per_s)
    _, mattering = _called_up(*line)
    cues = _cues(*line, named, (shown & mattering).tobytes())
    start_s = now_s + min(cues.preparation_s(lead_s, shown), planner.config.lead_in_s)
    return cues.later(start_s), start_s


@lru_cache(maxsize=KNOWN_LINES)
def _called_up(
    planner: Planner, text: str, language: str, chars_per_s: float | None
) -> tuple[GestureCues, NDArray[np.bool_]]:
    """A line's cues without beats, and (G,) the gestures of which it matters whether they are shown."""
    library, timed = planner.library, _timed(text, language, chars_per_s)
    cues = GestureCues.from_words(library, text, timed.char_s, language)
    mattering = np.zeros(cues.count, dtype=bool)
    mattering[cues.gesture] = mattering[beat_columns(library, planner.config.stress)] = True
    return cues, mattering


@lru_cache(maxsize=KNOWN_LINES)
def _cues(
    planner: Planner, text: str, language: str, chars_per_s: float | None, named: str | None, shown: bytes
) -> GestureCues:
    """A line's cues from its start on; shown: (G,) bool as bytes, gestures that the feeling knows."""
    library, timed = planner.library, _timed(text, language, chars_per_s)
    words, _ = _called_up(planner, text, language, chars_per_s)
    known = np.frombuffer(shown, dtype=bool)
    cues = words.with_beats(library, text, timed.char_s, language, shown=known, stress=planner.config.stress)
    return cues if named is None else cues.adding(library, named, min(NAMED_GESTURE_S, timed.length_s))


def forget_planners() -> None:
    """Let go of what is remembered of planners that are asked no more: it would keep their whole library."""
    _called_up.cache_clear()
    _cues.cache_clear()
    habit_of.cache_clear()


def feeling_stage(assets: StepAssets, world: World, intent: Intent) -> World:
    """What the body feels and the face shows follow their targets; both fast, neither at once."""
    felt, shown = feelings_after(world.felt, world.felt_target, world.shown[:6], world.shown_target[:6])
    return replace(world, felt=felt, shown=with_neutral(shown))


def feelings_after(felt: Floats, felt_target: Floats, shown: Floats, shown_target: Floats) -> tuple[Floats, Floats]:
    """Felt and shown one tick later, all (..., 6)."""
    felt = np.asarray(damp(felt, felt_target, FELT_HALF_LIFE_S, TICK_S), dtype=np.float64)
    return felt, np.asarray(damp(shown, shown_target, SHOWN_HALF_LIFE_S, TICK_S), dtype=np.float64)


def body_emotion(assets: StepAssets, world: World) -> Floats:
    """(7,) what drives posture and mannerism: the felt emotion as far as it leaks, strongest in the burst."""
    leaked = leaked_emotion(assets.talk.person, world.felt, world.shown[:6], np.array(world.time_s - world.burst_s))
    if not world.habit or len(world.marks) != 1 or world.time_s - world.marks[0].time_s > HABIT_S:
        return leaked
    habit = np.eye(len(EMOTIONS))[EMOTIONS.index(world.habit)]
    return with_neutral(leaked[:6] * (1.0 - HABIT_SHARE) + habit[:6] * HABIT_SHARE)


def leaked_emotion(person: Temperament, felt: Floats, shown: Floats, since_burst_s: Floats) -> Floats:
    """felt, shown: (..., 6); since_burst_s: (...) seconds since the reaction's peak -> (..., 7)."""
    leaked = felt * person.leak + shown * (1.0 - person.leak)
    since = np.minimum(np.abs(since_burst_s) / BURST_S, 20.0)  # beyond that nothing is left of it
    gain = 1.0 + BURST_GAIN * np.exp(-since * since * 2.0)
    return with_neutral(np.clip(leaked * gain[..., None], 0.0, 1.0))


def planner_stage(assets: StepAssets, world: World, intent: Intent) -> World:
    """Eq. 1 for every layer."""
    library = assets.planner.library
    emotion = body_emotion(assets, world)[None, :]
    words = np.zeros((1, len(library.gestures)))
    if world.speech is not None and world.speech.cues is not None:
        lead_s, window_s = library.stroke_lead_s(emotion)[0], assets.planner.config.word_window_s
        words = world.speech.cues.factors(world.time_s, lead_s, window_s)[None, :]
    # Somebody's own habits belong to their talk; a feeling that is performed alone has nobody's.
    person = assets.talk.person if world.talk is not None else None
    habit = None if person is None else habit_of(assets.planner, person.habit_units, person.habit_rate)
    signal = PlannerSignal(emotion=emotion, words=words, time_s=world.time_s, habit=habit)
    state, decisions = assets.planner.advance(world.body.planner, signal, TICK_S)
    return replace(world, body=replace(world.body, planner=state, decisions=decisions, signal=signal))


def speaking(world: World) -> bool:
    """Whether the shopkeeper's mouth is moving now."""
    speech = world.speech
    if speech is None or speech.line.speaker != "shopkeeper":
        return False
    return 0.0 <= world.time_s - speech.started_s < speech.timed.length_s


def performer_stage(assets: StepAssets, world: World, intent: Intent) -> World:
    """Units to one pose."""
    if assets.performer is None or world.body.performer is None or world.body.signal is None:
        return world
    signal = PerformSignal(
        emotion=world.body.signal.emotion,
        gaze_target=CUSTOMER_GAZE[None, :],
        speaking=np.array([float(speaking(world))]),
        mode=world.mode,
    )
    state, pose = assets.performer.advance(world.body.performer, world.body.decisions, signal, TICK_S)
    return replace(world, body=replace(world.body, performer=state, pose=pose))


def face_stage(assets: StepAssets, world: World, intent: Intent) -> World:
    """The shown emotion to one part per region, over time."""
    if assets.face is None or world.body.face is None:
        return world
    pose, speech = world.body.pose, world.speech
    shown, named, visemes = world.shown, None, None
    if world.mode == "gestures":
        # Gestures are judged alone: a face that tells the feeling would tell it for them.
        shown = with_neutral(np.zeros(6))
    if speech is not None and speech.line.speaker == "shopkeeper":
        visemes = None if speech.visemes is None else speech.visemes.at(world.time_s - speech.started_s + LIPS_LEAD_S)
        if speech.line.face is not None and world.mode != "gestures":
            # What the script asks for belongs to the words: a drawn expression, or a nudge on what is shown.
            named = speech.line.face if speech.line.face in assets.face.expressions else None
            nudge = assets.talk.script.faces.get(speech.line.face, {})
            change = np.array([nudge.get(name, 0.0) for name in SIX])
            shown = with_neutral(np.clip(shown[:6] + change, 0.0, 1.0))
    signal = FaceSignal(
        shown=shown,
        felt=shown if world.mode == "gestures" else with_neutral(world.felt),
        blink=0.0 if pose is None else float(pose.blink[0]),
        look=None if pose is None else pose.gaze[0],
        visemes=visemes,
        expression=named,
    )
    state, params = advance_face(assets.face, world.body.face, signal, TICK_S)
    return replace(world, body=replace(world.body, face=state, face_params=params, face_signal=signal))


STAGES = (story_stage, speech_stage, feeling_stage, planner_stage, performer_stage, face_stage)


def step(assets: StepAssets, world: World, intent: Intent = Intent()) -> World:  # noqa: B008 - frozen, never changed
    """The next world: every stage in order, then the clock."""
    for stage in STAGES:
        world = stage(assets, world, intent)
    return replace(world, tick=world.tick + 1)
