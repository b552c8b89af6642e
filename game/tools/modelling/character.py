"""A shopkeeper from its YAML: all parts modelled, bound and written as VRM with its levels of detail."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from game.tools.modelling.anatomy import Anatomy
from game.tools.modelling.clothes import Clothes
from game.tools.modelling.fields import Floats, smoothstep, unit
from game.tools.modelling.gltf import Gltf, material_json
from game.tools.modelling.hair import Hair
from game.tools.modelling.headband import Headband
from game.tools.modelling.legwear import Legwear
from game.tools.modelling.mesh import Mesh, joined
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.rig import Rig
from game.tools.modelling.spec import CharacterSpec, load_character
from game.tools.modelling.surface import sculpted
from game.tools.modelling.vrm import add_skeleton, humanoid_extension, spring_extension
from game.tools.modelling.weights import Binder

__all__ = ["LEVELS", "Character", "build_character"]

LEVELS = {40000: 0.43, 25000: 0.250, 15000: 0.143, 8000: 0.068}
"""Triangles of each level of detail (within a tenth) and the detail scale that gives them."""

_FACE_SQUARE_M = 0.340
"""Edge of the square the face is painted in (ART.md, "Face")."""
_BLANK_UV = (0.5, 0.02)


class Character:
    """The fields and fine meshes of one shopkeeper; ``parts`` takes any level of detail from them."""

    def __init__(self, spec: CharacterSpec) -> None:
        self.spec = spec
        self.anatomy = Anatomy.of(spec.head, spec.body, spec.hand)
        self.hair = Hair(spec.hair, spec.springs, self.anatomy.head_centre)
        self.band = Headband(spec.band, spec.springs["bow"], self.hair)
        self.clothes = Clothes(spec.clothes, self.anatomy, spec.springs["scarf"])
        self.legwear = Legwear(spec.clothes, self.anatomy)
        chains = (*self.band.chains.values(), *self.clothes.tails, *self.hair.tuft_chains, *self.hair.chains.values())
        self.rig = Rig.with_chains(chains)
        self.binder = Binder(self.rig, self.anatomy)
        self._head = sculpted(self.anatomy.head, (-0.21, 0.90, -0.20), (0.21, 1.42, 0.20), 0.0045)
        self._hand = sculpted(self.anatomy.hand, (0.24, 0.36, -0.075), (0.60, 0.82, 0.115), 0.0025)

    def hand_parts(self, detail: Detail) -> list[Part]:
        """Forearm and hand of both sides."""
        mesh = self._hand.mesh(detail.triangles(5600))
        left = Part("left_hand", "skin", mesh, self.binder.left_hand(mesh.position), 0.75)
        return [left, left.mirrored(self.rig.mirrored_columns())]

    def head_parts(self, detail: Detail) -> list[Part]:
        mesh = self._head.mesh(detail.triangles(8500))
        return [Part("head", "face", mesh, self.binder.head(mesh.position), 0.9)]

    def parts(self, detail: Detail) -> list[Part]:
        parts = self.head_parts(detail) + self.hand_parts(detail)
        parts += self.clothes.parts(self.binder, detail) + self.legwear.parts(self.binder, detail)
        return parts + self.hair.parts(self.binder, detail) + self.band.parts(self.binder, detail)


def build_character(yaml_path: Path, out_dir: Path) -> list[Path]:
    """Model the character of ``yaml_path``; write ``<id>.vrm`` (40,000 triangles) and ``<id>.lod.glb`` (the others).

    Deterministic: the same bytes on one machine. Raises BadInput where the YAML is wrong. -> the files written.
    """
    spec = load_character(yaml_path)
    character = Character(spec)
    main, levels = Gltf(), Gltf()
    finest, *coarser = LEVELS
    _write_levels(main, character, [finest])
    _write_levels(levels, character, coarser)
    main.root["extensions"] = {
        "VRMC_vrm": humanoid_extension(spec, character.rig),
        "VRMC_springBone": spring_extension(main, character.rig),
    }
    main.root["extensionsUsed"] = ["VRMC_vrm", "VRMC_springBone", "VRMC_materials_mtoon"]
    files = [out_dir / f"{spec.id}.vrm", out_dir / f"{spec.id}.lod.glb"]
    for gltf, file in zip((main, levels), files, strict=True):
        gltf.save(file)
    return files


def _write_levels(gltf: Gltf, character: Character, levels: Sequence[int]) -> None:
    """The skeleton, then one mesh node per level; the lowest is the depth-only shadow mesh."""
    add_skeleton(gltf, character.rig)
    scene = [0]
    toon = LEVELS.keys() >= set(levels) and levels[0] == next(iter(LEVELS))
    material_of: dict[str, int] = {}
    for level in levels:
        parts = character.parts(Detail(LEVELS[level]))
        if level == min(LEVELS):
            primitives, name = [_shadow_primitive(gltf, parts)], f"shadow{level // 1000}k"
            extras: dict[str, Any] = {"lod": level, "shadow": True}
        else:
            primitives = []
            for material in dict.fromkeys(part.material for part in parts):
                if material not in material_of:
                    material_of[material] = len(gltf.materials)
                    gltf.materials.append(material_json(material, character.spec.palette[material], toon=toon))
                members = [part for part in parts if part.material == material]
                primitive = _primitive(gltf, character, members)
                primitives.append(primitive | {"material": material_of[material]})
            name, extras = ("body" if toon else f"lod{level // 1000}k"), {"lod": level}
        gltf.meshes.append({"name": name, "primitives": primitives})
        scene.append(gltf.node(name=name, mesh=len(gltf.meshes) - 1, skin=0, extras=extras))
    gltf.root["scenes"] = [{"name": character.spec.id, "nodes": scene}]


def _primitive(gltf: Gltf, character: Character, parts: Sequence[Part]) -> dict[str, Any]:
    """One material's parts as a primitive with all vertex attributes of its shading class."""
    kind = character.spec.palette[parts[0].material].kind
    extra: dict[str, Floats] = {}
    if kind == "face":
        parts, extra = _face_attributes(character, parts)
    elif kind == "hair":
        extra = {"_HAIR": np.vstack([_hair_terms(character.hair, part.mesh) for part in parts])}
    mesh = joined([part.mesh for part in parts])
    joints, weights = _four_strongest(np.vstack([_weights_of(part) for part in parts]))
    outline = np.concatenate([np.full(len(part.mesh.position), part.outline) for part in parts])
    attributes = {
        "POSITION": gltf.vertices(mesh.position.astype(np.float32), bounds=True),
        "NORMAL": gltf.vertices(_unit_float32(mesh.normal)),
        "JOINTS_0": gltf.vertices(joints),
        "WEIGHTS_0": gltf.vertices(weights, normalized=True),
        "_OUTLINE": gltf.vertices(outline.astype(np.float32)),
    }
    for name, values in extra.items():
        attributes[name] = gltf.vertices(values.astype(np.float32))
    return {"attributes": attributes, "indices": gltf.indices(mesh.triangle, len(mesh.position))}


def _shadow_primitive(gltf: Gltf, parts: Sequence[Part]) -> dict[str, Any]:
    """Positions and weights only; _PUSH marks the head's skin, which steps back from the light."""
    parts = [part for part in parts if not part.trim]
    mesh = joined([part.mesh for part in parts])
    joints, weights = _four_strongest(np.vstack([_weights_of(part) for part in parts]))
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


def _unit_float32(normal: Floats) -> np.ndarray[Any, np.dtype[np.float32]]:
    """Unit normals; a degenerate one (the pole of a lathe) points up, as glTF demands length 1."""
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    safe = np.where(length > 1e-6, normal / np.maximum(length, 1e-6), (0.0, 1.0, 0.0))
    return np.asarray(safe.astype(np.float32))


def _four_strongest(weights: Floats) -> tuple[np.ndarray[Any, np.dtype[np.uint8]], np.ndarray[Any, np.dtype[np.uint8]]]:
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
