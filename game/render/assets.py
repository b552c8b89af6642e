"""From asset files to render meshes: characters (.vrm with .lod.glb), stalls (.glb), pictures (.png)."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pygame.image
import pygame.surfarray
from numpy.typing import NDArray

from game.core.errors import BadInput, Where
from game.formats import GltfFile, GltfMaterial, GltfNode, GltfPrimitive, picture_size, read_gltf
from game.formats.files import read_bytes
from game.render.model import (
    KINDS,
    CharacterMesh,
    CharacterModel,
    Material,
    Part,
    ShadowMesh,
    StaticMesh,
    WhenAsked,
    merge_character,
    merge_static,
    on_legs,
)
from game.render.mood import MARKET_MOOD, Mood
from game.render.moving import Motion, hanging_bulbs, moving_meshes, read_motion
from game.render.strands import strand_terms
from game.render.weave import MOTIFS

_MAX_BYTES, _MAX_PIXELS = 256_000_000, 128_000_000  # of a picture; 16 frames of 3840×2160 in a strip
_LEG = re.compile(r"(Leg|Foot|Toes)$")  # joints whose vertices a table hides

__all__ = ["character_parts", "encode_picture", "load_character", "load_picture", "load_stall", "save_png"]


def load_character(vrm: Path) -> CharacterModel:
    """Read ``<id>.vrm`` and, beside it, ``<id>.lod.glb`` with the coarser meshes and the shadow mesh.

    A level of detail is put together when it is first asked for: a game draws one of them.

    Raises BadInput where a file is unreadable, or lacks what the renderer needs.
    """
    makers: dict[int, Callable[[], CharacterMesh]] = {}
    shadow: ShadowMesh | None = None
    joint_count = head = 0
    for path in (vrm, vrm.with_suffix("").with_suffix(".lod.glb")):
        file = read_gltf(path)
        if not file.skins:
            raise BadInput("character", where=Where(path), expected="a skin", seen="none")
        joint_count = len(file.skins[0].joints)
        names = [file.nodes[node].name for node in file.skins[0].joints]
        head = names.index("head") if "head" in names else 0
        legs = [i for i, name in enumerate(names) if _LEG.search(name)]
        for node, extras in _mesh_nodes(file):
            primitives = _primitives(file, node)
            if extras.get("shadow"):
                shadow = _shadow_mesh(primitives[0], legs)
            else:
                parts = [_part(file, primitive, "body") for primitive in primitives]
                makers[int(extras.get("lod", 40_000))] = partial(merge_character, parts, joint_count, legs)
    if shadow is None or not makers:
        missing = "a mesh" if not makers else "a node with extras.shadow in its .lod.glb"
        raise BadInput("character", where=Where(vrm), expected=missing, seen="none")
    return CharacterModel(vrm.stem, WhenAsked(makers), shadow, joint_count, head)


def character_parts(vrm: Path) -> list[Part]:
    """The parts of the coarsest level of detail beside ``<id>.vrm``. Raises BadInput."""
    path = vrm.with_suffix("").with_suffix(".lod.glb")
    file = read_gltf(path)
    levels = {
        int(extras["lod"]): node for node, extras in _mesh_nodes(file) if "lod" in extras and not extras.get("shadow")
    }
    if not levels or not file.skins:
        raise BadInput("character", where=Where(path), expected="a level of detail with a skin", seen="none")
    return [_part(file, primitive, "body") for primitive in _primitives(file, levels[min(levels)])]


def load_stall(path: Path, mood: Mood = MARKET_MOOD) -> StaticMesh:
    """Read a stall's .glb: one node per group, items with their anchor, what sways with its pivots. Raises BadInput."""
    file = read_gltf(path)
    parts: list[Part] = []
    anchors: dict[str, tuple[float, float, float]] = {}
    things: list[tuple[Part, Motion, NDArray[np.floating[Any]]]] = []
    for node, extras in _mesh_nodes(file):
        group = str(extras.get("group", node.name))
        if "anchor" in extras:
            x, y, z = (float(v) for v in extras["anchor"])
            anchors[group] = (x, y, z)
        motion = read_motion(extras, Where(path, pointer=f"/nodes/{file.node_index.get(node.name, 0)}/extras"))
        for primitive in _primitives(file, node):
            part = _part(file, primitive, group)
            bulbs = hanging_bulbs(part) if motion is None else None
            if bulbs is not None:
                things.append(bulbs)
            elif motion is not None and "_PIVOT" in primitive.attributes:
                things.append((part, motion, _floats(primitive.attributes["_PIVOT"])))
            else:
                parts.append(part)
    return replace(merge_static(parts, anchors, moving_meshes(things)), mood=mood)


def load_picture(path: Path) -> NDArray[np.uint8]:
    """A PNG or JPEG file as (h, w, 3) uint8, first row at the top. Raises BadInput; a huge one is never unpacked."""
    data = read_bytes(path, max_bytes=_MAX_BYTES, what="picture")
    width, height = picture_size(data) or (0, 0)
    if not 0 < width * height <= _MAX_PIXELS:
        raise BadInput("picture", where=Where(path), expected=f"a PNG or JPEG of at most {_MAX_PIXELS} pixels",
                       seen=f"{width}×{height}" if width else "something else")  # fmt: skip
    try:
        surface = pygame.image.load(io.BytesIO(data), "x.png" if data.startswith(b"\x89PNG") else "x.jpg")
    except (pygame.error, OSError, ValueError, SystemError) as error:
        raise BadInput(f"unreadable picture: {error}", where=Where(path)) from error
    pixels = np.frombuffer(pygame.image.tobytes(surface, "RGB"), dtype=np.uint8)
    return pixels.reshape(surface.get_height(), surface.get_width(), 3)


def save_png(path: Path, pixels: NDArray[np.uint8]) -> None:
    """Write (h, w, 3) uint8 pixels as a PNG file. Raises OSError where there is no room for it."""
    path.write_bytes(encode_picture(pixels, "png"))


def encode_picture(pixels: NDArray[np.uint8], kind: str) -> bytes:
    """(h, w, 3) uint8 pixels as the bytes of a file: ``png``, or ``jpg`` for pages with many pictures."""
    height, width = pixels.shape[:2]
    surface = pygame.image.frombuffer(np.ascontiguousarray(pixels).tobytes(), (width, height), "RGB")
    # SDL says nothing of a full disk: it only encodes, and the file is its caller's to write.
    encoded = io.BytesIO()
    pygame.image.save(surface, encoded, f"picture.{kind}")
    return encoded.getvalue()


def _mesh_nodes(file: GltfFile) -> Iterator[tuple[GltfNode, Mapping[str, Any]]]:
    for node in file.nodes:
        if node.mesh is not None:
            yield node, node.extras if isinstance(node.extras, Mapping) else {}


def _primitives(file: GltfFile, node: GltfNode) -> tuple[GltfPrimitive, ...]:
    assert node.mesh is not None
    return file.meshes[node.mesh].primitives


def _material(file: GltfFile, primitive: GltfPrimitive) -> Material:
    where = Where(file.path, pointer=f"/materials/{primitive.material}")
    if primitive.material is None:
        raise BadInput("mesh without a material", where=Where(file.path))
    material: GltfMaterial = file.materials[primitive.material]
    extras = material.extras if isinstance(material.extras, Mapping) else {}
    if extras.get("class") not in KINDS:
        raise BadInput("material class", where=where, expected=", ".join(KINDS), seen=extras.get("class"))
    colours = []
    for key in ("lit", "shade", "deep"):
        value = extras.get(key)
        if not isinstance(value, list) or len(value) != 3:
            raise BadInput(f"material colour {key}", where=where, expected="three numbers in extras", seen=value)
        colours.append((float(value[0]), float(value[1]), float(value[2])))
    return Material(material.name, extras["class"], *colours)


def _weave(file: GltfFile, primitive: GltfPrimitive) -> tuple[float, float] | None:
    """Number and strength of a material's motif; None for a plain one, or one of which nothing is known here."""
    assert primitive.material is not None
    extras = file.materials[primitive.material].extras
    weave = extras.get("weave") if isinstance(extras, Mapping) else None
    if not isinstance(weave, Mapping) or weave.get("motif") not in MOTIFS:
        return None
    strength = weave.get("strength")
    return (
        float(list(MOTIFS).index(weave["motif"])),
        float(strength) if isinstance(strength, int | float) else 0.0,
    )


def _floats(array: NDArray[Any]) -> NDArray[np.float32]:
    return np.ascontiguousarray(array, dtype=np.float32)


def _part(file: GltfFile, primitive: GltfPrimitive, group: str) -> Part:
    attributes = primitive.attributes
    material = _material(file, primitive)
    if "NORMAL" not in attributes or primitive.indices is None:
        raise BadInput("mesh", where=Where(file.path), expected="NORMAL and indices", seen=", ".join(attributes))
    position = _floats(attributes["POSITION"])
    extra = np.zeros((len(position), 4), np.float32)
    if material.kind == "face" and {"TEXCOORD_0", "_FACE"} <= attributes.keys():
        extra = np.hstack([_floats(attributes["TEXCOORD_0"]), _floats(attributes["_FACE"])])
    elif material.kind == "hair" and "_HAIR" in attributes:
        extra[:, :2] = strand_terms(position, primitive.indices.reshape(-1, 3), attributes["_HAIR"])
    weave = _weave(file, primitive)
    if weave is not None and "TEXCOORD_0" in attributes:
        extra[:, :2], extra[:, 2:] = attributes["TEXCOORD_0"], weave
        material = replace(material, kind="woven")
    skinned = "JOINTS_0" in attributes
    return Part(
        group,
        material,
        position,
        _floats(attributes["NORMAL"]),
        _floats(attributes.get("_OUTLINE", np.zeros(len(position)))),
        primitive.indices.reshape(-1, 3),
        attributes["JOINTS_0"].astype(np.uint8) if skinned else None,
        _weight_bytes(attributes["WEIGHTS_0"]) if skinned else None,
        extra,
    )


def _weight_bytes(weight: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Weights (v, 4) in 0..1 as bytes whose rows sum to 255."""
    total = np.maximum(weight.sum(axis=1, keepdims=True), 1e-6)
    whole = np.rint(weight / total * 255.0).astype(np.int32)
    rows = np.arange(len(whole))
    whole[rows, whole.argmax(axis=1)] += 255 - whole.sum(axis=1)
    return np.asarray(whole, dtype=np.uint8)


def _shadow_mesh(primitive: GltfPrimitive, legs: list[int]) -> ShadowMesh:
    attributes = primitive.attributes
    if primitive.indices is None:
        raise BadInput("shadow mesh", expected="indices", seen="none")
    position = _floats(attributes["POSITION"])
    joint = attributes["JOINTS_0"].astype(np.uint8)
    weight = _weight_bytes(attributes["WEIGHTS_0"])
    triangle = primitive.indices.reshape(-1, 3).astype(np.int32)
    leg = on_legs(triangle, joint, weight, legs)
    push = _floats(attributes.get("_PUSH", np.zeros(len(position))))
    ordered = np.concatenate([triangle[~leg], triangle[leg]])
    return ShadowMesh(position, joint, weight, push, ordered, int(np.count_nonzero(~leg)))
