"""What the linter writes back: ids that were missing, and which English a Japanese line was written for."""

from __future__ import annotations

import json
import random
import re

import pytest

from game.app.cli import main
from game.core.errors import BadInput
from game.core.paths import DIALOGUE
from game.story import lint_files, load_script, write_lock
from game.story.fix import fix_file, with_ids
from game.story.translations import read_lock

WITHOUT = """\
# A comment with id: in it.
pools:
  talk:
    - {act: praise, en: "One.", ja: "一。"}   # kept
    -   act: joke   # kept too

        en: "Two."
        ja: "二。"
        say:
          - en: "Three."
            ja: "三。"
nodes:
  hub:
    lines:
      - { en: "Four.", ja: "四。" }
      - any:
          - {id: hub_1, en: "Five.", ja: "五。"}
          - "a text is no line"
          - {}
    choices:
      - {id: given, act: story, say: [{en: "Six.", ja: "六。"}]}
"""


def test_ids_are_put_in_and_nothing_else_is_touched():
    text, ids = with_ids(WITHOUT)
    assert ids == ["praise_1", "joke_1", "joke_2", "hub_2", "given_1"]
    assert '- {id: praise_1, act: praise, en: "One.", ja: "一。"}   # kept' in text
    assert "    -   id: joke_1\n        act: joke   # kept too\n\n" in text
    assert '- {id: hub_2,  en: "Four."' in text
    assert re.sub(r"id: (praise_1|joke_1|joke_2|hub_2|given_1)(, |\n +)", "", text) == WITHOUT
    assert with_ids(text) == (text, [])


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
@pytest.mark.parametrize("seed", range(3))
def test_a_shipped_stall_gets_lost_ids_back(tmp_path, seed, newline):
    """Ids taken out of the shipped script at random: the file is whole again but for the new names."""
    rng = random.Random(seed)
    whole = (DIALOGUE / "flea.yaml").read_text(encoding="utf-8")
    found = [m for m in re.finditer(r"(?<=[{ ])id: \w+(, |\n +)", whole) if rng.random() < 0.2]
    assert len(found) > 30
    lost, kept = whole, []
    for match in reversed(found):
        lost = lost[: match.start()] + lost[match.end() :]
    path = tmp_path / "flea.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + lost.replace("\n", newline).encode())
    path.chmod(0o640)
    kept = fix_file(path)
    data = path.read_bytes()
    assert len(kept) == len(found)
    assert path.stat().st_mode & 0o777 == 0o640
    assert data.startswith(b"\xef\xbb\xbf")
    text = data.decode("utf-8-sig").replace(newline, "\n")
    # Each new id stands where one was lost, so putting the old names back gives the old file.
    for name, match in zip(kept, found, strict=True):
        assert text.count(f"id: {name}") >= 1
        text = re.sub(rf"id: {name}(?=, |\n)", re.match(r"id: \w+", match.group())[0], text, count=1)
    assert text == whole


def test_the_command_fixes_files_and_their_lock(tmp_path, capsys, tiny_text):
    path = tmp_path / "tiny.yaml"
    path.write_text(tiny_text.replace("{id: hub_1, ", "{").replace("{id: chat, ", "{"), encoding="utf-8")
    assert main(["lint", str(path)]) == 1
    assert capsys.readouterr().out.count("E_MISSING_ID") == 2
    assert main(["lint", str(path), "--fix"]) == 0
    assert "2 written" in capsys.readouterr().out
    assert load_script(path).lines["hub_1"].text.ja == "で?"
    lock = tmp_path / "translations.lock.yaml"
    first = lock.read_bytes()
    assert read_lock(lock)["tiny"]["hub_1"]
    assert main(["lint", str(tmp_path), "--fix"]) == 0
    assert lock.read_bytes() == first
    capsys.readouterr()

    path.write_text(path.read_text(encoding="utf-8").replace('"Ouch."', '"Not nice."'), encoding="utf-8")
    for extra in ([], ["--fix"]):
        assert main(["lint", str(path), *extra]) == 1
        assert "W_STALE_TRANSLATION the English of 'ouch_1'" in capsys.readouterr().out
    assert main(["lint", str(path), "--accept", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["fixed"] == {f"{lock} lines": 1}
    assert main(["lint", str(tmp_path)]) == 0


def test_what_cannot_be_read_is_left_alone(tmp_path, capsys):
    path = tmp_path / "broken.yaml"
    path.write_text("stall: [\n", encoding="utf-8")
    assert main(["lint", str(path), "--fix"]) == 1
    assert "E_YAML" in capsys.readouterr().out
    assert path.read_text(encoding="utf-8") == "stall: [\n"
    assert [file.name for file in tmp_path.iterdir()] == ["broken.yaml"]
    lock = tmp_path / "translations.lock.yaml"
    lock.write_text("locked:\n  tiny: {hub_1: nonsense}\n", encoding="utf-8")
    with pytest.raises(BadInput, match="two digests"):
        read_lock(lock)
    assert [(f.code, f.where.line, f.where.col) for f in lint_files([lock])] == [("E_BAD_VALUE", 2, 17)]


def test_the_lock_forgets_lines_that_are_gone(tmp_path, tiny_text):
    lock = tmp_path / "translations.lock.yaml"
    path = tmp_path / "tiny.yaml"
    path.write_text(tiny_text, encoding="utf-8")
    write_lock(lock, [load_script(path)])
    path.write_text(tiny_text.replace("id: ouch_1", "id: ouch_2"), encoding="utf-8")
    assert write_lock(lock, [load_script(path)]) == 2
    assert "ouch_2" in read_lock(lock)["tiny"]
    assert "ouch_1" not in read_lock(lock)["tiny"]
    # A line that is new is no fault, but the lock does not watch over it yet.
    assert [f.code for f in lint_files([path])] == []
    path.write_text(tiny_text.replace("id: ouch_1", "id: ouch_3"), encoding="utf-8")
    (finding,) = lint_files([path])
    assert (finding.code, finding.where.line) == ("I_NOT_LOCKED", 1)
    assert "1 of its lines" in str(finding)
