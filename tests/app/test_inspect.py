"""The inspect command, run as a user runs it."""

from __future__ import annotations

import json
import os
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from game.app import inspect
from game.app.cli import main

VECTORS: list[dict[str, Any]] = json.loads(
    Path(os.environ.get("MCG_CONFORMANCE_BVH") or Path(__file__).parents[1] / "data" / "bvh_fk.json").read_text("utf-8")
)

BVH = """HIERARCHY
ROOT hips
{
OFFSET 0 1 0
CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
JOINT he\u202ead
{
OFFSET 0 1 0
CHANNELS 3 Zrotation Xrotation Yrotation
}
}
MOTION
Frames: 3
Frame Time: 0.04
0 1 0 0 0 0 0 0 0
0 1 0 90 0 0 0 0 0
"""


@pytest.fixture
def take(tmp_path: Path) -> Path:
    path = tmp_path / "take.bvh"
    path.write_text(BVH, encoding="utf-8")
    return path


def test_json_of_a_take(take: Path, capsys: pytest.CaptureFixture[str]):
    assert main(["inspect", str(take), "--frames", "0,1", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["joints"] == ["hips", "he\u202ead"]
    assert result["parents"] == [-1, 0]
    assert result["frame_time"] == 0.04
    assert (result["frame_count"], result["declared_frames"]) == (2, 3)
    np.testing.assert_allclose(result["frames"]["0"], [[0, 1, 0], [0, 2, 0]], atol=1e-12)
    np.testing.assert_allclose(result["frames"]["1"], [[0, 1, 0], [-1, 1, 0]], atol=1e-12)
    assert "3 frames but there are 2" in result["findings"][0]


def test_table_of_a_take(take: Path, capsys: pytest.CaptureFixture[str]):
    assert main(["inspect", str(take)]) == 0
    text = capsys.readouterr().out
    assert "2 joints" in text
    assert "2 frames of 0.04 s (25 per second)" in text
    assert "\u202e" not in text
    assert "finding:" in text


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--frames", "2"], "expected frames from 0 to 1 but saw 2"),
        (["--frames", "-1"], "expected frame numbers from 0"),
        (["--frames", "0,x"], "expected frame numbers from 0"),
        (["--frames", "9" * 30], "expected frame numbers from 0"),
        (["--fps", "0"], "expected a rate from 1 to 1000"),
        (["--fps", "nan"], "expected a rate from 1 to 1000"),
    ],
)
def test_bad_requests(take: Path, capsys: pytest.CaptureFixture[str], words: list[str], message: str):
    assert main(["inspect", str(take), *words]) == 2
    captured = capsys.readouterr()
    assert message in captured.err
    assert captured.err.count("\n") == 1
    assert captured.out == ""


def test_bad_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    for name, content in [("a.bvh", b"nothing"), ("a.vrm", b"{}"), ("a.txt", b""), ("a.glb", b"glTF")]:
        (tmp_path / name).write_bytes(content)
        assert main(["inspect", str(tmp_path / name)]) == 2
        assert capsys.readouterr().err.count("\n") == 1
    assert main(["inspect", str(tmp_path / "missing.bvh")]) == 2


def test_gltf_rest_pose_and_animation(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    nodes = [{"name": "a", "children": [1]}, {"name": "b", "translation": [0, 2, 0]}]
    document: dict[str, Any] = {"asset": {"version": "2.0"}, "nodes": nodes}
    path = tmp_path / "m.gltf"
    path.write_text(json.dumps(document))
    assert main(["inspect", str(path), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["joints"] == ["a", "b"]
    assert result["frames"] == {"0": [[0, 0, 0], [0, 2, 0]]}
    data = struct.pack("<8f", 0, 1, 0, 2, 0, 0, 4, 0)
    (tmp_path / "m.bin").write_bytes(data)
    document |= {
        "buffers": [{"uri": "m.bin", "byteLength": 32}],
        "bufferViews": [{"buffer": 0, "byteLength": 32}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR"},
            {"bufferView": 0, "byteOffset": 8, "componentType": 5126, "count": 2, "type": "VEC3"},
        ],
        "animations": [
            {
                "samplers": [{"input": 0, "output": 1}],
                "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
            }
        ],
    }
    path.write_text(json.dumps(document))
    assert main(["inspect", str(path), "--frames", "0,15,30", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["frame_count"] == 31
    assert result["frame_time"] == pytest.approx(1 / 30)
    moving = [result["frames"][frame][1] for frame in ("0", "15", "30")]
    np.testing.assert_allclose(moving, [[0, 2, 0], [0, 3, 0], [0, 4, 0]])
    assert main(["inspect", str(path), "--animation", "1"]) == 2


def test_positions_agree_with_the_vectors(shared_data: Path, capsys: pytest.CaptureFixture[str]):
    for case in VECTORS[::4]:
        path = shared_data / case["file"]
        if not path.exists():
            continue
        frames = ",".join(case["frames"])
        assert main(["inspect", str(path), "--frames", frames, "--json"]) == 0
        result = json.loads(capsys.readouterr().out)
        assert result["joints"] == case["joints"]
        for frame, expected in case["frames"].items():
            height = np.ptp(np.array(expected), axis=0).max()
            np.testing.assert_allclose(result["frames"][frame], expected, atol=1e-6 * height)


def test_characters_show_their_bones_and_licence(shared_data: Path, capsys: pytest.CaptureFixture[str]):
    assert main(["inspect", str(shared_data / "vrm" / "Godette_vrm_v4.vrm")]) == 0
    text = capsys.readouterr().out
    for part in ("VRM 0.x", "licenseName=CC_BY", "hips=pelvis_Armature", "blinkLeft", "HairBall_L", "frame 0"):
        assert part in text


def test_the_module_says_how_to_use_it():
    assert "run_game.py inspect" in (inspect.__doc__ or "")


def test_a_figure_without_a_vrm_block_tells_what_an_avatar_needs(shared_data: Path, capsys: pytest.CaptureFixture[str]):
    assert main(["inspect", str(shared_data / "gltf_skin_morph" / "Fox.glb"), "--json"]) == 0
    fox = json.loads(capsys.readouterr().out)
    assert "no head" in fox["bones"]["not a person"]
    assert "PixelMannen" in fox["licence"]
    assert main(["inspect", str(shared_data / "gltf_skin_morph" / "facecap.glb"), "--json"]) == 0
    assert "eyeBlink_L" in json.loads(capsys.readouterr().out)["expressions"]
