"""Which conditions of a script were asked, and with what answers."""

from __future__ import annotations

from typing import Any

from game.story import Script
from game.story.expressions import Expression, Scope
from game.story.prepared import Prepared
from game.story.reach import Condition, conditions_of

__all__ = ["ConditionTrace"]


class ConditionTrace:
    """Listens to every condition of a script that was loaded for this purpose alone.

    conditions: in the order of the script; counts: per condition [times false, times true].
    """

    def __init__(self, script: Script) -> None:
        self.conditions: list[Condition] = []
        self.counts: list[list[int]] = []
        known: set[int] = set()
        for condition in conditions_of(script):
            if id(condition.expression) not in known:
                known.add(id(condition.expression))
                self.conditions.append(condition)
                self.counts.append([0, 0])
                self._listen(condition.expression, self.counts[-1])
        # Nothing is settled beforehand: every condition is asked where it stands.
        for item in script.items:
            script.tables[item] = Prepared(script, item, settle=False)

    @staticmethod
    def _listen(expression: Expression, count: list[int]) -> None:
        asked = expression.evaluate

        def heard(scope: Scope) -> Any:
            answer = asked(scope)
            count[1 if answer else 0] += 1
            return answer

        # Expressions are frozen for everybody else; this script is ours.
        object.__setattr__(expression, "evaluate", heard)

    def take(self) -> list[list[int]]:
        """The counts so far, and begin anew."""
        taken = [list(count) for count in self.counts]
        for count in self.counts:
            count[:] = [0, 0]
        return taken
