"""The planner's constants: data with the defaults of SPEC 3 to 5, each with its unit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from game.core.errors import BadInput
from game.embos.stress import StressRule
from game.embos.units import LAYERS, LAYERS_WITH_REST
from game.formats.yaml_source import Node, load_yaml

__all__ = ["PlannerConfig", "load_config"]


@dataclass(frozen=True)
class PlannerConfig:
    """Constants of eq. 1 to 5. Raises BadInput for values outside their ranges.

    layers: upper first. continuity_floor, transition_share: 0..1; sigma_rad > 0. minimum: layer -> φ_time while
    waiting; steady: φ_time of a unit that neither runs nor waits. least_s: layer -> seconds a started unit keeps
    going. spread: scales the takes' spread in the random factors. look_s: seconds between two looks at times and
    emotion, 0: every tick. settled: layers whose units are taken to have run before the first tick, so that not all
    are free at once; eager: 0..1, share of that wait that is left when the emotion leaps. rest: layer -> φ_state of
    its rest unit. presence: 0..1, by how much φ_state is scaled by the share of what is felt in which a unit was ever
    seen: at joy ½, anger ½ the difference d alone cannot tell a unit of pure joy (d = ½) from one that neither ever
    showed. tolerance: change of emotion that makes φ_state be computed anew. radius: r of eq. 5. word_window_s: seconds
    a word's moment stays open. lead_in_s: most seconds a line waits for the preparation of its first gesture. stress:
    which words beats may fall on.
    """

    layers: tuple[str, ...] = LAYERS
    continuity_floor: float = 0.1
    transition_share: float = 0.5
    sigma_rad: float = 0.3
    minimum: Mapping[str, float] = field(
        default_factory=lambda: {"posture": 0.02, "gesture": 0.0005, "mannerism": 0.0005}
    )
    steady: float = 0.5
    least_s: Mapping[str, float] = field(default_factory=lambda: {"posture": 1.0, "gesture": 0.5, "mannerism": 0.5})
    spread: float = 1.0
    look_s: float = 0.0
    settled: tuple[str, ...] = ("mannerism",)
    eager: float = 0.3
    rest: Mapping[str, float] = field(default_factory=lambda: dict.fromkeys(LAYERS_WITH_REST, 0.02))
    presence: float = 1.0
    tolerance: float = 0.02
    radius: float = 0.5
    word_window_s: float = 0.1
    lead_in_s: float = 0.7
    stress: StressRule = field(default_factory=StressRule)

    def __post_init__(self) -> None:
        if sorted(self.layers) != sorted(LAYERS):
            raise BadInput("planner layers", expected=f"each of {', '.join(LAYERS)} once", seen=list(self.layers))
        if not set(self.settled) <= set(LAYERS):
            raise BadInput("planner settled", expected=f"some of {', '.join(LAYERS)}", seen=list(self.settled))
        for name, low, high in (
            ("continuity_floor", 0.0, 1.0),
            ("transition_share", 0.0, 1.0),
            ("sigma_rad", 1e-6, 100.0),
            ("steady", 0.0, 1.0),
            ("spread", 0.0, 10.0),
            ("look_s", 0.0, 1.0),
            ("eager", 0.0, 1.0),
            ("presence", 0.0, 1.0),
            ("tolerance", 0.0, 1.0),
            ("radius", 1e-3, 100.0),
            ("word_window_s", 0.0, 10.0),
            ("lead_in_s", 0.0, 10.0),
        ):
            value = getattr(self, name)
            if not low <= value <= high:
                raise BadInput(f"planner {name}", expected=f"{low:g} to {high:g}", seen=value)


def load_config(path: Path) -> PlannerConfig:
    """Read planner.yaml; a missing key keeps its default. Raises BadInput with file:line:col."""
    root = load_yaml(path).only("layers", "continuity", "time", "state", "mixing", "words")
    values: dict[str, object] = {name: name for name in ("minimum", "steady", "least_s", "spread", "look_s", "settled")}
    layers = root.get("layers")
    if layers:
        values["layers"] = tuple(item.as_str() for item in layers)
    for section, names in (
        ("continuity", {"floor": "continuity_floor", "transition_share": "transition_share", "sigma_rad": "sigma_rad"}),
        (
            "time",
            {
                "minimum": "minimum",
                "steady": "steady",
                "least_s": "least_s",
                "spread": "spread",
                "look_s": "look_s",
                "settled": "settled",
                "eager": "eager",
            },
        ),
        ("state", {"rest": "rest", "presence": "presence", "tolerance": "tolerance"}),
        ("mixing", {"radius": "radius"}),
        ("words", {"window_s": "word_window_s", "lead_in_s": "lead_in_s", "stress": "stress"}),
    ):
        node = root.get(section)
        for key, value in node.only(*names).items() if node else []:
            name = names[key.as_str()]
            if name in ("least_s", "minimum"):
                values[name] = _per_layer(value, LAYERS, 0.0, 60.0 if name == "least_s" else 1.0)
            elif name == "stress":
                values[name] = _stress(value)
            elif name == "settled":
                values[name] = tuple(item.as_str() for item in value)
            elif name == "rest":
                values[name] = _per_layer(value, LAYERS_WITH_REST, 1e-6, 1.0)
            else:
                values[name] = value.as_float()
    try:
        return PlannerConfig(**values)  # type: ignore[arg-type]  # checked key by key above
    except BadInput as error:
        raise BadInput(error.message, where=root.where) from None


def _stress(node: Node) -> StressRule:
    node.only("units", "least_s", "apart_s", "clear_s", "unstressed")
    values: dict[str, object] = {
        name: node[name].as_float(0.0, 60.0) for name in ("least_s", "apart_s", "clear_s") if name in node
    }
    if "units" in node:
        values["units"] = tuple(item.as_str() for item in node["units"])
    if "unstressed" in node:
        words = node["unstressed"].items()
        values["unstressed"] = {key.as_str(): frozenset(item.as_str() for item in row) for key, row in words}
    return StressRule(**values)  # type: ignore[arg-type]  # checked key by key above


def _per_layer(node: Node, layers: tuple[str, ...], low: float, high: float) -> dict[str, float]:
    node.only(*layers)
    return {layer: node[layer].as_float(low, high) for layer in layers}
