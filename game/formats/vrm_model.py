"""What a VRM character or animation holds, the same for 0.x and 1.0 (named as in 1.0)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from game.core.clip import Clip
from game.formats.gltf_model import GltfFile
from game.formats.gltf_skeleton import GltfSkeleton

__all__ = [
    "HUMAN_BONES",
    "REQUIRED_BONES",
    "SpringChain",
    "SpringCollider",
    "SpringJoint",
    "Vrm",
    "VrmAnimation",
    "VrmExpression",
    "VrmLookAt",
]

Vector = tuple[float, float, float]

_SIDED = (
    *("Eye", "UpperLeg", "LowerLeg", "Foot", "Toes", "Shoulder", "UpperArm", "LowerArm", "Hand"),
    *("ThumbMetacarpal", "ThumbProximal", "ThumbDistal"),
    *(f"{f}{p}" for f in ("Index", "Middle", "Ring", "Little") for p in ("Proximal", "Intermediate", "Distal")),
)
HUMAN_BONES: tuple[str, ...] = (
    *("hips", "spine", "chest", "upperChest", "neck", "head", "jaw"),
    *(f"{side}{bone}" for side in ("left", "right") for bone in _SIDED),
)
REQUIRED_BONES: tuple[str, ...] = (
    *("hips", "spine", "head"),
    *(
        f"{side}{bone}"
        for side in ("left", "right")
        for bone in ("UpperLeg", "LowerLeg", "Foot", "UpperArm", "LowerArm", "Hand")
    ),
)


@dataclass(frozen=True)
class VrmExpression:
    """morphs: (mesh, target, weight 0..1). colours: (material, what: "lit", "shade", "emissive", "rim" or "outline",
    linear RGBA it turns to); shifts: (material, scale, offset) of its texture coordinates."""

    name: str
    preset: bool
    morphs: tuple[tuple[int, int, float], ...]
    colours: tuple[tuple[int, str, tuple[float, ...]], ...] = ()
    shifts: tuple[tuple[int, tuple[float, float], tuple[float, float]], ...] = ()
    is_binary: bool = False
    override_blink: str = "none"
    override_look_at: str = "none"
    override_mouth: str = "none"


@dataclass(frozen=True)
class SpringJoint:
    """One joint of a chain; its parameters act on the piece from this node to the next. hit_radius in metres."""

    node: int
    hit_radius_m: float
    stiffness: float
    gravity_power: float
    gravity_dir: Vector
    drag_force: float


@dataclass(frozen=True)
class SpringCollider:
    """A sphere, or with tail a capsule, in its node's frame; metres."""

    node: int
    offset: Vector
    radius_m: float
    tail: Vector | None = None


@dataclass(frozen=True)
class SpringChain:
    """joints: parents first, one line of nodes. colliders: indices into Vrm.colliders. center: node or None."""

    name: str
    joints: tuple[SpringJoint, ...]
    colliders: tuple[int, ...]
    center: int | None


@dataclass(frozen=True)
class VrmLookAt:
    """kind: "bone" or "expression"; offset from the head bone, metres; ranges: name -> (input max °, output scale)."""

    kind: str
    offset: Vector
    ranges: Mapping[str, tuple[float, float]]


@dataclass(frozen=True, eq=False)
class Vrm:
    """A character. bones: VRM 1.0 bone name -> node; first_person: node -> annotation.

    faces: "+Z" for 1.0, "-Z" for 0.x. licence: the meta block's permissions as written, meta: all of it.
    """

    gltf: GltfFile
    version: str
    faces: str
    name: str
    authors: tuple[str, ...]
    licence: Mapping[str, str]
    meta: Mapping[str, Any]
    bones: Mapping[str, int]
    expressions: Mapping[str, VrmExpression]
    springs: tuple[SpringChain, ...]
    colliders: tuple[SpringCollider, ...]
    look_at: VrmLookAt | None
    first_person: Mapping[int, str]
    findings: list[str]


@dataclass(frozen=True, eq=False)
class VrmAnimation:
    """A VRM animation. clip: on `skeleton`, sampled at a fixed rate; bones: VRM bone name -> joint of that skeleton.

    expressions: name -> the node whose x translation is the weight; look_at: node or None.
    """

    gltf: GltfFile
    skeleton: GltfSkeleton
    clip: Clip
    bones: Mapping[str, int]
    expressions: Mapping[str, int]
    look_at: int | None
    findings: list[str]
