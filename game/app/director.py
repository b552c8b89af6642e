"""The camera's director: which shot a moment wants, as a function of what the player sees, and the glides between.

It looks at the shown face, never at what is felt: a close-up must not tell what the player has to read. The one
exception is a person whose face is known to lie: there the camera glances down at the hands, once in a first visit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from game.app.shots import ESTABLISHING, SHOTS, Glide, framing, stand
from game.app.world import World
from game.render import Camera

__all__ = ["Direction", "Moment", "direct", "moment_of", "start_direction"]

SCENES = ("title", "market", "table", "talk", "outcome")
_FRAMED = {"title": "home", "market": "home", "table": "talk", "talk": "talk", "outcome": "side"}

GLIDE_S = {"home": 1.5, "talk": 1.1, "side": 1.0, "close": 0.75, "glance": 0.7, "offer": 0.9}
"""How long the way into each shot takes."""
ARRIVAL_S, ARRIVAL_HOLD_S = 2.4, 0.5
"""The way from the first sight of a stall up to its table, and how long that sight stands."""
STRONG = 0.6
"""A face that shows so much of one feeling is worth a close-up …"""
CLOSE_S = 2.6
"""… for so long after the reaction begins; the player's turn ends it."""
MASKED = 0.3
"""Felt and shown differ so much in one feeling: the hands know better than the face."""
GLANCE_S = 1.7
LEAD_S = 0.3
"""A reaction begins this long before its peak."""
NEVER_S = -1e9


@dataclass(frozen=True)
class Moment:
    """What the director looks at. scene: one of SCENES; place: the stall's name, whose change is an arrival.

    burst_s: when the present reaction peaks; strength: the strongest feeling on the face, 0 to 1; gap: the largest
    difference between felt and shown; talk: a number that is new in every talk; first_visit: of this person.
    """

    scene: str
    time_s: float
    place: str = ""
    waiting: bool = False
    offering: bool = False
    burst_s: float = NEVER_S
    strength: float = 0.0
    gap: float = 0.0
    talk: int = 0
    first_visit: bool = False


@dataclass(frozen=True, eq=False)
class Direction:
    """The camera over time. close_to_s, glance_to_s: until when those shots are wanted; burst_s: the reaction last
    weighed; glanced: the talk in which the camera has glanced down; time_s: of the last moment seen."""

    glide: Glide
    shot: str = "home"
    place: str = ""
    still: bool = False
    close_to_s: float = NEVER_S
    glance_to_s: float = NEVER_S
    burst_s: float = NEVER_S
    glanced: int = -1
    time_s: float = 0.0

    def camera(self, time_s: float) -> Camera:
        """Where the picture is taken from."""
        return self.glide.at(time_s)


def start_direction(place: str = "") -> Direction:
    """The whole stall, at rest."""
    return Direction(stand(SHOTS["home"]), place=place)


def moment_of(world: World, scene: str, *, place: str = "", offering: bool = False) -> Moment:
    """The moment of a world."""
    if world.talk is None:
        return Moment(scene, world.time_s, place)
    return Moment(
        scene=scene,
        time_s=world.time_s,
        place=place,
        waiting=world.waiting,
        offering=offering and world.waiting,
        burst_s=world.burst_s,
        strength=float(np.max(world.shown_target[:6])),
        gap=float(np.abs(world.felt_target - world.shown_target[:6]).max()),
        talk=world.talk.seed,
        first_visit=world.talk.visit == 1,
    )


def direct(state: Direction, moment: Moment, *, reduced_motion: bool = False, text_scale: float = 1.0) -> Direction:
    """One tick: weigh a new reaction, choose the shot, begin a glide where it is another one. text_scale: see
    ``framing``."""
    if moment.time_s < state.time_s:  # another world has begun
        state = start_direction(state.place)
    state = _weigh(replace(state, time_s=moment.time_s), moment)
    arriving = moment.place != state.place
    shot = _shot(state, moment, reduced_motion)
    if arriving or (reduced_motion and not state.still):
        state = replace(state, glide=stand(ESTABLISHING if arriving else state.glide.at(moment.time_s), moment.time_s))
    if shot == state.shot and not arriving and reduced_motion == state.still:
        return state
    length_s, after_s = (ARRIVAL_S, ARRIVAL_HOLD_S) if arriving else (GLIDE_S[shot], 0.0)
    if shot == "talk" and state.shot == "home":
        length_s = ARRIVAL_S
    if reduced_motion:
        length_s = after_s = 0.0
    glide = state.glide.toward(framing(shot, text_scale), moment.time_s, length_s, after_s=after_s)
    return replace(state, glide=glide, shot=shot, place=moment.place, still=reduced_motion)


def _weigh(state: Direction, moment: Moment) -> Direction:
    """A reaction is judged once, when it begins."""
    if moment.burst_s == state.burst_s or moment.time_s < moment.burst_s - LEAD_S:
        return state
    state = replace(state, burst_s=moment.burst_s)
    if moment.time_s > moment.burst_s + LEAD_S:
        return state  # it was over before anybody looked: a game taken up again
    if moment.first_visit and moment.gap >= MASKED and state.glanced != moment.talk:
        return replace(state, glance_to_s=moment.time_s + GLANCE_S, glanced=moment.talk)
    if moment.strength >= STRONG:
        return replace(state, close_to_s=moment.time_s + CLOSE_S)
    return state


def _shot(state: Direction, moment: Moment, reduced_motion: bool) -> str:
    framed = _FRAMED[moment.scene]
    if moment.scene != "talk" or reduced_motion:
        return framed
    if moment.offering:
        return "offer"
    if moment.waiting:
        return framed  # the choices stand on the right, and the hands must be seen
    if moment.time_s < state.glance_to_s:
        return "glance"
    return "close" if moment.time_s < state.close_to_s else framed
