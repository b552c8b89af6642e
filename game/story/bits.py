"""Sets of lines, choices and nodes as whole numbers: a question about many of them is one operation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

__all__ = ["Bits", "bits_of"]


class Bits:
    """A bit of a whole number for every line, choice and node, so that what happened in a talk is one number: lines
    said, choices taken, nodes passed. lines, choices, nodes: their bits by id; seen: the bits of all that has an id.
    """

    __slots__ = ("_ids", "choices", "lines", "nodes", "seen")

    def __init__(self, *ids: tuple[str, ...]) -> None:
        """ids: of lines, of choices, of nodes."""
        self._ids = tuple([name for each in ids for name in each])
        bits = iter([1 << at for at in range(len(self._ids))])
        self.lines, self.choices, self.nodes = [dict(zip(each, bits, strict=False)) for each in ids]
        self.seen = {
            name: self.lines.get(name, 0) | self.choices.get(name, 0) | self.nodes.get(name, 0) for name in self._ids
        }

    def ids(self, kind: Mapping[str, int], past: int) -> frozenset[str]:
        """The ids of one kind (``lines``, ``choices`` or ``nodes``) among what happened."""
        left, found = past & sum(kind.values()), []
        while left:
            low = left & -left
            found.append(self._ids[low.bit_length() - 1])
            left ^= low
        return frozenset(found)


def bits_of(kind: Mapping[str, int], ids: Iterable[str]) -> int:
    """The number that stands for different ids, as far as they are known."""
    return sum([kind.get(name, 0) for name in ids])
