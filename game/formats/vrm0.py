"""VRM 0.x in the terms of 1.0: bone, expression and spring names translated, left-handed offsets mirrored."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from game.formats.gltf_model import GltfFile
from game.formats.json_shape import Report
from game.formats.srgb import linear_light
from game.formats.vrm_model import (
    HUMAN_BONES,
    SpringChain,
    SpringCollider,
    SpringJoint,
    Vector,
    Vrm,
    VrmExpression,
    VrmLookAt,
)

__all__ = ["build_vrm0"]

_ROOT = ("extensions", "VRM")
_MAX_SPRING_JOINTS = 20_000

# 1.0 renamed the thumb (it has a metacarpal and no intermediate bone) and the expression presets.
_THUMB = {"ThumbProximal": "ThumbMetacarpal", "ThumbIntermediate": "ThumbProximal"}
_PRESETS = {
    "joy": "happy",
    "sorrow": "sad",
    "fun": "relaxed",
    "a": "aa",
    "i": "ih",
    "u": "ou",
    "e": "ee",
    "o": "oh",
    "blink_l": "blinkLeft",
    "blink_r": "blinkRight",
    "lookup": "lookUp",
    "lookdown": "lookDown",
    "lookleft": "lookLeft",
    "lookright": "lookRight",
}
_FIRST_PERSON = {
    "Auto": "auto",
    "Both": "both",
    "ThirdPersonOnly": "thirdPersonOnly",
    "FirstPersonOnly": "firstPersonOnly",
}
_COLOURS = {
    "_Color": "lit",
    "_ShadeColor": "shade",
    "_EmissionColor": "emissive",
    "_RimColor": "rim",
    "_OutlineColor": "outline",
}
_PERSONAL = ("title", "author", "version", "contactInformation", "reference", "texture")


def build_vrm0(file: GltfFile, source: Mapping[str, Any], report: Report) -> Vrm:
    """A character of a 0.x block whose shape has been checked."""
    meta = source.get("meta", {})
    first_person = source.get("firstPerson", {})
    springs, colliders = _springs(file, source.get("secondaryAnimation", {}), report)
    annotations = {
        item["mesh"]: _FIRST_PERSON.get(item.get("firstPersonFlag", "Auto"), "auto")
        for item in first_person.get("meshAnnotations", [])
        if item.get("mesh", -1) >= 0
    }
    return Vrm(
        gltf=file,
        version="0.x",
        faces="-Z",
        name=meta.get("title", ""),
        authors=(meta["author"],) if meta.get("author") else (),
        licence={key: str(value) for key, value in meta.items() if key not in _PERSONAL},
        meta=meta,
        bones=_bones(source["humanoid"]["humanBones"], report),
        expressions=_expressions(file, source.get("blendShapeMaster", {}), report),
        springs=springs,
        colliders=colliders,
        look_at=_look_at(first_person),
        first_person={node.index: annotations[node.mesh] for node in file.nodes if node.mesh in annotations},
        findings=report.findings,
    )


def _bones(source: list[Mapping[str, Any]], report: Report) -> dict[str, int]:
    bones: dict[str, int] = {}
    for at, item in enumerate(source):
        pointer = (*_ROOT, "humanoid", "humanBones", at)
        name = item["bone"]
        for side in ("left", "right"):
            name = side + _THUMB.get(name[len(side) :], name[len(side) :]) if name.startswith(side) else name
        if name not in HUMAN_BONES:
            report.note((*pointer, "bone"), f"unknown bone {item['bone'][:40]!r}, ignored")
        elif name in bones:
            report.refuse((*pointer, "bone"), f"the bone {item['bone'][:40]!r} stands twice")
        elif item["node"] >= 0:
            bones[name] = int(item["node"])
    return bones


def _expressions(file: GltfFile, source: Mapping[str, Any], report: Report) -> dict[str, VrmExpression]:
    expressions: dict[str, VrmExpression] = {}
    for at, group in enumerate(source.get("blendShapeGroups", [])):
        preset = group.get("presetName", "unknown").lower()
        known = preset not in ("", "unknown")
        name = _PRESETS.get(preset, preset) if known else group.get("name", f"expression_{at}")
        morphs = []
        for number, bind in enumerate(group.get("binds", [])):
            mesh, target = bind.get("mesh", -1), bind.get("index", -1)
            if mesh < 0 or target < 0:
                continue
            targets = len(file.meshes[mesh].weights)
            if target >= targets:
                pointer = (*_ROOT, "blendShapeMaster", "blendShapeGroups", at, "binds", number, "index")
                report.refuse(pointer, expected=f"one of the {targets} morph targets", seen=target)
            morphs.append((mesh, target, float(bind.get("weight", 100)) / 100.0))
        if name in expressions:
            report.note(
                (*_ROOT, "blendShapeMaster", "blendShapeGroups", at), f"a second expression {name[:40]!r}, ignored"
            )
            continue
        colours, shifts = _material_changes(file, group)
        expressions[name] = VrmExpression(
            name, known, tuple(morphs), colours, shifts, is_binary=group.get("isBinary", False)
        )
    return expressions


def _material_changes(
    file: GltfFile, group: Mapping[str, Any]
) -> tuple[
    tuple[tuple[int, str, tuple[float, ...]], ...], tuple[tuple[int, tuple[float, float], tuple[float, float]], ...]
]:
    """Colours (sRGB in 0.x) and texture places that an expression changes, by name of material and property."""
    index = {material.name: at for at, material in reversed(list(enumerate(file.materials)))}
    colours, shifts = [], []
    for bind in group.get("materialValues", []):
        material = index.get(bind.get("materialName", ""))
        name, value = bind.get("propertyName", ""), [float(v) for v in bind.get("targetValue", [])]
        if material is None or len(value) != 4:
            continue
        if name in _COLOURS:
            colours.append((material, _COLOURS[name], (*linear_light(value[:3]), value[3])))
        elif name == "_MainTex_ST":
            sx, sy, ox, oy = value
            shifts.append((material, (sx, sy), (ox, 1.0 - oy - sy)))
    return tuple(colours), tuple(shifts)


def _look_at(source: Mapping[str, Any]) -> VrmLookAt | None:
    if "lookAtTypeName" not in source:
        return None
    ranges = {
        key.removeprefix("lookAt"): (float(value.get("xRange", 90)), float(value.get("yRange", 10)))
        for key, value in source.items()
        if key.startswith("lookAt") and isinstance(value, dict)
    }
    kind = "bone" if source["lookAtTypeName"] == "Bone" else "expression"
    return VrmLookAt(kind, _mirrored(source.get("firstPersonBoneOffset", {})), ranges)


def _springs(
    file: GltfFile, source: Mapping[str, Any], report: Report
) -> tuple[tuple[SpringChain, ...], tuple[SpringCollider, ...]]:
    colliders: list[SpringCollider] = []
    groups: list[list[int]] = []
    for group in source.get("colliderGroups", []):
        members: list[int] = []
        for item in group.get("colliders", []):
            if group.get("node", -1) >= 0:
                members.append(len(colliders))
                offset = _mirrored(item.get("offset", {}))
                colliders.append(SpringCollider(group["node"], offset, float(item.get("radius", 0.0))))
        groups.append(members)
    chains: list[SpringChain] = []
    count = 0
    for at, group in enumerate(source.get("boneGroups", [])):
        touched = tuple(dict.fromkeys(c for number in group.get("colliderGroups", []) for c in groups[number]))
        center = group.get("center", -1)
        for root in group.get("bones", []):
            for line in _lines_below(file, root) if root >= 0 else ():
                count += len(line)
                if count > _MAX_SPRING_JOINTS:
                    report.refuse((*_ROOT, "secondaryAnimation", "boneGroups", at), "too many spring joints")
                joints = tuple(_joint(node, group) for node in line)
                chains.append(SpringChain(group.get("comment", ""), joints, touched, center if center >= 0 else None))
    return tuple(chains), tuple(colliders)


def _lines_below(file: GltfFile, root: int) -> list[list[int]]:
    """All nodes from root down, cut into unbranched lines: the first child goes on, the others begin a line."""
    lines = []
    starts = [root]
    while starts:
        line = [starts.pop()]
        while file.nodes[line[-1]].children:
            first, *others = file.nodes[line[-1]].children
            starts.extend(others)
            line.append(first)
        lines.append(line)
    return lines


def _joint(node: int, group: Mapping[str, Any]) -> SpringJoint:
    down = group.get("gravityDir", {})
    return SpringJoint(
        node,
        float(group.get("hitRadius", 0.0)),
        float(group.get("stiffiness", 1.0)),
        float(group.get("gravityPower", 0.0)),
        (float(down.get("x", 0.0)), float(down.get("y", -1.0)), float(down.get("z", 0.0))),
        float(group.get("dragForce", 0.5)),
    )


def _mirrored(source: Mapping[str, Any]) -> Vector:
    """0.x stores offsets in Unity's left-handed frame."""
    return float(source.get("x", 0.0)), float(source.get("y", 0.0)), -float(source.get("z", 0.0))
