"""Parts and named expressions as a designer writes them: vector data and what each part says.

A part is a set of changes to the standard expression within one region, a Gaussian over (valence, arousal) as rated on
the standard face wearing only that part (Nagai et al., section 3.2), and affinities to the seven emotions.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.core import EMOTIONS, BadInput
from game.core.emotion_space import EMOTION_INDEX
from game.face.params import FIELDS, INDEX, REGIONS, FaceParams, face_params, region_mask
from game.formats import Node, load_yaml, nearest

__all__ = ["Face", "NamedExpression", "Parts", "Region", "load_expressions", "load_parts"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Region:
    """The parts of one region as arrays over its n parts; number 0 is the standard part."""

    name: str
    names: tuple[str, ...]
    labels: tuple[Mapping[str, str], ...]
    shape: Floats  # (n, K) whole expressions; only this region's numbers differ from the standard
    mean: Floats  # (n, 2) valence, arousal
    covariance: Floats  # (n, 2, 2)
    affinity: Floats  # (n, 7) in 0..1
    strength: Floats  # (n, 2) share of the shape shown at emotion strength 0 and 1

    def index(self, part: str) -> int:
        """The part's number. Raises BadInput, offering the nearest name."""
        if part in self.names:
            return self.names.index(part)
        near = nearest(part, self.names)
        raise BadInput(
            f"part of {self.name}",
            expected=" | ".join(self.names),
            seen=part,
            hint=f"did you mean {near!r}?" if near else None,
        )


@dataclass(frozen=True)
class Face:
    """One part per region, by name."""

    eyes: str = "standard"
    eyebrows: str = "standard"
    mouth: str = "standard"
    skin: str = "standard"

    @property
    def parts(self) -> tuple[str, str, str, str]:
        """The four names in the order of ``REGIONS``."""
        return self.eyes, self.eyebrows, self.mouth, self.skin


@dataclass(frozen=True)
class Parts:
    """All regions in the order of ``REGIONS``, and where the seven emotions stand, (7, 2)."""

    regions: tuple[Region, ...]
    places: Floats
    ratings: str  # who rated: shown wherever the numbers are presented

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of parts per region."""
        return tuple(len(region.names) for region in self.regions)

    def numbers(self, face: Face) -> tuple[int, ...]:
        """Part numbers (4,) of a face. Raises BadInput for an unknown part."""
        return tuple(region.index(name) for region, name in zip(self.regions, face.parts, strict=True))

    def face(self, numbers: Iterable[int]) -> Face:
        """The face of four part numbers."""
        return Face(*(region.names[i] for region, i in zip(self.regions, numbers, strict=True)))

    def params(self, numbers: Iterable[int], strength: float = 1.0) -> FaceParams:
        """The expression (K,) of four part numbers, shown as far as the emotion's strength 0..1 asks."""
        standard = np.array([f.standard for f in FIELDS])
        result = standard.copy()
        s = min(max(strength, 0.0), 1.0)
        s = s * s * (3.0 - 2.0 * s)
        for region, i in zip(self.regions, numbers, strict=True):
            low, high = region.strength[i]
            result += (low + (high - low) * s) * (region.shape[i] - standard)
        return result


@dataclass(frozen=True)
class NamedExpression:
    """A face with a name for the dialogue, and its numbers (K,)."""

    name: str
    label: Mapping[str, str]
    face: Face
    params: FaceParams


def _label(node: Node | None, fallback: str) -> Mapping[str, str]:
    if node is None:
        return {"en": fallback}
    return {key: value.as_str() for key, value in node.only("en", "ja").as_mapping().items()}


def _shape(node: Node | None, region: str | None, base: FaceParams) -> FaceParams:
    """``base`` changed by a mapping of parameter names; with a region, only that region's names are allowed."""
    result = base.copy()
    if node is None:
        return result
    known = [f.name for f in FIELDS if region is None or f.region == region]
    node.only(*known)
    for name, value in node.as_mapping().items():
        field = FIELDS[INDEX[name]]
        result[INDEX[name]] = value.as_float(field.low, field.high)
    return result


def _pair(node: Node, low: float, high: float) -> tuple[float, float]:
    items = node.as_list()
    if len(items) != 2:
        raise node.error(expected="a list of two numbers")
    return items[0].as_float(low, high), items[1].as_float(low, high)


def _read_region(name: str, node: Node) -> Region:
    names = [key.raw for key, _ in node.items()]
    if not names or names[0] != "standard":
        raise node.error(f"region {name}", expected="the part 'standard' first")
    if len(names) > 64:
        raise node.error(f"region {name}", expected="at most 64 parts")
    standard = face_params()
    labels, shapes, means, covariances, affinities, strengths = [], [], [], [], [], []
    for part, body in node.as_mapping().items():
        body.only("label", "shape", "mean", "deviation", "correlation", "affinity", "strength")
        labels.append(_label(body.get("label"), part))
        shapes.append(_shape(body["shape"], name, standard))
        means.append(_pair(body["mean"], -1.0, 1.0))
        valence, arousal = _pair(body["deviation"], 0.02, 1.0)
        together = body.get("correlation")
        cross = (together.as_float(-0.95, 0.95) if together is not None else 0.0) * valence * arousal
        covariances.append([[valence**2, cross], [cross, arousal**2]])
        row = np.zeros(len(EMOTIONS))
        for emotion, value in body["affinity"].only(*EMOTIONS).as_mapping().items():
            row[EMOTION_INDEX[emotion]] = value.as_float(0.0, 1.0)
        affinities.append(row)
        share = body.get("strength")
        strengths.append(_pair(share, 0.0, 1.0) if share is not None else (1.0, 1.0))
    arrays = [np.array(x, dtype=np.float64) for x in (shapes, means, covariances, affinities, strengths)]
    for array in arrays:
        array.setflags(write=False)
    outside = ~region_mask(name)
    if (arrays[0][0] != standard).any() or (arrays[0][:, outside] != standard[outside]).any():
        raise node.error(f"region {name}", expected="a standard part that changes nothing")
    return Region(name, tuple(names), tuple(labels), *arrays)


def load_parts(path: Path) -> Parts:
    """Read ``parts.yaml``. Raises BadInput with file:line:col for anything unknown or out of range."""
    root = load_yaml(path).only("version", "ratings", "emotions", "parts")
    root["version"].as_int(1, 1)
    emotions = root["emotions"].only(*EMOTIONS)
    places = np.array([_pair(emotions[name], -1.0, 1.0) for name in EMOTIONS])
    places.setflags(write=False)
    body = root["parts"].only(*REGIONS)
    regions = tuple(_read_region(name, body[name]) for name in REGIONS)
    return Parts(regions, places, root["ratings"].as_str())


def load_expressions(path: Path, parts: Parts) -> Mapping[str, NamedExpression]:
    """Read ``expressions.yaml``: name -> expression. Raises BadInput for unknown parts or numbers."""
    root = load_yaml(path).only("version", "expressions")
    root["version"].as_int(1, 1)
    result: dict[str, NamedExpression] = {}
    for name, body in root["expressions"].as_mapping().items():
        body.only("label", *REGIONS, "change")
        chosen = []
        for region in parts.regions:
            part = body[region.name]
            if part.as_str() not in region.names:
                near = nearest(part.as_str(), region.names)
                hint = f"did you mean {near!r}?" if near else None
                raise part.error("unknown part", expected=" | ".join(region.names), hint=hint)
            chosen.append(part.as_str())
        face = Face(*chosen)
        params = _shape(body.get("change"), None, parts.params(parts.numbers(face)))
        params.setflags(write=False)
        result[name] = NamedExpression(name, _label(body.get("label"), name), face, params)
    return result
