"""build --check asks the Khronos validator about our models, where there is one."""

from __future__ import annotations

import json
import stat
import sys
from pathlib import Path

import pytest

from game.app import gltf_check
from game.app.build import check_models
from game.app.gltf_check import validate
from game.core.errors import MissingPart
from game.core.paths import ASSETS

MODELS = sorted(path for path in ASSETS.rglob("*") if path.suffix in {".vrm", ".glb"})


def test_without_node_one_line_says_so(monkeypatch, capsys) -> None:
    monkeypatch.setenv("PATH", "")
    with pytest.raises(MissingPart, match="no node on the path"):
        validate(MODELS[:1])
    assert check_models(MODELS[:1]) == 0
    out = capsys.readouterr().out
    assert out.count("\n") == 1
    assert "did not run" in out


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in for node is a shell script")
def test_errors_and_warnings_are_findings(monkeypatch, tmp_path, capsys) -> None:
    wrong = {"severity": 0, "code": "BAD", "pointer": "/meshes/0", "message": "wrong"}
    issues = [wrong, {"severity": 1, "code": "ODD", "message": "hm"}]
    node = tmp_path / "node"
    node.write_text(f"#!/bin/sh\nprintf '%s' '{json.dumps([issues])}'\n", encoding="utf-8")
    node.chmod(node.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    assert check_models([Path("x.glb")]) == 2
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "x.glb:/meshes/0: error BAD wrong"
    assert lines[1] == "x.glb:: warning ODD hm"


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in for node is a shell script")
@pytest.mark.parametrize(("script", "says"), [("exit 3", "npm install -g"), ("echo oh no >&2; exit 4", "oh no")])
def test_a_validator_that_fails_is_no_finding(monkeypatch, tmp_path, script, says) -> None:
    node = tmp_path / "node"
    node.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
    node.chmod(node.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    with pytest.raises(MissingPart, match=says):
        validate([Path("x.glb")])


def test_our_models_pass_the_official_validator() -> None:
    try:
        findings = validate(MODELS)
    except MissingPart as error:
        pytest.skip(str(error))
    assert findings == []
    assert gltf_check.TIMEOUT_S > 0
