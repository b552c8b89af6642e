"""Fingerprints of a world: equal fingerprints, equal play.

Numbers go in rounded, so that another machine's last bit of a sine is no difference; the body's is apart from the
game's, because only the body adds up thousands of such numbers a second.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.app.afternoon import Afternoon
from game.app.saves import SavedGame, game_to_dict
from game.app.talk import TalkState, ask_money
from game.app.world import World
from game.core.emotion_space import SIX

__all__ = ["body_digest", "game_digest", "talk_digest", "talk_in_words"]

DIGITS = 6
BODY_DIGITS = 4


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, DIGITS) + 0.0
    if isinstance(value, dict):
        return {name: _rounded(inner) for name, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(inner) for inner in value]
    return value


def _hash(parts: Iterator[bytes]) -> str:
    whole = hashlib.blake2b(digest_size=8)
    for part in parts:
        whole.update(part)
        whole.update(b"|")
    return whole.hexdigest()


def _text(value: Any) -> bytes:
    return json.dumps(_rounded(value), sort_keys=True, ensure_ascii=False, default=str).encode()


def _array(values: NDArray[Any], digits: int = DIGITS) -> bytes:
    # Adding zero turns a negative zero into the other one.
    return (np.round(np.asarray(values, np.float64), digits) + 0.0).tobytes()


def talk_digest(talk: TalkState) -> str:
    """16 hex digits of a talk: script's state, feeling, bargain; not what could be said, which only matters if said."""
    saved = game_to_dict(SavedGame(Afternoon(seed=0), "", talk))["talk"]
    return _hash(iter([_text(saved), _text([talk.beat.node, talk.beat.ended])]))


def talk_in_words(talk: TalkState) -> str:
    """Where a talk stands, for people: round, price, patience, trust, and what is felt most."""
    bargain, six = talk.bargain, talk.feeling.six
    most = max(range(6), key=lambda k: six[k])
    return (
        f"round {bargain.round}, asking {ask_money(talk.list_price, bargain.ask)}, patience {bargain.patience:.2f}, "
        f"trust {bargain.trust:.2f}, {SIX[most]} {six[most]:.2f}"
    )


def game_digest(world: World, afternoon: Afternoon) -> str:
    """16 hex digits of everything a player could notice of the game: afternoon, talk, words, feelings, active units."""

    def parts() -> Iterator[bytes]:
        yield _text(game_to_dict(SavedGame(afternoon, ""))["afternoon"])
        yield _text([world.tick, world.language, world.text_speed, world.timers, world.mode, world.waited, world.habit])
        yield b"" if world.talk is None else talk_digest(world.talk).encode()
        speech = world.speech
        yield _text(None if speech is None else [speech.line.id, speech.started_s, speech.hurried])
        yield _text([[line.id for line in world.queue], len(world.backlog), len(world.marks)])
        for values in (world.felt, world.shown, world.felt_target, world.shown_target):
            yield _array(values)
        yield np.asarray(world.body.decisions.unit, np.int64).tobytes()

    return _hash(parts())


def body_digest(world: World) -> str:
    """16 hex digits of pose and face; "" before there is a pose."""
    pose, face = world.body.pose, world.body.face_params
    if pose is None or face is None:
        return ""
    values = (pose.rotation, pose.root, pose.gaze, pose.blink, pose.breath, face)
    return _hash(_array(value, BODY_DIGITS) for value in values)
