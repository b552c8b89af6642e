"""Show what is in a BVH, glTF or VRM file: joints, frame time, world positions, a character's bones and licence.

Examples:
  run_game.py inspect take.bvh                      joints and their positions in frame 0
  run_game.py inspect take.bvh --frames 0,10 --json
  run_game.py inspect person.vrm                    rest pose, humanoid bones, expressions, springs, licence

Positions are in model space and in the file's own units. A glTF file with animations shows the first of them (or
--animation N) at --fps; one without shows its rest pose as frame 0.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core.clip import Clip
from game.core.errors import BadInput, Where
from game.core.skeleton import Skeleton
from game.formats import (
    GltfFile,
    Vrm,
    animation_clip,
    build_vrm,
    build_vrma,
    detect_map,
    estimate_scale,
    read_bvh,
    read_gltf,
    skeleton_of,
)

__all__ = ["add_arguments", "run"]

_GLTF_SUFFIXES = (".gltf", ".glb", ".vrm", ".vrma")


@dataclass
class _Contents:
    """What the command shows: the motion (one frame where nothing moves), facts in order of display, findings."""

    path: Path
    kind: str
    clip: Clip
    animated: bool
    facts: dict[str, Any] = field(default_factory=dict)
    findings: list[str] = field(default_factory=list)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The command's grammar."""
    parser.add_argument("file", type=Path, help=".bvh, .gltf, .glb, .vrm or .vrma")
    parser.add_argument("--frames", default="0", help="frames to show, for example 0,10 (default: 0)")
    parser.add_argument("--animation", type=int, default=0, help="which animation of a glTF file (default: 0)")
    parser.add_argument("--fps", type=float, default=30.0, help="sampling rate of a glTF animation (default: 30)")
    parser.add_argument("--json", action="store_true", help="machine-readable result")


def run(args: argparse.Namespace) -> int:
    """0 shown; a file that cannot be read or a frame that is not there raises BadInput."""
    frames = _parse_frames(args.frames)
    if not (1.0 <= args.fps <= 1000.0):
        raise BadInput("--fps", expected="a rate from 1 to 1000", seen=args.fps)
    contents = _open(args.file, args.animation, args.fps)
    count = len(contents.clip)
    for frame in frames:
        if frame >= count:
            raise BadInput("--frames", where=Where(args.file), expected=f"frames from 0 to {count - 1}", seen=frame)
    positions, _ = contents.clip.to_model(np.array(frames, dtype=np.intp))
    if args.json:
        print(json.dumps(_as_json(contents, frames, positions), ensure_ascii=False))
    else:
        _print_table(contents, frames, positions)
    return 0


def _parse_frames(text: str) -> list[int]:
    frames = []
    for word in text.split(","):
        number = word.strip()
        if not (number.isascii() and number.isdecimal()) or len(number) > 9:
            raise BadInput("--frames", expected="frame numbers from 0, such as 0,10", seen=text)
        frames.append(int(number))
    if len(frames) > 10_000:
        raise BadInput("--frames", expected="at most 10000 frames", seen=len(frames))
    return frames


def _open(path: Path, animation: int, fps: float) -> _Contents:
    suffix = path.suffix.lower()
    if suffix == ".bvh":
        return _open_bvh(path)
    if suffix in _GLTF_SUFFIXES:
        return _open_gltf(path, animation, fps)
    raise BadInput(where=Where(path), expected=f"a file ending in .bvh {' '.join(_GLTF_SUFFIXES)}", seen=suffix)


def _open_bvh(path: Path) -> _Contents:
    file = read_bvh(path)
    facts = {
        "declared_frames": file.declared_frames,
        "metres_per_unit": estimate_scale(file.clip),
        "channels": [list(channels) for channels in file.channels],
    }
    return _Contents(path, "BVH", file.clip, True, facts, file.findings)


def _open_gltf(path: Path, animation: int, fps: float) -> _Contents:
    file = read_gltf(path)
    vrm = build_vrm(file) if {"VRM", "VRMC_vrm"} & set(file.extensions) else None
    rig = skeleton_of(file, _character_nodes(file, vrm) if vrm else None)
    facts: dict[str, Any] = {
        "nodes": len(file.nodes),
        "meshes": len(file.meshes),
        "materials": [material.name for material in file.materials],
        "animations": [{"name": item.name, "length_s": item.length_s} for item in file.animations],
        "extensions": sorted(file.json.get("extensionsUsed", [])),
    }
    if vrm is not None:
        facts.update(_character_facts(file, vrm))
    elif file.skins or any(mesh.target_names for mesh in file.meshes):
        facts.update(_figure_facts(file, rig.skeleton))
    if not file.animations:
        rest = rig.skeleton
        clip = Clip(rest, 1.0 / fps, rest.rest_rotation[None], rest.rest_translation[None], name=path.stem)
    elif not 0 <= animation < len(file.animations):
        raise BadInput("--animation", expected=f"0 to {len(file.animations) - 1}", seen=animation)
    elif "VRMC_vrm_animation" in file.extensions:
        moving = build_vrma(file, animation, fps=fps)
        names = moving.clip.skeleton.names
        facts["bones"] = {bone: names[joint] for bone, joint in moving.bones.items()}
        facts["expressions"] = list(moving.expressions)
        return _Contents(path, "VRMA 1.0", moving.clip, True, facts, moving.findings)
    else:
        clip = animation_clip(file, animation, fps, rig)
    kind = f"VRM {vrm.version}" if vrm else "glTF"
    return _Contents(path, kind, clip, bool(file.animations), facts, vrm.findings if vrm else file.findings)


def _character_nodes(file: GltfFile, vrm: Vrm) -> set[int]:
    nodes = set(vrm.bones.values())
    nodes.update(node for skin in file.skins for node in skin.joints)
    nodes.update(joint.node for chain in vrm.springs for joint in chain.joints)
    return nodes


def _character_facts(file: GltfFile, vrm: Vrm) -> dict[str, Any]:
    names = [node.name or f"node_{node.index}" for node in file.nodes]
    return {
        "character": vrm.name,
        "authors": list(vrm.authors),
        "faces": vrm.faces,
        "bones": {bone: names[node] for bone, node in vrm.bones.items()},
        "expressions": list(vrm.expressions),
        "springs": [
            {"name": chain.name, "joints": [names[joint.node] for joint in chain.joints]} for chain in vrm.springs
        ],
        "licence": dict(vrm.licence),
    }


def _figure_facts(file: GltfFile, skeleton: Skeleton) -> dict[str, Any]:
    """Of a figure without a VRM block: what ``--avatar`` would make of it."""
    try:
        bones = {bone: " + ".join(names) for bone, names in detect_map(skeleton, file.path).joints.items() if names}
    except BadInput as error:
        bones = {"not a person": str(error.seen)}
    targets = dict.fromkeys(name for mesh in file.meshes for name in mesh.target_names)
    stated = str(file.json.get("asset", {}).get("copyright", ""))
    return {"bones": bones, "expressions": list(targets), "licence": stated or "none stated in the file"}


def _as_json(contents: _Contents, frames: list[int], positions: NDArray[np.floating[Any]]) -> dict[str, Any]:
    clip = contents.clip
    return {
        "file": str(contents.path),
        "kind": contents.kind,
        "joints": list(clip.skeleton.names),
        "parents": clip.skeleton.parents.tolist(),
        "frame_count": len(clip),
        "frame_time": clip.frame_time_s,
        "frames": {str(frame): positions[at].tolist() for at, frame in enumerate(frames)},
        **contents.facts,
        "findings": contents.findings,
    }


def _print_table(contents: _Contents, frames: list[int], positions: NDArray[np.floating[Any]]) -> None:
    clip = contents.clip
    print(f"{_plain(str(contents.path))}: {contents.kind}, {len(clip.skeleton)} joints")
    if contents.animated:
        rate = 1.0 / clip.frame_time_s
        print(f"  {len(clip)} frames of {clip.frame_time_s:g} s ({rate:.4g} per second), {clip.length_s:.2f} s")
    else:
        print("  no animation: the rest pose is frame 0")
    for name, value in contents.facts.items():
        if name != "channels":
            print(f"  {name.replace('_', ' ')}: {_fact_text(value)}")
    for finding in contents.findings:
        print(f"  finding: {_plain(finding)}")
    depth: list[int] = []
    for parent in clip.skeleton.parents.tolist():
        depth.append(depth[parent] + 1 if parent >= 0 else 0)
    labels = ["  " * level + _plain(name) for level, name in zip(depth, clip.skeleton.names, strict=True)]
    width = max(map(len, labels))
    for at, frame in enumerate(frames):
        print(f"frame {frame}".ljust(width) + "".join(f"{axis:>12}" for axis in "xyz"))
        for label, position in zip(labels, positions[at].tolist(), strict=True):
            print(label.ljust(width) + "".join(f"{value:12.4f}" for value in position))


def _fact_text(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{_plain(str(key))}={_fact_text(inner)}" for key, inner in value.items()) or "none"
    if isinstance(value, list):
        if value and isinstance(value[0], dict):
            return "; ".join(_fact_text(inner) for inner in value)
        return " ".join(_plain(str(inner)) or "(unnamed)" for inner in value) or "none"
    return f"{value:g}" if isinstance(value, float) else _plain(str(value))


def _plain(text: str) -> str:
    """Names come from the file: nothing of them may steer the terminal."""
    return "".join(character if character.isprintable() else "\ufffd" for character in text)
