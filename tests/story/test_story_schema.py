"""The schema for editors: as the reader's own shapes say, right about the shipped scripts, and about broken ones."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

from game.core.paths import DIALOGUE
from game.formats.yaml_source import load_yaml, parse_yaml
from game.story import ACTS, OUTCOMES, STANDING_ACTS
from game.story.grammar import ACT_HELP, OUTCOME_HELP, SHAPES
from game.story.schema import schema, schema_text
from game.story.vocabulary import WHEN

BROKEN = Path(__file__).resolve().parents[1] / "data" / "dialogue_broken"
WRITTEN = DIALOGUE / "schema.json"
SCRIPTS = [path for path in sorted(DIALOGUE.rglob("*.yaml")) if {"stall", "part"} & set(load_yaml(path).as_mapping())]


@pytest.fixture(scope="module")
def validator():
    made = schema()
    jsonschema.Draft7Validator.check_schema(made)
    return jsonschema.Draft7Validator(made)


def test_the_file_is_what_the_shapes_say():
    assert WRITTEN.read_text(encoding="utf-8") == schema_text(), "run_game.py lint --schema writes it anew"


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_shipped_scripts_validate_and_name_the_schema(path, validator):
    errors = [f"{error.json_path}: {error.message}" for error in validator.iter_errors(load_yaml(path).to_python())]
    assert errors == []
    first = path.read_text(encoding="utf-8").split("\n", 1)[0]
    assert first.startswith("# yaml-language-server: $schema=")
    assert (path.parent / first.split("=")[1]).resolve() == WRITTEN


def test_the_example_stall_validates(validator, tiny_text):
    assert list(validator.iter_errors(parse_yaml(tiny_text, "tiny").to_python())) == []


@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("unknown_key", "$.nodes"),
        ("missing_key", "$"),
        ("missing_id", "$.nodes"),
        ("unknown_act", "$.pools.talk"),
        ("unknown_emotion", "$.nodes"),
        ("unknown_face", "$.nodes"),
        ("unknown_gesture", "$.nodes"),
        ("unknown_order", "$.nodes"),
        ("unknown_outcome", "$.outcomes"),
        ("unknown_when", "$.nodes"),
        ("feel_too_strong", "$.nodes"),
        ("not_a_list", "$"),
        ("bad_id", "$.nodes"),
        ("timer_too_short", "$.nodes.hub.timer"),
        ("include_no_list", "$.include"),
    ],
)
def test_broken_scripts_do_not(name, place, validator):
    found = [error.json_path for error in validator.iter_errors(load_yaml(BROKEN / f"{name}.yaml").to_python())]
    assert found
    assert all(path.startswith(place) for path in found)


def test_every_key_has_words_to_show():
    assert tuple(ACT_HELP) == (*ACTS, *STANDING_ACTS)
    assert set(OUTCOME_HELP) == set(OUTCOMES)
    for shape in SHAPES:
        assert shape.help
        assert len({key.name for key in shape.keys}) == len(shape.keys)
        for key in shape.keys:
            assert 10 <= len(key.help) <= 120, (shape.name, key.name)
    made = json.loads(schema_text())["definitions"]
    assert made["line"]["properties"]["when"]["enum"] == list(WHEN)
    assert len(made["choice"]["properties"]["act"]["markdownEnumDescriptions"]) == len(ACT_HELP)
    assert made["line"]["defaultSnippets"][0]["body"]["en"]
