"""Collecting every finding in a set of files before giving up, each with its place."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from game.core.errors import BadInput

__all__ = ["Findings"]


class Findings:
    """What is wrong with some input, in the order it was met.

    broken: True once a file could not be read at all (against one that can be read but does not make sense).
    """

    def __init__(self) -> None:
        self.items: list[BadInput] = []
        self.broken = False

    def __len__(self) -> int:
        return len(self.items)

    def add(self, error: BadInput) -> None:
        """Note one finding, or all that it stands for."""
        self.items += error.findings or (error,)

    @contextmanager
    def collect(self, *, reading: bool = False) -> Iterator[None]:
        """Turn a BadInput raised in the block into a finding and go on after it."""
        try:
            yield
        except BadInput as error:
            self.broken = self.broken or reading
            self.add(error)

    def raise_first(self) -> None:
        """Raise the first finding as one line that says how many more there are; nothing where there is none."""
        if self.items:
            more = len(self.items) - 1
            error = BadInput(self.items[0].message + (f" (and {more} more)" if more else ""))
            error.findings = tuple(self.items) if more else ()
            raise error
