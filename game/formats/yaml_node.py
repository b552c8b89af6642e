"""One YAML value with its place in the file, and typed access that says what was expected where."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from game.core.errors import BadInput, Where

__all__ = ["Kind", "Node", "Plain", "Scalar", "nearest"]

Kind = Literal["mapping", "sequence", "scalar", "null"]
Scalar = str | int | float | bool | None


class Plain(str):
    """A description that error messages show without quotes."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Node:
    """One YAML value with its place. Immutable.

    value: the Python scalar (None for mappings and sequences); raw: the scalar's text before it was resolved.
    """

    where: Where
    kind: Kind
    value: Scalar = None
    raw: str = ""
    _items: tuple[Node, ...] = ()
    _pairs: Mapping[str, tuple[Node, Node]] = field(default_factory=dict)

    # --- structure -------------------------------------------------------------------------------------------
    def keys(self) -> list[Node]:
        """The key nodes of a mapping, in file order."""
        self._need("mapping", "a mapping (key: value)")
        return [key for key, _ in self._pairs.values()]

    def items(self) -> list[tuple[Node, Node]]:
        """(key node, value node) of a mapping, in file order."""
        self._need("mapping", "a mapping (key: value)")
        return list(self._pairs.values())

    def __getitem__(self, key: str) -> Node:
        """The value of a key. Raises BadInput where the key is missing."""
        self._need("mapping", f"a mapping with the key {key!r}")
        if key not in self._pairs:
            seen = ", ".join(self._pairs) or "no keys"
            close = nearest(key, self._pairs)
            raise BadInput(
                where=self.where,
                expected=f"the key {key!r}",
                seen=Plain(seen),
                hint=f"is {close!r} a slip for it?" if close else None,
            )
        return self._pairs[key][1]

    def get(self, key: str) -> Node | None:
        """The value of a key, or None where it is missing or empty (``key:`` with nothing behind it)."""
        self._need("mapping", f"a mapping that may have the key {key!r}")
        pair = self._pairs.get(key)
        return None if pair is None or pair[1].kind == "null" else pair[1]

    def __contains__(self, key: object) -> bool:
        return self.kind == "mapping" and key in self._pairs

    def __len__(self) -> int:
        return len(self._pairs) if self.kind == "mapping" else len(self._items)

    def __bool__(self) -> bool:
        # A node is a place in a file, true even where it is empty; `if node.get(...)` must not ask for its length.
        return True

    def __iter__(self) -> Iterator[Node]:
        """The items of a sequence."""
        self._need("sequence", "a list")
        return iter(self._items)

    def only(self, *allowed: str) -> Node:
        """This mapping, if it has no keys but these. Raises BadInput at the unknown key, offering the nearest."""
        self._need("mapping", "a mapping (key: value)")
        for name, (key, _) in self._pairs.items():
            if name not in allowed:
                close = nearest(name, allowed)
                raise BadInput(
                    "unknown key",
                    where=key.where,
                    expected=" | ".join(allowed),
                    seen=name,
                    hint=f"did you mean {close!r}?" if close else None,
                )
        return self

    # --- typed values ----------------------------------------------------------------------------------------
    def as_str(self) -> str:
        """The text. Numbers, booleans and nothing are refused: quote them to make them text."""
        if self.kind == "scalar" and isinstance(self.value, str):
            return self.value
        raise self.error(expected="text", hint='put it in "quotes"' if self.kind == "scalar" else None)

    def as_float(self, lo: float | None = None, hi: float | None = None) -> float:
        """A finite number, optionally within [lo, hi]."""
        value = self.value
        if self.kind != "scalar" or isinstance(value, bool) or not isinstance(value, int | float):
            raise self.error(expected=_bounds("a number", lo, hi))
        number = float(value)
        if not math.isfinite(number) or (lo is not None and number < lo) or (hi is not None and number > hi):
            raise self.error(expected=_bounds("a finite number" if not math.isfinite(number) else "a number", lo, hi))
        return number

    def as_int(self, lo: int | None = None, hi: int | None = None) -> int:
        """A whole number, optionally within [lo, hi]."""
        value = self.value
        if self.kind != "scalar" or isinstance(value, bool) or not isinstance(value, int):
            raise self.error(expected=_bounds("a whole number", lo, hi))
        if (lo is not None and value < lo) or (hi is not None and value > hi):
            raise self.error(expected=_bounds("a whole number", lo, hi))
        return value

    def as_bool(self) -> bool:
        """true or false; yes, no, on and off are text in YAML 1.2 and refused."""
        if self.kind == "scalar" and isinstance(self.value, bool):
            return self.value
        raise self.error(expected="true or false")

    def as_list(self) -> list[Node]:
        """The items of a sequence."""
        self._need("sequence", "a list")
        return list(self._items)

    def as_mapping(self) -> dict[str, Node]:
        """Key text -> value node, in file order."""
        self._need("mapping", "a mapping (key: value)")
        return {name: value for name, (_, value) in self._pairs.items()}

    def to_python(self) -> Any:
        """Plain dict, list and scalars (recursion is bounded by the reader's max_depth)."""
        if self.kind == "mapping":
            return {name: value.to_python() for name, (_, value) in self._pairs.items()}
        if self.kind == "sequence":
            return [item.to_python() for item in self._items]
        return self.value

    # --- errors ----------------------------------------------------------------------------------------------
    def error(self, message: str = "", *, expected: str | None = None, hint: str | None = None) -> BadInput:
        """A BadInput at this place; where something is expected, what stands here is named as seen."""
        return BadInput(message, where=self.where, expected=expected, seen=self._shown(), hint=hint)

    def __repr__(self) -> str:
        return f"Node({self.where}, {self._shown()!r})"

    def _shown(self) -> str:
        if self.kind == "mapping":
            return Plain(f"a mapping of {', '.join(self._pairs) or 'nothing'}")
        if self.kind == "sequence":
            return Plain(f"a list of {len(self._items)}")
        if self.kind == "null":
            return Plain("nothing")
        return self.raw if isinstance(self.value, str) else Plain(self.raw)

    def _need(self, kind: Kind, expected: str) -> None:
        if self.kind != kind:
            raise self.error(expected=expected)


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The known name most like this one, or None where none is close."""
    # Slips are short; on long or very many names difflib would cost more than the hint is worth.
    candidates = [k for k in known if abs(len(k) - len(name)) <= 8][:1000]
    close = difflib.get_close_matches(name[:80], candidates, n=1, cutoff=0.6)
    return close[0] if close else None


def _bounds(what: str, lo: float | None, hi: float | None) -> str:
    if lo is not None and hi is not None:
        return f"{what} from {lo:g} to {hi:g}"
    if lo is not None:
        return f"{what} of at least {lo:g}"
    return what if hi is None else f"{what} of at most {hi:g}"
