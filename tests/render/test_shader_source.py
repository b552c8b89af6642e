from __future__ import annotations

from pathlib import Path

import pytest

from game.render import Device
from game.render.shader_source import SHADER_FOLDER, ShaderError, explain_log, load_stage

VERTEX = "in vec3 position;\nvoid main() { gl_Position = vec4(position, 1.0); }\n"


def write(folder: Path, **files: str) -> Path:
    for name, text in files.items():
        (folder / f"{name}.glsl").write_text(text)
    return folder


def test_an_include_is_pasted_once_with_line_numbers_around_it(tmp_path: Path) -> None:
    write(tmp_path, a='int a;\n#include "b.glsl"\n#include "b.glsl"\nint c;', b="int b;")
    files: list[str] = []
    text = load_stage("a.glsl", {}, files, folder=tmp_path).text
    assert text.count("int b;") == 1
    assert files == ["a.glsl", "b.glsl"]
    lines = text.splitlines()
    assert lines[0].startswith("#version 330")
    assert lines[lines.index("int b;") - 1] == "#line 10001"
    assert lines[lines.index("int c;") - 1] == "#line 4"


def test_a_missing_include_names_the_line_that_wanted_it(tmp_path: Path) -> None:
    write(tmp_path, a='\n#include "nowhere.glsl"\n')
    with pytest.raises(ShaderError, match=r"a\.glsl:2: no shader file nowhere\.glsl"):
        load_stage("a.glsl", {}, [], folder=tmp_path)


def test_a_missing_define_is_an_error(tmp_path: Path) -> None:
    write(tmp_path, a="#needs TAPS SIZE\n")
    with pytest.raises(ShaderError, match=r"a\.glsl:1: needs the define SIZE"):
        load_stage("a.glsl", {"TAPS": 2}, [], folder=tmp_path)


def test_a_given_define_reaches_the_text(tmp_path: Path) -> None:
    write(tmp_path, a="#needs TAPS\n")
    source = load_stage("a.glsl", {"TAPS": 2, "OTHER": 1}, [], folder=tmp_path)
    assert "#define TAPS 2" in source.text
    assert "OTHER" not in source.text
    assert source.used == {"TAPS"}


@pytest.mark.parametrize(
    "log",
    ["0:10014(7): error: no x", "0(10014) : error C1008: no x", "ERROR: 0:10014: no x"],
    ids=["mesa", "nvidia", "others"],
)
def test_messages_of_all_vendors_are_mapped_to_files(log: str) -> None:
    assert explain_log(f"fragment_shader\n====\n{log}\n", ["a.glsl", "b.glsl"]).startswith("b.glsl:14: ")


@pytest.mark.gl
def test_a_compile_error_names_file_and_line(tmp_path: Path, device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    write(
        tmp_path,
        v=VERTEX,
        f='#include "c.glsl"\nout vec4 o;\nvoid main() { o = tint(); }\n',
        c="\n\nvec4 tint() { return wrong; }\n",
    )
    monkeypatch.setattr("game.render.shader_source.SHADER_FOLDER", tmp_path)
    monkeypatch.setattr(load_stage, "__kwdefaults__", {"version": 330, "folder": tmp_path})
    with pytest.raises(ShaderError, match=r"^c\.glsl:3: .*wrong"):
        device.program("v.glsl", "f.glsl")


@pytest.mark.gl
def test_a_define_that_no_file_needs_is_an_error(device: Device) -> None:
    with pytest.raises(ShaderError, match="needs the define NONSENSE"):
        device.program("screen.vert.glsl", "post.frag.glsl", defines={"NONSENSE": 1})


def test_every_shader_include_exists() -> None:
    for path in SHADER_FOLDER.glob("*.glsl"):
        for line in path.read_text().splitlines():
            if line.startswith("#include"):
                assert (SHADER_FOLDER / line.split('"')[1]).is_file(), f"{path.name}: {line}"
