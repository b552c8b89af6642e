"""Writing a character: ``<id>.vrm`` with the finest level of detail, ``<id>.lod.glb`` with the others.

Vertex attributes beyond glTF's own: _OUTLINE (width of the ink line, 0 = none), _FACE (face-texture mask, cast-shadow
fade), _HAIR (azimuth and height term of the highlight ring), _PUSH (head skin of the shadow mesh).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.tools.modelling.character import Character
from game.tools.modelling.fields import Floats, smoothstep, unit
from game.tools.modelling.gltf import Gltf, material_json, unit_normals
from game.tools.modelling.hair import Hair
from game.tools.modelling.mesh import Mesh, joined
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.spec import CharacterSpec, load_character
from game.tools.modelling.vrm import add_face_pictures, add_skeleton, humanoid_extension, spring_extension, use_picture
from game.tools.modelling.weave_spec import Weave
from game.tools.modelling.weaving import cut, tile_picture

__all__ = ["LEVELS", "build_character"]

LEVELS: Mapping[int, float] = {40000: 0.43, 25000: 0.250, 15000: 0.133, 8000: 0.067}
"""Triangles of each level of detail (within a tenth), finest first, and the detail scale that gives them."""
_FINEST, _SHADOW = max(LEVELS), min(LEVELS)

_BUDGET_SLACK = 0.08
_BUDGET_ROUNDS = 6

_FACE_SQUARE_M = 0.340
"""Edge of the square the face is painted in (ART.md, "Face")."""
_BLANK_UV = (0.5, 0.96)
"""A place on the face texture that is never painted."""


def build_character(yaml_path: Path, out_dir: Path, *, draft: bool = False) -> list[Path]:
    """Model the character of ``yaml_path`` and write its two files. -> their paths.

    draft: one level of detail and no pictures of the face for other programs, in half the time.

    Deterministic: the same bytes on one machine. Raises BadInput where the YAML is wrong.
    """
    spec = load_character(yaml_path)
    character = Character(spec)
    main, others = Gltf(), Gltf()
    coarser = [_SHADOW] if draft else [level for level in LEVELS if level != _FINEST]
    _write_levels(main, character, [_FINEST], toon=True)
    _write_levels(others, character, coarser, toon=False)
    face = next(i for i, material in enumerate(main.materials) if material["extras"]["class"] == "face")
    if not draft:
        add_face_pictures(main, main.materials[face], spec)
    main.root["extensions"] = {
        "VRMC_vrm": humanoid_extension(spec, character.figure, face),
        "VRMC_springBone": spring_extension(main, character.figure),
    }
    main.root["extensionsUsed"] = [
        "VRMC_vrm",
        "VRMC_springBone",
        "VRMC_materials_mtoon",
        *(() if draft else ("KHR_texture_transform",)),
    ]
    files = [out_dir / f"{spec.id}.vrm", out_dir / f"{spec.id}.lod.glb"]
    for gltf, file in zip((main, others), files, strict=True):
        gltf.save(file)
    return files


def _write_levels(gltf: Gltf, character: Character, levels: Sequence[int], *, toon: bool) -> None:
    """The skeleton, then one mesh node per level; the lowest is the depth-only shadow mesh."""
    scene = [add_skeleton(gltf, character.figure.rig)]
    material_of: dict[str, int] = {}
    for level in levels:
        parts = _parts_of_level(character, level)
        extras: dict[str, Any] = {"lod": level}
        if level == _SHADOW:
            name, primitives = f"shadow{level // 1000}k", [_shadow_primitive(gltf, character, parts)]
            extras["shadow"] = True
        else:
            name, primitives = "body" if level == _FINEST else f"lod{level // 1000}k", []
            for material in dict.fromkeys(part.material for part in parts):
                if material not in material_of:
                    material_of[material] = len(gltf.materials)
                    gltf.materials.append(_material(gltf, character.spec, material, toon=toon))
                primitive = _primitive(gltf, character, [part for part in parts if part.material == material])
                primitives.append(primitive | {"material": material_of[material]})
        gltf.meshes.append({"name": name, "primitives": primitives})
        scene.append(gltf.node(name=name, mesh=len(gltf.meshes) - 1, skin=0, extras=extras))
    gltf.root["scenes"] = [{"name": character.spec.id, "nodes": scene}]


def _material(gltf: Gltf, spec: CharacterSpec, name: str, *, toon: bool) -> dict[str, Any]:
    """A material; a patterned one says its motif in ``extras.weave`` and, for other programs, has it as a texture."""
    swatch = spec.palette[name]
    material = material_json(name, swatch, toon=toon)
    weave = spec.weaves.get(name)
    if weave is not None:
        material["extras"]["weave"] = {"motif": weave.motif, "strength": weave.strength}
        if toon:
            use_picture(material, gltf.picture(tile_picture(weave, swatch.lit), f"weave_{name}", repeat=True))
    return material


def _woven_attributes(
    character: Character, parts: Sequence[Part], weave: Weave
) -> tuple[list[Part], dict[str, Floats]]:
    """Cloth with vertices doubled along its seams, and where each lies on the cloth, in tiles."""
    pieces = [cut(part, weave, character.rig, character.anatomy.arm) for part in parts]
    return [part for part, _ in pieces], {"TEXCOORD_0": np.vstack([uv for _, uv in pieces])}


def _parts_of_level(character: Character, level: int) -> list[Part]:
    """The parts at the detail that gives the level's triangles: clothes of other persons have other shares."""
    scale = LEVELS[level]
    for _ in range(_BUDGET_ROUNDS):
        parts = character.parts(Detail(scale))
        count = sum(len(part.mesh.triangle) for part in parts)
        if abs(count - level) <= _BUDGET_SLACK * level:
            break
        scale *= level / count
    return parts


def _primitive(gltf: Gltf, character: Character, parts: Sequence[Part]) -> dict[str, Any]:
    """One material's parts as a primitive with all vertex attributes of its shading class."""
    material = parts[0].material
    kind = character.spec.palette[material].kind
    extra: dict[str, Floats] = {}
    if kind == "face":
        parts, extra = _face_attributes(character, parts)
    elif material in character.spec.weaves:
        parts, extra = _woven_attributes(character, parts, character.spec.weaves[material])
    elif kind == "hair":
        extra = {"_HAIR": np.vstack([_hair_terms(character.hair, part.mesh) for part in parts])}
    everything = np.vstack([_weights_of(part) for part in parts])
    mesh = character.figure.stretched(joined([part.mesh for part in parts]), everything)
    joints, weights = _four_strongest(everything)
    outline = np.concatenate([np.full(len(part.mesh.position), part.outline) for part in parts])
    attributes = {
        "POSITION": gltf.vertices(mesh.position.astype(np.float32), bounds=True),
        "NORMAL": gltf.vertices(unit_normals(mesh.normal)),
        "JOINTS_0": gltf.vertices(joints),
        "WEIGHTS_0": gltf.vertices(weights, normalized=True),
        "_OUTLINE": gltf.vertices(outline.astype(np.float32)),
    }
    for name, values in extra.items():
        attributes[name] = gltf.vertices(values.astype(np.float32))
    return {"attributes": attributes, "indices": gltf.indices(mesh.triangle, len(mesh.position))}


def _shadow_primitive(gltf: Gltf, character: Character, parts: Sequence[Part]) -> dict[str, Any]:
    """Positions and weights only; _PUSH marks the head's skin, which steps back from the light."""
    parts = [part for part in parts if not part.trim]
    everything = np.vstack([_weights_of(part) for part in parts])
    mesh = character.figure.stretched(joined([part.mesh for part in parts]), everything)
    joints, weights = _four_strongest(everything)
    push = np.concatenate([np.full(len(part.mesh.position), float(part.name == "head")) for part in parts])
    attributes = {
        "POSITION": gltf.vertices(mesh.position.astype(np.float32), bounds=True),
        "JOINTS_0": gltf.vertices(joints),
        "WEIGHTS_0": gltf.vertices(weights, normalized=True),
        "_PUSH": gltf.vertices(push.astype(np.float32)),
    }
    return {"attributes": attributes, "indices": gltf.indices(mesh.triangle, len(mesh.position))}


def _weights_of(part: Part) -> Floats:
    assert part.weights is not None
    return part.weights


def _four_strongest(weights: Floats) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """(n, J) weights -> joint indices and weights of 255 (n, 4) uint8; every row of weights sums to 255."""
    joint = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    value = np.take_along_axis(weights, joint, 1)
    value = np.round(value / value.sum(1, keepdims=True) * 255).astype(np.int64)
    value[:, 0] += 255 - value.sum(1)
    joint = np.where(value > 0, joint, 0)
    return joint.astype(np.uint8), value.astype(np.uint8)


def _face_attributes(character: Character, parts: Sequence[Part]) -> tuple[list[Part], dict[str, Floats]]:
    """Head skin: its normals bent to a sphere, the planar face projection, and the two masks of the face shader."""
    (head,) = parts
    mesh = head.mesh
    local = mesh.position - character.anatomy.head_centre
    ball = unit(local - (0.0, -0.01, -0.09))
    front = np.clip((local[:, 2] - 0.02) / 0.06, 0, 1) * np.clip((mesh.position[:, 1] - 1.04) / 0.05, 0, 1)
    normal = unit(mesh.normal * (1 - 0.90 * front[:, None]) + ball * (0.90 * front[:, None]))
    uv = np.stack([local[:, 0] + 0.170, 0.140 - local[:, 1]], 1) / _FACE_SQUARE_M
    painted = smoothstep(0.05, 0.25, mesh.normal[:, 2]) * (local[:, 2] > 0.015) * ((uv > 0) & (uv < 1)).all(1)
    lit = smoothstep(0.045, 0.015, local[:, 1]) * smoothstep(0.02, 0.06, local[:, 2])
    lit *= smoothstep(-0.175, -0.15, local[:, 1])

    # Triangles off the painted front take their uv from a blank spot, through vertices of their own.
    blank = ~(painted[mesh.triangle] > 0).any(1)
    kept, kept_from = Mesh(mesh.position, normal, mesh.triangle).compacted(mesh.triangle[~blank])
    rest, rest_from = Mesh(mesh.position, normal, mesh.triangle).compacted(mesh.triangle[blank])
    weights = _weights_of(head)
    attributes = {
        "TEXCOORD_0": np.vstack([uv[kept_from], np.tile(_BLANK_UV, (len(rest_from), 1))]),
        "_FACE": np.stack([painted, lit], 1)[np.r_[kept_from, rest_from]],
    }
    both = replace(head, mesh=joined([kept, rest]), weights=weights[np.r_[kept_from, rest_from]])
    return [both], attributes


def _hair_terms(hair: Hair, mesh: Mesh) -> Floats:
    """(n, 2): azimuth about the skull (unwrapped within the part), and the highlight's height term (ART.md)."""
    local = mesh.position - hair.centre
    middle = local.mean(0)
    centre = np.arctan2(middle[0], middle[2])
    azimuth = centre + (np.arctan2(local[:, 0], local[:, 2]) - centre + np.pi) % (2 * np.pi) - np.pi
    skull = unit(local / hair.radii)
    return np.stack([azimuth, unit(skull * 0.48 + mesh.normal * 0.52)[:, 1]], 1)
