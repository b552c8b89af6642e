"""Which nodes a talk can reach and which conditions can ever hold, by search over the values names can take."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from game.core.errors import Where
from game.story.expressions import Expression, Scope
from game.story.model import BACK, HOME, Branch, ChoiceDef, EffectDef, LineDef, NodeDef, SayDef, Script
from game.story.vocabulary import ENV, Value

__all__ = ["Condition", "Reach", "conditions_of"]

_MAX_ASSIGNMENTS = 20_000
_MAX_VALUES = 20


@dataclass(frozen=True)
class Condition:
    """A condition and what it decides about."""

    expression: Expression
    where: Where
    what: str


def conditions_of(script: Script) -> Iterator[Condition]:
    """Every condition of a script."""

    def of(expression: Expression | None, what: str) -> Iterator[Condition]:
        if expression is not None:
            yield Condition(expression, expression.where, what)

    for node in script.nodes.values():
        for say in node.says:
            yield from of(say.condition, f"lines of {node.id!r}")
            for line in say.lines:
                yield from of(line.condition, f"the line {line.id!r}")
        for branch in node.to:
            yield from of(branch.condition, f"the way to {branch.target!r}")
    for choice in script.all_choices():
        yield from of(choice.condition, f"the choice {choice.id!r}")
        yield from of(choice.needs, f"the choice {choice.id!r}")
        for line in choice.texts if len(choice.texts) > 1 else ():
            yield from of(line.condition, f"the wording {line.id!r}")
        for branch in choice.to:
            yield from of(branch.condition, f"the way to {branch.target!r}")


class Reach:
    """The least fixed point: nodes reached, lines and choices that can come up, values that variables can take.

    Conditions are tried on all combinations of values that can make a difference: both values of a bool, the
    known values of a text, for numbers the constants they are compared with and their neighbours. It
    over-approximates (each name is taken by itself), so what it calls unreachable is unreachable.
    """

    def __init__(self, script: Script) -> None:
        self.script = script
        self.nodes: set[str] = set()
        self.ids: set[str] = set()
        self.values: dict[str, set[Value]] = {name: {v.initial} for name, v in script.variables.items()}
        self.open: set[str] = {name for name, v in script.variables.items() if v.scope == "afternoon"}
        size = -1
        while size != (size := self._size()):
            self._spread()

    def _size(self) -> int:
        return len(self.nodes) + len(self.ids) + sum(map(len, self.values.values())) + 1000 * len(self.open)

    def _spread(self) -> None:
        script = self.script
        queue = [script.start, *script.outcomes.values()]
        done: set[str] = set()
        while queue:
            name = queue.pop()
            if name in {BACK, HOME}:
                name = script.home
            if name in done or name not in script.nodes:
                continue
            done.add(name)
            queue.extend(self._pass(script.nodes[name]))
        self.nodes |= done

    def _pass(self, node: NodeDef) -> list[str]:
        self.ids.add(node.id)
        self._apply(node.effects)
        for say in node.says:
            if self.holds(say.condition):
                self.ids.update(line.id for line in say.lines if self.holds(line.condition))
        out = [node.call] if node.call else []
        out += self._targets(node.to)
        if node.waits:
            for choice in self.script.choices_at(node):
                if self.holds(choice.condition) and self.holds(choice.needs):
                    self.ids.update((choice.id, *(line.id for line in choice.texts)))
                    self._apply(choice.effects, tuple(choice_conditions(choice)))
                    out += self._targets(choice.to)
        return out

    def _targets(self, branches: Sequence[Branch]) -> list[str]:
        out = []
        for branch in branches:
            if self.holds(branch.condition):
                out.append(branch.target)
            if branch.condition is None:
                break
        return out

    def _apply(self, effects: Sequence[EffectDef], guards: Sequence[Expression] = ()) -> None:
        for effect in effects:
            values = self.values[effect.name]
            if effect.name in self.open:
                continue
            found = self._outcomes(effect.value, guards)
            if found is None or len(values | found) > _MAX_VALUES:
                self.open.add(effect.name)
            else:
                values |= found

    def _outcomes(self, expression: Expression, guards: Sequence[Expression]) -> set[Value] | None:
        """All values an expression can take where its guards hold; None where they cannot be listed."""
        anything: set[Value] | None = {False, True} if expression.type == "bool" else None
        if any(self._is_open(name) for name in expression.names):
            return anything
        found: set[Value] = set()
        for scope in self._scopes(expression, *guards):
            if scope is None:
                return anything
            if all(not guard.simple or guard.evaluate(scope) for guard in guards):
                found.add(expression.evaluate(scope))
        return found

    def _is_open(self, name: str) -> bool:
        return name in self.open or (name in ENV and ENV[name].type == "number")

    def holds(self, expression: Expression | None) -> bool:
        """Whether a condition can hold; True where that cannot be decided."""
        return self._some(expression, True)

    def fails(self, expression: Expression) -> bool:
        """Whether a condition can fail; True where that cannot be decided."""
        return self._some(expression, False)

    def _some(self, expression: Expression | None, wanted: bool) -> bool:
        if expression is None:
            return wanted
        if not expression.simple:
            return True
        return any(scope is None or bool(expression.evaluate(scope)) == wanted for scope in self._scopes(expression))

    def values_of(self, kind: str, name: str, expression: Expression) -> Sequence[Value] | None:
        """What a name of an expression may be (kind: variable, visits or seen); None where that cannot be listed."""
        constants = expression.compared.get(f"visits.{name}" if kind == "visits" else name, frozenset())
        if kind == "seen":
            return (False, True) if name in self.ids or name in self.nodes else (False,)
        if kind == "visits":
            return self._visit_domain(name, constants) if expression.simple else None
        listed = expression.simple or not self._is_open(name)
        return self._domain(name, constants) if listed else None

    def _scopes(self, *expressions: Expression) -> Iterator[Scope | None]:
        """Scopes that can make a difference to some expressions; None once where there are too many."""
        names = sorted({name for e in expressions for name in e.names})
        visits = sorted({name for e in expressions for name in e.visits})
        seen = sorted({name for e in expressions for name in e.seen})
        constants: dict[str, set[Value]] = {}
        for expression in expressions:
            for name, values in expression.compared.items():
                constants.setdefault(name, set()).update(values)
        domains: list[Sequence[Value]] = [self._domain(name, constants.get(name, set())) for name in names]
        domains += [self._visit_domain(name, constants.get(f"visits.{name}", set())) for name in visits]
        domains += [(False, True) if name in self.ids or name in self.nodes else (False,) for name in seen]
        if math.prod(map(len, domains)) > _MAX_ASSIGNMENTS:
            yield None
            return
        for values_ in itertools.product(*domains):
            given = dict(zip(names, values_, strict=False))
            counts = {name: int(v) for name, v in zip(visits, values_[len(names) :], strict=False)}
            told = {name for name, v in zip(seen, values_[len(names) + len(visits) :], strict=True) if v}
            yield Scope(given, counts, told)

    def _domain(self, name: str, constants: Collection[Value]) -> Sequence[Value]:
        if name == "item":
            return tuple(self.script.items)
        if name in ENV:
            known = ENV[name]
            return _near(constants, known.values) if known.type == "number" else known.values
        variable = self.script.variables[name]
        if name not in self.open:
            return sorted(self.values[name], key=repr)
        if variable.type == "number":
            return _near(constants, (-1e9, 1e9))
        return (False, True) if variable.type == "bool" else tuple({*constants, *self.values[name], ""})

    def _visit_domain(self, name: str, constants: Collection[Value]) -> Sequence[Value]:
        if name not in self.nodes:
            return (0,)
        return [int(v) for v in _near(constants, (0.0, 100.0)) if float(v) == int(v)]


def _near(constants: Collection[Value], bounds: Sequence[Value]) -> list[Value]:
    """The bounds, and each constant within them with a neighbour on either side."""
    low, high = float(bounds[0]), float(bounds[-1])
    around = {float(c) + d for c in constants if not isinstance(c, str) for d in (-1.0, -1e-6, 0.0, 1e-6, 1.0)}
    return sorted({low, high, *(value for value in around if low <= value <= high)})


def lines_by_way(says: Sequence[SayDef]) -> Iterator[tuple[str | None, bool, LineDef]]:
    """(`when` that applies, whether a further condition stands in the way, line) of a node's lines."""
    for say in says:
        for line in say.lines:
            yield line.when or say.when, line.condition is not None or say.condition is not None, line


def choice_conditions(choice: ChoiceDef) -> Iterator[Expression]:
    """What decides whether a choice is on offer."""
    for expression in (choice.condition, choice.needs):
        if expression is not None:
            yield expression
