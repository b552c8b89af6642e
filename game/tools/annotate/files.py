"""Annotations on the disk: YAML that people read and diff, one file per take, one span a line; and the autosave.

Times stand in seconds and in frames; the seconds count, the frames must agree with them to within one.
"""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput, Where
from game.embos.annotations import check_frames
from game.embos.clips import TakeClip
from game.embos.findings import Findings
from game.embos.units import LAYERS
from game.embos.units_file import one_of
from game.formats.bvh import read_bvh
from game.formats.files import read_bytes, write_text
from game.formats.yaml_source import Node, load_yaml, parse_yaml
from game.tools.annotate.document import LONGEST_S, Document, Mark, Word, check_overlaps, on_grid

__all__ = ["autosave_path", "clear_autosave", "document_text", "open_document", "read_document", "recover", "save",
           "write_autosave"]  # fmt: skip

_HEAD = ("take", "emotion", "bvh", "author", "version", "fps", "frames", "note", "licence", "spoken", "spans")
_SPAN = ("layer", "behaviour", "start_s", "end_s", "frames", "stroke_s", "words", "note", "confidence")
MAX_BYTES = 4_000_000


def open_document(bvh: Path, author: str = "", motion: TakeClip | None = None) -> Document:
    """The annotation beside a BVH file (same name, .yaml), or a new empty one. motion: of the file, where it has been
    read. Raises BadInput."""
    if motion is None:
        clip = read_bvh(bvh).clip
        frame_time_s, frames = clip.frame_time_s, len(clip)
    else:
        frame_time_s, frames = motion.frame_time_s, len(motion.rotation)
    notes = bvh.with_suffix(".yaml")
    fps = round(1.0 / frame_time_s, 6)
    if notes.exists():
        return replace(read_document(notes), fps=fps, frames=frames)
    return Document(take=bvh.stem, bvh=bvh.name, fps=fps, frames=frames, author=author)


def read_document(path: Path) -> Document:
    """One annotation, whatever its behaviours are called. Raises a BadInput that also says how many more there are."""
    findings = Findings()
    document = _document(load_yaml(path), path, findings)
    findings.raise_first()
    assert document is not None
    return document


def _document(root: Node, path: Path, findings: Findings) -> Document | None:
    document: Document | None = None
    with findings.collect():
        root.only(*_HEAD)
        fps = root["fps"].as_float(1.0, 1000.0)

        def text(key: str) -> str:
            node = root.get(key)
            return "" if node is None or node.kind == "null" else node.as_str()

        bvh = text("bvh") or f"{path.stem}.bvh"
        if Path(bvh).name != bvh:
            raise root["bvh"].error("bvh", expected="a file name in this folder")
        emotion = text("emotion")
        if emotion:
            one_of(root["emotion"], EMOTIONS)
        version = root.get("version")
        document = Document(
            take=text("take") or path.stem, bvh=bvh, fps=fps, frames=0, emotion=emotion, author=text("author"),
            version=1 if version is None else version.as_int(1, 1_000_000), note=text("note"), licence=text("licence"),
        )  # fmt: skip
        marks: list[Mark] = []
        words: list[Word] = []
        places: dict[Mark, Where] = {}
        for node in _items(root, "spans"):
            with findings.collect():
                marks.append(_mark(node, fps))
                places[marks[-1]] = node.where
        for node in _items(root, "spoken"):
            with findings.collect():
                words.append(_word(node))
        frames = root.get("frames")
        last = max([m.end_s for m in marks] + [w.end_s for w in words], default=0.0)
        count = frames.as_int(1, 10_000_000) if frames is not None else max(round(last * fps + 0.499), 1)
        document = replace(document, frames=count, spoken=tuple(sorted(words))).with_marks(marks)
        check_overlaps(document, places, findings)
    return document


def _items(root: Node, key: str) -> list[Node]:
    node = root.get(key)
    return [] if node is None or node.kind == "null" else node.as_list()


def _mark(node: Node, fps: float) -> Mark:
    node.only(*_SPAN)
    start, end = on_grid(node["start_s"].as_float(0.0, LONGEST_S)), on_grid(node["end_s"].as_float(0.0, LONGEST_S))
    if end <= start:
        raise node["end_s"].error("span", expected=f"an end after its start at {start:g} s")
    stroke, words, note, sure, frames = (node.get(k) for k in ("stroke_s", "words", "note", "confidence", "frames"))
    if frames is not None:
        check_frames(frames, start, end, fps)
    stroke_s = None if stroke is None else on_grid(stroke.as_float(0.0, LONGEST_S))
    if stroke is not None and stroke_s is not None and not start <= stroke_s <= end:
        raise stroke.error("stroke", expected=f"a moment from {start:g} to {end:g} s")
    return Mark(
        start,
        end,
        one_of(node["layer"], LAYERS),
        node["behaviour"].as_str(),
        stroke_s,
        "" if words is None else words.as_str(),
        "" if note is None else note.as_str(),
        None if sure is None else sure.as_float(0.0, 1.0),
    )


def _word(node: Node) -> Word:
    node.only("word", "start_s", "end_s")
    start, end = on_grid(node["start_s"].as_float(0.0, LONGEST_S)), on_grid(node["end_s"].as_float(0.0, LONGEST_S))
    if end <= start:
        raise node["end_s"].error("word", expected=f"an end after its start at {start:g} s")
    return Word(start, end, node["word"].as_str())


def document_text(document: Document) -> str:
    """The YAML of a document; reading it gives the same document."""
    head: list[tuple[str, str]] = [("take", _name(document.take))]
    if document.emotion:
        head.append(("emotion", document.emotion))
    head.append(("bvh", _name(document.bvh)))
    for key, value in (("author", document.author), ("note", document.note), ("licence", document.licence)):
        if value:
            head.append((key, _name(value)))
    head += [("version", str(document.version)), ("fps", f"{document.fps:g}"), ("frames", str(document.frames))]
    lines = [f"{key}: {value}" for key, value in head]
    if document.spoken:
        lines.append("spoken:")
        for word in document.spoken:
            lines.append(f"  - {{word: {_quoted(word.text)}, start_s: {word.start_s:.3f}, end_s: {word.end_s:.3f}}}")
    lines.append("spans:" if document.marks else "spans: []")
    lines += [f"  - {{{_span_text(mark, document)}}}" for mark in document.marks]
    return "\n".join(lines) + "\n"


def _span_text(mark: Mark, document: Document) -> str:
    parts = [
        f"layer: {mark.layer}", f"behaviour: {_name(mark.behaviour)}",
        f"start_s: {mark.start_s:.3f}", f"end_s: {mark.end_s:.3f}",
        f"frames: [{round(mark.start_s * document.fps)}, {round(mark.end_s * document.fps)}]",
    ]  # fmt: skip
    if mark.stroke_s is not None:
        parts.append(f"stroke_s: {mark.stroke_s:.3f}")
    if mark.words:
        parts.append(f"words: {_quoted(mark.words)}")
    if mark.note:
        parts.append(f"note: {_quoted(mark.note)}")
    if mark.confidence is not None:
        parts.append(f"confidence: {mark.confidence!r}")
    return ", ".join(parts)


def _quoted(text: str) -> str:
    """YAML's single quotes; control characters have no business in one line of text."""
    plain = "".join(c if c.isprintable() else " " for c in text)
    return "'" + plain.replace("'", "''") + "'"


def _name(text: str) -> str:
    plain = text.replace("_", "").replace("-", "").replace(".", "").replace(" ", "")
    words = text.lower() not in {"true", "false", "null"}
    if plain.isalpha() and plain.isascii() and words and text == text.strip() and text[0].isalpha():
        return text
    return _quoted(text)


def save(document: Document, path: Path) -> None:
    """Write the annotation whole or not at all. Raises BadInput."""
    write_text(path, document_text(document))


# --- autosave --------------------------------------------------------------------------------------------------
def autosave_path(notes: Path) -> Path:
    """Where the work on an annotation is kept until it is saved."""
    return notes.with_name(f".{notes.stem}.autosave.yaml")


def write_autosave(document: Document, notes: Path) -> None:
    """Keep the work: the document behind its own checksum, so that a half-written file is known for one."""
    text = document_text(document)
    digest = hashlib.sha256(text.encode()).hexdigest()
    write_text(autosave_path(notes), f"# autosave sha256={digest}\n{text}")


def clear_autosave(notes: Path) -> None:
    """After saving nothing is left to recover."""
    autosave_path(notes).unlink(missing_ok=True)


def recover(notes: Path) -> tuple[Document | None, str]:
    """What an interrupted session left: the document and "", or None and the reason why it cannot be used.

    (None, "") where nothing was left. A file that cannot be used is kept aside, never overwritten.
    """
    path = autosave_path(notes)
    if not path.exists():
        return None, ""
    try:
        raw = read_bytes(path, max_bytes=MAX_BYTES, what="autosave")
        head, _, body = raw.partition(b"\n")
        if head != b"# autosave sha256=" + hashlib.sha256(body).hexdigest().encode():
            raise BadInput("autosave", where=Where(path), expected="a whole file", seen="one that was cut off")
        findings = Findings()
        document = _document(parse_yaml(body.decode("utf-8"), path), path, findings)
        findings.raise_first()
    except (BadInput, UnicodeDecodeError) as error:
        aside = path.with_name(f".{notes.stem}.autosave.unreadable.yaml")
        path.replace(aside)
        return None, f"{error}; kept as {aside.name}"
    return document, ""
