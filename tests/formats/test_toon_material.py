"""Materials of foreign avatars: the two MToons and PBR as one kind of data, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from game.core.errors import BadInput
from game.formats import Report, ToonMaterial, read_gltf, toon_materials
from game.formats.gltf_shape import LISTS


def materials_of(path: Path) -> dict[str, ToonMaterial]:
    file = read_gltf(path)
    report = Report(path, {name: len(file.json.get(name, [])) for name in LISTS})
    return {material.name: material for material in toon_materials(file, report)}


def test_mtoon_of_0x_becomes_that_of_1_0(shared_data: Path):
    """Values by hand from UniVRM's migration: shade shift −0.45 and toony 0.8 span −0.45 … −0.16."""
    body = materials_of(shared_data / "vrm" / "Godette_vrm_v4.vrm")
    face = body["Face"]
    assert face.kind == "mtoon"
    low, high = -0.45, 1.0 + (-0.45 - 1.0) * 0.8
    assert face.shift == pytest.approx(-0.5 * (low + high))
    assert face.toony == pytest.approx(0.5 * (2.0 - (high - low)))
    assert face.shade == pytest.approx([((v + 0.055) / 1.055) ** 2.4 for v in (0.827, 0.73595411, 0.85)])
    assert face.outline_mode == "screen"
    assert face.outline_width == pytest.approx(0.0025)
    assert face.lit_texture is not None
    assert face.lit_texture.image == 0
    assert body["GodotLogo"].kind == "unlit"
    assert body["GodotLogo"].alpha == "blend"
    assert body["GodotLogo"].double_sided
    assert body["GodotLogo"].lit_texture is not None
    assert body["GodotLogo"].lit_texture.nearest
    assert body["Backpack"].kind == "pbr"
    assert "PBR shown as toon" in body["Backpack"].notes


def test_alpha_modes_of_0x(shared_data: Path):
    found = materials_of(shared_data / "vrm" / "blender_mtoon1_2_20_61_vrm0.vrm")
    assert found["Opaque"].alpha == "opaque"
    assert found["Cutout"].alpha == "mask"
    assert found["TransparentWithZWrite"].alpha == "blend"
    assert found["TransparentWithZWrite"].writes_depth
    assert not found["Transparent"].writes_depth
    assert any("left out" in note for note in found["Opaque"].notes)


def _vrm1(extension: str) -> str:
    return (
        '{"asset": {"version": "2.0"}, "extensionsUsed": ["VRMC_materials_mtoon"],'
        f' "materials": [{{"name": "m", "extensions": {{"VRMC_materials_mtoon": {extension}}}}}]}}'
    )


def test_mtoon_1_0_is_read_as_written(tmp_path: Path):
    path = tmp_path / "m.gltf"
    path.write_text(
        _vrm1(
            '{"specVersion": "1.0", "shadeColorFactor": [0.1, 0.2, 0.3], "shadingShiftFactor": -0.2,'
            ' "shadingToonyFactor": 0.7, "outlineWidthMode": "worldCoordinates", "outlineWidthFactor": 0.004,'
            ' "parametricRimColorFactor": [1, 0, 0], "renderQueueOffsetNumber": 2}'
        )
    )
    (material,) = materials_of(path).values()
    assert (material.kind, material.shade, material.shift, material.toony) == ("mtoon", (0.1, 0.2, 0.3), -0.2, 0.7)
    assert (material.outline_mode, material.outline_width, material.queue) == ("world", 0.004, 2)
    assert material.rim == (1.0, 0.0, 0.0)


@pytest.mark.parametrize(
    "extension",
    [
        '{"shadeColorFactor": [0, 0]}',
        '{"shadingToonyFactor": 7}',
        '{"shadeMultiplyTexture": {"index": 3}}',
        '{"outlineWidthFactor": -1}',
        "[]",
    ],
)
def test_mtoon_out_of_bounds_is_refused_with_its_place(tmp_path: Path, extension: str):
    path = tmp_path / "m.gltf"
    path.write_text(_vrm1(extension))
    with pytest.raises(BadInput, match="/materials/0"):
        materials_of(path)
