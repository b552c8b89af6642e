"""A foreign avatar on the GPU: its textures, its expressions, its outlines; and nothing of it is left behind."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from game.formats import Report, join_meshes, picture_size, read_gltf, toon_materials
from game.formats.gltf_shape import LISTS
from game.render import Camera, Device, FrameView, Renderer
from game.render.avatar_model import AvatarLook, AvatarModel, build_avatar

FACE = Camera((0.0, 1.42, -1.6), (0.0, 1.38, 0.0), 22.0)
"""0.x faces −Z; in the file's own space the customer stands there."""


@pytest.fixture(scope="module")
def godette(shared_data: Path) -> AvatarModel:
    path = shared_data / "vrm" / "Godette_vrm_v4.vrm"
    file = read_gltf(path)
    report = Report(path, {name: len(file.json.get(name, [])) for name in LISTS})
    materials = toon_materials(file, report)
    return build_avatar("godette", file, join_meshes(file, materials), materials, 1.0)


@pytest.fixture
def view(godette: AvatarModel, shared_data: Path) -> FrameView:
    file = read_gltf(shared_data / "vrm" / "Godette_vrm_v4.vrm")
    matrices = file.node_model[list(godette.geometry.column_node)] @ godette.geometry.inverse_bind
    return FrameView(matrices.astype(np.float32), camera=FACE, look=godette.still(), show_stall=False)


@pytest.fixture
def drawn(device: Device, godette: AvatarModel) -> Iterator[Renderer]:
    made = Renderer(device, godette)
    yield made
    made.release()


def shot(renderer: Renderer, view: FrameView) -> np.ndarray:
    renderer.draw(view)
    return renderer.read_pixels().astype(int)


def test_textures_and_hair_are_where_they_belong(drawn: Renderer, view: FrameView):
    pixels = shot(drawn, view)
    blue = (pixels[..., 2] > pixels[..., 0] + 60) & (pixels[..., 2] > 120)
    skin = (pixels[..., 0] > 200) & (pixels[..., 1] > 150) & (pixels[..., 0] > pixels[..., 2] + 10)
    assert blue.sum() > 2000, "blue hair"
    assert skin.sum() > 2000, "a face"
    assert np.flatnonzero(blue.any(axis=1)).min() < np.flatnonzero(skin.any(axis=1)).max(), "hair on top"


def test_an_expression_moves_the_face_and_only_it(drawn: Renderer, view: FrameView, godette: AvatarModel):
    before = shot(drawn, view)
    morph = np.zeros(len(godette.moved), np.float32)
    morph[godette.slots[0, 14]] = 1.0
    changed = np.abs(shot(drawn, FrameView(**{**view.__dict__, "look": AvatarLook(morph, {}, {})})) - before)
    moved = changed.max(axis=-1) > 20
    assert 30 < moved.sum() < 0.05 * moved.size
    again = shot(drawn, view)
    assert np.abs(again - before).max() == 0


def test_an_expression_can_tint_a_material(drawn: Renderer, view: FrameView, godette: AvatarModel):
    before = shot(drawn, view)
    face = next(i for i, m in enumerate(godette.materials) if m.name == "Face")
    red = AvatarLook(view.look.morph, {(face, "lit"): (1.0, 0.1, 0.1, 1.0)}, {})  # type: ignore[union-attr]
    after = shot(drawn, FrameView(**{**view.__dict__, "look": red}))
    assert (after[..., 1] < before[..., 1] - 40).sum() > 2000


def test_pictures_are_measured_before_they_are_opened():
    png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + (640).to_bytes(4, "big") + (480).to_bytes(4, "big")
    assert picture_size(png) == (640, 480)
    jpeg = bytes.fromhex("ffd8ffe000104a46494600010100000100010000ffc0000b080102030401011100")
    assert picture_size(jpeg) == (0x0304, 0x0102)
    for broken in (b"", b"GIF89a", b"\xff\xd8", b"\xff\xd8\xff\xe0\0\0" * 9, png[:20]):
        assert picture_size(broken) is None
