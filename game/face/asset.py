"""Everything a face needs, read once: parts, weights, search, named expressions, timing, mouth shapes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.core import ASSETS, BadInput
from game.face.inverse import FaceSearch
from game.face.model import FaceModel, load_weights
from game.face.params import FIELDS, REGIONS
from game.face.parts import NamedExpression, load_expressions, load_parts
from game.face.speech import VisemeShapes, load_visemes
from game.formats import load_yaml, nearest

__all__ = ["FaceAsset", "FaceTiming", "load_face", "load_timing"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FaceTiming:
    """How a face changes: per region (in the order of REGIONS) and for the whole face; see ``timing.yaml``."""

    delay_s: Floats  # (4,)
    half_life_s: Floats  # (4,)
    margin: float
    hold_s: float
    micro_threshold: float
    micro_rate_hz: float
    micro_shortest_s: float
    micro_longest_s: float
    micro_depth: float
    speech_half_life_s: float
    speech_reach: float
    tremble_tears: float
    tremble_iris: float
    tremble_teeth_mm: float


def load_timing(path: Path) -> FaceTiming:
    """Read ``timing.yaml``. Raises BadInput with file:line:col."""
    root = load_yaml(path).only("version", "regions", "hysteresis", "micro", "speech", "tremble")
    root["version"].as_int(1, 1)
    table = root["regions"].only(*REGIONS)
    rows = [table[region].only("delay_s", "half_life_s") for region in REGIONS]
    hysteresis = root["hysteresis"].only("margin", "hold_s")
    micro = root["micro"].only("threshold", "rate_hz", "shortest_s", "longest_s", "depth")
    speech = root["speech"].only("half_life_s", "reach")
    tremble = root["tremble"].only("tears", "iris", "teeth_mm")
    shortest = micro["shortest_s"].as_float(0.0, 1.0)
    return FaceTiming(
        delay_s=np.array([row["delay_s"].as_float(0.0, 5.0) for row in rows]),
        half_life_s=np.array([row["half_life_s"].as_float(0.0, 10.0) for row in rows]),
        margin=hysteresis["margin"].as_float(0.0, 100.0),
        hold_s=hysteresis["hold_s"].as_float(0.0, 30.0),
        micro_threshold=micro["threshold"].as_float(0.0, 2.0),
        micro_rate_hz=micro["rate_hz"].as_float(0.0, 20.0),
        micro_shortest_s=shortest,
        micro_longest_s=micro["longest_s"].as_float(shortest, 2.0),
        micro_depth=micro["depth"].as_float(0.0, 1.0),
        speech_half_life_s=speech["half_life_s"].as_float(0.0, 1.0),
        speech_reach=speech["reach"].as_float(0.0, 2.0),
        tremble_tears=tremble["tears"].as_float(0.0, 1.0),
        tremble_iris=tremble["iris"].as_float(0.0, 1.0),
        tremble_teeth_mm=tremble["teeth_mm"].as_float(0.0, 5.0),
    )


@dataclass(frozen=True)
class FaceAsset:
    """One cast's face data, immutable and shared by all characters."""

    model: FaceModel
    search: FaceSearch
    expressions: Mapping[str, NamedExpression]
    timing: FaceTiming
    visemes: VisemeShapes

    def expression(self, name: str) -> NamedExpression:
        """A named expression. Raises BadInput, offering the nearest name."""
        if name in self.expressions:
            return self.expressions[name]
        near = nearest(name, self.expressions)
        raise BadInput(
            "expression",
            expected=" | ".join(self.expressions),
            seen=name,
            hint=f"did you mean {near!r}?" if near else None,
        )

    def per_number(self, per_region: Floats) -> Floats:
        """Spread values (4,) per region over the expression's numbers, (K,)."""
        return np.asarray(per_region[[REGIONS.index(field.region) for field in FIELDS]])


def load_face(folder: Path = ASSETS / "face") -> FaceAsset:
    """Read the face's folder. Raises BadInput with file:line:col for anything that does not fit."""
    parts = load_parts(folder / "parts.yaml")
    model = FaceModel(parts, load_weights(folder / "weights.yaml"))
    return FaceAsset(
        model=model,
        search=FaceSearch(model),
        expressions=load_expressions(folder / "expressions.yaml", parts),
        timing=load_timing(folder / "timing.yaml"),
        visemes=load_visemes(folder / "visemes.yaml"),
    )
