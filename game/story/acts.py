"""How each act lands on each felt emotion, and which four lines may stand side by side without telling it."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput
from game.formats.yaml_source import Node, load_yaml, nearest
from game.story.vocabulary import ACTS

__all__ = ["ActTable", "acts_from", "load_acts"]

_LETTERS = {"R": "right", ".": "neutral", "W": "wrong"}


@dataclass(frozen=True)
class ActTable:
    """``quality[act]``: seven of right | neutral | wrong, in the order of EMOTIONS."""

    quality: Mapping[str, tuple[str, ...]]
    lines_on_offer: int
    right_for_at_least: int = 6

    def judge(self, act: str, felt_label: str) -> str:
        """How an act lands on a felt emotion; ``offer`` alone and unknown acts are neutral."""
        row = self.quality.get(act)
        return "neutral" if row is None else row[EMOTIONS.index(felt_label)]

    def coverage(self, acts: Sequence[str]) -> int:
        """For how many of the seven emotions some act of the set is right."""
        return sum(any(self.judge(act, label) == "right" for act in acts) for label in EMOTIONS)

    def right_acts(self, acts: Sequence[str]) -> tuple[str, ...]:
        """The acts of the set that are right for any emotion at all."""
        return tuple(act for act in acts if "right" in self.quality.get(act, ()))

    @cached_property
    def _fair(self) -> dict[tuple[tuple[str, ...], int], tuple[tuple[str, ...], ...]]:
        return {}

    def fair_sets(self, available: Sequence[str], count: int) -> tuple[tuple[str, ...], ...]:
        """Sets of ``count`` acts that are right for at least six of seven emotions, or for as many as is possible."""
        found = self._fair.get((tuple(available), count))
        if found is not None:
            return found
        key = (tuple(act for act in ACTS if act in available), count)
        if key not in self._fair:
            sets = list(itertools.combinations(key[0], min(count, len(key[0]))))
            most = max(self.coverage(acts) for acts in sets)
            enough = min(most, self.right_for_at_least)
            self._fair[key] = tuple(acts for acts in sets if self.coverage(acts) >= enough)
        return self._fair[key]


def acts_from(root: Node, temperament: str) -> ActTable:
    """The ``acts`` of a rules file with one temperament's exceptions. Raises BadInput with file:line:col."""
    table = {key.as_str(): _row(value, None) for key, value in root["acts"].items()}
    for act in ACTS:
        root["acts"][act]  # every act of the language has its row
    people = root["people"]
    if temperament not in people:
        known = people.as_mapping()
        close = nearest(temperament, known)
        raise BadInput(
            "unknown temperament",
            where=people.where,
            expected=" | ".join(known),
            seen=temperament,
            hint=f"did you mean {close!r}?" if close else None,
        )
    exceptions = people[temperament].get("acts")
    for key, value in exceptions.items() if exceptions else ():
        act = key.as_str()
        if act not in table:
            raise BadInput("unknown act", where=key.where, expected=" | ".join(table), seen=act)
        table[act] = _row(value, table[act])
    return ActTable(table, root["constants"]["lines_on_offer"].as_int(1, len(ACTS)))


def load_acts(path: Path, temperament: str) -> ActTable:
    """Read the acts of a rules file for one temperament."""
    return acts_from(load_yaml(path), temperament)


def _row(node: Node, base: tuple[str, ...] | None) -> tuple[str, ...]:
    row = dict(zip(EMOTIONS, base, strict=True)) if base else {}
    for key, value in node.only(*EMOTIONS).items():
        if value.raw not in _LETTERS:
            raise BadInput(where=value.where, expected="R (right), W (wrong) or . (neutral)", seen=value.raw)
        row[key.as_str()] = _LETTERS[value.raw]
    missing = [name for name in EMOTIONS if name not in row]
    if missing:
        raise BadInput(where=node.where, expected="all seven emotions", seen=f"none for {', '.join(missing)}")
    return tuple(row[name] for name in EMOTIONS)
