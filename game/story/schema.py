"""``dialogue/schema.json`` (JSON Schema draft-07), made of the reader's own shapes: completion and hover in editors."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from game.core.emotion_space import SIX
from game.core.paths import DIALOGUE
from game.story.grammar import ACT_HELP, OUTCOME_HELP, SHAPES, WHEN_HELP, Key, Shape
from game.story.source import ID
from game.story.surroundings import gesture_names, load_faces
from game.story.vocabulary import OPTIONAL_OUTCOMES

__all__ = ["schema", "schema_text"]

Schema = dict[str, Any]

_ID: Schema = {"type": "string", "pattern": f"^{ID.pattern}$"}
_VALUE: Schema = {"type": ["number", "boolean", "string"]}
_CONDITION: Schema = {"type": ["string", "boolean"]}
_NODE: Schema = {"anyOf": [{"enum": ["home", "back"]}, _ID]}
# What an editor offers to write (yaml-language-server).
_SNIPPETS: Mapping[str, tuple[str, str, Schema]] = {
    "line": ("line", "a spoken line", {"id": "${1:id}", "en": "${2}", "ja": "${3}"}),
    "choice": (
        "choice",
        "something the player can say",
        {"id": "${1:id}", "act": "${2:praise}", "en": "${3}", "ja": "${4}", "to": "${5:home}"},
    ),
    "node": ("node", "lines and a way on", {"lines": [{"id": "${1:id}", "en": "${2}", "ja": "${3}"}], "to": "home"}),
}


def schema(folder: Path = DIALOGUE) -> Schema:
    """The schema of stalls and parts; named expressions are those of the folder's ``faces.yaml``."""
    faces = tuple(load_faces(folder / "faces.yaml"))
    makers = _makers(faces)
    definitions = {shape.name: _shape(shape, makers) for shape in SHAPES}
    definitions["line_or_group"] = {
        "if": {"required": ["any"]},
        "then": {"$ref": "#/definitions/group"},
        "else": {"$ref": "#/definitions/line"},
    }
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "A stall of the Mental Communication Game, or a part that stalls include",
        "description": "Reference: docs/dialogue.md. What no schema can say, `run_game.py lint` says.",
        "if": {"required": ["part"]},
        "then": {"$ref": "#/definitions/part"},
        "else": {"$ref": "#/definitions/stall"},
        "definitions": definitions,
    }


def schema_text(folder: Path = DIALOGUE) -> str:
    """The schema as the file holds it."""
    return json.dumps(schema(folder), ensure_ascii=False, indent=1) + "\n"


def _shape(shape: Shape, makers: Mapping[str, Callable[[Key], Schema]]) -> Schema:
    out: Schema = {
        "type": "object",
        "description": shape.help,
        "additionalProperties": False,
        "properties": {key.name: {**makers[key.kind](key), "description": key.help} for key in shape.keys},
    }
    if shape.required:
        out["required"] = list(shape.required)
    if shape.name in _SNIPPETS:
        label, text, body = _SNIPPETS[shape.name]
        out["defaultSnippets"] = [{"label": label, "description": text, "body": body}]
    return out


def _makers(faces: Sequence[str]) -> Mapping[str, Callable[[Key], Schema]]:
    """kind of a key -> what may stand there."""

    def reference(key: Key) -> Schema:
        # Beside a $ref, draft-07 ignores everything, the description too.
        return {"allOf": [{"$ref": f"#/definitions/{key.of}"}]}

    def items(key: Key) -> Schema:
        return {"type": "array", "items": {"$ref": f"#/definitions/{key.of}"}}

    def named(values: Schema) -> Schema:
        return {"type": "object", "propertyNames": _ID, "additionalProperties": values}

    return {
        "id": lambda key: _ID,
        "person": lambda key: _ID,
        "ending": lambda key: _ID,
        "text": lambda key: {"type": "string"},
        "number": lambda key: {"type": "number", "minimum": key.low, "maximum": key.high},
        "whole": lambda key: {"type": "integer", "minimum": int(key.low), "maximum": int(key.high)},
        "flag": lambda key: {"type": "boolean"},
        "condition": lambda key: _CONDITION,
        "feel": lambda key: {
            "type": "object",
            "additionalProperties": False,
            "properties": {name: {"type": "number", "minimum": -1, "maximum": 1} for name in SIX},
        },
        "set": lambda key: named(_VALUE),
        "values": lambda key: named(_VALUE),
        "once": lambda key: {"enum": [True, False, "stall"]},
        "option": lambda key: _enum({name: WHEN_HELP.get(name, "") for name in key.options}),
        "act": lambda key: _enum(ACT_HELP),
        "face": lambda key: {"enum": list(faces)},
        "gesture": lambda key: {"enum": list(gesture_names())},
        "speaker": lambda key: {"anyOf": [{"enum": ["you", "narrator"]}, _ID]},
        "node": lambda key: _NODE,
        "ways": lambda key: {
            "anyOf": [_NODE, {"type": "array", "items": {"anyOf": [_NODE, {"$ref": "#/definitions/branch"}]}}]
        },
        "pools": lambda key: {"anyOf": [_ID, {"type": "array", "items": _ID}]},
        "outcomes": lambda key: {
            "type": "object",
            "additionalProperties": False,
            "properties": {name: {**_ID, "description": text} for name, text in OUTCOME_HELP.items()},
            "required": [name for name in OUTCOME_HELP if name not in OPTIONAL_OUTCOMES],
        },
        "texts": lambda key: {"type": "array", "items": {"type": "string", "pattern": r"\.yaml$"}},
        "shape": reference,
        "list": items,
        "mapping": lambda key: named({"$ref": f"#/definitions/{key.of}"}),
        "lists": lambda key: named(items(key)),
    }


def _enum(help_by_name: Mapping[str, str]) -> Schema:
    out: Schema = {"enum": list(help_by_name)}
    if any(help_by_name.values()):
        out["markdownEnumDescriptions"] = list(help_by_name.values())
    return out
