"""Patterned clothes in the committed files: tiles of the size the YAML says, straight on the cloth, none torn."""

from __future__ import annotations

import numpy as np
import pytest

from game.core.errors import BadInput
from game.core.paths import ASSETS
from game.formats import load_yaml, read_gltf
from game.render.weave import ASPECT
from game.tools.modelling.spec import load_character
from game.tools.modelling.weave_spec import read_weaves

FOLDER = ASSETS / "characters"


@pytest.mark.parametrize("name", ["mira", "genzo", "daimon"])
def test_tiles_have_the_size_the_yaml_says_and_none_is_torn(name: str) -> None:
    spec = load_character(FOLDER / f"{name}.yaml")
    file = read_gltf(FOLDER / f"{name}.vrm")
    seen = set()
    for primitive in (p for mesh in file.meshes for p in mesh.primitives):
        material = file.materials[primitive.material]
        if "weave" not in material.extras:
            continue
        weave = spec.weaves[material.name]
        seen.add(material.name)
        assert material.extras["weave"] == {"motif": weave.motif, "strength": weave.strength}
        corner = primitive.indices.reshape(-1, 3)
        p, uv = primitive.attributes["POSITION"][corner], primitive.attributes["TEXCOORD_0"][corner]
        cloth = uv * (weave.size, weave.size * ASPECT[weave.motif])
        for a, b in ((0, 1), (1, 2), (2, 0)):
            on_cloth = np.linalg.norm(cloth[:, a] - cloth[:, b], axis=1)
            in_space = np.linalg.norm(p[:, a] - p[:, b], axis=1)
            # Seen straight on or aslant, never stretched but by the person's proportions; a torn tile would be long.
            assert (on_cloth <= 1.7 * in_space + 1e-3).all(), material.name
        area = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1)
        e, f = cloth[:, 1] - cloth[:, 0], cloth[:, 2] - cloth[:, 0]
        flat = np.abs(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0])
        assert flat.sum() > 0.55 * area.sum(), "the pattern lies flat on most of the cloth"
    assert seen == set(spec.weaves)


def test_a_weave_is_read_strictly(tmp_path) -> None:
    path = tmp_path / "p.yaml"
    for text, wanted in (
        ("coat: {motif: tartan, size: 0.1, strength: 0.1}", "herringbone"),
        ("cape: {motif: dots, size: 0.1, strength: 0.1}", "palette"),
        ("coat: {motif: dots, size: 9, strength: 0.1}", "0.5"),
    ):
        path.write_text(text)
        with pytest.raises(BadInput, match=wanted):
            read_weaves(load_yaml(path), {"coat": 1})
