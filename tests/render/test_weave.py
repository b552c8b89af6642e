"""Patterns of cloth and planes of faces: tiles that meet, maps that darken the right side, and both in the picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.core import ASSETS
from game.face import DEFAULT_STYLE
from game.render import CharacterModel, Device, FrameView, Renderer, level_named, load_character
from game.render.face_planes import PLANES_PX, face_planes
from game.render.weave import MOTIFS, REACH, weave_distance, weave_tiles


@pytest.mark.parametrize("motif", MOTIFS)
def test_a_motif_repeats_without_a_seam_and_covers_some_of_its_tile(motif: str) -> None:
    d = np.clip(weave_distance(motif), -REACH, REACH)
    # From the last column over the edge to the first is one more step like those within.
    for axis in (0, 1):
        steps = np.abs(np.diff(d, axis=axis)).max()
        seam = np.abs(np.take(d, 0, axis) - np.take(d, -1, axis)).max()
        assert seam <= 1.05 * steps + 1e-9
    assert 0.05 < (d > 0).mean() < 0.62
    assert weave_tiles().shape == (len(MOTIFS), 64, 64)


def test_the_light_ends_on_a_face_where_planes_do() -> None:
    """x to the shaded side: the nose's triangle, the face's side and the lip go dark early, the far cheek late."""
    planes = face_planes(DEFAULT_STYLE).astype(int) - 128

    def at(x_mm: float, y_mm: float) -> int:
        return int(planes[int((140 - y_mm) / 340 * PLANES_PX), int((x_mm + 170) / 340 * PLANES_PX)])

    assert at(6, -75) < -60 < at(-12, -75)
    assert at(115, -60) < -20 < at(-115, -60)
    assert at(0, DEFAULT_STYLE.mouth_y - 19) < -40
    assert at(DEFAULT_STYLE.eye_x - 5, -88) > 10
    assert at(-60, 30) == at(0, 40) == 0, "the brow is left alone"
    lower = face_planes(replace(DEFAULT_STYLE, nose_y=-20.0)).astype(int) - 128
    assert lower[int(235 / 340 * PLANES_PX), int(176 / 340 * PLANES_PX)] < -60, "it follows the person's own nose"


@pytest.mark.gl
def test_clothes_are_patterned_and_the_face_has_planes(device: Device, model, skin_matrices) -> None:
    renderer = Renderer(device, model)
    view = FrameView(skin_matrices, show_stall=False)

    def shot(shown: CharacterModel, level: str = "default") -> np.ndarray:
        renderer.level = level_named(level)
        renderer.set_stage(shown, None, None)
        renderer.draw(view)
        return renderer.read_pixels().astype(int)

    try:
        woven, flat = shot(model), shot(replace(model, planes=np.full((4, 4), 128, np.uint8)))
        plain = shot(model, "low")
    finally:
        renderer.release()
    faces = np.argwhere(np.abs(woven - flat).max(axis=2) > 12)
    assert len(faces) > 40, "planes show on the face"
    assert (faces[:, 0].min(), faces[:, 0].max()) > (60, 0)
    assert faces[:, 0].max() < 200
    mesh = model.mesh(40_000)
    strengths = {round(float(s), 2) for s in np.unique(mesh.extra[mesh.triangle[_of(mesh, "woven")], 3])}
    assert strengths == {0.20, 0.22, -0.12}, "coat, scarf and trousers, as the YAML says"
    coat = (woven[..., 2] > woven[..., 0] + 40) & (plain[..., 2] > plain[..., 0] + 40)
    assert woven[coat].std() > plain[coat].std() + 0.5, "the hemp leaf shows on the coat"


def _of(mesh, kind: str) -> np.ndarray:
    return np.concatenate([np.arange(r.first, r.first + r.count) // 3 for r in mesh.runs if r.kind == kind])


def test_every_shopkeeper_wears_a_pattern_of_their_own() -> None:
    worn = {}
    for name in ("genzo", "daimon"):
        mesh = load_character(ASSETS / "characters" / f"{name}.vrm").mesh(15_000)
        extra = mesh.extra[mesh.triangle[_of(mesh, "woven")]].reshape(-1, 4)
        worn[name] = {list(MOTIFS)[int(motif)] for motif in np.unique(extra[:, 2])}
    assert worn == {"genzo": {"leaves", "herringbone", "twill"}, "daimon": {"knit", "twill", "herringbone"}}
