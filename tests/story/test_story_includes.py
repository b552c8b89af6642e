"""Included files: their nodes, pools and variables play as the stall's own; their faults are told in their own file."""

from __future__ import annotations

from pathlib import Path

import pytest

from game.core.errors import BadInput
from game.story import Script, lint_files, load_script
from game.story.includes import MAX_DEPTH, MAX_FILES

WEATHER = """\
part: weather
variables:
  afternoon: {rained: false}
pools:
  talk:
    - {id: rain_talk, act: joke, en: "Rain again?", ja: "また雨?", to: rain}
nodes:
  rain:
    set: {rained: true}
    lines:
      - {id: rain_1, if: "not rained or told < 2", en: "Only on Sundays.", ja: "日曜だけです。"}
    to: home
"""


def _stall(folder: Path, tiny: str, include: str = "[shared/weather.yaml]", **files: str) -> Path:
    path = folder / "tiny.yaml"
    path.write_text(tiny.replace("items:\n", f"include: {include}\nitems:\n", 1), encoding="utf-8")
    (folder / "shared").mkdir(exist_ok=True)
    for name, text in {"weather": WEATHER, **files}.items():
        (folder / "shared" / f"{name}.yaml").write_text(text, encoding="utf-8")
    return path


def _plain(found: list, folder: Path) -> list[str]:
    return [str(finding).removeprefix(f"{folder}/") for finding in found]


def test_an_included_file_plays_as_the_stalls_own(tmp_path, tiny_text, talk):
    path = _stall(tmp_path, tiny_text)
    assert _plain(lint_files([tmp_path]), tmp_path) == []
    script: Script = load_script(path)
    assert [Path(file).name for file in script.files] == ["tiny.yaml", "weather.yaml"]
    assert script.variables["rained"].scope == "afternoon"
    for seed in range(30):
        player = talk(script, seed=seed)
        if any(choice.id == "rain_talk" for choice in player.beat.choices):
            beat = player.choose("rain_talk")
            assert [line.id for line in beat.lines][:2] == ["rain_talk", "rain_1"]
            assert beat.lines[1].ja == "日曜だけです。"
            assert player.state.variables["rained"] is True
            return
    raise AssertionError("a choice of the included file is never drawn")


def test_faults_stand_in_the_file_they_are_in(tmp_path, tiny_text):
    broken = WEATHER.replace("told < 2", "tolled < 2").replace("to: home", "to: hom")
    path = _stall(tmp_path, tiny_text, weather=broken)
    expected = [
        "shared/weather.yaml:11:41: E_UNKNOWN_NAME unknown name 'tolled' (did you mean 'told'?)",
        "shared/weather.yaml:12:9: E_MISSING_TARGET unknown node 'hom' (did you mean 'home'?)",
    ]
    assert _plain(lint_files([path]), tmp_path) == expected
    # The same where the part is checked by itself, or the whole folder is: each once.
    assert _plain(lint_files([tmp_path / "shared" / "weather.yaml"]), tmp_path) == expected
    assert _plain(lint_files([tmp_path]), tmp_path) == expected
    with pytest.raises(BadInput, match=r"weather\.yaml:11:41"):
        load_script(path)


def test_a_name_that_both_files_give_is_told_once_with_the_first_place(tmp_path, tiny_text):
    path = _stall(tmp_path, tiny_text, weather=WEATHER.replace("  rain:", "  hub:").replace("to: rain", "to: hub"))
    (found,) = [finding for finding in lint_files([path]) if finding.code == "E_DUPLICATE_ID"]
    assert found.where.path.endswith("weather.yaml")
    assert (found.where.line, found.where.col) == (8, 3)
    assert "tiny.yaml:42:3" in str(found)


def test_circles_depth_and_number_are_bounded(tmp_path, tiny_text):
    def part(name: str, include: str) -> str:
        return f"part: {name}\ninclude: [{include}]\n"

    path = _stall(tmp_path, tiny_text, "[shared/a.yaml]", a=part("a", "shared/b.yaml"), b=part("b", "shared/a.yaml"))
    (found,) = lint_files([path])
    assert str(found).endswith("shared/b.yaml:2:11: E_INCLUDE a circle: a.yaml -> b.yaml -> a.yaml")

    deep = {f"d{i}": part(f"d{i}", f"shared/d{i + 1}.yaml") for i in range(MAX_DEPTH)}
    path = _stall(tmp_path, tiny_text, "[shared/d0.yaml]", **deep, **{f"d{MAX_DEPTH}": "part: x\n"})
    (found,) = lint_files([path])
    assert found.code == "E_INCLUDE"
    assert found.where.path.endswith(f"d{MAX_DEPTH - 1}.yaml")

    many = {f"m{i}": f"part: m{i}\n" for i in range(MAX_FILES + 2)}
    names = ", ".join(f"shared/{name}.yaml" for name in many)
    found_many = lint_files([_stall(tmp_path, tiny_text, f"[{names}]", **many)])
    assert [finding.code for finding in found_many] == ["E_INCLUDE"] * 2

    # The same file twice is read once; that is no fault.
    twice = _stall(tmp_path, tiny_text, "[shared/weather.yaml, shared/weather.yaml]")
    assert lint_files([twice]) == []


def test_a_link_does_not_lead_out_of_the_folder(tmp_path, tiny_text):
    inside = tmp_path / "dialogue"
    inside.mkdir()
    secret = tmp_path / "secret.yaml"
    secret.write_text("part: secret\n")
    path = _stall(inside, tiny_text, "[shared/link.yaml]")
    (inside / "shared" / "link.yaml").symlink_to(secret)
    (found,) = lint_files([path])
    assert "leads out of the folder" in str(found)


def test_unreadable_parts_are_one_finding(tmp_path, tiny_text):
    path = _stall(tmp_path, tiny_text, weather="part: [\n")
    (found,) = lint_files([path])
    assert found.code == "E_YAML"
    assert found.where.path.endswith("weather.yaml")
    (tmp_path / "shared" / "weather.yaml").write_bytes(b"\xff\xfe")
    (found,) = lint_files([path])
    assert (found.code, found.where.line) == ("E_INCLUDE", 6)
