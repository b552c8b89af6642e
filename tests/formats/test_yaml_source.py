"""Strict YAML: places on every value, refusals with one line, and no file that hurts the reader."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from game.core import BadInput
from game.formats import load_yaml, nearest, parse_yaml, yaml_source


@pytest.fixture(params=["C parser", "Python parser"])
def either_parser(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """PyYAML without libyaml must behave the same."""
    if request.param == "Python parser":
        monkeypatch.setattr(yaml_source, "_LOADER", yaml.SafeLoader)


def test_core_schema_scalars_keep_no_and_yes_as_text():
    text = (
        "[no, yes, on, off, true, False, ~, null, 12, 0x1F, 0o17, 1.5, 1e3, -.5, .inf, 12:30, 1_000, '5', 2026-01-01]"
    )
    assert parse_yaml(text, "f").to_python() == [
        *("no", "yes", "on", "off", True, False, None, None, 12, 31, 15, 1.5, 1000.0, -0.5, float("inf")),
        *("12:30", "1_000", "5", "2026-01-01"),
    ]


def test_every_value_knows_its_place(either_parser: None):
    root = parse_yaml("title: talk\nlines:\n  - {id: a1, ja: こんにちは}\n  - id: a2\n", "talk.yaml")
    second = root["lines"].as_list()[1]
    assert str(second["id"].where) == "talk.yaml:4:9"
    assert str(root["lines"].as_list()[0]["ja"].where) == "talk.yaml:3:18"
    assert root["lines"].as_list()[0]["ja"].as_str() == "こんにちは"
    assert [str(key.where) for key, _ in root.items()] == ["talk.yaml:1:1", "talk.yaml:2:1"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\nb: 2\na: 3", "f:3:1: duplicate key 'a', first given at 1:1"),
        ("a: &x 1\nb: *x", "f:1:4: anchor &x"),
        ("b: *x", "f:1:4: alias *x"),
        ("a: 1\n---\nb: 2", "f:2:1: expected one YAML document"),
        ("a:\n\t- b", "indent with spaces, not tabs"),
        ("? [a]\n: b", "f:1:3: expected a text key"),
        ("1: b", "f:1:1: expected a text key but saw 1"),
        ("~: b", "f:1:1: expected a text key"),
        ("a: !!python/object:os.system {}", "f:1:4: tag"),
        ("a: !secret 1", "f:1:4: tag"),
        ("a: !!int x", "f:1:4: tag"),
        ("a: [1", "f:"),
        ("a: b: c", "f:1:5: YAML"),
        ('a: "x', "YAML"),
        ("a: x\x00y", "f:1:5: expected printable text but saw 'U+0000'"),
        ("a: \x1b[31m", "U+001B"),
        (f"a: {'9' * 5000}", "at most 40 digits"),
    ],
)
def test_refusals_are_one_line_with_the_place(text: str, message: str, either_parser: None):
    with pytest.raises(BadInput) as caught:
        parse_yaml(text, "f")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_typed_access_says_what_was_expected():
    root = parse_yaml("n: 5\nt: no\nf: .nan\nm: {keg: v}\nl: [1]\ne:\n", "f")
    assert root["n"].as_int(0, 9) == 5
    assert root["n"].as_float() == 5.0
    assert root.get("missing") is None
    assert root.get("e") is None
    assert "e" in root
    assert root["t"].as_str() == "no"
    for access, text in [
        (lambda: root["t"].as_bool(), "f:2:4: expected true or false but saw 'no'"),
        (lambda: root["n"].as_str(), 'expected text but saw 5 (put it in "quotes")'),
        (lambda: root["n"].as_int(6, 9), "expected a whole number from 6 to 9 but saw 5"),
        (lambda: root["f"].as_float(), "expected a finite number but saw .nan"),
        (lambda: root["m"].as_float(0), "expected a number of at least 0 but saw a mapping of keg"),
        (lambda: root["l"].as_mapping(), "expected a mapping"),
        (lambda: root["m"].as_list(), "expected a list but saw a mapping"),
        (lambda: root["e"].as_list(), "expected a list but saw nothing"),
        (lambda: root["m"]["kk"], "expected the key 'kk'"),
        (lambda: root["m"].only("key", "other"), "did you mean 'key'?"),
    ]:
        with pytest.raises(BadInput) as caught:
            access()
        assert text in str(caught.value)


def test_nearest_offers_slips_only():
    assert nearest("anegr", ["anger", "joy"]) == "anger"
    assert nearest("xyz", ["anger", "joy"]) is None


@pytest.mark.parametrize("bomb", ["[" * 200_000, "{a: " * 100_000, "- " * 200_000, "? " * 100_000, "[{" * 100_000])
def test_nesting_bombs_are_refused_at_once(bomb: str, either_parser: None):
    start = time.perf_counter()
    with pytest.raises(BadInput, match=r"levels of nesting|text key"):
        parse_yaml(bomb, "f")
    assert time.perf_counter() - start < 5.0


def test_alias_bomb_is_refused_at_its_first_anchor():
    bomb = "a: &a [x, x]\n" + "".join(
        f"{chr(98 + i)}: &{chr(98 + i)} [*{chr(97 + i)}, *{chr(97 + i)}]\n" for i in range(20)
    )
    with pytest.raises(BadInput, match="anchor &a"):
        parse_yaml(bomb, "f")


def test_size_limits(tmp_path: Path):
    path = tmp_path / "big.yaml"
    path.write_text("a: " + "x" * 3000, encoding="utf-8")
    with pytest.raises(BadInput, match="at most 1000 bytes but saw 3003"):
        load_yaml(path, max_bytes=1000)
    with pytest.raises(BadInput, match="at most 10 values"):
        parse_yaml("[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]", "f", max_nodes=10)


def test_files_that_cannot_be_read(tmp_path: Path):
    bad = tmp_path / "bad.yaml"
    bad.write_bytes(b"a: \xff\xfe")
    with pytest.raises(BadInput, match=r"bad\.yaml@3: expected UTF-8 text"):
        load_yaml(bad)
    with pytest.raises(BadInput, match="No such file"):
        load_yaml(tmp_path / "missing.yaml")
    with pytest.raises(BadInput, match="a folder"):
        load_yaml(tmp_path)
    with pytest.raises(BadInput, match="NUL"):
        load_yaml(Path("a\0b"))


def test_byte_order_mark_and_windows_line_ends(tmp_path: Path):
    path = tmp_path / "w.yaml"
    path.write_bytes("\ufeffa: 1\r\nb: [x,\r\n  y]\r\n".encode())
    assert load_yaml(path).to_python() == {"a": 1, "b": ["x", "y"]}


PLAIN = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**9), 10**9)
    | st.floats(-1e6, 1e6)
    | st.text("ab yes:#-[]{}'\"é日", max_size=8),
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(st.text("abcd", min_size=1, max_size=4), inner, max_size=4)
    ),
    max_leaves=12,
)


@settings(max_examples=60, deadline=None)
@given(PLAIN)
def test_what_pyyaml_writes_is_read_back(value: object):
    text = yaml.safe_dump(value, allow_unicode=True)
    assert parse_yaml(text, "f").to_python() == value


@settings(max_examples=150, deadline=None)
@given(st.text("ab:-[]{}\"'&*!|>%@#?, \n\t1.~\\", max_size=60))
def test_any_text_is_read_or_refused(text: str):
    message = ""
    try:
        parse_yaml(text, "f")
    except BadInput as error:
        message = str(error)
    assert "\n" not in message
