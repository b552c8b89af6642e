"""What a check finds: ``file:line:col: CODE message (hint)``, in three severities told by the code's first letter."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from game.core.errors import BadInput, Where
from game.formats.yaml_source import nearest

__all__ = ["CODES", "Finding", "Findings"]

# Stable codes. E: the script cannot be used. W: it plays, but not as it should. I: worth a look.
CODES: dict[str, str] = {
    "E_YAML": "the file is not YAML, or not the strict YAML the game reads",
    "E_DUPLICATE_KEY": "a key is given twice in one mapping",
    "E_UNKNOWN_KEY": "a key the language does not know",
    "E_MISSING_KEY": "something required is not there",
    "E_BAD_VALUE": "a value of the wrong kind or out of range",
    "E_MISSING_ID": "a line or choice without an id",
    "E_DUPLICATE_ID": "an id used twice",
    "E_BAD_ID": "an id that is not made of small letters, digits and _",
    "E_MISSING_TARGET": "a way on to a node that does not exist",
    "E_NO_WAY_ON": "a node that neither waits, goes on, nor ends the talk",
    "E_LOOP": "nodes that go on to each other without ever waiting for the player",
    "E_RUNS_DRY": "a place to wait whose choices can all be used up",
    "E_NO_EXIT": "the standing choices do not always let the player leave",
    "E_UNKNOWN_ACT": "an act the rules do not know",
    "E_UNKNOWN_EMOTION": "an emotion that does not exist",
    "E_INCLUDE": "an included file that cannot be used",
    "E_UNKNOWN_GESTURE": "a named gesture that does not exist",
    "E_BAD_FORMS": "forms of a plural or counter that cannot be used",
    "E_UNKNOWN_FACE": "a named expression that does not exist",
    "E_UNKNOWN_ITEM": "a thing that is not on this table",
    "E_UNKNOWN_NAME": "a name that a condition, effect or line cannot use",
    "E_UNKNOWN_POOL": "a pool of choices that does not exist",
    "E_UNKNOWN_OUTCOME": "an outcome that does not exist",
    "E_UNKNOWN_ENDING": "an ending that is not declared",
    "E_UNKNOWN_PERSON": "the shopkeeper's file cannot be used",
    "E_MISSING_OUTCOME": "an outcome of the market that leads nowhere",
    "E_EXPR_SYNTAX": "an expression that cannot be read",
    "E_EXPR_TYPE": "an expression that mixes numbers, text and true/false",
    "E_EXPR_FORBIDDEN": "something the expression language does not have",
    "E_EXPR_SIZE": "an expression that is too long or nested too deeply",
    "W_YAML_BOOLEAN": "an unquoted yes, no, on or off, which other YAML tools read as true or false",
    "W_MISSING_TRANSLATION": "a line without English or Japanese",
    "W_NO_ABOUT": "a thing on the table without a description",
    "W_SLOT_MISMATCH": "names in braces that only one language has",
    "W_LONG_LINE": "more text than the box holds",
    "W_UNREACHABLE": "a node that nothing leads to",
    "W_ENDING_FALLS_BACK": "an outcome that ends the talk, but leads back into it",
    "W_NEVER": "a condition that can never hold",
    "W_NEVER_DRAWN": "choices whose act is never among the lines that are drawn",
    "W_UNWINNABLE": "no deal can ever be struck, or not for this thing",
    "W_STALE_TRANSLATION": "the English was changed after the Japanese was written",
    "W_UNUSED": "a pool, variable or ending that nothing uses",
    "W_UNKNOWN_VALUE": "a comparison with a value the name never has",
    "W_FEW_CHOICES": "a hub with fewer choices than are drawn, or too few kinds of them",
    "W_ONE_RIGHT": "lines of which only one can ever be right: they tell what is felt",
    "W_LEAK": "choices that depend on hidden feelings: they tell what is felt",
    "W_REPEATED_TEXT": "the same words under two ids: they could be spoken twice in a talk",
    "W_FALLS_THROUGH": "a list of ways on whose last one has a condition",
    "W_SILENT_REACTION": "a reaction with nothing to say for some way the line can land",
    "W_NO_ANSWER": "a choice that was left without a word in random talks (--walks)",
    "I_NOT_WALKED": "a node that no random talk came to (--walks)",
    "I_NOT_INCLUDED": "a part that no stall beside it includes",
    "I_NOT_LOCKED": "a stall, or lines of it, that translations.lock.yaml does not know yet",
    "I_ALWAYS": "a condition that always holds",
}


_HINTED = 200


@dataclass(frozen=True)
class Finding:
    """One finding. ``str()`` is its one line."""

    code: str
    where: Where
    message: str
    hint: str | None = None

    @property
    def severity(self) -> str:
        """error, warning or info."""
        return {"E": "error", "W": "warning", "I": "info"}[self.code[0]]

    def __str__(self) -> str:
        hint = f" ({self.hint})" if self.hint else ""
        return " ".join(f"{self.where}: {self.code} {self.message}{hint}".split())

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "file": self.where.path,
            "line": self.where.line,
            "col": self.where.col,
            "severity": self.severity,
            "code": self.code,
            "message": self.message,
            "hint": self.hint,
        }


class Findings:
    """Collects; nothing stops at the first fault."""

    def __init__(self) -> None:
        self.all: list[Finding] = []
        self.files: set[Path] = set()
        """Included files that were read on the way."""
        self._known: set[tuple[str, str, str]] = set()

    def add(self, code: str, where: Where, message: str, hint: str | None = None) -> None:
        """Note one finding; the same one at the same place is noted once."""
        assert code in CODES, code
        key = (code, str(where), message)
        if key not in self._known:
            self._known.add(key)
            self.all.append(Finding(code, where, message, hint))

    def hint(self, name: str, known: Iterable[str]) -> str | None:
        """A hint: the nearest known name, or all of them where none is near and they are few.

        A file with very many faults gets none for the later ones: looking for likeness is slow.
        """
        if len(self.all) > _HINTED:
            return None
        names = list(known)
        close = nearest(name, names)
        if close:
            return f"did you mean {close!r}?"
        return f"known: {', '.join(names)}" if 0 < len(names) <= 12 else "none is near"

    def take(self, code: str, error: BadInput) -> None:
        """Note a refused value of the YAML reader."""
        where = error.where or Where("?")
        message = error.message.removeprefix(f"{where}: ")
        if error.hint and message.endswith(f"({error.hint})"):
            message = message.removesuffix(f"({error.hint})").rstrip()
        self.add(code, where, message, error.hint)

    @property
    def errors(self) -> list[Finding]:
        """Those that make the script unusable."""
        return [finding for finding in self.all if finding.severity == "error"]

    def ordered(self) -> list[Finding]:
        """By file and place."""
        return sorted(self.all, key=lambda f: (f.where.path, f.where.line or 0, f.where.col or 0, f.code))
