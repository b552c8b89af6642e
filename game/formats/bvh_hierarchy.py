"""The HIERARCHY half of a BVH file: joints, offsets, channels, end sites.

Parsed line by line with a stack of our own, so that nesting costs nothing and is bounded. A joint's name is the
rest of its line (some exporters write names with spaces); braces may share a line with anything.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from game.core.errors import BadInput, Where

__all__ = ["BvhJoint", "BvhText", "Token", "number", "read_hierarchy"]

CHANNELS = tuple(f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ")
LARGEST = 1e9
"""Offsets, positions and angles beyond this are taken for damage."""

_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_LINE = re.compile(rb"[^\r\n]+")
_WORD = re.compile(r"[{}]|[^\s{}]+")
_CONTROL = re.compile(rb"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]")


@dataclass(frozen=True, slots=True)
class Token:
    """A word and its place in the file."""

    text: str
    where: Where


@dataclass(slots=True)
class BvhJoint:
    """One joint as declared. parent: index, -1 for a root; offset and end site in the file's units."""

    name: str
    parent: int
    where: Where
    offset: tuple[float, float, float] | None = None
    channels: tuple[str, ...] = ()
    end_site: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class BvhText:
    """The file's bytes with places in them."""

    data: bytes
    path: Path

    def where(self, offset: int) -> Where:
        """Line and column (both from 1, columns in bytes) of a byte offset."""
        start = max(self.data.rfind(b"\n", 0, offset), self.data.rfind(b"\r", 0, offset)) + 1
        return Where(self.path, self.line_ends(0, offset) + 1, offset - start + 1)

    def line_ends(self, start: int, end: int) -> int:
        """How many lines end between two byte offsets, whatever ends them: CR LF, LF or CR."""
        count = self.data.count
        return count(b"\n", start, end) + count(b"\r", start, end) - count(b"\r\n", start, end)

    def lines(self, offset: int) -> Iterator[tuple[int, bytes]]:
        """(byte offset, content) of the lines from offset that are not empty; nothing is copied ahead."""
        for match in _LINE.finditer(self.data, offset):
            yield match.start(), match.group()

    def require_printable(self, end: int) -> None:
        """Raise BadInput at the first control character before byte offset end."""
        bad = _CONTROL.search(self.data, 0, end)
        if bad:
            raise BadInput(where=self.where(bad.start()), expected="text", seen=bad.group())


def number(token: Token) -> float:
    """A finite number no larger than LARGEST. Raises BadInput at the token."""
    if _NUMBER.fullmatch(token.text):
        value = float(token.text)
        if abs(value) <= LARGEST:
            return value
    hint = "write numbers with a decimal point" if "," in token.text else None
    raise BadInput(where=token.where, expected="a finite number", seen=token.text, hint=hint)


@dataclass(slots=True)
class _Reader:
    text: BvhText
    max_joints: int
    max_depth: int
    joints: list[BvhJoint] = field(default_factory=list)
    stack: list[int | None] = field(default_factory=list)  # open blocks; None is an end site
    pending: int | None = None  # joint whose "{" has not come yet
    pending_end_site: bool = False
    findings: list[str] = field(default_factory=list)

    def line(self, words: list[Token]) -> None:
        at = 0
        while at < len(words):
            at = self._statement(words, at)

    def _statement(self, words: list[Token], at: int) -> int:
        """Handle the statement that begins at words[at]; the index of the next one."""
        word = words[at]
        keyword = word.text.upper()
        if self.pending is not None or self.pending_end_site:
            if keyword != "{":
                raise BadInput(where=word.where, expected="'{'", seen=word.text)
            self._open(word)
            return at + 1
        if keyword == "}":
            self._close(word)
            return at + 1
        if keyword in ("ROOT", "JOINT"):
            return self._joint(words, at, root=keyword == "ROOT")
        if keyword == "END":
            return self._end_site(words, at)
        if keyword == "OFFSET":
            return self._offset(words, at)
        if keyword == "CHANNELS":
            return self._channels(words, at)
        raise BadInput(
            where=word.where, expected="ROOT, JOINT, End Site, OFFSET, CHANNELS, '}' or MOTION", seen=word.text
        )

    def _open(self, word: Token) -> None:
        if len(self.stack) >= self.max_depth:
            raise BadInput(f"more than {self.max_depth} levels of joints", where=word.where)
        self.stack.append(None if self.pending_end_site else self.pending)
        self.pending, self.pending_end_site = None, False

    def _close(self, word: Token) -> None:
        if not self.stack:
            raise BadInput("a '}' without its '{'", where=word.where)
        joint = self.stack.pop()
        if joint is not None and self.joints[joint].offset is None:
            raise BadInput(f"joint {self.joints[joint].name!r} has no OFFSET", where=word.where)

    def _current(self, word: Token) -> BvhJoint:
        """The joint whose block is open (not an end site's)."""
        if not self.stack or self.stack[-1] is None:
            place = "inside an end site" if self.stack else "outside any joint"
            raise BadInput(f"{word.text} {place}", where=word.where)
        return self.joints[self.stack[-1]]

    def _joint(self, words: list[Token], at: int, *, root: bool) -> int:
        word = words[at]
        if root and self.stack:
            raise BadInput("ROOT inside another joint", where=word.where)
        if not root:
            self._current(word)
        if len(self.joints) >= self.max_joints:
            raise BadInput(f"more than {self.max_joints} joints", where=word.where)
        end = at + 1
        while end < len(words) and words[end].text not in "{}":
            end += 1
        name = " ".join(token.text for token in words[at + 1 : end])
        parent = self.stack[-1] if self.stack else -1
        self.joints.append(BvhJoint(name, -1 if parent is None else parent, word.where))
        self.pending = len(self.joints) - 1
        return end

    def _end_site(self, words: list[Token], at: int) -> int:
        self._current(words[at])
        self.pending_end_site = True
        end = at + 1
        while end < len(words) and words[end].text not in "{}":
            end += 1
        return end

    def _offset(self, words: list[Token], at: int) -> int:
        word = words[at]
        if not self.stack:
            raise BadInput("OFFSET outside any joint", where=word.where)
        if len(words) < at + 4:
            raise BadInput(where=word.where, expected="three numbers after OFFSET", seen=len(words) - at - 1)
        x, y, z = (number(token) for token in words[at + 1 : at + 4])
        joint = self.stack[-1]
        if joint is None:
            owner = next(i for i in reversed(self.stack) if i is not None)
            self.joints[owner].end_site = (x, y, z)
        elif self.joints[joint].offset is not None:
            raise BadInput(f"joint {self.joints[joint].name!r} has a second OFFSET", where=word.where)
        else:
            self.joints[joint].offset = (x, y, z)
        return at + 4

    def _channels(self, words: list[Token], at: int) -> int:
        word = words[at]
        joint = self._current(word)
        if joint.channels:
            raise BadInput(f"joint {joint.name!r} has CHANNELS twice", where=word.where)
        if len(words) < at + 2 or not words[at + 1].text.isdecimal() or len(words[at + 1].text) > 4:
            seen = words[at + 1].text if len(words) > at + 1 else "nothing"
            raise BadInput(where=word.where, expected="the number of channels after CHANNELS", seen=seen)
        count = int(words[at + 1].text)
        if count > len(CHANNELS):
            raise BadInput(where=words[at + 1].where, expected="at most 6 channels", seen=count)
        named = words[at + 2 : at + 2 + count]
        if len(named) < count:
            raise BadInput(where=word.where, expected=f"{count} channel names", seen=len(named))
        joint.channels = tuple(self._channel(token) for token in named)
        for index, channel in enumerate(joint.channels):
            # An axis may be turned about twice (Z X Z), but not twice in a row.
            before = joint.channels[:index] if channel.endswith("position") else joint.channels[:index][-1:]
            if channel in before:
                raise BadInput(f"joint {joint.name!r}: channel {channel} given twice", where=named[index].where)
        return at + 2 + count

    @staticmethod
    def _channel(token: Token) -> str:
        name = token.text[:1].upper() + token.text[1:].lower()
        if name not in CHANNELS:
            raise BadInput("unknown channel", where=token.where, expected=" | ".join(CHANNELS), seen=token.text)
        return name


def read_hierarchy(text: BvhText, *, max_joints: int, max_depth: int) -> tuple[list[BvhJoint], int, list[str]]:
    """Joints (parents first), the byte offset behind the MOTION keyword, and findings.

    Raises BadInput with line and column for anything that is not a BVH hierarchy.
    """
    reader = _Reader(text, max_joints, max_depth)
    started = False
    line_number, counted = 1, 0
    for offset, line in text.lines(0):
        line_number, counted = line_number + text.line_ends(counted, offset), offset
        stripped = line.strip()
        if stripped.upper() == b"MOTION":
            text.require_printable(offset)
            _finish(reader, text.where(offset))
            return reader.joints, offset + len(line), reader.findings
        if len(line) > 10_000:
            raise BadInput(where=text.where(offset), expected="a BVH hierarchy", seen="a line of over 10,000 bytes")
        decoded = line.decode("utf-8", errors="replace")
        if not started:
            text.require_printable(offset + len(line))
            decoded = decoded.removeprefix("\ufeff")
        words = [
            Token(match.group(), Where(text.path, line_number, match.start() + 1)) for match in _WORD.finditer(decoded)
        ]
        if not started and words:
            if words[0].text.upper() != "HIERARCHY":
                raise BadInput(
                    where=words[0].where, expected="HIERARCHY, the first word of a BVH file", seen=words[0].text
                )
            started, words = True, words[1:]
        reader.line(words)
    text.require_printable(len(text.data))
    raise BadInput(where=text.where(len(text.data)), expected="MOTION", seen="the end of the file")


def _finish(reader: _Reader, where: Where) -> None:
    if reader.stack or reader.pending is not None or reader.pending_end_site:
        raise BadInput(where=where, expected=f"{max(len(reader.stack), 1)} more '}}' before MOTION", seen="MOTION")
    if not reader.joints:
        raise BadInput(where=where, expected="at least one ROOT before MOTION", seen="none")
    _make_unique(reader)


def _make_unique(reader: _Reader) -> None:
    taken = {joint.name for joint in reader.joints if joint.name}
    seen: set[str] = set()
    copies: dict[str, int] = {}
    for index, joint in enumerate(reader.joints):
        if "\ufffd" in joint.name:
            reader.findings.append(f"{joint.where}: the name {joint.name!r} is not UTF-8")
        if joint.name and joint.name not in seen:
            seen.add(joint.name)
            continue
        base = joint.name or f"joint_{index}"
        name = base
        while name in taken:
            copies[base] = copies.get(base, 1) + 1
            name = f"{base}_{copies[base]}"
        what = f"a second joint {joint.name!r}" if joint.name else "a joint without a name"
        reader.findings.append(f"{joint.where}: {what}, called {name!r}")
        joint.name = name
        taken.add(name)
        seen.add(name)
