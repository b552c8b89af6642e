"""BVH: conformance of positions, every dialect, writing, and one clear line for what is broken."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from game.core import BadInput, Clip
from game.core import quaternion as quat
from game.core.humanoid import REFERENCE
from game.formats import estimate_scale, read_bvh, to_metres, write_bvh

VECTORS: list[dict[str, Any]] = json.loads(
    Path(os.environ.get("MCG_CONFORMANCE_BVH") or Path(__file__).parents[1] / "data" / "bvh_fk.json").read_text("utf-8")
)

SMALL = """HIERARCHY
ROOT Hips
{
  OFFSET 0.0 1.0 0.0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Knee
  {
    OFFSET 0.0 -0.5 0.0
    CHANNELS 3 Yrotation Zrotation Xrotation
    End Site
    {
      OFFSET 0.0 -0.4 0.0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.0333333
0 1 0 10 20 30 40 50 60
.5 1.e0 -2.5E-1 0 0 0 0 0 0
"""


@pytest.fixture
def bvh(tmp_path: Path):
    """Write text (or bytes) as a file and read it."""

    def read(text: str | bytes, **limits: int):
        path = tmp_path / "take.bvh"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_bvh(path, **limits)

    return read


@pytest.mark.parametrize("case", VECTORS, ids=lambda case: Path(case["file"]).stem)
def test_world_positions_agree_with_the_independent_vectors(case: dict[str, Any], shared_data: Path):
    path = shared_data / case["file"]
    if not path.exists():
        pytest.skip(f"{case['file']} is not there")
    file = read_bvh(path)
    assert list(file.clip.skeleton.names) == case["joints"]
    assert len(file.clip) == case["rows"]
    assert file.declared_frames == case["declared_frames"]
    assert bool(file.findings) == (case["rows"] != case["declared_frames"])
    assert file.clip.frame_time_s == pytest.approx(case["frame_time"], rel=1e-9)
    for frame, expected in case["frames"].items():
        positions, _ = file.clip.to_model(np.array([int(frame)]))
        height = np.ptp(np.array(expected), axis=0).max()
        np.testing.assert_allclose(positions[0], expected, atol=1e-9 * height)


def test_all_neighbouring_files_can_be_read(shared_data: Path):
    paths = sorted(shared_data.glob("*/*.bvh"))
    assert paths
    # A slice of each folder keeps this quick; the conformance vectors cover the dialects one by one.
    for path in [*sorted((shared_data / "bvh_dialects").glob("*.bvh")), *paths[::8]]:
        clip = read_bvh(path).clip
        assert len(clip) > 0
        assert 0.2 < np.ptp(to_metres(clip).to_model(slice(0, 1))[0], axis=(0, 1)).max() < 3.0


def test_channels_apply_left_to_right_and_positions_replace_the_offset(bvh):
    clip = bvh(SMALL).clip
    np.testing.assert_allclose(clip.translation[1, 0], [0.5, 1.0, -0.25])
    expected = Rotation.from_euler("ZXY", [10, 20, 30], degrees=True)
    np.testing.assert_allclose(quat.to_matrix(clip.rotation[0, 0]), expected.as_matrix(), atol=1e-12)
    knee = Rotation.from_euler("YZX", [40, 50, 60], degrees=True)
    np.testing.assert_allclose(quat.to_matrix(clip.rotation[0, 1]), knee.as_matrix(), atol=1e-12)
    np.testing.assert_allclose(clip.to_model()[0][0, 1], [0, 1, 0] + expected.apply([0, -0.5, 0]), atol=1e-12)


@pytest.mark.parametrize(
    "change",
    [
        lambda t: t.replace("\n", "\r\n"),
        lambda t: t.replace("\n", "\r"),
        lambda t: t.replace("  ", "\t"),
        lambda t: t.rstrip("\n"),
        lambda t: "\ufeff" + t,
        lambda t: t.replace("Hips\n{", "Hips {").replace("Frames:", "Frames :").replace("Frame Time", "FRAME  TIME"),
        lambda t: t.replace("Xposition Yposition", "XPOSITION yposition").replace("End Site", "END SITE tip"),
        lambda t: t.replace("MOTION", "MOTION\n\n").replace("\n.5", "\n\n  \n.5") + "\n \n",
    ],
)
def test_dialects_of_one_file_read_alike(bvh, change):
    expected = bvh(SMALL)
    file = bvh(change(SMALL))
    np.testing.assert_array_equal(file.clip.rotation, expected.clip.rotation)
    np.testing.assert_array_equal(file.clip.translation, expected.clip.translation)
    assert list(file.end_sites) == ["Knee"]


@pytest.mark.parametrize("declared", [1, 3, 999999999])
def test_a_wrong_frame_count_is_a_finding(bvh, declared: int):
    file = bvh(SMALL.replace("Frames: 2", f"Frames: {declared}"))
    assert len(file.clip) == 2
    assert f"the header says {declared} frames but there are 2" in file.findings[0]


def test_names_are_made_unique(bvh):
    file = bvh(SMALL.replace("JOINT Knee", "JOINT Hips"))
    assert file.clip.skeleton.names == ("Hips", "Hips_2")
    assert "a second joint 'Hips'" in file.findings[0]
    file = bvh(SMALL.replace("JOINT Knee", "JOINT"))
    assert file.clip.skeleton.names == ("Hips", "joint_1")
    assert bvh(SMALL.replace("JOINT Knee", "JOINT left knee")).clip.skeleton.names[1] == "left knee"


@pytest.mark.parametrize(
    ("old", "new", "place", "message"),
    [
        ("HIERARCHY", "HIERARCHIE", ":1:1:", "expected HIERARCHY"),
        ("OFFSET 0.0 1.0 0.0", "OFFSET 0.0 1,0 0.0", ":4:14:", "decimal point"),
        ("OFFSET 0.0 1.0 0.0", "OFFSET 0.0 nan 0.0", ":4:14:", "expected a finite number but saw 'nan'"),
        ("OFFSET 0.0 1.0 0.0", "OFFSET 0.0 1.0", ":4:3:", "three numbers"),
        ("  OFFSET 0.0 1.0 0.0\n", "", ":14:1:", "has no OFFSET"),
        ("Zposition", "Wposition", ":5:34:", "unknown channel"),
        ("Zposition", "Xposition", ":5:34:", "given twice"),
        ("CHANNELS 3", "CHANNELS 4", ":9:5:", "4 channel names"),
        ("CHANNELS 3", "CHANNELS 99", ":9:14:", "at most 6 channels"),
        ("  }\n}\n", "  }\n", ":15:1:", "more '}' before MOTION"),
        ("  }\n}\n", "  }\n}\n}\n", ":16:1:", "'}' without its '{'"),
        ("MOTION", "", ":17:1:", "but saw 'Frames:'"),
        ("Frames: 2", "Frames: many", ":17:9:", "expected a number of frames"),
        ("Frames: 2", "Frames: -2", ":17:9:", "expected a number of frames"),
        ("0.0333333", "0", ":18:13:", "frame time"),
        ("0.0333333", "inf", ":18:13:", "finite number"),
        (" 40 50 60", " 40 50", ":19:21:", "expected 9 numbers in this row but saw 8"),
        (" 40 50 60", " 40 50 60 70", ":19:25:", "expected 9 numbers"),
        (" 40 50 60", " 40 nan 60", ":19:19:", "'nan'"),
        (" 40 50 60", " 40 1e999 60", ":19:19:", "1e999"),
        (" 40 50 60", " 40 1_0 60", ":19:19:", "1_0"),
        (" 40 50 60", " 40 1.2.3 60", ":19:19:", "1.2.3"),
        (" 0 0 0 0\n", " 0 0", ":20:", "cut off?"),
        ("JOINT Knee", "JOINT Kn\0ee", ":6:", "expected text"),
    ],
)
def test_broken_files_give_one_line_with_the_place(bvh, old: str, new: str, place: str, message: str):
    assert old in SMALL
    with pytest.raises(BadInput) as caught:
        bvh(SMALL.replace(old, new, 1) if old != " 0 0 0 0\n" else SMALL[: -len(" 0 0 0\n")])
    text = str(caught.value)
    assert f"take.bvh{place}" in text
    assert message in text
    assert "\n" not in text


def test_limits(bvh, tmp_path: Path):
    nested = "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\n" + "JOINT j\n{\nOFFSET 0 0 0\n" * 5000
    with pytest.raises(BadInput, match="more than 200 levels"):
        bvh(nested)
    flat = "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\n" + "JOINT j\n{\nOFFSET 0 0 0\n}\n" * 5000
    with pytest.raises(BadInput, match="more than 2000 joints"):
        bvh(flat)
    with pytest.raises(BadInput, match="at most 1 frames"):
        bvh(SMALL, max_frames=1)
    with pytest.raises(BadInput, match="at most 50 bytes"):
        bvh(SMALL, max_bytes=50)
    with pytest.raises(BadInput, match="at least one row"):
        bvh(SMALL[: SMALL.index("0 1 0 10")])
    with pytest.raises(BadInput, match="expected HIERARCHY"):
        bvh("\n" * 100_000 + "x")
    with pytest.raises(BadInput, match="expected MOTION"):
        bvh("")


def _random_clip(seed: int, frames: int = 9) -> Clip:
    rng = np.random.default_rng(seed)
    turns = np.cumsum(rng.normal(0, 0.15, (frames, len(REFERENCE), 3)), axis=0)
    translation = np.broadcast_to(REFERENCE.rest_translation, (frames, len(REFERENCE), 3)).copy()
    translation[:, 0] += rng.normal(0, 0.05, (frames, 3))
    return Clip(REFERENCE, 1 / 30, np.asarray(quat.exp(turns)), translation)


@pytest.mark.parametrize("order", ["ZXY", "XYZ", "YZX"])
def test_write_then_read_keeps_every_joint_in_place(tmp_path: Path, order: str):
    clip = _random_clip(3)
    path = tmp_path / "out.bvh"
    write_bvh(clip, path, order=order)
    again = read_bvh(path)
    assert again.findings == []
    assert sorted(again.clip.skeleton.names) == sorted(REFERENCE.names)
    assert again.clip.frame_time_s == pytest.approx(1 / 30, abs=1e-8)
    there = [again.clip.skeleton.index[name] for name in REFERENCE.names]
    np.testing.assert_allclose(again.clip.to_model()[0][:, there], clip.to_model()[0], atol=3e-5)
    assert {len(channels) for channels in again.channels} == {3, 6}
    write_bvh(again.clip, tmp_path / "twice.bvh", order=order, end_sites=again.end_sites)
    assert (tmp_path / "twice.bvh").read_bytes() == path.read_bytes()


def test_a_moving_joint_keeps_its_translation_and_angles_do_not_jump(tmp_path: Path):
    clip = _random_clip(5)
    translation = clip.translation.copy()
    translation[:, 7, 1] += np.linspace(0, 0.2, len(clip))
    turning = clip.rotation.copy()
    turning[:, 0] = quat.from_axis_angle([0, 1, 0], np.linspace(0, 3 * np.pi, len(clip)))
    path = tmp_path / "out.bvh"
    write_bvh(Clip(REFERENCE, 1 / 30, turning, translation), path)
    again = read_bvh(path).clip
    there = [again.skeleton.index[name] for name in REFERENCE.names]
    expected, _ = REFERENCE.to_model(turning, translation)
    np.testing.assert_allclose(again.to_model()[0][:, there], expected, atol=3e-5)
    rows = [list(map(float, line.split())) for line in path.read_text().split("Frame Time")[1].splitlines()[1:]]
    assert np.abs(np.diff(np.array(rows), axis=0)).max() < 180


def test_a_failed_write_leaves_nothing_behind(tmp_path: Path):
    with pytest.raises(BadInput, match="cannot write"):
        write_bvh(_random_clip(1), tmp_path / "missing" / "x.bvh")
    with pytest.raises(BadInput, match="order of X, Y and Z"):
        write_bvh(_random_clip(1), tmp_path / "x.bvh", order="XXY")
    assert list(tmp_path.iterdir()) == []


def test_scale_to_metres(bvh):
    clip = _random_clip(2)
    assert estimate_scale(clip) == 1.0
    in_centimetres = to_metres(clip, 100.0)
    assert estimate_scale(in_centimetres) == 0.01
    np.testing.assert_allclose(to_metres(in_centimetres).translation, clip.translation, atol=1e-12)


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_damaged_files_are_read_or_refused(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject):
    raw = bytearray(SMALL.encode())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, max(len(raw) - 1, 0)))
        kind = data.draw(st.sampled_from(["flip", "cut", "insert", "huge", "drop line"]))
        if kind == "flip" and raw:
            raw[at] = data.draw(st.integers(0, 255))
        elif kind == "cut":
            del raw[at + 1 :]
        elif kind == "insert":
            raw[at:at] = data.draw(st.binary(max_size=6))
        elif kind == "huge":
            raw[at : at + 1] = b" 99999999999999999999999 "
        else:
            end = raw.find(b"\n", at)
            del raw[at : end if end >= 0 else len(raw)]
    path = tmp_path_factory.getbasetemp() / "damaged.bvh"
    path.write_bytes(raw)
    try:
        clip = read_bvh(path).clip
    except BadInput as error:
        message = str(error)
    else:
        message = ""
        assert np.isfinite(clip.to_model()[0]).all()
    assert "\n" not in message
