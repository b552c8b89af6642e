"""Whether a condition can ever hold, by search over the states that a talk can really reach.

For each condition only what it hangs on is tracked: its variables, visits and memories, and what those hang on in
turn (program slicing; Weiser 1981). Everything else may be anything at any moment, a called node may return to any
caller, and a stall is visited again and again. So the search reaches at least what a talk can reach, and what it
never sees never happens. Where too much hangs together it gives up and says nothing.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from game.story.expressions import Expression, Scope
from game.story.model import BACK, HOME, Branch, ChoiceDef, EffectDef, NodeDef, Script
from game.story.reach import Reach, conditions_of
from game.story.vocabulary import Value

__all__ = ["Search"]

_MAX_NAMES = 8
_MAX_STATES = 8_000
_MAX_GUESSES = 256
_MAX_NUMBER = 60.0

State = tuple[Value, ...]


@dataclass(frozen=True)
class _Slice:
    """What is tracked: (kind, name) in order; kinds are variable, visits, seen, used."""

    keys: tuple[tuple[str, str], ...]

    def index(self, kind: str, name: str) -> int | None:
        key = (kind, name)
        return self.keys.index(key) if key in self.keys else None


class Search:
    """Reachable states of one script, searched anew for each set of names a condition hangs on."""

    def __init__(self, script: Script, reach: Reach) -> None:
        self.script = script
        self.reach = reach
        self._found: dict[_Slice, frozenset[State] | None] = {}
        self._conditions = [condition.expression for condition in conditions_of(script)]
        self._returns = [
            *(f"after:{node.id}" for node in script.nodes.values() if node.call),
            *(node.id for node in script.nodes.values() if node.waits),
        ]

    def holds(self, expression: Expression) -> bool:
        """False where the condition fails in every reachable state; True where it can hold or that is not known."""
        tracked = self._slice(expression)
        if tracked is None:
            return True
        if tracked not in self._found:
            self._found[tracked] = self._explore(tracked)
        states = self._found[tracked]
        if states is None:
            return True
        return any(self._may(expression, state, tracked) for state in states)

    # --- what to track -----------------------------------------------------------------------------------------
    def _slice(self, expression: Expression) -> _Slice | None:
        """The names that decide a condition, with those that decide them; None where there are too many."""
        keys: dict[tuple[str, str], None] = {}
        queue = list(_names(expression, self.script))
        while queue:
            key = queue.pop(0)
            if key in keys:
                continue
            keys[key] = None
            if len(keys) > _MAX_NAMES:
                return None
            if key[0] == "variable":
                for effect, choice in self._effects_on(key[1]):
                    if effect.name in effect.value.names and self._repeats(effect.name, choice):
                        return None  # it can count on and on
                    queue.extend(_names(effect.value, self.script))
                    if choice is not None and choice.once != "never":
                        queue.append(("used", choice.id))
        dynamic = [key for key in keys if key[0] != "used"]
        # A single memory is decided by whether it can come up at all: the coarse search knows that.
        if not dynamic or (len(dynamic) == 1 and dynamic[0][0] == "seen"):
            return None
        return _Slice(tuple(sorted(keys)))

    def _repeats(self, variable: str, choice: ChoiceDef | None) -> bool:
        """Whether an effect of a choice (or a node) can come any number of times before the variable is new again."""
        kept = self.script.variables[variable].scope != "talk"
        return choice is None or choice.once == "never" or (choice.once == "talk" and kept)

    def _effects_on(self, name: str) -> Iterator[tuple[EffectDef, ChoiceDef | None]]:
        for node in self.script.nodes.values():
            yield from ((effect, None) for effect in node.effects if effect.name == name)
        for choice in self.script.all_choices():
            yield from ((effect, choice) for effect in choice.effects if effect.name == name)

    # --- the search --------------------------------------------------------------------------------------------
    def _explore(self, tracked: _Slice) -> frozenset[State] | None:
        script = self.script
        initial = tuple(self._initial(kind, name) for kind, name in tracked.keys)
        starts = {script.start, script.outcomes.get("came_back", script.start)}
        queue: list[tuple[str, State]] = [(start, initial) for start in sorted(starts)]
        done: set[tuple[str, State]] = set()
        states: set[State] = {initial}
        while queue:
            place, state = queue.pop()
            if (place, state) in done:
                continue
            if len(done) > _MAX_STATES:
                return None
            done.add((place, state))
            for target, after in self._steps(place, state, tracked):
                if after is None:
                    return None
                states.add(after)
                for resolved in self._resolved(target):
                    if resolved == "end":
                        again = self._new_visit(after, tracked)
                        queue.extend((start, again) for start in starts)
                    else:
                        queue.append((resolved, after))
        return frozenset(states)

    def _initial(self, kind: str, name: str) -> Value:
        return self.script.variables[name].initial if kind == "variable" else 0.0 if kind == "visits" else False

    def _new_visit(self, state: State, tracked: _Slice) -> State:
        out = list(state)
        for index, (kind, name) in enumerate(tracked.keys):
            kept = (kind == "variable" and self.script.variables[name].scope != "talk") or kind == "seen"
            kept = kept or (kind == "used" and self.script.choices[name].once == "stall")
            if not kept:
                out[index] = self._initial(kind, name)
        return tuple(out)

    def _resolved(self, target: str) -> Sequence[str]:
        if target == HOME:
            return (self.script.home,)
        return self._returns if target == BACK else (target,)

    def _steps(self, place: str, state: State, tracked: _Slice) -> Iterator[tuple[str, State | None]]:
        """Where a talk can go from a place, and the states it can be in then."""
        if place.startswith("after:"):
            node = self.script.nodes[place.removeprefix("after:")]
            yield from self._ways(node.to, state, tracked)
            return
        node = self.script.nodes[place]
        if node.waits or node.end is not None:
            # The market's answer comes before the talk goes on there (see engine).
            yield from ((target, state) for target in self.script.outcomes.values())
        for after in self._entered(node, state, tracked):
            if after is None:
                yield place, None
                return
            if node.end is not None:
                yield "end", after
            elif node.waits:
                yield from self._moves(node, after, tracked)
            elif node.call is not None:
                yield node.call, after
                yield f"after:{node.id}", after
            else:
                yield from self._ways(node.to, after, tracked)

    def _moves(self, node: NodeDef, state: State, tracked: _Slice) -> Iterator[tuple[str, State | None]]:
        """Every choice that may be there, and every outcome of the market, which comes whenever it likes."""
        yield "end", state
        yield HOME, state
        yield from ((target, state) for target in self.script.outcomes.values())
        offers = {line.id for choice in self.script.standing if choice.act == "offer" for line in choice.texts}
        for choice in self.script.choices_at(node):
            used = tracked.index("used", choice.id)
            if used is not None and state[used]:
                continue
            if not all(self._may(guard, state, tracked) for guard in _guards(choice)):
                continue
            # Any line may carry an offer, and then the words of an offer are said too.
            ids = {choice.id, *(line.id for line in choice.texts), *offers}
            said = self._remembered(state, tracked, {choice.id})
            if used is not None:
                said = (*said[:used], True, *said[used + 1 :])
            variants = [said]
            others = [name for name in ids - {choice.id} if tracked.index("seen", name) is not None]
            variants += [self._remembered(said, tracked, {name}) for name in others]
            for variant in variants:
                for after in self._applied(choice.effects, variant, tracked):
                    if after is None:
                        yield node.id, None
                        return
                    yield from self._ways(choice.to, after, tracked)

    def _ways(self, branches: Sequence[Branch], state: State, tracked: _Slice) -> Iterator[tuple[str, State | None]]:
        for branch in branches:
            if branch.condition is None or self._may(branch.condition, state, tracked):
                yield branch.target, state
            if branch.condition is None:
                return
        yield HOME, state

    def _entered(self, node: NodeDef, state: State, tracked: _Slice) -> Iterator[State | None]:
        """The states after a node's effects and lines: a line that is remembered may have been said or not."""
        counted = tracked.index("visits", node.id)
        if counted is not None:
            top = self._top(node.id)
            state = (*state[:counted], min(float(state[counted]) + 1.0, top), *state[counted + 1 :])
        state = self._remembered(state, tracked, {node.id})
        lines = [line for say in node.says for line in say.lines if tracked.index("seen", line.id) is not None]
        for after in self._applied(node.effects, state, tracked):
            if after is None:
                yield None
                return
            for said in itertools.product((False, True), repeat=len(lines)):
                names = {line.id for line, spoken in zip(lines, said, strict=True) if spoken}
                yield self._remembered(after, tracked, names)

    def _top(self, node: str) -> float:
        """Beyond the largest number a visit count is compared with, one more makes no difference."""
        found = [
            float(value)
            for condition in self._conditions
            for value in condition.compared.get(f"visits.{node}", ())
            if not isinstance(value, str)
        ]
        return max(found, default=0.0) + 1.0

    def _remembered(self, state: State, tracked: _Slice, names: set[str]) -> State:
        out = list(state)
        for name in names:
            index = tracked.index("seen", name)
            if index is not None:
                out[index] = True
        return tuple(out)

    def _applied(self, effects: Sequence[EffectDef], state: State, tracked: _Slice) -> Iterator[State | None]:
        """All states after some effects; None where a variable can become anything."""
        states = {state}
        for effect in effects:
            index = tracked.index("variable", effect.name)
            if index is None:
                continue
            found: set[State] = set()
            for before in states:
                scopes = self._scopes(effect.value, before, tracked)
                if scopes is None:
                    yield None
                    return
                for scope in scopes:
                    value = effect.value.evaluate(scope)
                    if isinstance(value, float) and abs(value) > _MAX_NUMBER:
                        yield None
                        return
                    found.add((*before[:index], value, *before[index + 1 :]))
            states = found
        yield from states

    # --- evaluating with what is known -------------------------------------------------------------------------
    def _may(self, expression: Expression, state: State, tracked: _Slice) -> bool:
        """Whether an expression can hold in a state, whatever the names are that are not tracked."""
        scopes = self._scopes(expression, state, tracked)
        return True if scopes is None else any(bool(expression.evaluate(scope)) for scope in scopes)

    def _scopes(self, expression: Expression, state: State, tracked: _Slice) -> list[Scope] | None:
        """Every scope a state stands for; None where they cannot be listed."""
        known = dict(zip(tracked.keys, state, strict=True))
        free: list[tuple[tuple[str, str], Sequence[Value]]] = []
        for key in _names(expression, self.script, everything=True):
            if key not in known:
                values = self.reach.values_of(key[0], key[1], expression)
                if values is None:
                    return None
                free.append((key, values))
        if math.prod(len(values) for _, values in free) > _MAX_GUESSES:
            return None
        out = []
        for guess in itertools.product(*(values for _, values in free)):
            every = known | {key: value for (key, _), value in zip(free, guess, strict=True)}
            out.append(_scope(every))
        return out


def _scope(values: Mapping[tuple[str, str], Value]) -> Scope:
    return Scope(
        {name: value for (kind, name), value in values.items() if kind == "variable"},
        {name: int(value) for (kind, name), value in values.items() if kind == "visits"},
        {name for (kind, name), value in values.items() if kind == "seen" and value},
    )


def _names(expression: Expression, script: Script, *, everything: bool = False) -> Iterator[tuple[str, str]]:
    """What an expression asks for; what others change as well only where everything is wanted."""
    own = {name for name, variable in script.variables.items() if variable.scope != "afternoon"}
    yield from (("variable", name) for name in sorted(expression.names) if everything or name in own)
    yield from (("visits", name) for name in sorted(expression.visits))
    yield from (("seen", name) for name in sorted(expression.seen))


def _guards(choice: ChoiceDef) -> Iterator[Expression]:
    yield from (guard for guard in (choice.condition, choice.needs) if guard is not None)
