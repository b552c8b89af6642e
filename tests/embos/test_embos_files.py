"""units.yaml, clips.npz and planner.yaml: what is written is read back; what is broken is refused in one line."""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from game.core import ASSETS, BadInput
from game.core.humanoid import REFERENCE
from game.embos import (
    ClipBank,
    MotionUnit,
    PlannerConfig,
    StressRule,
    TakeClip,
    UnitLibrary,
    Variant,
    clips,
    load_clips,
    load_config,
    pack_clips,
)  # fmt: skip
from game.embos.units_file import read_units, units_text

JOY = np.eye(7)[2]
GOOD = """\
version: 1
units:
  upright:
    layer: posture
    label: {en: upright, ja: 直立}
    uses: [legs]
    intensity: {joy: 0.5}
    duration_s: {joy: 3.5}
    waiting_s: {joy: 1.0}
    duration_cv: 0.2
    variants:
      - {take: joy, emotion: joy, start_s: 1.0, end_s: 3.0, clean: [1.5, 2.5]}
transitions:
  upright: {rest_gesture: 2}
"""


def take(frames: int = 30) -> TakeClip:
    rng = np.random.default_rng(1)
    turn = rng.normal(size=(frames, len(REFERENCE), 4))
    turn /= np.linalg.norm(turn, axis=-1, keepdims=True)
    return TakeClip(turn.astype(np.float32), rng.normal(size=(frames, 3)).astype(np.float32), 1 / 30)


def test_units_are_read_back_as_they_were_written(tmp_path: Path) -> None:
    units = [
        MotionUnit(
            "on", "gesture", 0.25 * JOY, 1.5 * JOY, 7.0 * JOY, 0.3, "deictic", {"en": "on", "ja": "なし: いや"},
            {"en": ("yes", "don't"), "ja": ("これ",)}, frozenset({"right_arm"}), frozenset({"gaze"}),
            {"right_hand": "table"}, False, (Variant(2, "joy", 1.0, 2.5, 1.0, 2.5, 1.75),),
        ),
        MotionUnit("upright", "posture", JOY, JOY, JOY, variants=(Variant(2, "joy", 0.0, 9.0, 2.0, 5.5),)),
    ]  # fmt: skip
    path = tmp_path / "units.yaml"
    path.write_text(units_text(units, {"on": {"rest_gesture": 3}}), "utf-8")
    read, transitions = read_units(path)
    assert transitions == {"on": {"rest_gesture": 3}}
    for old, new in zip(units, read, strict=True):
        for name in ("name", "layer", "duration_cv", "kind", "label", "words", "uses", "locks", "contacts", "variants"):
            assert getattr(old, name) == getattr(new, name), name
        for name in ("intensity", "duration_s", "waiting_s"):
            np.testing.assert_allclose(getattr(old, name), getattr(new, name))
    assert units_text(read, transitions) == path.read_text("utf-8")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("layer: posture", "layer: postures", r"units.yaml:4:12: expected posture \| gesture .*did you mean 'posture'"),
        ("joy: 0.5", "joy: 1.5", "units.yaml:7:22: .*from 0 to 1"),
        ("joy: 0.5", "jay: 0.5", "units.yaml:7:17: unknown key"),
        ("joy: 0.5", "joy: .nan", "units.yaml:7:22"),
        ("joy: 0.5", "joy: 0.5, joy: 0.6", "duplicate key"),
        ("uses: [legs]", "uses: [tail]", "units.yaml:6:12"),
        ("end_s: 3.0", "end_s: 0.5", "units.yaml:12:56: span: expected an end after its start at 1 s but saw 0.5$"),
        ("clean: [1.5, 2.5]", "clean: [0.5, 2.5]", "units.yaml:12:68: clean part: expected a stretch within 1 to 3 s"),
        ("version: 1", "version: 2", "version 1"),
        ("upright: {rest", "uptight: {rest", "units.yaml:14:3: unknown unit.*did you mean 'upright'"),
        ("    duration_cv: 0.2\n", "", "expected the key 'duration_cv'"),
        ("take: joy, emotion: joy", "take: joy, emotion: glee", "units.yaml:12:30"),
        ("variants:\n", "variants: &a\n", "anchor"),
        ("units:\n", "- units:\n", "YAML"),
    ],
)
def test_broken_units_are_refused_with_their_place(old: str, new: str, said: str, tmp_path: Path) -> None:
    assert old in GOOD
    path = tmp_path / "units.yaml"
    path.write_text(GOOD.replace(old, new), "utf-8")
    with pytest.raises(BadInput, match=said) as caught:
        read_units(path)
    assert "\n" not in str(caught.value)


def test_several_findings_are_counted(tmp_path: Path) -> None:
    path = tmp_path / "units.yaml"
    path.write_text(GOOD.replace("layer: posture", "layer: x").replace("upright: {", "uptight: {"), "utf-8")
    with pytest.raises(BadInput, match="and 1 more"):
        read_units(path)


def test_a_library_needs_postures_and_its_clips(tmp_path: Path) -> None:
    path = tmp_path / "units.yaml"
    path.write_text(GOOD.replace("layer: posture", "layer: gesture"), "utf-8")
    with pytest.raises(BadInput, match="at least one posture"):
        UnitLibrary.load(path)
    more = "".join(
        f"  {layer}: {{layer: {layer}, intensity: {{}}, duration_s: {{}}, waiting_s: {{}}, duration_cv: 0, "
        "variants: []}\n"
        for layer in ("gesture", "mannerism")
    )
    path.write_text(GOOD.replace("transitions:", more + "transitions:"), "utf-8")
    library = UnitLibrary.load(path)
    assert [u.name for u in library.units] == ["upright", "rest_gesture", "gesture", "rest_mannerism", "mannerism"]
    assert library.transition_counts("posture").tolist() == [[0.0]]
    (tmp_path / "clips.npz").write_bytes(pack_clips({"joy": take(60)}))
    with pytest.raises(BadInput, match="a span inside its clip"):
        UnitLibrary.load(path)
    (tmp_path / "clips.npz").write_bytes(pack_clips({"joy": take(90)}))
    assert len(UnitLibrary.load(path).clips) == 1


def test_clips_are_read_back_and_the_same_bytes_each_time(tmp_path: Path) -> None:
    bank = {"joy": take(), "anger": take(12)}
    path = tmp_path / "clips.npz"
    path.write_bytes(pack_clips(bank))
    assert path.read_bytes() == pack_clips(dict(reversed(bank.items())))
    read = load_clips(path)
    assert sorted(read) == ["anger", "joy"]
    np.testing.assert_allclose(read["joy"].rotation, bank["joy"].rotation, atol=1e-4)
    np.testing.assert_array_equal(read["joy"].root, bank["joy"].root)
    np.testing.assert_allclose(np.linalg.norm(read["joy"].rotation, axis=-1), 1.0, atol=1e-6)
    assert not read["joy"].rotation.flags.writeable


def _npz(path: Path, **arrays: np.ndarray) -> Path:
    buffer = io.BytesIO()
    np.savez(buffer, **{name.replace("__", "/"): array for name, array in arrays.items()})
    path.write_bytes(buffer.getvalue())
    return path


GOOD_TURN = np.full((4, len(REFERENCE), 4), 16384, dtype=np.int16)
GOOD_ROOT = np.zeros((4, 3), dtype=np.float32)
RATE = np.array(1 / 30)


@pytest.mark.parametrize(
    ("arrays", "said"),
    [
        ({"joy__rotation": GOOD_TURN[:, :40], "joy__root": GOOD_ROOT, "joy__frame_time": RATE}, "41"),
        ({"joy__rotation": GOOD_TURN, "joy__root": GOOD_ROOT[:3], "joy__frame_time": RATE}, "root"),
        ({"joy__rotation": GOOD_TURN, "joy__root": GOOD_ROOT * np.nan, "joy__frame_time": RATE}, "finite"),
        ({"joy__rotation": GOOD_TURN * 0, "joy__root": GOOD_ROOT, "joy__frame_time": RATE}, "unit quaternions"),
        ({"joy__rotation": GOOD_TURN.astype(float), "joy__root": GOOD_ROOT, "joy__frame_time": RATE}, "int16"),
        ({"joy__rotation": GOOD_TURN, "joy__root": GOOD_ROOT}, "joy/frame_time"),
        ({"joy__rotation": GOOD_TURN, "joy__root": GOOD_ROOT, "joy__frame_time": RATE * 0}, "frame time"),
        ({"joy__rotation": np.array([{}], dtype=object)}, "npz archive"),
    ],
)
def test_broken_clips_are_refused(arrays: dict[str, np.ndarray], said: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=said) as caught:
        load_clips(_npz(tmp_path / "clips.npz", **arrays))
    assert "clips.npz" in str(caught.value)


def test_no_archive_a_cut_archive_and_a_bomb_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "clips.npz"
    with pytest.raises(BadInput, match="analyse"):
        load_clips(path)
    path.write_bytes(pack_clips({"joy": take()})[:-60])
    with pytest.raises(BadInput, match="archive"):
        load_clips(path)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("joy/rotation.npy", b"\0" * 3_000_000)
    monkeypatch.setattr(clips, "MAX_BYTES", 2_000_000)
    with pytest.raises(BadInput, match="at most"):
        load_clips(path)


def test_planner_yaml_states_the_defaults_and_refuses_slips(tmp_path: Path) -> None:
    shipped = ASSETS / "motion" / "planner.yaml"
    config = load_config(shipped)
    assert replace(config, stress=StressRule(), radius=PlannerConfig().radius) == PlannerConfig()
    assert set(config.stress.units) <= set(UnitLibrary.load(ASSETS / "motion" / "units.yaml").index)
    path = tmp_path / "planner.yaml"
    text = shipped.read_text("utf-8")
    for old, new, said in (
        ("floor: 0.1", "flor: 0.1", "did you mean 'floor'"),
        ("steady: 0.5", "steady: 5", "planner.yaml:.*steady"),
        ("[posture, gesture, mannerism]", "[posture, gesture]", "each of"),
        ("least_s: {posture: 1.0,", "least_s: {posture: -1.0,", "planner.yaml:"),
        ("apart_s: 1.4", "apart_s: 1000", "planner.yaml:"),
        ("clear_s: 0.7", "clearing_s: 0.7", "did you mean 'clear_s'"),
    ):
        assert old in text
        path.write_text(text.replace(old, new), "utf-8")
        with pytest.raises(BadInput, match=said):
            load_config(path)


def test_units_refuse_what_is_out_of_range() -> None:
    for field, value in (("intensity", 2 * JOY), ("duration_s", -JOY), ("waiting_s", np.full(7, np.inf))):
        values = {"intensity": JOY, "duration_s": JOY, "waiting_s": JOY} | {field: value}
        with pytest.raises(BadInput, match=field):
            MotionUnit("x", "posture", **values)
    with pytest.raises(BadInput, match="layer"):
        MotionUnit("x", "dance", JOY, JOY, JOY)
    with pytest.raises(BadInput, match="body part"):
        MotionUnit("x", "posture", JOY, JOY, JOY, uses=frozenset({"tail"}))
    with pytest.raises(BadInput, match="unique names"):
        UnitLibrary([MotionUnit("x", layer, JOY, JOY, JOY) for layer in ("posture", "gesture", "mannerism")])


def test_variants_are_found_by_emotion_and_pick() -> None:
    spans = tuple(Variant(2, "joy", i, i + 1.0, i, i + 1.0) for i in range(4))
    units = [MotionUnit(layer, layer, JOY, JOY, JOY, variants=spans) for layer in ("posture", "gesture", "mannerism")]
    library = UnitLibrary(units, ClipBank())
    assert [library.variant(0, 2, pick).start_s for pick in (0.0, 0.3, 0.99, 1.0)] == [0, 1, 3, 3]
    assert library.variant(0, 1, 0.5) is None
    assert library.stroke_offset_s[library.index["gesture"]].tolist() == [0.5] * 7
