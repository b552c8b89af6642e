"""Animations of a glTF document: checked channels, and poses sampled from them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from game.core import quaternion as quat
from game.formats.gltf_buffers import Buffers
from game.formats.gltf_model import Floats, GltfAnimation, GltfChannel, GltfFile, GltfMesh, GltfNode
from game.formats.json_shape import Report

__all__ = ["build_animations", "sample_local"]

_WIDTH = {"translation": 3, "rotation": 4, "scale": 3}


def build_animations(
    document: Mapping[str, Any],
    nodes: Sequence[GltfNode],
    meshes: Sequence[GltfMesh],
    buffers: Buffers,
    report: Report,
) -> tuple[GltfAnimation, ...]:
    """All animations. Raises BadInput for times that go back, values that do not fit, two channels on one property."""
    animations = []
    accessors = document.get("accessors", [])
    for index, source in enumerate(document.get("animations", [])):
        channels: list[GltfChannel] = []
        taken: set[tuple[int, str]] = set()
        for at, channel in enumerate(source["channels"]):
            pointer = ("animations", index, "channels", at)
            sampler_index, target = channel["sampler"], channel["target"]
            if sampler_index >= len(source["samplers"]):
                report.refuse(
                    (*pointer, "sampler"), expected=f"one of {len(source['samplers'])} samplers", seen=sampler_index
                )
            path = target["path"]
            if "node" not in target or path not in (*_WIDTH, "weights"):
                report.note((*pointer, "target"), "a channel that drives no node property, ignored")
                continue
            node = nodes[target["node"]]
            if (node.index, path) in taken:
                report.refuse((*pointer, "target"), "a second channel on the same property")
            taken.add((node.index, path))
            if path != "weights" and "matrix" in document["nodes"][node.index]:
                report.refuse((*pointer, "target"), "the node has a matrix and cannot be animated")
            width = _WIDTH.get(path, 0)
            if path == "weights":
                width = len(meshes[node.mesh].weights) if node.mesh is not None else 0
                if width == 0:
                    report.refuse((*pointer, "target"), "weights of a node without morph targets")
            sampler = source["samplers"][sampler_index]
            place = ("animations", index, "samplers", sampler_index)
            channels.append(_channel(node.index, path, width, sampler, accessors, buffers, report, place))
        animations.append(GltfAnimation(source.get("name", ""), tuple(channels)))
    return tuple(animations)


def _channel(
    node: int,
    path: str,
    width: int,
    sampler: Mapping[str, Any],
    accessors: Sequence[Mapping[str, Any]],
    buffers: Buffers,
    report: Report,
    pointer: tuple[str | int, ...],
) -> GltfChannel:
    interpolation = sampler.get("interpolation", "LINEAR")
    times = buffers.accessor(sampler["input"])
    if times.ndim != 1 or times.dtype.kind != "f":
        report.refuse((*pointer, "input"), expected="SCALAR floats", seen=f"{times.dtype} {times.shape[1:]}")
    times_s = times.astype(np.float64)
    steps = np.diff(times_s)
    if times_s[0] < 0 or np.any(steps < 0):
        report.refuse((*pointer, "input"), expected="times from 0 that increase", seen="times that go back")
    if not {"min", "max"} <= accessors[sampler["input"]].keys():
        report.note((*pointer, "input"), "times without min and max")
    if np.any(steps == 0):
        report.note((*pointer, "input"), "the same time twice")
    values = buffers.accessor(sampler["output"])
    scalar = path == "weights"
    if values.dtype.kind != "f" or (values.ndim != 1 if scalar else values.shape[1:] != (width,)):
        expected = f"{'SCALAR' if scalar else f'VEC{width}'} floats or normalised integers"
        report.refuse((*pointer, "output"), expected=expected, seen=f"{values.dtype} {values.shape[1:]}")
    cubic = interpolation == "CUBICSPLINE"
    if cubic and len(times_s) < 2:
        report.refuse((*pointer, "input"), expected="at least 2 keys for CUBICSPLINE", seen=len(times_s))
    keys = len(times_s) * (3 if cubic else 1) * (width if scalar else 1)
    if len(values) != keys:
        report.refuse((*pointer, "output"), expected=f"{keys} elements", seen=len(values))
    shaped = values.astype(np.float64).reshape((len(times_s), 3, width) if cubic else (len(times_s), width))
    if path == "rotation":
        length = np.linalg.norm(shaped[:, 1] if cubic else shaped, axis=-1)
        if np.any(np.abs(length - 1.0) > 0.1):
            report.refuse(
                (*pointer, "output"),
                expected="unit quaternions",
                seen=f"length {length[np.abs(length - 1).argmax()]:.3f}",
            )
    for array in (times_s, shaped):
        array.setflags(write=False)
    return GltfChannel(node, path, times_s, shaped, interpolation)


def sample_local(file: GltfFile, animation: GltfAnimation, times_s: Floats) -> tuple[Floats, Floats, Floats]:
    """Local translation (T, N, 3), rotation (T, N, 4) and scale (T, N, 3) of all nodes at times (T,), clamped."""
    shape = (len(times_s), len(file.nodes))
    parts: dict[str, Floats] = {
        "translation": np.broadcast_to([node.translation for node in file.nodes], (*shape, 3)).copy(),
        "rotation": np.broadcast_to([node.rotation for node in file.nodes], (*shape, 4)).copy(),
        "scale": np.broadcast_to([node.scale for node in file.nodes], (*shape, 3)).copy(),
    }
    for channel in animation.channels:
        if channel.path in parts:
            parts[channel.path][:, channel.node] = _sample(channel, times_s)
    return parts["translation"], parts["rotation"], parts["scale"]


def _sample(channel: GltfChannel, times_s: Floats) -> Floats:
    keys, values = channel.times_s, channel.values
    cubic = channel.interpolation == "CUBICSPLINE"
    rotation = channel.path == "rotation"
    if len(keys) == 1:
        return np.broadcast_to(values[0], (len(times_s), values.shape[-1]))
    at = np.clip(times_s, keys[0], keys[-1])
    low = np.clip(np.searchsorted(keys, at, side="right") - 1, 0, len(keys) - 2)
    span = np.maximum(keys[low + 1] - keys[low], 1e-9)[:, None]
    t = np.clip((at - keys[low])[:, None] / span, 0.0, 1.0)
    if channel.interpolation == "STEP":
        return np.asarray(np.where(t >= 1.0, values[low + 1], values[low]))
    if cubic:
        # Hermite spline, specification appendix C.5.
        a, b = values[low], values[low + 1]
        t2, t3 = t * t, t * t * t
        mixed = (2 * t3 - 3 * t2 + 1) * a[:, 1] + span * (t3 - 2 * t2 + t) * a[:, 2]
        mixed = mixed + (3 * t2 - 2 * t3) * b[:, 1] + span * (t3 - t2) * b[:, 0]
        return np.asarray(quat.normalize(mixed) if rotation else mixed)
    if rotation:
        return np.asarray(quat.slerp(quat.normalize(values[low]), quat.normalize(values[low + 1]), t[:, 0]))
    return np.asarray(values[low] * (1 - t) + values[low + 1] * t)
