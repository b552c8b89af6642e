"""VRM characters (0.x and 1.0) and VRM animations (VRMA 1.0) on top of the glTF reader."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from game.core.errors import BadInput, Where
from game.formats.gltf import read_gltf
from game.formats.gltf_model import GltfFile
from game.formats.gltf_shape import LISTS
from game.formats.gltf_skeleton import animation_clip, skeleton_of
from game.formats.json_shape import Report, check
from game.formats.vrm0 import build_vrm0
from game.formats.vrm_model import (
    HUMAN_BONES,
    REQUIRED_BONES,
    SpringChain,
    SpringCollider,
    SpringJoint,
    Vrm,
    VrmAnimation,
    VrmExpression,
    VrmLookAt,
)
from game.formats.vrm_shape import VRM0, VRMA, VRMC_SPRING, VRMC_VRM

_COLOURS = {
    "color": "lit",
    "shadeColor": "shade",
    "emissionColor": "emissive",
    "rimColor": "rim",
    "outlineColor": "outline",
}

__all__ = ["build_vrm", "build_vrma", "read_vrm", "read_vrma"]


def read_vrm(path: Path | str, *, max_bytes: int = 256_000_000) -> Vrm:
    """Read a VRM 0.x or 1.0 character. Raises BadInput also where required humanoid bones are missing."""
    return build_vrm(read_gltf(path, max_bytes=max_bytes))


def build_vrm(file: GltfFile) -> Vrm:
    """The character in a glTF file that is already read."""
    report = _report(file)
    extensions = file.extensions
    if "VRMC_vrm" in extensions:
        source = extensions["VRMC_vrm"]
        check(source, VRMC_VRM, report, ("extensions", "VRMC_vrm"))
        _check_version(source, report, ("extensions", "VRMC_vrm"))
        vrm = _build_vrm1(file, source, report)
    elif "VRM" in extensions:
        source = extensions["VRM"]
        _count_colliders(report, source.get("secondaryAnimation"), "colliderGroups", "springColliderGroups")
        check(source, VRM0, report, ("extensions", "VRM"))
        vrm = build_vrm0(file, source, report)
    else:
        raise BadInput(
            "a glTF file without a character", where=Where(file.path, pointer="/extensions"), hint="no VRM block"
        )
    missing = [bone for bone in REQUIRED_BONES if bone not in vrm.bones]
    if missing:
        pointer = ("extensions", "VRM" if vrm.version == "0.x" else "VRMC_vrm", "humanoid", "humanBones")
        report.refuse(pointer, f"required bones are missing: {', '.join(missing)}")
    return vrm


def read_vrma(path: Path | str, *, fps: float = 30.0, max_bytes: int = 64_000_000) -> VrmAnimation:
    """Read a VRM animation and sample it at a fixed rate on the skeleton of its humanoid bones."""
    return build_vrma(read_gltf(path, max_bytes=max_bytes), fps=fps)


def build_vrma(file: GltfFile, index: int = 0, *, fps: float = 30.0) -> VrmAnimation:
    """The VRM animation in a glTF file that is already read; index: which of its animations."""
    report = _report(file)
    if "VRMC_vrm_animation" not in file.extensions:
        raise BadInput("no VRMC_vrm_animation block", where=Where(file.path, pointer="/extensions"))
    source = file.extensions["VRMC_vrm_animation"]
    check(source, VRMA, report, ("extensions", "VRMC_vrm_animation"))
    _check_version(source, report, ("extensions", "VRMC_vrm_animation"))
    if not file.animations:
        raise BadInput("no animation", where=Where(file.path, pointer="/animations"))
    if not 0 <= index < len(file.animations):
        raise BadInput("animation", where=Where(file.path), expected=f"0 to {len(file.animations) - 1}", seen=index)
    bones = _bones(source.get("humanoid", {"humanBones": {}}), report, ("extensions", "VRMC_vrm_animation"))
    rig = skeleton_of(file, bones.values() if bones else None)
    groups = source.get("expressions", {})
    expressions = {
        name: target["node"] for group in ("preset", "custom") for name, target in groups.get(group, {}).items()
    }
    return VrmAnimation(
        file,
        rig,
        animation_clip(file, index, fps, rig),
        {bone: rig.joint[node] for bone, node in bones.items()},
        expressions,
        source.get("lookAt", {}).get("node"),
        report.findings,
    )


def _check_version(source: Mapping[str, Any], report: Report, pointer: tuple[str | int, ...]) -> None:
    version = source.get("specVersion")
    if version is None:
        report.note(pointer, "no specVersion, read as 1.0")
    elif not version.startswith("1."):
        report.refuse((*pointer, "specVersion"), expected="1.0", seen=version)


def _report(file: GltfFile) -> Report:
    lengths = {name: len(file.json.get(name, [])) for name in LISTS}
    return Report(file.path, lengths, list(file.findings))


def _count_colliders(report: Report, source: Any, key: str, name: str) -> None:
    """Let the shape check know how long a list inside an extension is, whatever stands there."""
    items = source.get(key) if isinstance(source, dict) else None
    report.lengths = {**report.lengths, name: len(items) if isinstance(items, list) else 0}


def _bones(humanoid: Mapping[str, Any], report: Report, pointer: tuple[str | int, ...]) -> dict[str, int]:
    bones = {}
    for name, bone in humanoid["humanBones"].items():
        if name in HUMAN_BONES:
            bones[name] = int(bone["node"])
        else:
            report.note((*pointer, "humanoid", "humanBones", name), "an unknown bone, ignored")
    if len(set(bones.values())) != len(bones):
        report.note((*pointer, "humanoid", "humanBones"), "one node for two bones")
    return bones


def _build_vrm1(file: GltfFile, source: Mapping[str, Any], report: Report) -> Vrm:
    root = ("extensions", "VRMC_vrm")
    meta = source["meta"]
    expressions = {}
    for group in ("preset", "custom"):
        for name, item in source.get("expressions", {}).get(group, {}).items():
            expressions[name] = _expression(file, name, item, group, report)
    springs, colliders = _springs(file, report)
    permissions = {key: str(value) for key, value in meta.items() if key not in ("name", "authors", "thumbnailImage")}
    first_person = source.get("firstPerson", {}).get("meshAnnotations", [])
    return Vrm(
        gltf=file,
        version="1.0",
        faces="+Z",
        name=meta.get("name", ""),
        authors=tuple(meta.get("authors", ())),
        licence=permissions,
        meta=meta,
        bones=_bones(source["humanoid"], report, root),
        expressions=expressions,
        springs=springs,
        colliders=colliders,
        look_at=_look_at(source["lookAt"]) if "lookAt" in source else None,
        first_person={item["node"]: item.get("type", "auto") for item in first_person},
        findings=report.findings,
    )


def _expression(file: GltfFile, name: str, item: Mapping[str, Any], group: str, report: Report) -> VrmExpression:
    morphs = []
    for at, bind in enumerate(item.get("morphTargetBinds", [])):
        pointer = ("extensions", "VRMC_vrm", "expressions", group, name, "morphTargetBinds", at)
        mesh = file.nodes[bind["node"]].mesh
        if mesh is None:
            report.note((*pointer, "node"), "a node without a mesh, ignored")
            continue
        targets = len(file.meshes[mesh].weights)
        if bind["index"] >= targets:
            report.refuse((*pointer, "index"), expected=f"one of the {targets} morph targets", seen=bind["index"])
        morphs.append((mesh, bind["index"], float(bind["weight"])))
    return VrmExpression(
        name,
        group == "preset",
        tuple(morphs),
        tuple(
            (bind["material"], _COLOURS[bind["type"]], tuple(float(v) for v in bind["targetValue"]))
            for bind in item.get("materialColorBinds", [])
            if bind.get("type") in _COLOURS and len(bind.get("targetValue", ())) == 4
        ),
        tuple(
            (bind["material"], _pair(bind.get("scale"), 1.0), _pair(bind.get("offset"), 0.0))
            for bind in item.get("textureTransformBinds", [])
        ),
        item.get("isBinary", False),
        item.get("overrideBlink", "none"),
        item.get("overrideLookAt", "none"),
        item.get("overrideMouth", "none"),
    )


def _look_at(source: Mapping[str, Any]) -> VrmLookAt:
    ranges = {
        key.removeprefix("rangeMap"): (float(value.get("inputMaxValue", 90)), float(value.get("outputScale", 10)))
        for key, value in source.items()
        if key.startswith("rangeMap")
    }
    return VrmLookAt(source.get("type", "bone"), _vector(source.get("offsetFromHeadBone")), ranges)


def _springs(file: GltfFile, report: Report) -> tuple[tuple[SpringChain, ...], tuple[SpringCollider, ...]]:
    if "VRMC_springBone" not in file.extensions:
        return (), ()
    source = file.extensions["VRMC_springBone"]
    _count_colliders(report, source, "colliders", "springColliders")
    _count_colliders(report, source, "colliderGroups", "springColliderGroups")
    check(source, VRMC_SPRING, report, ("extensions", "VRMC_springBone"))
    _check_version(source, report, ("extensions", "VRMC_springBone"))
    colliders = []
    for item in source.get("colliders", []):
        capsule = item["shape"].get("capsule")
        shape = capsule or item["shape"].get("sphere", {})
        tail = _vector(capsule.get("tail")) if capsule else None
        colliders.append(SpringCollider(item["node"], _vector(shape.get("offset")), shape.get("radius", 0.0), tail))
    groups = [group["colliders"] for group in source.get("colliderGroups", [])]
    chains = []
    for at, spring in enumerate(source.get("springs", [])):
        joints = tuple(
            SpringJoint(
                joint["node"],
                float(joint.get("hitRadius", 0.0)),
                float(joint.get("stiffness", 1.0)),
                float(joint.get("gravityPower", 0.0)),
                _vector(joint.get("gravityDir"), (0.0, -1.0, 0.0)),
                float(joint.get("dragForce", 0.5)),
            )
            for joint in spring["joints"]
        )
        _check_chain(file, joints, at, report)
        touched = dict.fromkeys(c for group in spring.get("colliderGroups", []) for c in groups[group])
        chains.append(SpringChain(spring.get("name", ""), joints, tuple(touched), spring.get("center")))
    return tuple(chains), tuple(colliders)


def _check_chain(file: GltfFile, joints: tuple[SpringJoint, ...], index: int, report: Report) -> None:
    """Every joint must be a descendant of the one before it."""
    for at in range(1, len(joints)):
        node = file.nodes[joints[at].node].parent
        while node >= 0 and node != joints[at - 1].node:
            node = file.nodes[node].parent
        if node < 0:
            pointer = ("extensions", "VRMC_springBone", "springs", index, "joints", at, "node")
            report.refuse(pointer, expected="a descendant of the joint before it", seen=joints[at].node)


def _pair(value: Any, default: float) -> tuple[float, float]:
    return (default, default) if value is None else (float(value[0]), float(value[1]))


def _vector(value: Any, default: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> tuple[float, float, float]:
    return default if value is None else (float(value[0]), float(value[1]), float(value[2]))
