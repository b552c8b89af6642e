"""BVH motion: reading every dialect we have met, and writing our own.

Conventions: a joint's rotation channels apply left to right on column vectors ("Zrotation Xrotation Yrotation" is
R = Rz·Rx·Ry); a joint's position channels replace its OFFSET. Lengths stay in the file's own units (see to_metres).
"""

from __future__ import annotations

import array
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.core import quaternion as quat
from game.core.clip import Clip
from game.core.errors import BadInput, Where
from game.core.skeleton import Skeleton
from game.formats.bvh_hierarchy import LARGEST, BvhJoint, BvhText, Token, number, read_hierarchy
from game.formats.files import read_bytes, write_text

__all__ = ["MAX_BYTES", "BvhFile", "estimate_scale", "read_bvh", "to_metres", "write_bvh"]

Floats = NDArray[np.float64]

_WORD = re.compile(rb"\S+")
_HEADER = re.compile(rb"\s*(Frames|Frame\s+Time)\s*:\s*(\S*)\s*", re.IGNORECASE)
_NUMERIC = b"0123456789+-.eE \t\r\n"
MAX_BYTES = 64_000_000
_MAX_VALUES = 16_000_000
_BLOCK_VALUES = 250_000
_NEGLIGIBLE = 1e-30  # far below any angle or length; its products would underflow


@dataclass(frozen=True, eq=False)
class BvhFile:
    """What a BVH file holds.

    clip: rest rotations are the identity, lengths in the file's units; channels: per joint, in file order;
    declared_frames: the header's count, which may be wrong (then it is among the findings, and the clip has the
    rows there are); end_sites: leaf joint name -> (3,) offset.
    """

    clip: Clip
    channels: tuple[tuple[str, ...], ...]
    declared_frames: int
    end_sites: Mapping[str, Floats]
    findings: list[str]


def read_bvh(
    path: Path | str,
    *,
    max_bytes: int = MAX_BYTES,
    max_joints: int = 2_000,
    max_depth: int = 200,
    max_frames: int = 200_000,
) -> BvhFile:
    """Read a BVH file. Raises BadInput with path:line:col for whatever is not one."""
    path = Path(path)
    text = BvhText(read_bytes(path, max_bytes=max_bytes, what="BVH file"), path)
    joints, offset, findings = read_hierarchy(text, max_joints=max_joints, max_depth=max_depth)
    declared, frame_time_s, offset = _motion_header(text, offset)
    columns = sum(len(joint.channels) for joint in joints)
    if columns == 0:
        raise BadInput("no joint has any channel", where=Where(path))
    rows = _motion_rows(text, offset, columns, min(max_frames, _MAX_VALUES // columns))
    if len(rows) != declared:
        findings.append(f"{path}: the header says {declared} frames but there are {len(rows)}; these are used")
    rotation, translation = _poses(joints, rows)
    offsets = np.array([joint.offset for joint in joints], dtype=np.float64)
    identity = np.broadcast_to(quat.IDENTITY, (len(joints), 4))
    parents = np.array([joint.parent for joint in joints], dtype=np.intp)
    skeleton = Skeleton(tuple(joint.name for joint in joints), parents, offsets, identity)
    return BvhFile(
        Clip(skeleton, frame_time_s, rotation, translation, name=path.stem),
        tuple(joint.channels for joint in joints),
        declared,
        {joint.name: np.array(joint.end_site) for joint in joints if joint.end_site is not None},
        findings,
    )


def _motion_header(text: BvhText, offset: int) -> tuple[int, float, int]:
    """Declared frame count, frame time in seconds, byte offset of the first row."""
    found: dict[str, Token] = {}
    for start, line in text.lines(offset):
        if not line.strip():
            continue
        match = _HEADER.fullmatch(line[:200])
        if match is None:
            where = text.where(start)
            raise BadInput(where=where, expected="'Frames:' and 'Frame Time:'", seen=_shown(line.strip()))
        key = "time" if b"ime" in match.group(1).lower() else "frames"
        found[key] = Token(_shown(match.group(2)), text.where(start + match.start(2)))
        if len(found) == 2:
            offset = start + len(line)
            break
    else:
        raise BadInput(
            where=text.where(len(text.data)), expected="'Frames:' and 'Frame Time:'", seen="the end of the file"
        )
    count, time = found["frames"], found["time"]
    if not count.text.isdecimal() or len(count.text) > 18:
        raise BadInput(where=count.where, expected="a number of frames", seen=count.text)
    frame_time_s = number(time)
    if not 1e-6 <= frame_time_s <= 100.0:
        raise BadInput(where=time.where, expected="a frame time from 1e-6 to 100 seconds", seen=time.text)
    return int(count.text), frame_time_s, offset


def _motion_rows(text: BvhText, offset: int, columns: int, max_frames: int) -> Floats:
    """(F, columns) values of the motion block, one frame per line. Memory grows with the rows that are there."""
    # One look at the whole block for what no number contains, so that float() below cannot see nan, inf or 1_0.
    if text.data[offset:].translate(None, _NUMERIC):
        _refuse_odd_token(text, offset)
    values = array.array("d")
    frames = 0
    for start, line in text.lines(offset):
        words = line.split(None, columns)
        if len(words) != columns:
            if not words:
                continue
            raise _wrong_width(text, start, line, columns)
        if frames == max_frames:
            raise BadInput(where=text.where(start), expected=f"at most {max_frames} frames", seen="more")
        try:
            values.extend(map(float, words))
        except ValueError:
            _refuse_odd_token(text, start)
        frames += 1
    if frames == 0:
        raise BadInput(
            where=text.where(len(text.data)), expected="at least one row of motion", seen="the end of the file"
        )
    rows = np.frombuffer(values, dtype=np.float64).reshape(frames, columns)
    if max(rows.max(), -rows.min()) > LARGEST:  # also infinity, of a number like 1e999
        _refuse_odd_token(text, offset)
    rows[np.abs(rows) < _NEGLIGIBLE] = 0.0
    return rows


def _refuse_odd_token(text: BvhText, offset: int) -> None:
    """Find the first word of the motion block that is not a usable number and raise BadInput there."""
    for match in _WORD.finditer(text.data, offset):
        word = _shown(match.group())
        if not match.group().isascii() or not _is_number(word):
            number(Token(word, text.where(match.start())))


def _is_number(word: str) -> bool:
    try:
        return "_" not in word and abs(float(word)) <= LARGEST
    except ValueError:
        return False


def _wrong_width(text: BvhText, start: int, line: bytes, columns: int) -> BadInput:
    words = list(_WORD.finditer(line))
    at = words[columns].start() if len(words) > columns else len(line.rstrip())
    hint = "cut off?" if len(words) < columns and start + len(line) >= len(text.data.rstrip()) else None
    return BadInput(where=text.where(start + at), expected=f"{columns} numbers in this row", seen=len(words), hint=hint)


def _shown(data: bytes) -> str:
    return data[:60].decode("utf-8", errors="replace")


def _poses(joints: Sequence[BvhJoint], rows: Floats) -> tuple[Floats, Floats]:
    """Local rotations (F, J, 4) and translations (F, J, 3) from channel values (F, C)."""
    frames = len(rows)
    rotation = np.empty((frames, len(joints), 4))
    rotation[:] = quat.IDENTITY
    translation = np.empty((frames, len(joints), 3))
    translation[:] = np.array([joint.offset for joint in joints])
    column = 0
    turning: dict[str, list[tuple[int, list[int]]]] = {}
    for index, joint in enumerate(joints):
        order, turn_columns = "", []
        for channel in joint.channels:
            if channel.endswith("position"):
                translation[:, index, "XYZ".index(channel[0])] = rows[:, column]
            else:
                order += channel[0]
                turn_columns.append(column)
            column += 1
        if order:
            turning.setdefault(order, []).append((index, turn_columns))
    # All joints with the same channel order are turned at once.
    block = max(1, _BLOCK_VALUES // rows.shape[1])
    for order, group in turning.items():
        turned = [index for index, _ in group]
        turn_columns_of = np.array([columns for _, columns in group])
        # In blocks of frames, so that intermediate results stay small however long the take.
        for start in range(0, frames, block):
            angles_rad = np.radians(rows[start : start + block, turn_columns_of])
            rotation[start : start + block, turned] = quat.normalize(quat.from_euler(order, angles_rad))
    return rotation, translation


# Metres per unit of the programs we have met; the last is the CMU database's (inches scaled by 0.45).
_UNITS = (1.0, 0.01, 0.001, 0.0254, 0.3048, 0.0254 / 0.45)
_USUAL_HEIGHT_M = 1.6


def estimate_scale(clip: Clip) -> float:
    """Metres per unit of a person's clip, guessed from the rest pose: the known unit that gives a usual height."""
    position, _ = clip.skeleton.to_model(clip.skeleton.rest_rotation)
    extent = float(np.ptp(position, axis=0).max())
    if extent <= 0.0:
        return 1.0
    return min(_UNITS, key=lambda unit: abs(float(np.log(extent * unit / _USUAL_HEIGHT_M))))


def to_metres(clip: Clip, metres_per_unit: float | None = None) -> Clip:
    """The same motion with lengths in metres; the scale is estimated where None."""
    scale = estimate_scale(clip) if metres_per_unit is None else metres_per_unit
    rest = clip.skeleton
    skeleton = Skeleton(rest.names, rest.parents, rest.rest_translation * scale, rest.rest_rotation)
    return replace(clip, skeleton=skeleton, translation=clip.translation * scale)


def write_bvh(
    clip: Clip,
    path: Path | str,
    order: str = "ZXY",
    decimals: int = 5,
    end_sites: Mapping[str, Sequence[float]] | None = None,
) -> None:
    """Write a clip as BVH, lengths as they are, rotation channels in the given order on every joint.

    Roots and joints that leave their rest offset get six channels, the others three. end_sites: leaf name ->
    offset; a leaf without one gets half its own offset. Angles run on without jumps of 360°. The file appears
    whole or not at all.
    """
    order = order.upper()
    if sorted(order) != ["X", "Y", "Z"]:
        raise BadInput("BVH channel order", expected="an order of X, Y and Z", seen=order)
    skeleton = clip.skeleton
    slack = 0.5 * 10.0**-decimals
    moving = np.abs(clip.translation - skeleton.rest_translation).max(axis=(0, 2)) > slack
    moving |= skeleton.parents < 0
    sequence = _depth_first(skeleton)
    angles = np.degrees(np.unwrap(quat.to_euler(order, clip.rotation), axis=0))
    columns: list[NDArray[np.floating[Any]]] = []
    for joint in sequence:
        if moving[joint]:
            columns.append(clip.translation[:, joint])
        columns.append(angles[:, joint])
    # Adding zero turns -0.0 into 0.0.
    rows = np.round(np.concatenate(columns, axis=1), decimals) + 0.0
    template = " ".join([f"%.{decimals}f"] * rows.shape[1])
    head = _hierarchy_text(skeleton, sequence, moving, order, decimals, end_sites or {})
    body = [template % tuple(row) for row in rows.tolist()]
    lines = [*head, "MOTION", f"Frames: {len(clip)}", f"Frame Time: {clip.frame_time_s:.8f}", *body]
    write_text(Path(path), "\n".join(lines) + "\n")


def _depth_first(skeleton: Skeleton) -> list[int]:
    """Joint indices in the order BVH nests them."""
    children: list[list[int]] = [[] for _ in skeleton.names]
    roots: list[int] = []
    for joint, parent in enumerate(skeleton.parents.tolist()):
        (children[parent] if parent >= 0 else roots).append(joint)
    sequence: list[int] = []
    stack = roots[::-1]
    while stack:
        joint = stack.pop()
        sequence.append(joint)
        stack.extend(children[joint][::-1])
    return sequence


def _hierarchy_text(
    skeleton: Skeleton,
    sequence: Sequence[int],
    moving: NDArray[np.bool_],
    order: str,
    decimals: int,
    end_sites: Mapping[str, Sequence[float]],
) -> list[str]:
    def offset(values: Any) -> str:
        return "OFFSET " + " ".join(f"{v + 0.0:.{decimals}f}" for v in np.round(values, decimals))

    parents = skeleton.parents
    with_children = set(parents.tolist())
    lines, depth_of, depth = ["HIERARCHY"], {-1: -1}, 0
    turns = " ".join(f"{axis}rotation" for axis in order)
    for joint in sequence:
        level = depth_of[int(parents[joint])] + 1
        depth_of[joint] = level
        while depth > level:
            depth -= 1
            lines.append("\t" * depth + "}")
        name, tab = skeleton.names[joint], "\t" * level
        lines += [f"{tab}{'ROOT' if parents[joint] < 0 else 'JOINT'} {name}", f"{tab}{{"]
        lines.append(f"{tab}\t{offset(skeleton.rest_translation[joint])}")
        channels = f"6 Xposition Yposition Zposition {turns}" if moving[joint] else f"3 {turns}"
        lines.append(f"{tab}\tCHANNELS {channels}")
        depth = level + 1
        if joint not in with_children:
            end = end_sites.get(name, 0.5 * skeleton.rest_translation[joint])
            lines += [f"{tab}\tEnd Site", f"{tab}\t{{", f"{tab}\t\t{offset(end)}", f"{tab}\t}}"]
    while depth > 0:
        depth -= 1
        lines.append("\t" * depth + "}")
    return lines
