"""What is left of the choices that a node draws from, by act."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from game.story.acts import ActTable
from game.story.expressions import Scope
from game.story.ready import Few, Left, ReadyChoice, Test

__all__ = ["Act", "Pool", "Round"]


class Act:
    """The choices of a pool that perform one act."""

    __slots__ = ("_left", "choices", "gone", "name", "used")

    def __init__(self, name: str, choices: Sequence[tuple[ReadyChoice, Test | None]]) -> None:
        self.name, self.choices = name, tuple(choices)
        self.used = sum([choice.used for choice, _ in choices])
        self.gone = sum([choice.gone for choice, _ in choices])
        self._left: Few[int, Left[ReadyChoice]] = Few()

    def left(self, past: int, seen: int) -> Left[ReadyChoice]:
        """What is left of it where so much happened in the talk (past) and ever at the stall (seen), as bits."""
        used = past & self.used | seen & self.gone
        try:
            return self._left[used]
        except KeyError:
            rest = [(choice, test) for choice, test in self.choices if not (choice.used | choice.gone) & used]
            return self._left.keep(used, Left(rest))


class Pool:
    """The choices that a node draws from, by act; count: how many it draws."""

    __slots__ = ("_gone", "_rounds", "_used", "acts", "count", "fair")

    def __init__(self, acts: Sequence[Act], count: int, fair: ActTable) -> None:
        self.acts, self.count, self.fair = tuple(acts), count, fair
        self._used = sum([act.used for act in acts])
        self._gone = sum([act.gone for act in acts])
        self._rounds: Few[int, Round] = Few(256)

    def round(self, past: int, seen: int) -> Round:
        """What is left of it where so much happened in the talk (past) and ever at the stall (seen), as bits."""
        used = past & self._used | seen & self._gone
        try:
            return self._rounds[used]
        except KeyError:
            lefts = {act.name: act.left(past, seen) for act in self.acts}
            return self._rounds.keep(used, Round({name: left for name, left in lefts.items() if left.items}, self))


class Round:
    """What is left of a pool, by act; sets: those of its acts that may be on offer together, where each of them is
    there without a question."""

    __slots__ = ("_lefts", "_pool", "_sets")

    def __init__(self, lefts: Mapping[str, Left[ReadyChoice]], pool: Pool) -> None:
        self._lefts, self._pool = lefts, pool
        self._sets = self._fair(lefts) if all(left.open for left in lefts.values()) else None

    def _fair(self, lefts: Mapping[str, Left[ReadyChoice]]) -> Sequence[Sequence[str]]:
        return self._pool.fair.fair_sets(tuple(lefts), self._pool.count) if lefts and self._pool.count > 0 else ()

    def sets(self, scope: Scope) -> tuple[Mapping[str, Left[ReadyChoice]], Sequence[Sequence[str]]]:
        """By act, choices of which some can be taken, and the sets of acts that may be on offer together."""
        if self._sets is not None:
            return self._lefts, self._sets
        here = {name: left for name, left in self._lefts.items() if left.open or left.any_usable(scope)}
        return here, self._fair(here)
