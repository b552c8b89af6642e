"""ELAN's .eaf files (EUDICO Annotation Format 3.0): the annotation format of the field, there and back without loss.

A time-aligned tier per layer and one for the spoken words; what else a span holds (stroke, words, note, confidence)
lies on tiers that refer to it, named ``layer@what`` as ELAN users do. What belongs to the whole take are properties
of the header. Files from others are taken as far as their tiers carry our layers' names.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput, Where
from game.embos.findings import Findings
from game.embos.units import LAYERS
from game.formats.files import read_bytes, write_text
from game.tools.annotate.document import Document, Mark, Word, check_overlaps, on_grid

__all__ = ["eaf_text", "read_eaf", "write_eaf"]

MAX_BYTES = 32_000_000
MAX_ELEMENTS = 400_000
_SPOKEN = "spoken"
_PREFIX = "mcg:"
_FIELDS = ("stroke", "words", "note", "confidence")
_SCHEMA = "http://www.mpi.nl/tools/elan/EAFv3.0.xsd"


def write_eaf(document: Document, path: Path) -> None:
    """Write a document for ELAN. Raises BadInput."""
    write_text(path, eaf_text(document))


def eaf_text(document: Document) -> str:
    """The XML of a document."""
    xsi = "http://www.w3.org/2001/XMLSchema-instance"
    ElementTree.register_namespace("xsi", xsi)
    # Without a date: the same document gives the same bytes.
    root = ElementTree.Element(
        "ANNOTATION_DOCUMENT",
        {"AUTHOR": document.author, "DATE": "1970-01-01T00:00:00+00:00", "FORMAT": "3.0", "VERSION": "3.0",
         f"{{{xsi}}}noNamespaceSchemaLocation": _SCHEMA},
    )  # fmt: skip
    header = ElementTree.SubElement(root, "HEADER", {"MEDIA_FILE": "", "TIME_UNITS": "milliseconds"})
    for name in ("take", "emotion", "bvh", "version", "fps", "frames", "note", "licence"):
        value = getattr(document, name)
        ElementTree.SubElement(header, "PROPERTY", {"NAME": _PREFIX + name}).text = (
            repr(value) if isinstance(value, float) else str(value)
        )
    _Writer(root, document).write()
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


class _Writer:
    """Numbers the time slots and annotations of one file."""

    def __init__(self, root: ElementTree.Element, document: Document) -> None:
        self.root, self.document = root, document
        self.order = ElementTree.SubElement(root, "TIME_ORDER")
        self.slots: dict[int, str] = {}
        self.count = 0

    def write(self) -> None:
        times = {_ms(t) for m in self.document.marks for t in (m.start_s, m.end_s)}
        times |= {_ms(t) for w in self.document.spoken for t in (w.start_s, w.end_s)}
        for number, ms in enumerate(sorted(times), 1):
            self.slots[ms] = f"ts{number}"
            ElementTree.SubElement(self.order, "TIME_SLOT", {"TIME_SLOT_ID": f"ts{number}", "TIME_VALUE": str(ms)})
        for layer in LAYERS:
            marks = self.document.of_layer(layer)
            tier = self._tier(layer, "default-lt")
            ids = [self._aligned(tier, m.start_s, m.end_s, m.behaviour) for m in marks]
            for field in _FIELDS:
                values = [_field(m, field) for m in marks]
                if any(values):
                    below = self._tier(f"{layer}@{field}", "about", layer)
                    for own, value in zip(ids, values, strict=True):
                        if value:
                            self._referring(below, own, value)
        tier = self._tier(_SPOKEN, "default-lt")
        for word in self.document.spoken:
            self._aligned(tier, word.start_s, word.end_s, word.text)
        for name, constraint in (("default-lt", None), ("about", "Symbolic_Association")):
            attributes = {"LINGUISTIC_TYPE_ID": name, "GRAPHIC_REFERENCES": "false"}
            attributes["TIME_ALIGNABLE"] = "false" if constraint else "true"
            if constraint:
                attributes["CONSTRAINTS"] = constraint
            ElementTree.SubElement(self.root, "LINGUISTIC_TYPE", attributes)
        ElementTree.SubElement(
            self.root, "CONSTRAINT",
            {"STEREOTYPE": "Symbolic_Association", "DESCRIPTION": "1-1 association with a parent annotation"},
        )  # fmt: skip

    def _tier(self, name: str, kind: str, parent: str | None = None) -> ElementTree.Element:
        attributes = {"TIER_ID": name, "LINGUISTIC_TYPE_REF": kind}
        if self.document.author:
            attributes["ANNOTATOR"] = self.document.author
        if parent:
            attributes["PARENT_REF"] = parent
        return ElementTree.SubElement(self.root, "TIER", attributes)

    def _aligned(self, tier: ElementTree.Element, start_s: float, end_s: float, value: str) -> str:
        name = self._next()
        holder = ElementTree.SubElement(tier, "ANNOTATION")
        place = {"TIME_SLOT_REF1": self.slots[_ms(start_s)], "TIME_SLOT_REF2": self.slots[_ms(end_s)]}
        own = ElementTree.SubElement(holder, "ALIGNABLE_ANNOTATION", {"ANNOTATION_ID": name, **place})
        ElementTree.SubElement(own, "ANNOTATION_VALUE").text = value
        return name

    def _referring(self, tier: ElementTree.Element, parent: str, value: str) -> None:
        holder = ElementTree.SubElement(tier, "ANNOTATION")
        attributes = {"ANNOTATION_ID": self._next(), "ANNOTATION_REF": parent}
        own = ElementTree.SubElement(holder, "REF_ANNOTATION", attributes)
        ElementTree.SubElement(own, "ANNOTATION_VALUE").text = value

    def _next(self) -> str:
        self.count += 1
        return f"a{self.count}"


def _ms(time_s: float) -> int:
    return round(time_s * 1000.0)


def _field(mark: Mark, name: str) -> str:
    if name == "stroke":
        return "" if mark.stroke_s is None else f"{mark.stroke_s:.3f}"
    if name == "confidence":
        return "" if mark.confidence is None else repr(mark.confidence)
    return str(getattr(mark, name))


# --- reading ---------------------------------------------------------------------------------------------------
def read_eaf(path: Path, like: Document | None = None) -> Document:
    """A document from an .eaf file. like: the take it belongs to, for what a foreign file does not say.

    Raises a BadInput that holds all that is wrong with its annotations, each with its place, or the line where XML is
    broken; entities and document types are refused.
    """
    root = _parse(path)
    if root.tag != "ANNOTATION_DOCUMENT":
        raise BadInput("ELAN file", where=Where(path), expected="<ANNOTATION_DOCUMENT>", seen=f"<{root.tag}>")
    times = _times(root, path)
    document = _head(root, path, like)
    below = _referring(root)
    marks: list[Mark] = []
    words: list[Word] = []
    places: dict[Mark, Where] = {}
    findings = Findings()
    for tier in root.iter("TIER"):
        name = tier.get("TIER_ID", "")
        if name not in LAYERS and name != _SPOKEN:
            continue
        for own in tier.iter("ALIGNABLE_ANNOTATION"):
            where = Where(path, pointer=f"/{name}/{own.get('ANNOTATION_ID', '?')}")
            with findings.collect():
                start, end = (_slot(own, key, times, where) for key in ("TIME_SLOT_REF1", "TIME_SLOT_REF2"))
                value = (own.findtext("ANNOTATION_VALUE") or "").strip()
                if end <= start:
                    seen = f"{start:g} to {end:g} s"
                    raise BadInput("annotation", where=where, expected="an end after its start", seen=seen)
                if name == _SPOKEN:
                    words.append(Word(start, end, value))
                elif value:
                    about = below.get(own.get("ANNOTATION_ID", ""), {})
                    marks.append(_mark(Mark(start, end, name, value), about, where))
                    places[marks[-1]] = where
                else:
                    raise BadInput("annotation", where=where, expected="a behaviour", seen="nothing")
    if not document.frames:
        last = max([m.end_s for m in marks] + [w.end_s for w in words], default=0.0)
        document = replace(document, frames=max(round(last * document.fps + 0.499), 1))
    document = replace(document, spoken=tuple(sorted(words))).with_marks(marks)
    check_overlaps(document, places, findings)
    findings.raise_first()
    return document


def _parse(path: Path) -> ElementTree.Element:
    data = read_bytes(path, max_bytes=MAX_BYTES, what="ELAN file")
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise BadInput("ELAN file", where=Where(path), expected="no document type", seen="<!DOCTYPE …>")
    # Without a document type there are no entities to expand; what is left is bounded by the file's size.
    try:
        root = ElementTree.fromstring(data)
    except ElementTree.ParseError as error:
        line, column = error.position
        raise BadInput(f"ELAN file: {error.msg.split(':')[0]}", where=Where(path, line, column + 1)) from None
    except (LookupError, ValueError) as error:  # an encoding nobody knows, or one of several bytes
        raise BadInput("ELAN file", where=Where(path), expected="UTF-8", seen=str(error)) from None
    if (count := sum(1 for _ in root.iter())) > MAX_ELEMENTS:
        raise BadInput("ELAN file", where=Where(path), expected=f"at most {MAX_ELEMENTS} elements", seen=count)
    return root


def _times(root: ElementTree.Element, path: Path) -> dict[str, float]:
    times: dict[str, float] = {}
    for slot in root.iter("TIME_SLOT"):
        value = slot.get("TIME_VALUE")
        if value is None:
            continue  # ELAN leaves slots between two known ones open
        pointer = f"/TIME_ORDER/{slot.get('TIME_SLOT_ID', '?')}"
        if not (value.isascii() and value.isdigit()) or len(value) > 12:
            raise BadInput("time", where=Where(path, pointer=pointer), expected="whole milliseconds", seen=value)
        times[slot.get("TIME_SLOT_ID", "")] = on_grid(int(value) / 1000.0)
    return times


def _slot(own: ElementTree.Element, key: str, times: dict[str, float], where: Where) -> float:
    name = own.get(key, "")
    if name not in times:
        raise BadInput("annotation", where=where, expected=f"{key} with a time", seen=name)
    return times[name]


def _head(root: ElementTree.Element, path: Path, like: Document | None) -> Document:
    held = {
        p.get("NAME", "").removeprefix(_PREFIX): p.text or ""
        for p in root.iter("PROPERTY") if p.get("NAME", "").startswith(_PREFIX)
    }  # fmt: skip
    base = like or Document(take=path.stem, bvh=f"{path.stem}.bvh", fps=30.0, frames=0)

    def number(key: str, default: float, low: float, high: float) -> float:
        if key not in held:
            return default
        try:
            value = float(held[key])
        except ValueError:
            value = float("nan")
        if not low <= value <= high:
            where = Where(path, pointer=f"/HEADER/{_PREFIX}{key}")
            raise BadInput(key, where=where, expected=f"a number from {low:g} to {high:g}", seen=held[key])
        return value

    emotion = held.get("emotion", base.emotion)
    if emotion and emotion not in EMOTIONS:
        where = Where(path, pointer=f"/HEADER/{_PREFIX}emotion")
        raise BadInput("emotion", where=where, expected=" | ".join(EMOTIONS), seen=emotion)
    bvh = held.get("bvh", base.bvh)
    if Path(bvh).name != bvh:
        raise BadInput("bvh", where=Where(path, pointer=f"/HEADER/{_PREFIX}bvh"), expected="a file name", seen=bvh)
    return replace(
        base, take=held.get("take", base.take), emotion=emotion, bvh=bvh, author=root.get("AUTHOR") or base.author,
        version=int(number("version", base.version, 1, 1e6)), fps=number("fps", base.fps, 1.0, 1000.0),
        frames=int(number("frames", base.frames, 0, 1e7)), note=held.get("note", base.note),
        licence=held.get("licence", base.licence), marks=(), spoken=(),
    )  # fmt: skip


def _referring(root: ElementTree.Element) -> dict[str, dict[str, str]]:
    """Annotation id -> what other tiers say about it."""
    about: dict[str, dict[str, str]] = {}
    for tier in root.iter("TIER"):
        layer, _, field = tier.get("TIER_ID", "").partition("@")
        if layer in LAYERS and field in _FIELDS:
            for own in tier.iter("REF_ANNOTATION"):
                about.setdefault(own.get("ANNOTATION_REF", ""), {})[field] = own.findtext("ANNOTATION_VALUE") or ""
    return about


def _mark(mark: Mark, about: dict[str, str], place: Where) -> Mark:
    def number(key: str, low: float, high: float) -> float | None:
        if key not in about:
            return None
        try:
            value = float(about[key])
        except ValueError:
            value = float("nan")
        if not low <= value <= high:
            where = Where(place.path, pointer=f"{place.pointer}@{key}")
            raise BadInput(key, where=where, expected=f"a number from {low:g} to {high:g}", seen=about[key])
        return value

    stroke = number("stroke", mark.start_s, mark.end_s)
    return replace(
        mark, stroke_s=None if stroke is None else on_grid(stroke), confidence=number("confidence", 0.0, 1.0),
        words=about.get("words", ""), note=about.get("note", ""),
    )  # fmt: skip
