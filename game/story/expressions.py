"""Conditions and effects: a small, total, typed expression language on a whitelist of Python's syntax tree.

Numbers, "text", true and false; names; ``+ - * /``; comparisons (chained ones too) and ``in (a, b)``; ``and or
not``; ``visits.NODE``; ``seen('id')``; ``min(…)`` and ``max(…)``. Nothing is ever executed by Python: the tree is
checked and turned into closures. Evaluation cannot fail: types are checked beforehand, results are clamped to
±1e9 and a division by zero is 0.
"""

from __future__ import annotations

import ast
import warnings
from collections.abc import Callable, Collection, Container, Mapping
from dataclasses import dataclass

from game.core.errors import BadInput, Where
from game.formats.yaml_source import nearest
from game.story.closures import BOUND, Closure, arithmetic, comparison, constant, joined, membership, name_of
from game.story.vocabulary import Type, Value

__all__ = ["Expression", "ExpressionError", "Names", "Scope", "compile_expression"]

MAX_CHARS = 400
MAX_DEPTH = 24
MAX_PARTS = 120
_LITERALS: Mapping[str, Value] = {"true": True, "false": False}


class ExpressionError(BadInput):
    """A condition or effect that cannot be used; ``code`` is the lint code, ``where`` points into the YAML."""

    def __init__(self, code: str, message: str, where: Where, hint: str | None = None) -> None:
        super().__init__(message, where=where, hint=hint)
        self.code = code
        self.plain = message
        self.hint = hint


class Scope:
    """What an expression can see: values by name, visits by node, and everything said, chosen or visited."""

    __slots__ = ("_seen", "_visits", "names")

    def __init__(self, names: Mapping[str, Value], visits: Mapping[str, int], seen: Container[str]) -> None:
        self.names, self._visits, self._seen = names, visits, seen

    def visits(self, node: str) -> int:
        """How often a node was passed."""
        return self._visits.get(node, 0)

    def seen(self, name: str) -> bool:
        """Whether a line was said, a choice taken or a node passed, now or on an earlier visit."""
        return name in self._seen


@dataclass(frozen=True)
class Names:
    """What an expression may mention: types by name, nodes for ``visits``, ids for ``seen``."""

    types: Mapping[str, Type]
    nodes: Collection[str]
    ids: Collection[str]


@dataclass(frozen=True)
class Expression:
    """A checked expression. ``evaluate(scope)`` never fails where the scope has the names it was checked with.

    ``compared``: for each name or ``visits.x``, the constants it is compared with (what a search has to try).
    ``simple``: numbers are only compared with constants, so that trying those values decides the condition.
    """

    source: str
    where: Where
    type: Type
    names: frozenset[str]
    visits: frozenset[str]
    seen: frozenset[str]
    compared: Mapping[str, frozenset[Value]]
    simple: bool
    evaluate: Closure

    def __repr__(self) -> str:
        return f"Expression({self.source!r})"


def compile_expression(
    source: str, names: Names, place: Callable[[int], Where], *, wanted: Type | None = None
) -> Expression:
    """Check one expression. ``place`` maps a character of the source to its place in the file.

    Raises ExpressionError (a BadInput with a lint code) at the offending character.
    """
    compiler = _Compiler(source, names, place)
    kind, run = compiler.top()
    if wanted is not None and kind != wanted:
        raise ExpressionError("E_EXPR_TYPE", f"expected a {wanted} but this is a {kind}: {source!r}", place(0))
    return Expression(
        source,
        place(0),
        kind,
        frozenset(compiler.used),
        frozenset(compiler.visits),
        frozenset(compiler.seen),
        {name: frozenset(values) for name, values in compiler.compared.items()},
        compiler.simple,
        run,
    )


class _Compiler:
    """One pass over the tree: whitelist, types, and closures."""

    def __init__(self, source: str, names: Names, place: Callable[[int], Where]) -> None:
        self.source = source
        self.names = names
        self.place = place
        self.used: set[str] = set()
        self.visits: set[str] = set()
        self.seen: set[str] = set()
        self.compared: dict[str, set[Value]] = {}
        self.simple = True
        self.parts = 0
        self.offset = 0
        self.bytes = b""

    def top(self) -> tuple[Type, Closure]:
        if len(self.source) > MAX_CHARS:
            raise self._error("E_EXPR_SIZE", f"an expression has at most {MAX_CHARS} characters", 0)
        flat = self.source.replace("\n", " ").replace("\t", " ")
        self.offset = len(flat) - len(flat.lstrip())
        self.bytes = flat.strip().encode()
        try:
            with warnings.catch_warnings():
                # What Python would warn about is either refused below or no warning of ours.
                warnings.simplefilter("ignore")
                tree = ast.parse(self.bytes.decode(), mode="eval")
        except SyntaxError as error:
            column = max((error.offset or 1) - 1, 0)
            raise self._error("E_EXPR_SYNTAX", f"not an expression: {error.msg}", self.offset + column) from None
        except (RecursionError, MemoryError, ValueError):
            raise self._error("E_EXPR_SIZE", "the expression is nested too deeply", 0) from None
        return self.visit(tree.body, 0)

    def _error(self, code: str, message: str, at: int, hint: str | None = None) -> ExpressionError:
        return ExpressionError(code, message, self.place(min(at, max(len(self.source) - 1, 0))), hint)

    def fail(self, code: str, message: str, node: ast.expr, hint: str | None = None) -> ExpressionError:
        # Python counts columns in UTF-8 bytes.
        column = len(self.bytes[: node.col_offset].decode(errors="replace"))
        return self._error(code, message, self.offset + column, hint)

    def visit(self, node: ast.expr, depth: int) -> tuple[Type, Closure]:
        self.parts += 1
        if depth > MAX_DEPTH or self.parts > MAX_PARTS:
            raise self.fail("E_EXPR_SIZE", f"more than {MAX_PARTS} parts or {MAX_DEPTH} levels", node)
        match node:
            case ast.Constant():
                return self.constant(node)
            case ast.Name():
                return self.name(node)
            case ast.Attribute(value=ast.Name(id="visits"), attr=attr):
                if attr not in self.names.nodes:
                    raise self.fail("E_UNKNOWN_NAME", f"no node {attr!r}", node, _hint(attr, self.names.nodes))
                self.visits.add(attr)
                return "number", lambda scope: float(scope.visits(attr))
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                inner = self.wanted(operand, "bool", depth)
                return "bool", lambda scope: not inner(scope)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                inner = self.wanted(operand, "number", depth)
                return "number", lambda scope: -inner(scope)
            case ast.BoolOp(op=op, values=values):
                return "bool", joined(isinstance(op, ast.And), [self.wanted(v, "bool", depth) for v in values])
            case ast.BinOp(left=left, op=ast.Add() | ast.Sub() | ast.Mult() | ast.Div() as op, right=right):
                self.simple = False
                return "number", arithmetic(op, self.wanted(left, "number", depth), self.wanted(right, "number", depth))
            case ast.Compare():
                return self.compare(node, depth)
            case ast.Call(func=ast.Name(id="seen"), args=[ast.Constant(value=str(name)) as argument], keywords=[]):
                if name not in self.names.ids:
                    hint = _hint(name, self.names.ids)
                    raise self.fail("E_UNKNOWN_NAME", f"no line, choice or node {name!r}", argument, hint)
                self.seen.add(name)
                return "bool", lambda scope: scope.seen(name)
            case ast.Call(func=ast.Name(id="min" | "max" as which), args=args, keywords=[]) if 2 <= len(args) <= 8:
                numbers = [self.wanted(arg, "number", depth) for arg in args]
                pick = min if which == "min" else max
                self.simple = False
                return "number", lambda scope: pick(number(scope) for number in numbers)
        raise self.fail(
            "E_EXPR_FORBIDDEN",
            f"{type(node).__name__} is not part of the language",
            node,
            "names, numbers, 'text', + - * /, comparisons, in (…), and or not, visits.NODE, seen('id'), min, max",
        )

    def wanted(self, node: ast.expr, kind: Type, depth: int) -> Closure:
        found, run = self.visit(node, depth + 1)
        if found != kind:
            raise self.fail("E_EXPR_TYPE", f"expected a {kind} but saw a {found}", node)
        return run

    def constant(self, node: ast.Constant) -> tuple[Type, Closure]:
        value = node.value
        if isinstance(value, bool):
            hint = f"write {str(value).lower()}"
            raise self.fail("E_EXPR_FORBIDDEN", f"{value} is not part of the language", node, hint)
        if isinstance(value, str):
            return "text", constant(value)
        if isinstance(value, int | float) and abs(value) <= BOUND:
            return "number", constant(float(value))
        raise self.fail("E_EXPR_FORBIDDEN", f"only text and numbers up to {BOUND:g} may be written out", node)

    def name(self, node: ast.Name) -> tuple[Type, Closure]:
        name = node.id
        if name in _LITERALS:
            return "bool", constant(_LITERALS[name])
        if name not in self.names.types:
            raise self.fail("E_UNKNOWN_NAME", f"unknown name {name!r}", node, _hint(name, self.names.types))
        self.used.add(name)
        return self.names.types[name], name_of(name)

    def compare(self, node: ast.Compare, depth: int) -> tuple[Type, Closure]:
        tests: list[Closure] = []
        left = node.left
        for op, right in zip(node.ops, node.comparators, strict=True):
            kind, a = self.visit(left, depth + 1)
            if isinstance(op, ast.In | ast.NotIn):
                if not isinstance(right, ast.Tuple | ast.List) or not right.elts:
                    raise self.fail("E_EXPR_FORBIDDEN", "after `in` stands a list of values: in ('a', 'b')", right)
                options = [self.wanted(item, kind, depth + 1) for item in right.elts]
                for item in right.elts:
                    self.note(left, item)
                tests.append(membership(a, options, negate=isinstance(op, ast.NotIn)))
                left = right
                continue
            b = self.wanted(right, kind, depth)
            self.note(left, right)
            self.note(right, left)
            if kind == "number" and not (_constant(left) or _constant(right)):
                self.simple = False
            if isinstance(op, ast.Is | ast.IsNot):
                raise self.fail("E_EXPR_FORBIDDEN", "`is` is not part of the language", left, "write ==")
            if kind != "number" and not isinstance(op, ast.Eq | ast.NotEq):
                raise self.fail("E_EXPR_TYPE", f"only numbers are larger or smaller, not a {kind}", left)
            tests.append(comparison(op, a, b))
            left = right
        return "bool", tests[0] if len(tests) == 1 else joined(True, tests)

    def note(self, side: ast.expr, other: ast.expr) -> None:
        """Remember what a name is compared with, for the search in the linter."""
        name = _term(side)
        if name is None:
            return
        values = self.compared.setdefault(name, set())
        if isinstance(other, ast.Constant) and isinstance(other.value, str | int | float):
            values.add(float(other.value) if isinstance(other.value, int) else other.value)
        elif isinstance(other, ast.UnaryOp) and isinstance(other.operand, ast.Constant):
            number = other.operand.value
            if isinstance(number, int | float):
                values.add(-float(number))


def _constant(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) or (isinstance(node, ast.UnaryOp) and isinstance(node.operand, ast.Constant))


def _term(node: ast.expr) -> str | None:
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        return f"visits.{node.attr}"
    return None


def _hint(name: str, known: Collection[str]) -> str | None:
    close = nearest(name, known)
    return f"did you mean {close!r}?" if close else None
