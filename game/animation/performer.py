"""From the planner's decisions to one pose per character: the stages of a tick, one after the other.

decisions -> playback    rows of the running units, variants mixed (EMBOS eq. 5)
          -> blending    layers into one row, transitions without pops (SPEC 6)
          -> liveliness  breath, sway, gaze
          -> limbs       hands where their contact wants them and out of the body, feet planted
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from game.animation import bilinear as bl
from game.animation import blending, contacts, figure, limbs, liveliness, playback
from game.animation import channels as ch
from game.animation.motion_bank import KnownUnits, MotionBank, bake
from game.animation.placing import place_limbs
from game.animation.pose import Pose
from game.core.emotion_space import EMOTIONS
from game.core.humanoid import HEAD_CENTRE_OFFSET
from game.embos import LAYERS, Decisions, UnitLibrary
from game.embos.mixing import RADIUS

__all__ = ["MODES", "Mode", "PerformSignal", "Performer", "PerformerState"]

Floats = NDArray[np.floating[Any]]

Mode = Literal["full", "gestures", "body", "face"]
MODES: tuple[Mode, ...] = ("full", "gestures", "body", "face")
"""What of the behaviour is shown. ``gestures``: posture and mannerism stand at neutral; ``body``: everything the
body does (the face is another stage's); ``face``: the body stands still at neutral."""

_NEUTRAL = np.eye(len(EMOTIONS))[EMOTIONS.index("neutral")]
_EYES = np.array(HEAD_CENTRE_OFFSET, dtype=np.float32)
_REACH = np.array([limbs.ARM, limbs.ARM, limbs.STRAIGHT, limbs.STRAIGHT])
_LIMBS = limbs.limbs_of(figure.BONE_LENGTHS[0], figure.BONE_LENGTHS[1], _REACH)
_HANDS = slice(contacts.GOALS.start, contacts.GOALS.start + 2)
_BONES = np.append(contacts.slot("hips") + figure.BONES, np.arange(contacts.GOALS.start, contacts.GOALS.stop))
_HEAD, _CHEST = contacts.slot("head"), contacts.slot("chest")
for _array in (_NEUTRAL, _EYES, _BONES):
    _array.setflags(write=False)


@dataclass(frozen=True, eq=False)
class PerformSignal:
    """What a tick brings besides the decisions.

    emotion: (n, 7) felt; gaze_target: (n, 3) model space, metres; speaking: (n,) 0 silent .. 1 speaking.
    """

    emotion: Floats
    gaze_target: Floats
    speaking: Floats
    mode: Mode = "full"


@dataclass(frozen=True, eq=False)
class PerformerState:
    """Where n characters stand; every tick makes a new one. matrices: (n, contacts.SLOTS, 4, 4) of the
    body as last shown; push: (n, 2, 2, 3) how far the hands are held off, and how fast that changes, metres."""

    playback: playback.Playback
    blend: blending.Blend
    life: liveliness.Life
    gaze: liveliness.Gaze
    matrices: Floats
    push: Floats

    def __len__(self) -> int:
        return len(self.push)


class Performer:
    """Plays a library's units. Immutable; all that changes is in the state."""

    def __init__(
        self,
        library: UnitLibrary,
        layers: tuple[str, ...] = LAYERS,
        life: liveliness.LifeConfig | None = None,
        collide: bool = True,
        radius: float = RADIUS,
        known: KnownUnits | None = None,
    ) -> None:
        """layers, radius: the planner's order and r of eq. 5; collide: keep hands out of body and table; known: what
        stayed the same since another performer was made is not made anew."""
        self.library = library
        self.layers = layers
        self.life = life or liveliness.LifeConfig()
        self.collide = collide
        self.bank: MotionBank = bake(library, layers, radius, known)
        self._posture = layers.index("posture")
        self._held_by_mode: dict[str, tuple[int, ...]] = {
            "full": (),
            "body": (),
            "gestures": tuple(i for i, name in enumerate(layers) if name != "gesture"),
            "face": tuple(range(len(layers))),
        }

    def start(self, n: int, seed: int = 0, first: int = 0) -> PerformerState:
        """n characters before their first tick; character first + i moves the same in any company."""
        matrices = np.tile(np.eye(4, dtype=np.float32), (n, contacts.SLOTS, 1, 1))
        return PerformerState(
            playback=playback.start(n, len(self.layers)),
            blend=blending.start_blend(n, len(self.layers)),
            life=liveliness.start_life(n, seed, first),
            gaze=liveliness.start_gaze(n),
            matrices=matrices,
            push=np.zeros((n, 2, 2, 3), dtype=np.float32),
        )

    def adopt(self, state: PerformerState, before: Performer) -> PerformerState:
        """Characters who moved by the repertoire of another performer, before their next tick: they go on from where
        they are, as fast as they were."""
        n, layers = state.playback.unit.shape
        if layers != len(self.layers):
            return replace(self.start(n), life=state.life, gaze=state.gaze)
        speed = blending.shown_speed(before.bank, state.blend, state.playback, before._posture)
        return replace(state, playback=playback.start(n, layers), blend=replace(state.blend, speed=speed))

    def advance(
        self, state: PerformerState, decisions: Decisions, signal: PerformSignal, dt_s: float
    ) -> tuple[PerformerState, Pose]:
        """One tick of dt_s seconds (0 draws the present moment again)."""
        emotion = _shares(signal)
        play, blend = self._layers(state, decisions, signal, emotion, dt_s)
        attention = blend.source.attention
        life, row = liveliness.advance_life(
            self.life, state.life, state.gaze, emotion, attention, signal.speaking, dt_s
        )
        row += blend.row
        n = len(row)
        turns = bl.normalize(row[:, ch.TURNS].reshape(n, -1, 4))
        matrices = contacts.body_matrices(turns, row[:, ch.PLACES])
        contacts.aim(matrices, blend.source.frame)
        push = state.push
        if self.collide:
            push = contacts.advance_push(push, contacts.clearance(matrices, row[:, ch.POINTS]), dt_s)
            matrices[:, _HANDS, :3, 3] += push[:, 0]
        rotation = turns[:, : ch.JOINTS]
        place_limbs(_LIMBS, rotation, matrices.take(_BONES, axis=1))
        head, chest = matrices[:, _HEAD], matrices[:, _CHEST]
        gaze = liveliness.look(self.life, life, state.gaze, signal.gaze_target, head, chest, _EYES, dt_s)
        pose = Pose(rotation, row[:, ch.ROOT], gaze.eye, life.lids, life.lungs)
        return PerformerState(play, blend, life, gaze, matrices, push), pose

    def _layers(
        self, state: PerformerState, decisions: Decisions, signal: PerformSignal, emotion: Floats, dt_s: float
    ) -> tuple[playback.Playback, blending.Blend]:
        """Clips run on, new units begin, all layers come together in one row."""
        play = state.playback
        unit, weights = decisions.unit, decisions.emotion_weights
        held = self._held_by_mode[signal.mode]
        if held:
            unit, weights = unit.copy(), weights.copy()
            for layer in held:
                unit[:, layer] = self.bank.rest[layer]
                weights[:, layer] = self._neutral_weights(layer)
        changed, started = unit != play.unit, decisions.started
        events: Any = None
        if np.count_nonzero(changed) or np.count_nonzero(started):
            # A posture that is chosen again goes on; a layer held by the mode does not hear the planner's starts.
            events = started | changed
            for layer in (self._posture, *held):
                events[:, layer] = changed[:, layer]
            if np.count_nonzero(events):
                seconds, pick = decisions.duration_s, decisions.variant_pick
                play = playback.begin(self.bank, play, events, unit, seconds, weights, pick, self._posture, dt_s)
        drift_to = _NEUTRAL[None] if held else signal.emotion
        values, play, jumped = playback.advance_playback(self.bank, play, drift_to, self._posture, dt_s)
        blend = state.blend
        if jumped is not None:
            events = jumped if events is None else events | jumped
        if events is not None and np.count_nonzero(events):
            frames = state.matrices.take(contacts.FRAMES, axis=1)
            base_s, arc = self.life.transition_s * (emotion @ self.life.tempo), emotion @ self.life.arc
            was, at = state.playback, self._posture
            blend = blending.switch(self.bank, blend, was, play, events, values, base_s, arc, frames, at, dt_s)
        return play, blending.advance_blend(blend, values, dt_s)

    def _neutral_weights(self, layer: int) -> Floats:
        unit = self.bank.rest[layer]
        return np.asarray(self.library.mix_weights(_NEUTRAL, unit)) if layer == self._posture else np.zeros(7)


def _shares(signal: PerformSignal) -> Floats:
    """Felt emotion as shares that sum to 1 (their sum is never below 1, eq. 4); neutral where the body is held."""
    if signal.mode == "face":
        return np.broadcast_to(_NEUTRAL, signal.emotion.shape)
    total = np.add.reduce(signal.emotion, axis=-1, keepdims=True)
    return np.asarray(signal.emotion / np.maximum(total, 1e-9, out=total))
