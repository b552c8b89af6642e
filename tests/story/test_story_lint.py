"""The linter: every broken script gives exactly its findings, each at its place; shipped dialogue gives none."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from game.app.cli import main
from game.core.errors import BadInput
from game.core.paths import DIALOGUE
from game.story import CODES, lint_files, load_script
from game.story.findings import Findings
from game.story.lint import lint_text

BROKEN = Path(__file__).resolve().parents[1] / "data" / "dialogue_broken"
FILES = sorted(BROKEN.glob("*.yaml"))
_EXPECT = re.compile(r"# expect: (\w+) (\d+):(\d+)")


def test_there_are_many_broken_files_and_they_know_most_codes():
    assert len(FILES) >= 40
    covered = {
        code for path in BROKEN.rglob("*.yaml") for code, _, _ in _EXPECT.findall(path.read_text(encoding="utf-8"))
    }
    # Those of random talks have a test of their own.
    assert set(CODES) - covered == {"W_NO_ANSWER", "I_NOT_WALKED"}


@pytest.mark.parametrize("name", ["stale", "unlocked"])
def test_translations_are_compared_with_their_lock(name):
    path = BROKEN / name / f"{name}.yaml"
    expected = [(code, int(line), int(col)) for code, line, col in _EXPECT.findall(path.read_text(encoding="utf-8"))]
    assert [(f.code, f.where.line, f.where.col) for f in lint_files([BROKEN / name])] == expected
    # Where English and Japanese both changed, the line was written anew: `gone_1` of the stale stall is no finding.
    assert all("gone_1" not in str(finding) for finding in lint_files([path]))


def test_what_the_purse_cannot_pay_for(tiny_text):
    findings = Findings()
    lint_text(Path("tiny.yaml"), tiny_text, findings, purse=449)
    (finding,) = findings.all
    assert (finding.code, finding.where.line, finding.where.col) == ("W_UNWINNABLE", 8, 3)
    assert "'pot' costs 450 at the very least" in str(finding)


def test_a_part_that_nobody_includes():
    assert [(f.code, f.where.line, f.where.col) for f in lint_files([BROKEN / "parts"])] == [("I_NOT_INCLUDED", 2, 1)]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_each_fault_is_found_where_it_is(path):
    expected = [(code, int(line), int(col)) for code, line, col in _EXPECT.findall(path.read_text(encoding="utf-8"))]
    assert expected
    findings = lint_files([path])
    assert [(f.code, f.where.line, f.where.col) for f in findings] == expected
    for finding in findings:
        assert "\n" not in str(finding)
        assert str(finding).startswith(f"{path}:{finding.where.line}:{finding.where.col}: {finding.code} ")
    # A script with errors does not load, and says so at the first of them; one with warnings does.
    errors = [finding for finding in findings if finding.severity == "error"]
    if not errors:
        assert load_script(path).stall == "tiny"
        return
    with pytest.raises(BadInput) as caught:
        load_script(path)
    assert str(caught.value).startswith(f"{path}:{errors[0].where.line}:{errors[0].where.col}: ")
    assert ("more" in str(caught.value)) == (len(errors) > 1)


def test_random_talks_find_silence_and_what_nobody_comes_to(tmp_path, tiny_text, capsys):
    path = tmp_path / "tiny.yaml"
    text = tiny_text.replace(
        "    - {id: chat,",
        '    - {id: mute, act: joke, once: false, if: trust > 0, en: "Ha!", ja: "は!", to: nothing}\n    - {id: chat,',
    ).replace("  quiet:\n", "  nothing:\n    to: home\n  quiet:\n")
    text = text.replace('if: "told < 2"', 'if: "told < 2 and round > 40"')
    path.write_text(text, encoding="utf-8")
    found = {finding.code: finding for finding in lint_files([path], walks=60, seed=3)}
    mute = next(f for f in lint_files([path], walks=60, seed=3) if "'mute'" in str(f))
    rows = text.split("\n")
    assert mute.code == "W_NO_ANSWER"
    assert rows[mute.where.line - 1][mute.where.col - 1 :].startswith("{id: mute")
    assert "tale" in str(found["I_NOT_WALKED"]) or "aside" in str(found["I_NOT_WALKED"])
    # One seed, the same findings; none of it unless asked for, none of it where there are errors.
    assert [*map(str, lint_files([path], walks=60, seed=3))] == [*map(str, lint_files([path], walks=60, seed=3))]
    assert lint_files([path]) == []
    assert main(["lint", str(path), "--walks", "30", "--seed", "3"]) == 1
    capsys.readouterr()
    path.write_text(text.replace("to: nothing}", "to: nothin}"), encoding="utf-8")
    assert {f.code for f in lint_files([path], walks=30)} == {"E_MISSING_TARGET"}


def test_every_move_of_many_random_talks_is_answered_in_the_shipped_stalls():
    assert [str(f) for f in lint_files([DIALOGUE], walks=80, seed=2) if f.code == "W_NO_ANSWER"] == []


def test_shipped_dialogue_is_clean():
    # A new line may wait for the lock of translations to learn it (`lint --fix`); nothing else is left standing.
    assert [str(finding) for finding in lint_files([DIALOGUE]) if finding.code != "I_NOT_LOCKED"] == []


def test_tiny_is_clean(tiny_text):
    findings = Findings()
    lint_text(Path("tiny.yaml"), tiny_text, findings)
    assert findings.all == []


@pytest.mark.parametrize("style", ['"{}"', "'{}'", "{}", "|\n          {}", ">\n          {}"])
def test_places_inside_every_kind_of_scalar(tiny_text, style):
    before = "    to:\n      - {if: \"item == 'cup'\""
    assert before in tiny_text
    way = f"      - if: {style.format('told > 1 and oops')}\n        to: cup_tale\n"
    text = tiny_text.replace(before, before.replace("    to:\n", "    to:\n" + way))
    findings = Findings()
    lint_text(Path("tiny.yaml"), text, findings)
    (finding,) = findings.all
    row = text.split("\n")[(finding.where.line or 0) - 1]
    assert finding.code == "E_UNKNOWN_NAME"
    assert row[(finding.where.col or 0) - 1 :].startswith("oops")


def test_other_dialogue_files(tmp_path):
    (tmp_path / "rules.yaml").write_text(
        "constants: {lines_on_offer: 4}\nacts: {praise: {anger: Q}}\npeople: {a: {}}\n"
    )
    (tmp_path / "faces.yaml").write_text("faces:\n  smile: {joyy: 0.2}\n")
    (tmp_path / "mira.yaml").write_text("person: mara\nname: {en: A, ja: B}\ntemperament: student\n")
    found = [str(f).removeprefix(f"{tmp_path}/") for f in lint_files([tmp_path])]
    assert [text.split(" ")[0] for text in found] == ["faces.yaml:2:11:", "mira.yaml:1:9:", "rules.yaml:2:24:"]
    assert "did you mean 'joy'" in found[0]


def test_command_line(capsys, tmp_path):
    assert main(["lint", str(DIALOGUE / "flea.yaml")]) == 0
    assert " E_" not in capsys.readouterr().out
    assert main(["lint", str(BROKEN / "several.yaml")]) == 1
    rows = capsys.readouterr().out.splitlines()
    assert rows[-1] == "3 errors, 1 warning, 0 infos"
    assert len(rows) == 5
    assert main(["lint", str(BROKEN / "several.yaml"), "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    assert (told["errors"], told["warnings"], told["infos"]) == (3, 1, 0)
    assert set(told["findings"][0]) == {"file", "line", "col", "severity", "code", "message", "hint"}
    assert main(["lint", str(BROKEN / "always.yaml")]) == 0
    capsys.readouterr()
    assert main(["lint", str(tmp_path / "nothing")]) == 2
    assert "no such file" in capsys.readouterr().err
    assert main(["lint", "--codes"]) == 0
    assert capsys.readouterr().out.count("\n") == len(CODES)


def test_hostile_files_are_one_finding(tmp_path):
    hostile = {
        "deep.yaml": "stall: " + "[" * 5000,
        "bomb.yaml": "stall: &a [x]\nb: [*a, *a]\n",
        "binary.yaml": "stall: \x00",
        "bytes.yaml": None,
        "long_key.yaml": "stall: a\n" + "k" * 100_000 + ": 1\n",
    }
    for name, text in hostile.items():
        path = tmp_path / name
        path.write_bytes(b"stall: \xff\xfe" if text is None else text.encode())
        findings = lint_files([path])
        assert findings
        assert all(finding.severity == "error" and "\n" not in str(finding) for finding in findings)
        assert len(findings) < 20
        with pytest.raises(BadInput):
            load_script(path)
