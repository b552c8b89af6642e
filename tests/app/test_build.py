"""build --check tells a real difference from another machine's last bits."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

from game.app.build import STEPS, differences
from game.app.cli import main
from game.core.paths import ASSETS
from game.render.assets import load_picture, save_png


@pytest.mark.parametrize(
    ("name", "old", "new", "differs"),
    [
        ("a.bvh", "Frame Time: 0.0333333\n1.2345 -90.001", "Frame Time: 0.0333333\n1.2346 -90.000", False),
        ("a.bvh", "Frame Time: 0.0333333\n1.2345 -90.001", "Frame Time: 0.0333333\n1.2345 -89.0", True),
        ("a.yaml", "fear: {joy: 0.5}", "fear: {joy: 0.5001}", False),
        ("a.yaml", "fear: {joy: 0.5}", "anger: {joy: 0.5}", True),
        ("a.yaml", "fear: [1, 2]", "fear: [1, 2, 3]", True),
    ],
)
def test_text_is_compared_by_its_words_and_numbers(tmp_path, name, old, new, differs) -> None:
    made, kept = tmp_path / f"made_{name}", tmp_path / f"kept_{name}"
    made.write_text(new, encoding="utf-8")
    kept.write_text(old, encoding="utf-8")
    assert (differences(made, kept) is not None) == differs


def test_arrays_are_compared_by_value(tmp_path) -> None:
    made, kept = tmp_path / "a.npz", tmp_path / "b.npz"
    np.savez(kept, root=np.zeros((4, 3), np.float32), rotation=np.full((4, 2, 4), 1000, np.int16))
    np.savez(made, root=np.full((4, 3), 1e-4, np.float32), rotation=np.full((4, 2, 4), 1010, np.int16))
    assert differences(made, kept) is None
    np.savez(made, root=np.full((4, 3), 1e-2, np.float32), rotation=np.full((4, 2, 4), 1000, np.int16))
    assert "root differs" in str(differences(made, kept))
    np.savez(made, root=np.zeros((5, 3), np.float32), rotation=np.full((4, 2, 4), 1000, np.int16))
    assert "another shape" in str(differences(made, kept))


def test_pictures_and_models_are_compared_by_what_they_show(tmp_path) -> None:
    backdrop = ASSETS / "stalls" / "flea_backdrop.png"
    pixels = load_picture(backdrop)[:64, :64].astype(np.int16)
    kept, near, far = (tmp_path / f"{name}.png" for name in ("kept", "near", "far"))
    for path, change in ((kept, 0), (near, 1), (far, 30)):
        save_png(path, np.clip(pixels + change, 0, 255).astype(np.uint8))
    assert differences(near, kept) is None
    assert "on average" in str(differences(far, kept))

    copy = tmp_path / "flea.glb"
    shutil.copyfile(ASSETS / "stalls" / "flea.glb", copy)
    assert differences(copy, ASSETS / "stalls" / "flea.glb") is None
    assert differences(ASSETS / "characters" / "mira.lod.glb", copy) is not None


def test_a_file_that_was_not_there_is_new(tmp_path) -> None:
    made = tmp_path / "x.yaml"
    made.write_text("a: 1", encoding="utf-8")
    assert differences(made, tmp_path / "missing.yaml") == "is new"


def test_every_generated_file_has_a_step_that_makes_it() -> None:
    generated = {".bvh", ".npz", ".vrm", ".glb"}
    folders = {folder for folder, _ in STEPS.values()}
    for path in ASSETS.rglob("*"):
        if path.suffix in generated:
            assert path.parent in folders, f"{path.relative_to(ASSETS)} is made by no step of build"


def test_an_unknown_step_is_refused(capsys) -> None:
    assert main(["build", "castle"]) == 2
    assert "compiled | takes | units | characters | stalls" in capsys.readouterr().err
