"""docs/dialogue.md: every example is a script that passes the linter, every table is what the code says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from game.app.cli import build_parser, main
from game.core.errors import Where
from game.story import ACTS, CODES, ENV, OUTCOMES, STANDING_ACTS, Chose, Start, advance, begin, load_script
from game.story.expressions import Names, Scope, compile_expression
from game.story.findings import Findings
from game.story.lint import lint_files, lint_text
from game.story.reader import read_script

ROOT = Path(__file__).resolve().parents[2]
DOC = (ROOT / "docs" / "dialogue.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"<!-- example: (\w+) -->\n```\w+\n(.*?)```", DOC, re.S)


def test_every_yaml_block_is_an_example():
    assert len(re.findall(r"```yaml", DOC)) == sum(kind != "expressions" for kind, _ in EXAMPLES)
    assert len(EXAMPLES) >= 9


@pytest.mark.parametrize(("kind", "text"), EXAMPLES, ids=[f"{i}-{kind}" for i, (kind, _) in enumerate(EXAMPLES)])
def test_examples_pass_the_linter(kind, text, tiny_text, tmp_path):
    if kind == "expressions":
        return
    if kind in {"part", "head"}:
        # Both halves of one example: a part, and the stall that includes it.
        (tmp_path / "shared").mkdir()
        part = next(text for kind, text in EXAMPLES if kind == "part")
        head = next(text for kind, text in EXAMPLES if kind == "head")
        (tmp_path / "shared" / "weather.yaml").write_text(part, encoding="utf-8")
        (tmp_path / "tiny.yaml").write_text(tiny_text.replace("items:\n", head + "items:\n", 1), encoding="utf-8")
        assert [str(finding) for finding in lint_files([tmp_path])] == []
        assert "rain_coming" in load_script(tmp_path / "tiny.yaml").choices
        return
    whole = {
        "stall": text,
        "nodes": tiny_text + text,
        "pool": tiny_text.replace("nodes:\n", text + "nodes:\n"),
        "variables": re.sub(r"variables:\n(  .*\n)+", text, tiny_text),
    }[kind]
    assert text in whole
    findings = Findings()
    lint_text(Path("example.yaml"), whole, findings)
    # A node by itself is not led to, and a variable by itself not asked for.
    loose = {"nodes": {"W_UNREACHABLE"}, "variables": {"W_UNUSED"}}.get(kind, set())
    assert [str(finding) for finding in findings.all if finding.code not in loose] == []


def test_the_whole_stall_plays():
    text = next(text for kind, text in EXAMPLES if kind == "stall")
    script = read_script(Path("radishes.yaml"), Findings(), text)
    assert script is not None
    state, beat = advance(script, begin(script, "radish", 1), Start(), {"list_price": 200, "ask": 200})
    assert beat.lines[0].en == "Radishes! ¥200."
    assert len(beat.choices) == 6
    state, beat = advance(script, state, Chose("offer", "deal"), {"offer": 150, "deal_price": 150})
    assert beat.ended == "bought"
    assert beat.lines[-1].ja == "150円。これで包んで。"


def test_expressions_have_the_values_shown():
    names = Names(
        {"told": "number", "warm": "bool", "trust": "number", "item": "text"}, ("hub",), frozenset({"hub", "hub_9"})
    )
    scope = Scope({"told": 2.0, "warm": False, "trust": 0.5, "item": "vase"}, {"hub": 1}, {"hub"})
    rows = next(text for kind, text in EXAMPLES if kind == "expressions").splitlines()
    assert len(rows) >= 6
    for row in rows:
        source, shown = row.split("->")
        value = compile_expression(source.strip(), names, lambda _: Where("x")).evaluate(scope)
        assert (str(value).lower() if isinstance(value, bool) else f"{value:g}") == shown.strip()


def test_tables_are_complete():
    codes = dict(re.findall(r"^\| `([EWI]_\w+)` \| (.+) \|$", DOC, re.M))
    assert codes == CODES
    names = {name for name, kind in re.findall(r"^\| `(\w+)` \| (number|money|true/false|text) \|", DOC, re.M)}
    assert names == set(ENV)
    outcomes = dict(re.findall(r"^\| `(\w+)` \| (yes|no|) ?\|", DOC, re.M))
    assert {name: ends == "yes" for name, ends in outcomes.items()} == dict(OUTCOMES)
    assert all(f"`{act}`" in DOC or f" {act}" in DOC for act in (*ACTS, *STANDING_ACTS))


def test_shell_examples_run(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    # All name the shipped dialogue; what they print is tested with the linter.
    shell = re.findall(r"^run_game\.py (lint[^#\n]*)", DOC, re.M)
    assert len(shell) == 5
    for command in shell:
        if not command.strip().endswith(("flea.yaml", "--codes")):
            # --fix would write into the shipped files (see test_story_fix); the others check all of them again.
            build_parser("lint").parse_args(command.split())
            continue
        assert main(command.split()) == 0
    capsys.readouterr()
