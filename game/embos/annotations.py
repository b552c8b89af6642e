"""Takes: a BVH file and, of the same name, a YAML file that marks spans of it by layer and behaviour.

Whatever is wrong in a folder of takes is found in one go, each finding with its file and line.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.core.clip import Clip
from game.core.emotion_space import EMOTION_INDEX, EMOTIONS
from game.core.errors import BadInput, Where
from game.core.humanoid import REFERENCE
from game.embos.clips import TakeClip
from game.embos.findings import Findings
from game.embos.repertoire import Behaviour
from game.embos.units import LAYERS
from game.embos.units_file import one_of
from game.formats.bvh import read_bvh
from game.formats.yaml_source import Node, load_yaml, nearest

__all__ = ["ReadClip", "Span", "Take", "check_fps", "check_frames", "read_takes", "reference_clip"]

_OFFSET_TOLERANCE_M = 0.005
_LEAST_POSTURE_S = 1.0
_SLACK_S = 1e-6


@dataclass(frozen=True)
class Span:
    """One annotated stretch of a take, seconds. where: its place in the annotation file."""

    layer: str
    behaviour: str
    start_s: float
    end_s: float
    stroke_s: float | None
    where: Where

    @property
    def length_s(self) -> float:
        """Seconds."""
        return self.end_s - self.start_s


@dataclass(frozen=True)
class Take:
    """One performance of the scene in one emotion (index 0..6), spans in order of their start."""

    name: str
    emotion: int
    clip: TakeClip
    spans: tuple[Span, ...]

    def of_layer(self, layer: str) -> list[Span]:
        """The spans of one layer."""
        return [span for span in self.spans if span.layer == layer]


ReadClip = Callable[[Path, Node | None], TakeClip]
"""Reads a BVH file's motion; the frame rate its annotation says is checked."""


def read_takes(
    folder: Path, repertoire: Mapping[str, Behaviour], findings: Findings, read_clip: ReadClip | None = None
) -> list[Take]:
    """All takes of a folder, in order of their names; what is wrong goes into the findings.

    read_clip: reads a motion (default: reference_clip).
    """
    paths = sorted(folder.glob("*.yaml")) if folder.is_dir() else []
    # Names that begin with a dot are work in progress: the annotation desk's autosaves.
    paths = [path for path in paths if path.name != "behaviours.yaml" and not path.name.startswith(".")]
    takes: list[Take] = []
    if not paths:
        hint = "one NAME.yaml and NAME.bvh per take"
        findings.add(BadInput("takes", where=Where(folder), expected="annotated takes", seen="none", hint=hint))
        return takes
    emotions: set[int] = set()
    for path in paths:
        with findings.collect(reading=True):
            root = load_yaml(path)
            with findings.collect():
                take = _take(path, root, repertoire, findings, emotions, read_clip or reference_clip)
                if take is not None:
                    takes.append(take)
    for k, emotion in enumerate(EMOTIONS):
        if k not in emotions:
            findings.add(BadInput("takes", where=Where(folder), expected=f"a take of {emotion}", seen="none"))
    return takes


def _take(
    path: Path,
    root: Node,
    repertoire: Mapping[str, Behaviour],
    findings: Findings,
    emotions: set[int],
    read_clip: ReadClip,
) -> Take | None:
    root.only("take", "emotion", "bvh", "author", "version", "fps", "frames", "spans", "spoken", "note", "licence")
    emotion, clip = -1, None
    name = path.stem
    with findings.collect():
        if root["take"].as_str() != path.stem:
            raise root["take"].error("take", expected=f"the file's name, {path.stem!r}")
    with findings.collect():
        emotion = EMOTION_INDEX[one_of(root["emotion"], EMOTIONS)]
        emotions.add(emotion)
    with findings.collect():
        bvh = root["bvh"].as_str()
        if Path(bvh).name != bvh or bvh in {"", ".", ".."}:
            raise root["bvh"].error("bvh", expected="a file name in this folder")
        with findings.collect(reading=True):
            clip = read_clip(path.parent / bvh, root.get("fps"))
    spans = _spans(root, repertoire, clip, findings)
    if emotion < 0 or clip is None or not spans:
        return None
    return Take(name, emotion, clip, tuple(sorted(spans, key=lambda span: (span.start_s, span.layer))))


def reference_clip(path: Path, fps: Node | None = None) -> TakeClip:
    """A BVH file's motion on the reference skeleton. fps: what its annotation says, to be checked. Raises BadInput."""
    clip = read_bvh(path).clip
    check_fps(path, clip.frame_time_s, fps)
    skeleton = clip.skeleton
    missing = [joint for joint in REFERENCE.names if joint not in skeleton.index]
    foreign = [joint for joint in skeleton.names if joint not in REFERENCE.index]
    if missing or foreign:
        raise BadInput(
            "skeleton", where=_place(path, foreign[0] if foreign else skeleton.names[0]),
            expected=f"the {len(REFERENCE)} joints of the reference humanoid",
            seen=f"missing {', '.join(missing[:4]) or 'none'}; foreign {', '.join(foreign[:4]) or 'none'}",
            hint="retarget it first",
        )  # fmt: skip
    order = np.array([skeleton.index[joint] for joint in REFERENCE.names])
    _same_rest(path, skeleton.rest_translation[order], _parents(clip, order))
    if len(clip) < 2:
        raise BadInput("take", where=Where(path), expected="at least 2 frames", seen=len(clip))
    root_joint = REFERENCE.index["hips"]
    return TakeClip(
        clip.rotation[:, order].astype(np.float32), clip.translation[:, order[root_joint]].astype(np.float32),
        clip.frame_time_s,
    )  # fmt: skip


def check_fps(path: Path, frame_time_s: float, fps: Node | None) -> None:
    """Raises BadInput where an annotation says another frame rate than its motion has."""
    if fps and abs(fps.as_float(1.0, 1000.0) * frame_time_s - 1.0) > 1e-3:
        raise fps.error("fps", expected=f"{1.0 / frame_time_s:.3f} as in {path.name}")


def _parents(clip: Clip, order: NDArray[np.intp]) -> list[str]:
    names = clip.skeleton.names
    return [names[p] if p >= 0 else "" for p in clip.skeleton.parents[order]]


def _same_rest(path: Path, offsets: NDArray[np.floating], parents: Sequence[str]) -> None:
    """Raises BadInput at the first joint that hangs elsewhere than in the reference, with how many more there are."""
    wanted = [REFERENCE.names[p] if p >= 0 else "" for p in REFERENCE.parents]
    hung = [i for i in range(len(REFERENCE)) if parents[i] != wanted[i]]
    # The root's rest place may differ: its channels replace it.
    gap = np.abs(offsets - REFERENCE.rest_translation).max(axis=1)
    far = [i for i in range(len(REFERENCE)) if REFERENCE.parents[i] >= 0 and gap[i] > _OFFSET_TOLERANCE_M]
    if not hung and not far:
        return
    first = min(hung + far)
    joint, others = REFERENCE.names[first], len({*hung, *far}) - 1
    more = f" (and {others} more joints)" if others else ""
    if first in hung:
        raise BadInput(f"joint {joint}{more}", where=_place(path, joint), expected=f"parent {wanted[first]!r}",
                       seen=parents[first], hint="retarget it first")  # fmt: skip
    offset_m = np.round(REFERENCE.rest_translation[first], 4).tolist()
    raise BadInput(
        f"joint {joint}{more}", where=_place(path, joint), seen=np.round(offsets[first], 4).tolist(),
        expected=f"the reference humanoid's offset in metres, {offset_m}",
        hint="retarget it first",
    )  # fmt: skip


def _place(path: Path, joint: str) -> Where:
    """The line of a BVH file on which a joint begins."""
    lines = path.read_text("utf-8", errors="replace").splitlines()
    found = (number for number, line in enumerate(lines, 1) if line.split()[:2] in (["JOINT", joint], ["ROOT", joint]))
    return Where(path, line=next(found, 1))


def _spans(root: Node, repertoire: Mapping[str, Behaviour], clip: TakeClip | None, findings: Findings) -> list[Span]:
    spans: list[Span] = []
    items = root["spans"].as_list() if root.get("spans") else []
    if not items:
        findings.add(BadInput("take", where=root.where, expected="annotated spans", seen="none"))
    for node in items:
        with findings.collect():
            span = _span(node, repertoire, clip)
            # What a program proposed and nobody has looked at is not yet an observation.
            if node.get("confidence") is None:
                spans.append(span)
    for layer in LAYERS:
        # Within one layer only one thing can be done at a time.
        own = sorted((s for s in spans if s.layer == layer), key=lambda s: (s.start_s, s.end_s))
        for before, after in itertools.pairwise(own):
            if after.start_s < before.end_s - _SLACK_S:
                findings.add(
                    BadInput(
                        f"overlapping {layer} spans",
                        where=after.where,
                        expected=f"a start at or after {before.end_s:g} s, where {before.behaviour} ends",
                        seen=after.start_s,
                    )
                )
    if items and not any(span.layer == "posture" for span in spans):
        findings.add(BadInput("take", where=root["spans"].where, expected="at least one posture span", seen="none"))
    return spans


def check_frames(node: Node, start_s: float, end_s: float, fps: float) -> None:
    """Raises BadInput where a span's frames do not agree with its seconds to within one frame."""
    pair = [frame.as_int(0, 10_000_000) for frame in node.as_list()]
    wanted = (start_s * fps, end_s * fps)
    if len(pair) != 2 or any(abs(f - t) > 1.0 + 1e-6 for f, t in zip(pair, wanted, strict=True)):
        raise node.error("frames", expected=f"[{round(wanted[0])}, {round(wanted[1])}], as the seconds say")


def _span(node: Node, repertoire: Mapping[str, Behaviour], clip: TakeClip | None) -> Span:
    node.only("layer", "behaviour", "start_s", "end_s", "frames", "stroke_s", "words", "note", "confidence")
    layer = one_of(node["layer"], LAYERS)
    behaviour = node["behaviour"].as_str()
    known = repertoire.get(behaviour)
    if known is None:
        close = nearest(behaviour, repertoire)
        raise node["behaviour"].error(
            "unknown behaviour", expected="one of behaviours.yaml", hint=f"did you mean {close!r}?" if close else None
        )
    if known.layer != layer:
        raise node["layer"].error(f"behaviour {behaviour}", expected=f"layer {known.layer}")
    start_s = node["start_s"].as_float(0.0)
    end_s = node["end_s"].as_float(0.0)
    if end_s <= start_s:
        raise node["end_s"].error("span", expected=f"an end after its start at {start_s:g} s")
    if clip is not None and end_s > clip.length_s + 0.5 * clip.frame_time_s:
        raise node["end_s"].error("span outside the clip", expected=f"at most {clip.length_s:.3f} s")
    if layer == "posture" and end_s - start_s < _LEAST_POSTURE_S - _SLACK_S:
        raise node["end_s"].error("posture", expected=f"at least {_LEAST_POSTURE_S:g} s after {start_s:g} s")
    frames = node.get("frames")
    if frames is not None and clip is not None:
        check_frames(frames, start_s, end_s, 1.0 / clip.frame_time_s)
    stroke = node.get("stroke_s")
    stroke_s = stroke.as_float() if stroke else None
    if stroke is not None and stroke_s is not None and not start_s <= stroke_s <= end_s:
        raise stroke.error("stroke", expected=f"a moment from {start_s:g} to {end_s:g} s")
    return Span(layer, behaviour, start_s, end_s, stroke_s, node.where)
