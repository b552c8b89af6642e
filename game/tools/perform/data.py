"""The performer's data, read strictly: effort by emotion, hand targets and finger poses, the repertoire, the scores."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import ASSETS, EMOTIONS
from game.core.errors import BadInput
from game.core.humanoid import BODY_PARTS
from game.formats.yaml_source import Node, load_yaml
from game.tools.perform.body import CHANNELS
from game.tools.perform.timing import Ease

__all__ = [
    "MOTION",
    "Attention",
    "Behaviour",
    "Breath",
    "Cue",
    "Effort",
    "Score",
    "Target",
    "load_effort",
    "load_hands",
    "load_repertoire",
    "load_score",
]

Floats = NDArray[np.floating[Any]]
MOTION = ASSETS / "motion"
LAYERS = ("posture", "mannerism", "gesture")
_SPACES = ("world", "chest", "hips", "head")


@dataclass(frozen=True)
class Breath:
    """Breaths per minute; depth 1 = 3.2 degrees of the chest; the shoulders' share; the inhaling share of a cycle."""

    rate: float
    depth: float
    shoulders: float
    inhale: float


@dataclass(frozen=True)
class Attention:
    """The head takes a new bearing every so many seconds, within some degrees, in ``move_s``."""

    every_s: tuple[float, float]
    yaw_deg: float
    pitch_deg: float
    move_s: float


@dataclass(frozen=True)
class Effort:
    """How an emotion moves; see assets/motion/effort.yaml for every field."""

    tempo: float
    ease: Ease
    strike: Ease
    settle: Ease
    spring: tuple[float, float, float]
    drag: float
    hand: tuple[float, float]
    arc: float
    wrist_lag_s: float
    breath: Breath
    sway: float
    sway_band_hz: tuple[float, float]
    tremor: float
    attention: Attention
    undertone: tuple[tuple[str, float, float], ...]
    carriage: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Target:
    """Where a left hand goes: see assets/motion/hands.yaml. curls: (5, 3) degrees."""

    space: str
    at: Floats
    fingers: Floats
    back: Floats
    elbow: Floats
    curls: Floats
    contact: float


@dataclass(frozen=True)
class Behaviour:
    """What the repertoire says of one behaviour, as far as the performer needs it."""

    name: str
    layer: str
    uses: frozenset[str]


@dataclass(frozen=True)
class Cue:
    """One line of a score: what to do when. Times in seconds, ``at`` from the take's start.

    hands: for a posture, where main and other hand belong instead of where the posture puts them.
    """

    at_s: float
    do: str
    hold_s: float
    size: float
    side: str
    words: str | None
    channels: Mapping[str, float]
    tempo: float
    hands: tuple[str, str] | None


@dataclass(frozen=True)
class Score:
    """The choreography of one take."""

    take: str
    emotion: str
    seed: int
    length_s: float
    cues: tuple[Cue, ...]


def _numbers(node: Node, count: int) -> tuple[float, ...]:
    items = node.as_list()
    if len(items) != count:
        raise BadInput(where=node.where, expected=f"{count} numbers", seen=len(items))
    return tuple(item.as_float() for item in items)


def _pair(node: Node) -> tuple[str, str]:
    names = [item.as_str() for item in node.as_list()]
    if len(names) != 2:
        raise BadInput(where=node.where, expected="two hand targets: main and other", seen=len(names))
    return names[0], names[1]


def _undertone(node: Node) -> tuple[str, float, float]:
    items = node.as_list()
    if len(items) != 3 or items[0].as_str() not in CHANNELS:
        raise BadInput(where=node.where, expected="[channel, amount, Hz]", seen=str(node.to_python()))
    return items[0].as_str(), items[1].as_float(), items[2].as_float(0, 8)


def _channels(node: Node | None) -> dict[str, float]:
    if node is None:
        return {}
    return {key.as_str(): value.as_float() for key, value in node.only(*CHANNELS).items()}


def load_effort(emotion: str, path: Path = MOTION / "effort.yaml") -> Effort:
    """The effort of one emotion. Raises BadInput with the place of what is wrong."""
    node = load_yaml(path)["emotions"].only(*EMOTIONS)[emotion]
    node.only(
        "tempo",
        "skew",
        "strike",
        "settle",
        "sharp",
        "anticipation",
        "spring",
        "drag",
        "hand",
        "arc",
        "wrist_lag",
        "breath",
        "sway",
        "tremor",
        "attention",
        "undertone",
        "carriage",
    )
    sharp, anticipation = node["sharp"].as_float(0, 2), node["anticipation"].as_float(0, 1)
    breath, sway = node["breath"], node["sway"]
    frequency, damping, response = _numbers(node["spring"], 3)
    hand_frequency, hand_damping = _numbers(node["hand"], 2)
    low, high = _numbers(sway["band"], 2)
    notice = node["attention"].only("every", "yaw", "pitch", "move")
    first, last = _numbers(notice["every"], 2)
    return Effort(
        tempo=node["tempo"].as_float(0.2, 5),
        ease=Ease(node["skew"].as_float(0.2, 5), sharp, anticipation),
        strike=Ease(node["strike"].as_float(0.2, 5), 0.4 * sharp, 0.0),
        settle=Ease(node["settle"].as_float(0.2, 5), 0.0, 0.0),
        spring=(frequency, damping, response),
        drag=node["drag"].as_float(0, 5),
        hand=(hand_frequency, hand_damping),
        arc=node["arc"].as_float(-1, 1),
        wrist_lag_s=node["wrist_lag"].as_float(0, 1),
        breath=Breath(*(breath[name].as_float(0, 120) for name in ("rate", "depth", "shoulders", "inhale"))),
        sway=sway["amplitude"].as_float(0, 5),
        sway_band_hz=(low, high),
        tremor=node["tremor"].as_float(0, 3),
        attention=Attention(
            (first, last),
            notice["yaw"].as_float(0, 60),
            notice["pitch"].as_float(0, 60),
            notice["move"].as_float(0.05, 5),
        ),
        undertone=tuple(_undertone(item) for item in node["undertone"].as_list()),
        carriage=_channels(node["carriage"]),
    )


def load_hands(path: Path = MOTION / "hands.yaml") -> tuple[dict[str, Target], dict[str, Floats]]:
    """Hand targets and finger presets (5, 3) degrees by name."""
    root = load_yaml(path).only("targets", "fingers")
    fingers: dict[str, Floats] = {
        key.as_str(): np.array([_numbers(row, 3) for row in value.as_list()]) for key, value in root["fingers"].items()
    }
    targets = {}
    for key, node in root["targets"].items():
        node.only("space", "at", "fingers", "back", "elbow", "preset", "contact")
        space, preset = node["space"].as_str(), node["preset"].as_str()
        if space not in _SPACES:
            raise BadInput(where=node["space"].where, expected=f"one of {', '.join(_SPACES)}", seen=space)
        if preset not in fingers:
            raise BadInput(where=node["preset"].where, expected="a finger preset of this file", seen=preset)
        at, point, back, elbow = (np.array(_numbers(node[name], 3)) for name in ("at", "fingers", "back", "elbow"))
        targets[key.as_str()] = Target(space, at, point, back, elbow, fingers[preset], node["contact"].as_float(0, 1))
    return targets, fingers


def load_repertoire(path: Path = MOTION / "behaviours.yaml") -> dict[str, Behaviour]:
    """Layer and used parts of every behaviour of the repertoire."""
    out = {}
    for key, node in load_yaml(path)["behaviours"].items():
        layer = node["layer"].as_str()
        if layer not in LAYERS:
            raise BadInput(where=node["layer"].where, expected=f"one of {', '.join(LAYERS)}", seen=layer)
        uses = frozenset(part.as_str() for part in node["uses"].as_list())
        if not uses <= set(BODY_PARTS):
            raise BadInput(where=node["uses"].where, expected=f"parts of {', '.join(BODY_PARTS)}", seen=sorted(uses))
        out[key.as_str()] = Behaviour(key.as_str(), layer, uses)
    return out


def load_score(emotion: str, folder: Path = MOTION / "scores") -> Score:
    """The score of one emotion's take; a cue's ``at`` counts from the start of its line in the scene."""
    root = load_yaml(folder / f"{emotion}.yaml").only("take", "emotion", "seed", "scene")
    start = 0.0
    cues = []
    for line in root["scene"].as_list():
        line.only("line", "length_s", "do")
        length = line["length_s"].as_float(1, 120)
        if not line["line"].as_str():
            raise line["line"].error(expected="the name of a line of the scene")
        for cue in line["do"].as_list():
            cue.only("at", "do", "hold", "size", "side", "words", "with", "tempo", "hands")
            side = cue.get("side")
            if side is not None and side.as_str() not in ("left", "right"):
                raise side.error(expected="left or right")
            words = cue.get("words")
            hands = cue.get("hands")
            hold, size, tempo = cue.get("hold"), cue.get("size"), cue.get("tempo")
            cues.append(
                Cue(
                    at_s=start + cue["at"].as_float(0, length),
                    do=cue["do"].as_str(),
                    hold_s=0.8 if hold is None else hold.as_float(0, 30),
                    size=1.0 if size is None else size.as_float(0.1, 3),
                    side="left" if side is None else side.as_str(),
                    words=None if words is None else words.as_str(),
                    channels=_channels(cue.get("with")),
                    tempo=1.0 if tempo is None else tempo.as_float(0.2, 5),
                    hands=None if hands is None else _pair(hands),
                )
            )
        start += length
    cues.sort(key=lambda cue: cue.at_s)
    return Score(root["take"].as_str(), root["emotion"].as_str(), root["seed"].as_int(0, 2**31), start, tuple(cues))
