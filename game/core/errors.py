"""The error tree. Every error a user can meet is one line: where, what was expected, what was seen, what to do."""

from __future__ import annotations

from pathlib import Path

__all__ = ["BadInput", "GameError", "MissingPart", "Where"]


class Where:
    """A place in a file: ``path:line:col`` for text, ``path@byte`` or ``path:/json/pointer`` for the rest."""

    __slots__ = ("byte", "col", "line", "path", "pointer")

    def __init__(
        self,
        path: str | Path,
        line: int | None = None,
        col: int | None = None,
        *,
        byte: int | None = None,
        pointer: str | None = None,
    ) -> None:
        self.path = str(path)
        self.line = line
        self.col = col
        self.byte = byte
        self.pointer = pointer

    def __str__(self) -> str:
        text = self.path
        if self.line is not None:
            text += f":{self.line}"
            if self.col is not None:
                text += f":{self.col}"
        if self.byte is not None:
            text += f"@{self.byte}"
        if self.pointer is not None:
            text += f":{self.pointer or '/'}"
        return text

    def __repr__(self) -> str:
        return f"Where({self})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Where) and str(self) == str(other)

    def __hash__(self) -> int:
        return hash(str(self))


class GameError(Exception):
    """Any error with a clear cause; the command line prints it as one line and exits with 2."""


class BadInput(GameError):
    """A file, argument or value from outside that cannot be used.

    ``str(error)`` is always one line: ``WHERE: expected X, saw Y (hint)`` or ``WHERE: message (hint)``.
    findings: all that is wrong, where this one stands for several.
    """

    findings: tuple[BadInput, ...] = ()

    def __init__(
        self,
        message: str = "",
        *,
        where: Where | None = None,
        expected: str | None = None,
        seen: object = None,
        hint: str | None = None,
    ) -> None:
        self.where = where
        self.expected = expected
        self.seen = seen
        self.hint = hint
        parts = message
        if expected is not None:
            shown = repr(seen) if isinstance(seen, str) else str(seen)
            if len(shown) > 80:
                shown = shown[:77] + "..."
            clause = f"expected {expected} but saw {shown}"
            parts = f"{message}: {clause}" if message else clause
        if hint:
            parts += f" ({hint})"
        if where is not None:
            parts = f"{where}: {parts}"
        self.message = " ".join(parts.split())
        super().__init__(self.message)


class MissingPart(GameError):
    """Something of the machine or the installation is missing (no OpenGL, no font); says what to install."""
