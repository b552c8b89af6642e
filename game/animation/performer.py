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
from game.animation import blending, collision, figure, limbs, liveliness, playback
from game.animation import channels as ch
from game.animation.motion_bank import KnownUnits, MotionBank, bake
from game.animation.pose import Pose
from game.core.emotion_space import EMOTIONS
from game.core.humanoid import HEAD_CENTRE_OFFSET
from game.core.springs import critical_spring
from game.embos import LAYERS, Decisions, UnitLibrary
from game.embos.mixing import RADIUS

__all__ = ["MODES", "Mode", "PerformSignal", "Performer", "PerformerState"]

Floats = NDArray[np.floating[Any]]

Mode = Literal["full", "gestures", "body", "face"]
MODES: tuple[Mode, ...] = ("full", "gestures", "body", "face")
"""What of the behaviour is shown. ``gestures``: posture and mannerism stand at neutral; ``body``: everything the
body does (the face is another stage's); ``face``: the body stands still at neutral."""

PUSH_HALF_LIFE_S = 0.025
"""How softly body and table let go of a hand."""

_NEUTRAL = np.eye(len(EMOTIONS))[EMOTIONS.index("neutral")]
_NEUTRAL.setflags(write=False)
_ADDED = liveliness.additive_slice()
_EYES = HEAD_CENTRE_OFFSET.astype(np.float32)
_PALM_POINT = np.array([[0.05, 0.0, 0.0], [-0.05, 0.0, 0.0]], dtype=np.float32)
_LIMBS = limbs.limbs_of(figure.BONE_LENGTHS[0], figure.BONE_LENGTHS[1], np.array([True, True, False, False]))
_HINGE = figure.HINGE[..., None]
_FLAT = np.eye(3, dtype=np.float32)
_FRAMES = [figure.WHERE[name] for name in ch.CONTACT_FRAMES[1:]]
_BODY = np.array([figure.WHERE[name] for name in collision.BODY_JOINTS])
_HEAD, _CHEST = figure.WHERE["head"], figure.WHERE["chest"]
_ENDS = figure.ENDS.reshape(-1)
for _array in (_ADDED, _BODY, _EYES, _PALM_POINT, _FLAT):
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
    """Where n characters stand; every tick makes a new one. contact_frames: (n, 4, 4, 4) matrices of CONTACT_FRAMES
    as last shown; push, push_speed: (n, 2, 3) how far the hands are held off, metres."""

    playback: playback.Playback
    blend: blending.Blend
    life: liveliness.Life
    gaze: liveliness.Gaze
    contact_frames: Floats
    push: Floats
    push_speed: Floats

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
        frames = np.zeros((n, len(ch.CONTACT_FRAMES), 4, 4), dtype=np.float32)
        frames[:] = np.eye(4, dtype=np.float32)
        return PerformerState(
            playback=playback.start(n, len(self.layers)),
            blend=blending.start_blend(n, len(self.layers)),
            life=liveliness.start_life(n, seed, first),
            gaze=liveliness.start_gaze(n),
            contact_frames=frames,
            push=np.zeros((n, 2, 3)),
            push_speed=np.zeros((n, 2, 3)),
        )

    def adopt(self, state: PerformerState) -> PerformerState:
        """Characters who moved by another repertoire, before their next tick: they go on from where they are."""
        n, layers = state.playback.unit.shape
        if layers != len(self.layers):
            return replace(self.start(n), life=state.life, gaze=state.gaze)
        return replace(state, playback=playback.start(n, layers))

    def advance(
        self, state: PerformerState, decisions: Decisions, signal: PerformSignal, dt_s: float
    ) -> tuple[PerformerState, Pose]:
        """One tick of dt_s seconds (0 draws the present moment again)."""
        emotion = _shares(signal)
        play, blend = self._layers(state, decisions, signal, emotion, dt_s)
        life, row, lungs, blink = self._enliven(state, play, blend, signal, emotion, dt_s)
        rotation, root = self._normal(row)
        joints, ends = figure.figure_matrices(rotation, root)
        contact_frames = state.contact_frames.copy()
        contact_frames[:, 1:] = joints.take(_FRAMES, axis=1)
        hand = self._hands(row, blend, contact_frames)
        push, push_speed = state.push, state.push_speed
        if self.collide:
            wanted = self._clearance(joints, ends, hand, row)
            push, push_speed = critical_spring(push, push_speed, wanted, PUSH_HALF_LIFE_S, dt_s)
            push = _held_off(push, wanted)
            hand[:, :, :3, 3] += push
        self._place_limbs(rotation, joints, ends, hand)
        head, chest = joints[:, _HEAD], joints[:, _CHEST]
        gaze = liveliness.look(self.life, life, state.gaze, signal.gaze_target, head, chest, _EYES, dt_s)
        pose = Pose(rotation, root, gaze.eye, blink, lungs)
        return PerformerState(play, blend, life, gaze, contact_frames, push, push_speed), pose

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
        changed = unit != play.unit
        fresh = decisions.started | changed
        # A posture that is chosen again goes on; a layer held by the mode does not hear the planner's starts.
        fresh[:, self._posture] = changed[:, self._posture]
        for layer in held:
            fresh[:, layer] = changed[:, layer]
        if np.count_nonzero(fresh):
            seconds, pick = decisions.duration_s, decisions.variant_pick
            play = playback.begin(self.bank, play, fresh, unit, seconds, weights, pick, self._posture, dt_s)
        drift_to = _NEUTRAL[None] if held else signal.emotion
        value, play, jumped = playback.advance_playback(self.bank, play, drift_to, self._posture, dt_s)
        blend = state.blend
        events = fresh | jumped
        if np.count_nonzero(events):
            base_s, arc = self.life.transition_s * (emotion @ self.life.tempo), emotion @ self.life.arc
            blend = blending.switch(
                self.bank, blend, play, events, value, base_s, arc, state.contact_frames, self._posture, dt_s
            )
        return play, blending.advance_blend(blend, value, dt_s)

    def _neutral_weights(self, layer: int) -> Floats:
        unit = self.bank.rest[layer]
        return np.asarray(self.library.mix_weights(_NEUTRAL, unit)) if layer == self._posture else np.zeros(7)

    def _enliven(
        self,
        state: PerformerState,
        play: playback.Playback,
        blend: blending.Blend,
        signal: PerformSignal,
        emotion: Floats,
        dt_s: float,
    ) -> tuple[liveliness.Life, Floats, Floats, Floats]:
        """Breath, sway and the head's share of the gaze added to the row."""
        mood = np.empty((len(blend.row), 2))
        mood[:, 0] = ~(self.bank.looks[play.unit] & play.active).any(axis=1)
        mood[:, 1] = signal.speaking
        life, added, lungs, blink = liveliness.advance_life(self.life, state.life, state.gaze, emotion, mood, dt_s)
        row = blend.row.copy()
        row[:, _ADDED] += added
        return life, row, lungs, blink

    @staticmethod
    def _normal(row: Floats) -> tuple[Floats, Floats]:
        rotation = bl.normalize(row[:, ch.ROTATION].reshape(len(row), ch.JOINTS, 4))
        return rotation, row[:, ch.ROOT]

    @staticmethod
    def _hands(row: Floats, blend: blending.Blend, contact_frames: Floats) -> Floats:
        """(n, 2, 4, 4) where the hands are wanted, in model space: kept in their contact frames."""
        n = len(row)
        local = bl.affine(bl.normalize(row[:, ch.PALM].reshape(n, 2, 4)))
        local[..., :3, 3] = row[:, ch.WRIST].reshape(n, 2, 3)
        frames = contact_frames[np.arange(n)[:, None], blend.frame]
        return np.asarray(frames @ local)

    @staticmethod
    def _clearance(joints: Floats, ends: Floats, hand: Floats, row: Floats) -> Floats:
        """(n, 2, 3) the push that keeps both hands and forearms out of body and table."""
        n = len(row)
        local = np.empty((n, 2, 1 + ch.POINTS_PER_HAND, 3), dtype=np.float32)
        local[:, :, 0] = _PALM_POINT
        local[:, :, 1:] = row[:, ch.POINTS].reshape(n, 2, ch.POINTS_PER_HAND, 3)
        points = np.empty((n, 2, 7, 3), dtype=np.float32)
        wrist = hand[:, :, :3, 3]
        points[:, :, 0] = wrist
        points[:, :, 1:6] = local @ hand[:, :, :3, :3].swapaxes(-1, -2) + wrist[:, :, None]
        # The elbow follows the wrist about half way.
        elbow = joints.take(figure.LOWER[:2], axis=1)[..., :3, 3] + 0.5 * (wrist - ends[:, :2])
        points[:, :, 6] = 0.5 * (wrist + elbow)
        maps = collision.body_frames(joints.take(_BODY, axis=1))
        return collision.push_out(maps, points)

    @staticmethod
    def _place_limbs(
        rotation: Floats,
        joints: Floats,
        ends: Floats,
        hand: Floats,
    ) -> None:
        """Arms to their hands, legs to their feet: rewrites the twelve joints of the limbs in rotation."""
        n = len(rotation)
        bones = joints.take(figure.BONES, axis=1)
        turned = bones[..., :3, :3]
        points = np.empty((n, 4, 4, 3), dtype=np.float32)
        points[:, :2] = bones[..., :3, 3].reshape(n, 2, 4, 3)
        points[:, 2] = ends
        points[:, 3, :2] = hand[:, :, :3, 3]
        points[:, 3, 2:] = figure.FEET_WORLD
        hinge = (turned[:, :4] @ _HINGE)[..., 0]
        fix = limbs.solve_limbs(_LIMBS, points, hinge)
        # Model-space rotations of upper bones, lower bones and ends, then back to local ones.
        model = np.empty((n, 12, 3, 3), dtype=np.float32)
        np.matmul(bl.rotation_matrix(fix).reshape(n, 8, 3, 3), turned, out=model[:, :8])
        model[:, 8:10] = hand[:, :, :3, :3]
        model[:, 10:] = _FLAT
        above = np.empty_like(model)
        above[:, :4] = joints.take(figure.SHOULDERS, axis=1)[..., :3, :3]
        above[:, 4:] = model[:, :8]
        rotation[:, _ENDS] = bl.from_matrix(above.swapaxes(-1, -2) @ model)


def _held_off(push: Floats, wanted: Floats) -> Floats:
    """The push, along its way at least what is wanted: a surface stops a hand at once, and lets go of it softly."""
    square = (wanted * wanted).sum(axis=-1, keepdims=True)
    lacking = 1.0 - (push * wanted).sum(axis=-1, keepdims=True) / np.maximum(square, 1e-12)
    return np.asarray(push + wanted * np.maximum(lacking, 0.0))


def _shares(signal: PerformSignal) -> Floats:
    """Felt emotion as shares that sum to 1 (their sum is never below 1, eq. 4); neutral where the body is held."""
    if signal.mode == "face":
        return np.broadcast_to(_NEUTRAL, signal.emotion.shape)
    total = np.maximum(signal.emotion.sum(axis=-1, keepdims=True), 1e-9)
    return np.asarray(signal.emotion / total)
