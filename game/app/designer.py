"""What a designer does to a running talk: look inside, turn feelings and variables, go back, jump to a node.

Whatever is done here marks the session as designed: it is not saved, not booked and not scored.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from game.app.session import Session
from game.app.talk import TalkState, warp_talk
from game.app.world import World
from game.core.emotion_space import EMOTION_INDEX, SIX, with_neutral
from game.core.errors import BadInput
from game.emotion import shown_emotion
from game.formats.yaml_source import nearest

__all__ = ["go_back", "set_felt", "set_goodwill", "set_shown", "set_variable", "warp_session"]


def warp_session(session: Session, node: str, item: str | None = None) -> None:
    """Stand in a talk at a node, whether one was under way or not. Raises BadInput for unknown nodes and items."""
    script = session.assets.talk.script
    if node not in script.nodes:
        raise BadInput("node", expected=f"one of {script.stall}", seen=node, hint=_nearest(node, script.nodes))
    if item is not None and item not in script.items:
        raise BadInput("item", expected=" | ".join(script.items), seen=item, hint=_nearest(item, script.items))
    if session.world.talk is None or item is not None:
        if not session.afternoon.wishes:
            session.open_day()
        session.begin_talk(item or next(iter(script.items)))
    talk = session.world.talk
    assert talk is not None
    if talk.ended:
        raise BadInput("warp", expected="a talk that goes on", seen=f"ended: {talk.beat.ended}")
    after = warp_talk(session.assets.talk, talk, node)
    session.world = replace(_settled(session, session.world, after), queue=after.beat.lines, speech=None, waited=0)
    session.designed = True


def go_back(session: Session) -> bool:
    """Back to before the last choice; False where there is none. The body keeps moving from where it is."""
    marks = session.world.marks
    before = marks[-1].before if marks else None
    if before is None:
        return False
    said = {line.id for line in session.world.talk.beat.lines} if session.world.talk is not None else set()
    backlog = session.world.backlog
    while backlog and backlog[-1].id in said:
        backlog = backlog[:-1]
    world = replace(session.world, marks=marks[:-1], queue=(), speech=None, waited=0, backlog=backlog)
    session.world = _settled(session, world, before)
    session.designed = True
    return True


def set_felt(session: Session, emotion: str, value: float) -> None:
    """What is felt, at once: in the talk, on its way into the body, and behind the mask."""
    talk = _talk(session)
    six = list(talk.feeling.six)
    six[SIX.index(emotion)] = min(max(value, 0.0), 1.0)
    changed = replace(talk, feeling=talk.feeling._replace(six=tuple(six)))
    session.world = _settled(session, session.world, changed)
    session.designed = True


def set_shown(session: Session, emotion: str, value: float) -> None:
    """What the face shows, until the next reaction makes it follow the mask again."""
    shown = np.array(session.world.shown_target[:6], dtype=np.float64)
    shown[EMOTION_INDEX[emotion]] = min(max(value, 0.0), 1.0)
    session.world = replace(session.world, shown_target=with_neutral(shown))
    session.designed = True


def set_goodwill(session: Session, name: str, value: float) -> None:
    """trust (0 to 1), patience (rounds) or ask (share of the list price, never below the lowest)."""
    talk = _talk(session)
    bargain = talk.bargain
    if name == "trust":
        bargain = bargain._replace(trust=min(max(value, 0.0), 1.0))
    elif name == "patience":
        bargain = bargain._replace(patience=min(max(value, 0.0), 12.0))
    elif name == "ask":
        bargain = bargain._replace(ask=min(max(value, bargain.lowest), 1.0))
    else:
        raise BadInput("goodwill", expected="trust | patience | ask", seen=name)
    session.world = replace(session.world, talk=replace(talk, bargain=bargain))
    session.designed = True


def set_variable(session: Session, name: str, value: float | bool | str) -> None:
    """A variable of the script. Raises BadInput for an unknown name or another type."""
    talk, script = _talk(session), session.assets.talk.script
    if name not in script.variables:
        raise BadInput("variable", expected=" | ".join(script.variables), seen=name)
    kind = {"number": float, "bool": bool, "text": str}[script.variables[name].type]
    if type(value) is not kind:
        raise BadInput(f"variable {name}", expected=f"a {script.variables[name].type}", seen=value)
    story = talk.story.with_variable(name, value)
    session.world = replace(session.world, talk=replace(talk, story=story))
    session.designed = True


def _nearest(name: str, known: Iterable[str]) -> str | None:
    close = nearest(name, known)
    return f"did you mean {close!r}?" if close else None


def _talk(session: Session) -> TalkState:
    if session.world.talk is None:
        raise BadInput("designer", expected="a talk under way", seen="none")
    return session.world.talk


def _settled(session: Session, world: World, talk: TalkState) -> World:
    """The world with a talk whose feelings body and face now head for."""
    shown = shown_emotion(session.assets.talk.person, talk.feeling)
    return replace(world, talk=talk, felt_target=np.asarray(talk.feeling.felt), shown_target=np.asarray(shown))
