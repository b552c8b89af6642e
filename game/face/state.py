"""A face over time: which parts, how they change, what leaks, and how talk, blinks and gaze join in."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from game.core.springs import critical_spring
from game.face.asset import FaceAsset
from game.face.params import FIELDS, INDEX, REGIONS, FaceParams, clamp
from game.face.parts import Face
from game.face.speech import VISEMES

__all__ = ["FaceDecision", "FaceLeak", "FaceSignal", "FaceState", "advance_face", "explain_face", "start_face"]

Floats = NDArray[np.float64]
_REGION_OF = np.array([REGIONS.index(field.region) for field in FIELDS])
_NEUTRAL = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
_STILL = 0.02  # an emotion that moved less than this (sum over the seven) is not looked up again
_MOUTH, _SKIN = REGIONS.index("mouth"), REGIONS.index("skin")


@dataclass(frozen=True)
class FaceSignal:
    """What reaches a face in one step.

    shown and felt: (7,) emotions, felt None = nothing leaks; blink 0..1; look (2,) in −1..1, +x to the character's
    left; visemes (6,) weights of the spoken mouth shapes, all 0 when silent; expression: a named one, or None.
    """

    shown: Floats
    felt: Floats | None = None
    blink: float = 0.0
    look: Floats | None = None
    visemes: Floats | None = None
    expression: str | None = None


@dataclass(frozen=True)
class FaceLeak:
    """A micro-expression at this moment: felt (7,) as it was when it broke through, and its share 0..1 of the face."""

    felt: Floats
    share: float


@dataclass(frozen=True)
class FaceState:
    """One character's face. Plain numbers only, so that it can be saved and compared."""

    seed: int
    tick: int
    numbers: tuple[int, ...]  # chosen parts
    looked_up: Floats  # (7,) the shown emotion for which they were last scored
    held_s: float
    pursued: FaceParams  # (K,) target of each number, changing region by region
    waiting: tuple[int, ...]  # parts toward which a region's delay is running
    expression: str | None
    delay_s: Floats  # (4,)
    params: FaceParams  # (K,)
    velocity: FaceParams  # (K,) per second
    visemes: Floats  # (6,) smoothed
    viseme_velocity: Floats  # (6,) per second
    micro_numbers: tuple[int, ...]
    micro_felt: Floats  # (7,)
    micro_time_s: float
    micro_length_s: float  # 0 = no micro-expression now
    micro_share: float  # of the face in this step

    @property
    def leak(self) -> FaceLeak | None:
        """What breaks through the mask in this step."""
        return FaceLeak(self.micro_felt, self.micro_share) if self.micro_share > 0.0 else None


@dataclass(frozen=True)
class FaceDecision:
    """Why this face: the parts shown, their score, the best alternative, and what decided."""

    face: Face
    score: float
    best: Face
    best_score: float
    reason: str


def start_face(asset: FaceAsset, seed: int, shown: Floats | None = None) -> FaceState:
    """A face at rest on an emotion (neutral without one)."""
    emotion = _NEUTRAL if shown is None else np.asarray(shown, dtype=np.float64)
    search = asset.search
    numbers = search.numbers(search.best(search.score_emotion(emotion)))
    params = asset.model.parts.params(numbers, _strength(emotion))
    return FaceState(
        seed=seed,
        tick=0,
        numbers=numbers,
        looked_up=emotion.copy(),
        held_s=asset.timing.hold_s,
        pursued=params,
        waiting=numbers,
        expression=None,
        delay_s=np.zeros(len(REGIONS)),
        params=params,
        velocity=np.zeros_like(params),
        visemes=np.zeros(len(VISEMES)),
        viseme_velocity=np.zeros(len(VISEMES)),
        micro_numbers=numbers,
        micro_felt=_NEUTRAL.copy(),
        micro_time_s=0.0,
        micro_length_s=0.0,
        micro_share=0.0,
    )


def advance_face(asset: FaceAsset, state: FaceState, signal: FaceSignal, dt_s: float) -> tuple[FaceState, FaceParams]:
    """One step: the new state and the expression (K,) to draw, within the parameters' ranges."""
    state = _choose(asset, state, signal, dt_s)
    state = _pursue(asset, state, signal, dt_s)
    state = _leak(asset, state, signal, dt_s)
    spoken = np.zeros(len(VISEMES)) if signal.visemes is None else np.asarray(signal.visemes, dtype=np.float64)
    # A spring, not a plain damping: lips and jaw set off softly instead of leaving with a jerk.
    visemes, velocity = critical_spring(
        state.visemes, state.viseme_velocity, spoken, asset.timing.speech_half_life_s, dt_s
    )
    state = replace(
        state,
        tick=state.tick + 1,
        visemes=np.maximum(np.asarray(visemes, dtype=np.float64), 0.0),
        viseme_velocity=np.asarray(velocity, dtype=np.float64),
        micro_share=_micro_share(asset, state, dt_s),
    )
    shown = _with_micro(asset, state, state.params.copy())
    _speak(asset, state.visemes, shown)
    _tremble(asset, state.tick * dt_s, shown)
    _look_and_blink(signal, shown)
    return state, clamp(shown)


def explain_face(asset: FaceAsset, state: FaceState, signal: FaceSignal) -> FaceDecision:
    """The decision behind the present face, for overlays and logs; changes nothing."""
    search, parts = asset.search, asset.model.parts
    score = search.score_emotion(signal.shown)
    best = search.best(score)
    mine, other = float(score[search.index(state.numbers)]), float(score[best])
    if signal.expression is not None:
        reason = f"named expression {signal.expression}"
    elif search.numbers(best) == state.numbers:
        reason = "best of all faces"
    elif other - mine <= asset.timing.margin:
        reason = f"kept: the best is ahead by {other - mine:.2f}, less than {asset.timing.margin:g}"
    else:
        reason = f"kept: held for {state.held_s:.2f} s of {asset.timing.hold_s:g} s"
    return FaceDecision(parts.face(state.numbers), mine, parts.face(search.numbers(best)), other, reason)


def _strength(emotion: Floats) -> float:
    return float(np.clip(emotion[:6].sum(), 0.0, 1.0))


def _choose(asset: FaceAsset, state: FaceState, signal: FaceSignal, dt_s: float) -> FaceState:
    """Hysteresis: another face only when it is clearly better and the present one was held for a while."""
    held = state.held_s + dt_s
    moved = float(np.abs(signal.shown - state.looked_up).sum())
    if held < asset.timing.hold_s or moved < _STILL:
        return replace(state, held_s=held)
    search = asset.search
    score = search.score_emotion(signal.shown)
    best = search.best(score)
    looked_up = np.asarray(signal.shown, dtype=np.float64).copy()
    if score[best] - score[search.index(state.numbers)] <= asset.timing.margin:
        return replace(state, held_s=held, looked_up=looked_up)
    return replace(state, held_s=0.0, looked_up=looked_up, numbers=search.numbers(best))


def _pursue(asset: FaceAsset, state: FaceState, signal: FaceSignal, dt_s: float) -> FaceState:
    """Every region waits its own delay after a change of mind, then follows its spring."""
    timing = asset.timing
    parts = asset.model.parts
    if signal.expression is not None:
        wanted = asset.expression(signal.expression)
        numbers, target = parts.numbers(wanted.face), wanted.params
    else:
        numbers, target = state.numbers, parts.params(state.numbers, _strength(signal.shown))
    delay = np.maximum(state.delay_s - dt_s, 0.0)
    renamed = signal.expression != state.expression
    changed = np.array([renamed or a != b for a, b in zip(numbers, state.waiting, strict=True)])
    delay = np.where(changed, np.maximum(delay, timing.delay_s), delay)
    pursued = np.where((delay <= 1e-9)[_REGION_OF], target, state.pursued)
    params, velocity = critical_spring(
        state.params, state.velocity, pursued, asset.per_number(timing.half_life_s), dt_s
    )
    return replace(
        state,
        waiting=numbers,
        expression=signal.expression,
        delay_s=delay,
        pursued=pursued,
        params=np.asarray(params, dtype=np.float64),
        velocity=np.asarray(velocity, dtype=np.float64),
    )


def _leak(asset: FaceAsset, state: FaceState, signal: FaceSignal, dt_s: float) -> FaceState:
    """Micro-expressions (1/25 to 1/5 s): the felt emotion shows for a moment when the mask differs strongly."""
    timing = asset.timing
    if state.micro_length_s > 0.0:
        time_s = state.micro_time_s + dt_s
        if time_s - dt_s < state.micro_length_s - 0.5 * dt_s:
            return replace(state, micro_time_s=time_s)
        state = replace(state, micro_time_s=0.0, micro_length_s=0.0)
    if signal.felt is None:
        return state
    felt = np.asarray(signal.felt, dtype=np.float64)
    difference = 0.5 * float(np.abs(felt[:6] - signal.shown[:6]).sum())
    excess = difference - timing.micro_threshold
    if excess <= 0.0 or timing.micro_rate_hz <= 0.0:
        return state
    rng = np.random.default_rng((state.seed, state.tick))  # restores from a save without a generator's state
    chance, length = rng.random(2)
    if chance >= 1.0 - np.exp(-timing.micro_rate_hz * excess * dt_s):
        return state
    search = asset.search
    return replace(
        state,
        micro_numbers=search.numbers(search.best(search.score_emotion(felt))),
        micro_felt=felt.copy(),
        micro_time_s=0.5 * dt_s,
        micro_length_s=timing.micro_shortest_s + float(length) * (timing.micro_longest_s - timing.micro_shortest_s),
    )


def _micro_share(asset: FaceAsset, state: FaceState, dt_s: float) -> float:
    """How much of the face the leak takes now: it swells and fades."""
    if state.micro_length_s <= 0.0:
        return 0.0
    phase = min(max(state.micro_time_s / max(state.micro_length_s, dt_s), 0.0), 1.0)
    return asset.timing.micro_depth * math.sin(math.pi * phase)


def _with_micro(asset: FaceAsset, state: FaceState, params: FaceParams) -> FaceParams:
    if state.micro_share <= 0.0:
        return params
    felt = asset.model.parts.params(state.micro_numbers, _strength(state.micro_felt))
    # Colour cannot change so fast, and lips that speak are not free: what leaks then are brows and eyes.
    free = np.ones(len(REGIONS))
    free[_SKIN], free[_MOUTH] = 0.0, 1.0 - min(float(state.visemes.sum()), 1.0)
    return np.asarray(params + state.micro_share * free[_REGION_OF] * (felt - params))


def _speak(asset: FaceAsset, visemes: Floats, params: FaceParams) -> None:
    """Talk on an emotional mouth: corners, lean and height stay the emotion's, the opening becomes the sound's."""
    talk = min(float(visemes.sum()), 1.0)
    if talk <= 1e-4:
        return
    shape, reach = asset.visemes, asset.timing.speech_reach
    share = visemes / max(float(visemes.sum()), 1e-9)
    width, opening = INDEX["mouth_width"], INDEX["mouth_open"]
    # A wide-open emotional mouth keeps part of its opening, so that laughter and shouting go on while talking.
    own = params[opening]
    sound = reach * float(shape.opening @ share)
    loud = sound * (1.0 + 0.012 * own) + 0.22 * own
    params[opening] += talk * (loud - own)
    base = params[width] + talk * (np.clip(params[width], 20.0, 36.0) - params[width])
    params[width] = base * (1.0 + talk * (float(shape.width @ share) - 1.0))
    params[INDEX["mouth_top"]] += talk * (float(shape.top @ share) - 0.6 * params[INDEX["mouth_top"]])
    for name, values in (("teeth", shape.teeth), ("tongue", shape.tongue)):
        params[INDEX[name]] += talk * (float(values @ share) - params[INDEX[name]])
    for name in ("teeth_clench", "tongue_out", "mouth_cat", "mouth_wave", "mouth_peak", "mouth_square", "mouth_pout"):
        params[INDEX[name]] *= 1.0 - 0.85 * talk
    params[INDEX["mouth_corner"]] *= 1.0 - 0.3 * talk


def _tremble(asset: FaceAsset, time_s: float, params: FaceParams) -> None:
    """Tears make the lights shake, fear the small iris, chattering teeth the mouth: at 4 to 11 Hz, never in step."""
    timing = asset.timing
    well = float(params[INDEX["tear_well"]])
    if well > 1e-3:
        params[INDEX["highlight"]] += timing.tremble_tears * well * math.sin(2.0 * math.pi * 4.3 * time_s)
    fright = max(0.85 - float(params[INDEX["iris_size"]]), 0.0) * max(float(params[INDEX["eye_open"]]) - 1.0, 0.0)
    if fright > 1e-3:
        shake = min(20.0 * fright, 1.0) * timing.tremble_iris
        params[INDEX["look_x"]] += shake * math.sin(2.0 * math.pi * 7.7 * time_s)
        params[INDEX["look_y"]] += 0.5 * shake * math.sin(2.0 * math.pi * 6.1 * time_s + 1.0)
    chatter = float(params[INDEX["teeth_clench"]]) * abs(float(params[INDEX["mouth_wave"]]))
    if chatter > 1e-3:
        params[INDEX["mouth_y"]] += chatter * timing.tremble_teeth_mm * math.sin(2.0 * math.pi * 11.3 * time_s)


def _look_and_blink(signal: FaceSignal, params: FaceParams) -> None:
    if signal.look is not None:
        params[INDEX["look_x"]] += float(signal.look[0])
        params[INDEX["look_y"]] += float(signal.look[1])
    blink = min(max(signal.blink, 0.0), 1.0)
    params[INDEX["eye_open"]] *= 1.0 - blink
    params[INDEX["brow_raise"]] -= 1.5 * blink
