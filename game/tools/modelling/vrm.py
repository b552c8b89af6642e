"""VRM 1.0 (VRMC_vrm, VRMC_springBone) around a rig: humanoid bones, meta, expressions, look-at, chains, colliders."""

from __future__ import annotations

from typing import Any

import numpy as np

from game.core.humanoid import HEAD_CENTRE_OFFSET, REFERENCE
from game.tools.modelling.face_atlas import COLUMNS, EXPRESSIONS, ROWS, cell_of, paint_atlas
from game.tools.modelling.gltf import Gltf, linear_rgb
from game.tools.modelling.proportions import Figure
from game.tools.modelling.rig import Rig
from game.tools.modelling.spec import CharacterSpec

__all__ = ["add_face_pictures", "add_skeleton", "humanoid_extension", "spring_extension", "use_picture"]

LICENSE_URL = "https://vrm.dev/licenses/1.0/"

_WHOLE_FACES = ("happy", "angry", "sad", "relaxed", "surprised")
"""Emotions are pictures of eyes and mouth together: nothing else may choose a cell meanwhile."""

# joint, offset from it, radius: what hair, bow and scarf must not sink into
_COLLIDERS = (
    ("head", tuple(HEAD_CENTRE_OFFSET + (0.0, 0.02, -0.010)), 0.150),
    ("neck", (0.0, 0.030, 0.0), 0.050),
    ("chest", (0.0, 0.060, 0.0), 0.100),
)


def add_skeleton(gltf: Gltf, rig: Rig) -> int:
    """Append the joints (T-pose, identity rotations) as nodes 0..J-1, the chain ends, and the skin; -> root node."""
    for joint, (name, parent) in enumerate(zip(rig.names, rig.parents, strict=True)):
        origin = rig.position[parent] if parent >= 0 else np.zeros(3)
        children = [i for i, p in enumerate(rig.parents) if p == joint]
        content: dict[str, Any] = {"name": name, "translation": _numbers(rig.position[joint] - origin)}
        if children:
            content["children"] = children
        gltf.node(**content)
    for chain in rig.chains:
        last = rig.index[chain.joints[-1]]
        end = gltf.node(name=chain.end, translation=_numbers(chain.points[-1] - chain.points[-2]))
        gltf.nodes[last].setdefault("children", []).append(end)
    inverse = np.linalg.inv(rig.bind)
    # glTF stores matrices by columns; the affine last row must be exact for validators.
    inverse[:, 3] = (0.0, 0.0, 0.0, 1.0)
    columns = inverse.transpose(0, 2, 1).astype(np.float32)
    gltf.root["skins"] = [
        {"joints": list(range(len(rig.names))), "skeleton": 0, "inverseBindMatrices": gltf.accessor(columns)}
    ]
    return 0


def add_face_pictures(gltf: Gltf, material: dict[str, Any], spec: CharacterSpec) -> None:
    """Give the face's material the atlas of expressions, at the neutral cell, on the lit and on the shaded side.

    The game ignores it and draws the vector face; other programs have no other face to show.
    """
    skin = material["extras"]["lit_srgb"]
    texture = gltf.picture(paint_atlas(skin, spec.face), "expressions")
    transform = {"offset": list(cell_of("neutral")), "scale": [1 / COLUMNS, 1 / ROWS]}
    use_picture(material, texture, transform)


def use_picture(material: dict[str, Any], texture: int, transform: dict[str, Any] | None = None) -> None:
    """Show a picture that already holds the material's lit colour, on its lit and on its shaded side."""
    use: dict[str, Any] = {"index": texture}
    if transform is not None:
        use["extensions"] = {"KHR_texture_transform": transform}
    material["pbrMetallicRoughness"]["baseColorTexture"] = use
    material["pbrMetallicRoughness"]["baseColorFactor"] = [1.0, 1.0, 1.0, 1.0]
    toon = material["extensions"]["VRMC_materials_mtoon"]
    toon["shadeMultiplyTexture"] = use
    # The factor is what remains from the lit colour to the shade.
    lit_srgb = material["extras"]["lit_srgb"]
    toon["shadeColorFactor"] = [
        round(min(shade / lit, 1.0), 6)
        for shade, lit in zip(toon["shadeColorFactor"], linear_rgb(lit_srgb), strict=True)
    ]


def _expression(name: str, face_material: int) -> dict[str, Any]:
    """A preset as a choice of the atlas' cell; binary, since half an offset would show half of two faces."""
    override = "block" if name in _WHOLE_FACES else "none"
    bind = {"material": face_material, "scale": [1 / COLUMNS, 1 / ROWS], "offset": list(cell_of(name))}
    return {
        "isBinary": True,
        "textureTransformBinds": [bind],
        "overrideBlink": override,
        "overrideLookAt": override,
        "overrideMouth": override,
    }


def humanoid_extension(spec: CharacterSpec, figure: Figure, face_material: int) -> dict[str, Any]:
    """VRMC_vrm: meta, humanoid bones, expressions, look-at. face_material: index of the face's material."""
    look_range = {"inputMaxValue": 90.0, "outputScale": 1.0}
    return {
        "specVersion": "1.0",
        "meta": {
            "name": spec.name,
            "version": "1",
            "authors": list(spec.authors),
            "licenseUrl": LICENSE_URL,
            "avatarPermission": "everyone",
            "allowExcessivelyViolentUsage": False,
            "allowExcessivelySexualUsage": False,
            "commercialUsage": "corporation",
            "allowPoliticalOrReligiousUsage": False,
            "allowAntisocialOrHateUsage": False,
            "creditNotation": "unnecessary",
            "allowRedistribution": True,
            "modification": "allowModificationRedistribution",
        },
        "humanoid": {"humanBones": {name: {"node": figure.rig.index[name]} for name in REFERENCE.names}},
        "firstPerson": {},
        "lookAt": {
            "offsetFromHeadBone": _numbers((HEAD_CENTRE_OFFSET + (0.0, -0.036, 0.10)) * figure.size_at("head")),
            "type": "expression",
            "rangeMapHorizontalInner": look_range,
            "rangeMapHorizontalOuter": look_range,
            "rangeMapVerticalDown": look_range,
            "rangeMapVerticalUp": look_range,
        },
        "expressions": {"preset": {name: _expression(name, face_material) for name in EXPRESSIONS}},
    }


def spring_extension(gltf: Gltf, figure: Figure) -> dict[str, Any]:
    """VRMC_springBone: one collider group per body part, one spring per chain."""
    rig = figure.rig
    where = {node.get("name"): i for i, node in enumerate(gltf.nodes)}
    springs = []
    group_of = {joint: k for k, (joint, _, _) in enumerate(_COLLIDERS)}
    for chain in rig.chains:
        joints = [
            {
                "node": where[name],
                "hitRadius": chain.hit_radius_m,
                "stiffness": chain.stiffness,
                "gravityPower": chain.gravity,
                "gravityDir": [0.0, -1.0, 0.0],
                "dragForce": chain.drag,
            }
            for name in (*chain.joints, chain.end)
        ]
        spring: dict[str, Any] = {"name": chain.name, "joints": joints}
        if chain.colliders:
            spring["colliderGroups"] = [group_of[joint] for joint in chain.colliders]
        springs.append(spring)
    return {
        "specVersion": "1.0",
        "colliders": [_collider(figure, joint, at, radius) for joint, at, radius in _COLLIDERS],
        "colliderGroups": [{"name": joint, "colliders": [k]} for k, (joint, _, _) in enumerate(_COLLIDERS)],
        "springs": springs,
    }


def _collider(figure: Figure, joint: str, at: tuple[float, ...], radius: float) -> dict[str, Any]:
    size = figure.size_at(joint)
    sphere = {"offset": _numbers(np.asarray(at) * size), "radius": round(float(radius * size.mean()), 6)}
    return {"node": figure.rig.index[joint], "shape": {"sphere": sphere}}


def _numbers(values: Any) -> list[float]:
    """Rounded to a hundredth of a millimetre, so that the file reads well and repeats exactly."""
    return [round(float(v), 6) + 0.0 for v in values]
