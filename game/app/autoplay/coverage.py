"""What a run reached of a stall, against all there is."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from game.app.autoplay.runs import Run
from game.app.autoplay.tally import Coverage
from game.app.content import load_talk_assets, stall_path
from game.app.loading import load_planner
from game.core.emotion_space import EMOTIONS
from game.face import load_face
from game.story import Script
from game.story.reach import conditions_of

__all__ = ["KINDS", "Reached", "covered"]

KINDS = ("nodes", "choices", "offered", "lines", "conditions", "labels", "units", "parts")
"""nodes passed; choices taken; choices offered; lines spoken; conditions that held and failed; felt labels met;
motion units seen; face parts drawn. The last two only where bodies were played."""


@dataclass(frozen=True)
class Reached:
    """One kind of part: how many of how many, and which are missing with the place in the script where they stand."""

    kind: str
    reached: int
    total: int
    missing: tuple[tuple[str, str], ...]

    @property
    def share(self) -> float:
        """In [0, 1]; 1 where there is nothing to reach."""
        return self.reached / self.total if self.total else 1.0


def covered(run: Run, stall: str) -> dict[str, Reached]:
    """By kind, for one stall of a run."""
    script = load_talk_assets(stall_path(stall)).script
    coverage = run.coverage.get(stall, Coverage())
    found = {
        "nodes": _of("nodes", coverage.nodes, {name: str(node.where) for name, node in script.nodes.items()}),
        "choices": _of("choices", coverage.chosen, _choices(script)),
        "offered": _of("offered", coverage.offered, _choices(script)),
        "lines": _of("lines", coverage.lines, _spoken_lines(script)),
        "labels": _of("labels", coverage.labels, dict.fromkeys(EMOTIONS, "")),
    }
    if coverage.conditions:
        found["conditions"] = _conditions(script, coverage.conditions)
    if coverage.units:
        units = load_planner().library.units
        found["units"] = _of("units", coverage.units, {unit.name: unit.layer for unit in units if not unit.is_rest})
    if coverage.parts:
        regions = load_face().model.parts.regions
        found["parts"] = _of("parts", coverage.parts, {part: r.name for r in regions for part in r.names})
    return {kind: found[kind] for kind in KINDS if kind in found}


def _of(kind: str, reached: Collection[str], all_of: Mapping[str, str]) -> Reached:
    missing = tuple((name, where) for name, where in all_of.items() if name not in reached)
    return Reached(kind, len(all_of) - len(missing), len(all_of), missing)


def _choices(script: Script) -> dict[str, str]:
    return {name: str(choice.where) for name, choice in script.choices.items()}


def _spoken_lines(script: Script) -> dict[str, str]:
    """All that can be heard: a silent choice's words are only read."""
    silent = {line.id for choice in script.all_choices() if choice.silent for line in choice.texts}
    return {name: str(line.where) for name, line in script.lines.items() if name not in silent}


def _conditions(script: Script, counts: list[list[int]]) -> Reached:
    total, missing = 0, []
    for (what, where), (no, yes) in zip(_asked(script), counts, strict=True):
        total += 2
        if not yes:
            missing.append((f"{what}: never true", where))
        if not no:
            missing.append((f"{what}: never false", where))
    return Reached("conditions", total - len(missing), total, tuple(missing))


def _asked(script: Script) -> Iterator[tuple[str, str]]:
    """In the order of ``ConditionTrace``."""
    known: set[int] = set()
    for condition in conditions_of(script):
        if id(condition.expression) not in known:
            known.add(id(condition.expression))
            yield f"{condition.what}, if {condition.expression.source}", str(condition.where)
