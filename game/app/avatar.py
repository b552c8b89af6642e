"""Opening a foreign avatar: VRM 0.x and 1.0, or plain skinned glTF whose joints are named like a person's.

Everything the file claims is checked by the readers below; what cannot be shown is refused in one line, what can be
shown only partly is told in the avatar's notes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.animation import NEEDED, Rig
from game.app.avatar_look import AvatarLooks
from game.app.avatar_rig import EYE_HEIGHT_M, avatar_rig, place_avatar
from game.app.avatar_smile import smile_instead
from game.core.errors import BadInput, Where
from game.face import AvatarFace, FaceLeak, FaceParams, FaceSignal, load_rated
from game.formats import (
    GltfFile,
    JointMap,
    Report,
    Vrm,
    VrmExpression,
    VrmLookAt,
    build_vrm,
    detect_map,
    join_meshes,
    map_from_names,
    read_gltf,
    skeleton_of,
    toon_materials,
)
from game.formats.gltf_shape import LISTS
from game.render.avatar_model import AvatarLook, AvatarModel, build_avatar

__all__ = ["Avatar", "open_avatar"]

MAX_BYTES = 256_000_000
RATED_SUFFIX = ".faces.yaml"


@dataclass(frozen=True, eq=False)
class Avatar:
    """kind: "VRM 0.x", "VRM 1.0" or "glTF". expressions: by name, with their morph targets as (mesh, target, weight);
    lift_m: how much higher than the reference's the eyes are;
    licence: a line to show whoever looks at it; notes: what is shown otherwise than the file has it, or not at all."""

    path: Path
    kind: str
    name: str
    rig: Rig
    model: AvatarModel
    expressions: Mapping[str, VrmExpression]
    look_at: VrmLookAt | None
    lift_m: float
    face: AvatarFace
    looks: AvatarLooks
    licence: str
    notes: tuple[str, ...]

    def look(
        self, signal: FaceSignal, params: FaceParams, visemes: NDArray[np.float64], leak: FaceLeak | None = None
    ) -> tuple[AvatarLook, float]:
        """What the face shows in a moment, and how much of the gaze the eyes follow."""
        found = self.face.weights(signal, params, visemes, leak)
        return self.looks.at(found.weight), found.look


def open_avatar(path: Path, joints: JointMap | None = None, ratings: Path | None = None) -> Avatar:
    """Read a foreign avatar. Raises BadInput, in one line, for anything that cannot stand behind the table.

    joints: which joint of a plain glTF plays which part, found by name where None. ratings: YAML of rated expressions;
    FILE.faces.yaml beside the avatar where None and there is one.
    """
    beside = path.with_name(path.name + RATED_SUFFIX)
    ratings = ratings or (beside if beside.is_file() else None)
    rated = None if ratings is None else load_rated(ratings)
    file = read_gltf(path, max_bytes=MAX_BYTES)
    lengths = {name: len(file.json.get(name, [])) for name in LISTS}
    report = Report(path, lengths, list(file.findings))
    vrm = build_vrm(file) if {"VRM", "VRMC_vrm"} & set(file.extensions) else None
    bones = vrm.bones if vrm is not None else _named_bones(file, joints)
    materials = toon_materials(file, report)
    geometry = join_meshes(file, materials)
    look_at = vrm.look_at if vrm is not None else None
    placing = place_avatar(file, bones, geometry, look_at)
    rig = avatar_rig(
        file,
        bones,
        geometry,
        placing,
        vrm.springs if vrm else (),
        vrm.colliders if vrm else (),
        look_at,
        open_ends=vrm is not None and vrm.version == "0.x",
    )
    name = (vrm.name if vrm is not None else "") or path.stem
    model = build_avatar(name, file, geometry, materials, placing.scale)
    expressions = dict(vrm.expressions) if vrm is not None else _morph_expressions(file)
    smile = smile_instead(model, expressions)
    told = [f"happy: no smile in it, joy is shown as {smile}"] if smile is not None and rated is None else []
    return Avatar(
        path=path,
        kind=f"VRM {vrm.version}" if vrm is not None else "glTF",
        name=_plain(name),
        rig=rig,
        model=model,
        expressions=expressions,
        look_at=look_at,
        lift_m=placing.eyes_m - EYE_HEIGHT_M,
        face=AvatarFace(expressions, look_at, rated, smile),
        looks=AvatarLooks(model, tuple(expressions.values())),
        licence=_licence(file, vrm),
        notes=tuple(_plain(note) for note in (*model.notes, *told, *(vrm.findings if vrm else file.findings))),
    )


def _named_bones(file: GltfFile, joints: JointMap | None) -> dict[str, int]:
    """VRM bone -> node, by the names of the joints. Raises BadInput with those that are missing."""
    if not file.skins:
        expected = "a VRM, or a skin with a person's joints"
        raise BadInput("avatar", where=Where(file.path), expected=expected, seen="no skin")
    found = skeleton_of(file)
    if joints is None:
        joints = detect_map(found.skeleton, file.path, option="--avatar-map")
    else:
        joints = map_from_names(joints, found.skeleton, file.path)
    bones = {bone: int(found.nodes[found.skeleton.index[name]]) for bone, name in _one_each(joints).items()}
    missing = [bone for bone in NEEDED if bone not in bones]
    if missing:
        raise BadInput("avatar", where=Where(file.path), expected="a person's bones", seen=f"no {', '.join(missing)}")
    return bones


def _one_each(joints: JointMap) -> dict[str, str]:
    """One joint for each bone: of several spine joints the lowest; the one that carries the arms is the chest, or the
    spine where there is no other."""
    chosen = {bone: names[0] for bone, names in joints.joints.items() if names}
    if "spine" not in chosen and "chest" in chosen:
        chosen["spine"] = chosen.pop("chest")
    return chosen


def _morph_expressions(file: GltfFile) -> dict[str, VrmExpression]:
    """Plain glTF has no expressions; its named morph targets are taken for them."""
    morphs: dict[str, list[tuple[int, int, float]]] = {}
    for mesh, item in enumerate(file.meshes):
        for target, name in enumerate(item.target_names):
            morphs.setdefault(name, []).append((mesh, target, 1.0))
    return {name: VrmExpression(name, False, tuple(binds)) for name, binds in morphs.items()}


def _licence(file: GltfFile, vrm: Vrm | None) -> str:
    """One line: who made it and what may be done with it."""
    if vrm is None:
        return _plain(str(file.json.get("asset", {}).get("copyright", ""))) or "no licence stated in the file"
    terms = vrm.licence
    told = [f"{label} {terms[key]}" for key, label in _LABELS.items() if terms.get(key)]
    authors = ", ".join(author for author in vrm.authors if author) or "an unnamed author"
    return _plain(f"{vrm.name or file.path.stem} by {authors}; {'; '.join(told) or 'no terms stated'}")


_LABELS = {
    "licenseName": "licence",
    "licenseUrl": "licence",
    "commercialUssageName": "commercial use",
    "commercialUsage": "commercial use",
    "modification": "modification",
    "allowRedistribution": "redistribution",
}


def _plain(text: str) -> str:
    """Names come from the file: nothing of them may steer the terminal."""
    return "".join(c if c.isprintable() else "\ufffd" for c in text)[:300]
