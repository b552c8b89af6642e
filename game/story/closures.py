"""The pieces that a checked expression is put together from: one closure for each shape, the commonest without a call.

A condition mostly compares a name with a constant, an effect mostly adds one to a name; those shapes have closures of
their own, so that nothing is called that need not be. Nothing here is made from text.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

from game.story.vocabulary import Value

__all__ = ["BOUND", "Closure", "arithmetic", "comparison", "constant", "joined", "membership", "name_of"]

BOUND = 1e9
"""Every result of arithmetic is held to ± this."""
_LEAST = -BOUND

Closure = Callable[[Any], Any]
"""From a scope (``game.story.expressions.Scope``) to a value."""


def _held(value: float) -> float:
    return min(max(value, -BOUND), BOUND)


def _add(a: Closure, b: Closure) -> Closure:
    return lambda scope: _held(a(scope) + b(scope))


def _subtract(a: Closure, b: Closure) -> Closure:
    return lambda scope: _held(a(scope) - b(scope))


def _multiply(a: Closure, b: Closure) -> Closure:
    return lambda scope: _held(a(scope) * b(scope))


def _divide(a: Closure, b: Closure) -> Closure:
    def quotient(scope: Any) -> float:
        by = b(scope)
        return _held(a(scope) / by) if by else 0.0

    return quotient


def _add_constant(name: str, number: float) -> Closure:
    def total(scope: Any) -> float:
        value: float = scope.names[name] + number
        return value if _LEAST <= value <= BOUND else _held(value)

    return total


def _multiply_constant(name: str, number: float) -> Closure:
    def product(scope: Any) -> float:
        value: float = scope.names[name] * number
        return value if _LEAST <= value <= BOUND else _held(value)

    return product


_ARITHMETIC: Mapping[type[ast.operator], Callable[[Closure, Closure], Closure]] = {
    ast.Add: _add,
    ast.Sub: _subtract,
    ast.Mult: _multiply,
    ast.Div: _divide,
}
_ARITHMETIC_OF_NAME: Mapping[type[ast.operator], Callable[[str, float], Closure]] = {
    ast.Add: _add_constant,
    ast.Sub: lambda name, number: _add_constant(name, -number),
    ast.Mult: _multiply_constant,
}
_TESTS: Mapping[type[ast.cmpop], Callable[[Closure, Closure], Closure]] = {
    ast.Eq: lambda a, b: lambda scope: a(scope) == b(scope),
    ast.NotEq: lambda a, b: lambda scope: a(scope) != b(scope),
    ast.Lt: lambda a, b: lambda scope: a(scope) < b(scope),
    ast.LtE: lambda a, b: lambda scope: a(scope) <= b(scope),
    ast.Gt: lambda a, b: lambda scope: a(scope) > b(scope),
    ast.GtE: lambda a, b: lambda scope: a(scope) >= b(scope),
}
_TESTS_OF_NAME: Mapping[type[ast.cmpop], Callable[[str, Value], Closure]] = {
    ast.Eq: lambda name, value: lambda scope: scope.names[name] == value,
    ast.NotEq: lambda name, value: lambda scope: scope.names[name] != value,
    ast.Lt: lambda name, value: lambda scope: scope.names[name] < value,
    ast.LtE: lambda name, value: lambda scope: scope.names[name] <= value,
    ast.Gt: lambda name, value: lambda scope: scope.names[name] > value,
    ast.GtE: lambda name, value: lambda scope: scope.names[name] >= value,
}


class _Constant:
    """A value written out."""

    __slots__ = ("value",)

    def __init__(self, value: Value) -> None:
        self.value = value

    def __call__(self, scope: Any) -> Value:
        return self.value


class _Name:
    """A name looked up."""

    __slots__ = ("name",)

    def __init__(self, name: str) -> None:
        self.name = name

    def __call__(self, scope: Any) -> Any:
        return scope.names[self.name]


def constant(value: Value) -> Closure:
    """A value written out."""
    return _Constant(value)


def name_of(name: str) -> Closure:
    """A name looked up."""
    return _Name(name)


def arithmetic(op: ast.operator, a: Closure, b: Closure) -> Closure:
    """``a op b`` for + - * /, held to ±BOUND, a division by zero 0."""
    if isinstance(a, _Name) and isinstance(b, _Constant) and type(op) in _ARITHMETIC_OF_NAME:
        return _ARITHMETIC_OF_NAME[type(op)](a.name, float(b.value))
    return _ARITHMETIC[type(op)](a, b)


def comparison(op: ast.cmpop, a: Closure, b: Closure) -> Closure:
    """``a op b`` for == != < <= > >=."""
    if isinstance(a, _Name) and isinstance(b, _Constant):
        return _TESTS_OF_NAME[type(op)](a.name, b.value)
    return _TESTS[type(op)](a, b)


def membership(a: Closure, options: Sequence[Closure], *, negate: bool) -> Closure:
    """``a in (…)``, or not."""
    if all(isinstance(option, _Constant) for option in options):
        values: Collection[Value] = tuple([option(None) for option in options])
        return (lambda scope: a(scope) not in values) if negate else (lambda scope: a(scope) in values)
    return lambda scope: (a(scope) in [option(scope) for option in options]) != negate


def joined(every: bool, parts: Sequence[Closure]) -> Closure:
    """``and`` or ``or`` of two or more parts, left to right, as far as needed."""
    first, second = parts[0], parts[1] if len(parts) == 2 else joined(every, parts[1:])
    if every:
        return lambda scope: first(scope) and second(scope)
    return lambda scope: first(scope) or second(scope)
