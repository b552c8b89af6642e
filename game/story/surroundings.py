"""What stands beside a script: the person, the rules, the named expressions and gestures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import cast, get_args

from game.core.emotion_space import SIX
from game.core.errors import BadInput
from game.core.paths import ASSETS, DIALOGUE
from game.formats.yaml_source import Node, load_yaml
from game.story.acts import ActTable, acts_from
from game.story.findings import Findings
from game.story.forms import Pronoun
from game.story.model import Person
from game.story.source import Source
from game.story.text import Text

__all__ = ["Surroundings", "gesture_names", "load_faces", "load_person", "surroundings"]


@dataclass(frozen=True)
class Surroundings:
    """What stands beside a script: the folder with people, rules and faces."""

    person: Person
    acts: ActTable
    faces: Mapping[str, Mapping[str, float]]
    lowest_share: float


def surroundings(node: Node | None, source: Source, path: Path, findings: Findings) -> Surroundings | None:
    folder = path.parent if (path.parent / "people").is_dir() else DIALOGUE
    name = source.identifier(node)
    if name is None or node is None:
        return None
    try:
        person = load_person(folder / "people" / f"{name}.yaml")
        rules = load_yaml(folder / "rules.yaml")
        lowest = rules["constants"]["lowest_price"].as_list()[0].as_float(0.0, 1.0)
        acts = acts_from(rules, person.temperament)
        return Surroundings(person, acts, load_faces(folder / "faces.yaml"), lowest)
    except BadInput as error:
        known = [file.stem for file in sorted((folder / "people").glob("*.yaml"))]
        if name in known:
            findings.add("E_UNKNOWN_PERSON", node.where, f"{name!r} cannot be used: {error.message}")
        else:
            findings.add("E_UNKNOWN_PERSON", node.where, f"no shopkeeper {name!r}", findings.hint(name, known))
        return None


def load_person(path: Path) -> Person:
    """Read a shopkeeper's file. Raises BadInput with file:line:col."""
    root = load_yaml(path).only("person", "name", "temperament", "pronouns", "notes", "voice")
    name, spoken_of = root["name"].only("en", "ja"), root.get("pronouns")
    pronoun = "they" if spoken_of is None else spoken_of.only("en", "ja")["en"].as_str()
    if pronoun not in get_args(Pronoun):
        assert spoken_of is not None
        raise spoken_of["en"].error(expected=" | ".join(get_args(Pronoun)))
    if root["person"].as_str() != path.stem:
        raise root["person"].error(expected=f"the file's own name, {path.stem!r}")
    notes = root.get("notes")
    return Person(
        root["person"].as_str(),
        Text(name["en"].as_str(), name["ja"].as_str()),
        root["temperament"].as_str(),
        notes.as_str() if notes else "",
        root.where,
        cast(Pronoun, pronoun),
    )


def load_faces(path: Path) -> dict[str, Mapping[str, float]]:
    """Read named expressions: name -> nudges on the shown emotions. Raises BadInput with file:line:col."""
    faces = load_yaml(path).only("faces")["faces"]
    return {
        key.as_str(): MappingProxyType({e.as_str(): v.as_float(-1, 1) for e, v in face.only(*SIX).items()})
        for key, face in faces.items()
    }


def gesture_names() -> tuple[str, ...]:
    """The named gestures of the motion library."""
    behaviours = load_yaml(ASSETS / "motion" / "behaviours.yaml")["behaviours"]
    return tuple(key.as_str() for key, unit in behaviours.items() if unit["layer"].as_str() == "gesture")
