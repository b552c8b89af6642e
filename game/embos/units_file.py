"""units.yaml: the statistics of the takes as the game reads them. Written by ``run_game.py analyse``."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.core.emotion_space import EMOTION_INDEX, EMOTIONS
from game.core.errors import BadInput
from game.core.humanoid import BODY_PARTS
from game.embos.findings import Findings
from game.embos.units import LAYERS, LAYERS_WITH_REST, MotionUnit, Variant, rest_unit
from game.formats.yaml_source import Node, load_yaml, nearest

__all__ = ["CONTACT_FRAMES", "contact_frames", "one_of", "parts", "read_units", "texts", "units_text", "words"]

Floats = NDArray[np.float64]
Transitions = dict[str, dict[str, int]]

VERSION = 1
CONTACT_FRAMES: tuple[str, ...] = ("table", "head", "chest", "hips")
"""Frames in which a hand's place can be kept."""
_MAX_SECONDS = 36_000.0
_MAX_UNITS = 2_000
_HEADER = """\
# Motion units: statistics of the annotated takes. Made by `run_game.py analyse`; do not edit, it will be remade.
# intensity: eq. 2, 0..1; duration_s, waiting_s: eq. 3, seconds per emotion; duration_cv: spread of span lengths
# around their emotion's mean; variants: spans of the takes, seconds, clean = free of mannerisms and gestures;
# transitions: how often the second unit followed the first.
"""


def read_units(path: Path) -> tuple[list[MotionUnit], Transitions]:
    """Units and transition counts of a units file.

    Raises BadInput with file:line:col, expected and seen; where there are more findings, their number is given.
    """
    root = load_yaml(path, max_bytes=8_000_000, max_nodes=500_000).only("version", "units", "transitions")
    version = root["version"].as_int()
    if version != VERSION:
        raise root["version"].error("units file", expected=f"version {VERSION}", hint="run_game.py analyse")
    findings = Findings()
    units: list[MotionUnit] = []
    entries = root["units"].items()
    if len(entries) > _MAX_UNITS:
        raise BadInput("units", where=root["units"].where, expected=f"at most {_MAX_UNITS}", seen=len(entries))
    for key, node in entries:
        with findings.collect():
            units.append(_unit(key, node))
    transitions: Transitions = {}
    known = {key.as_str() for key, _ in entries} | {rest_unit(layer).name for layer in LAYERS_WITH_REST}
    counts = root.get("transitions")
    for key, row in counts.items() if counts else []:
        with findings.collect():
            transitions[_known(key, known)] = {_known(k, known): v.as_int(0) for k, v in row.items()}
    findings.raise_first()
    if not units:
        raise root["units"].error(expected="at least one unit")
    return units, transitions


def _known(key: Node, names: Iterable[str]) -> str:
    name = key.as_str()
    if name not in names:
        close = nearest(name, names)
        raise key.error("unknown unit", expected="a unit", hint=f"did you mean {close!r}?" if close else None)
    return name


def _unit(key: Node, node: Node) -> MotionUnit:
    node.only(
        "layer", "kind", "label", "words", "uses", "locks", "contacts",
        "intensity", "duration_s", "waiting_s", "duration_cv", "variants",
    )  # fmt: skip
    kind, label, called_by = node.get("kind"), node.get("label"), node.get("words")
    contacts = node.get("contacts")
    try:
        return MotionUnit(
            name=key.as_str(),
            layer=one_of(node["layer"], LAYERS),
            intensity=_seven(node["intensity"], 1.0),
            duration_s=_seven(node["duration_s"], _MAX_SECONDS),
            waiting_s=_seven(node["waiting_s"], _MAX_SECONDS),
            duration_cv=node["duration_cv"].as_float(0.0, 1.0),
            kind=kind.as_str() if kind else "",
            label=texts(label) if label else None,
            words=words(called_by) if called_by else None,
            uses=parts(node.get("uses")),
            locks=parts(node.get("locks")),
            contacts=contact_frames(contacts) if contacts else None,
            variants=tuple(_variant(v) for v in node["variants"].as_list()),
        )
    except BadInput as error:
        raise error if error.where else BadInput(error.message, where=key.where) from None


def _variant(node: Node) -> Variant:
    node.only("take", "emotion", "start_s", "end_s", "stroke_s", "clean")
    start_s, end_s = node["start_s"].as_float(0.0, _MAX_SECONDS), node["end_s"].as_float(0.0, _MAX_SECONDS)
    if end_s <= start_s:
        raise node["end_s"].error("span", expected=f"an end after its start at {start_s:g} s")
    stroke, clean = node.get("stroke_s"), node.get("clean")
    clean_s = [start_s, end_s]
    if clean:
        if len(clean) != 2:
            raise clean.error(expected="[start, end] in seconds")
        clean_s = [value.as_float() for value in clean]
        if not start_s - 1e-6 <= clean_s[0] <= clean_s[1] <= end_s + 1e-6:
            raise clean.error("clean part", expected=f"a stretch within {start_s:g} to {end_s:g} s")
    emotion = EMOTION_INDEX[one_of(node["emotion"], EMOTIONS)]
    stroke_s = stroke.as_float(start_s, end_s) if stroke else None
    return Variant(emotion, node["take"].as_str(), start_s, end_s, clean_s[0], clean_s[1], stroke_s)


def one_of(node: Node, names: Sequence[str]) -> str:
    """The text of a node, if it is one of the names. Raises BadInput with the nearest one offered."""
    name = node.as_str()
    if name not in names:
        close = nearest(name, names)
        raise node.error(expected=" | ".join(names), hint=f"did you mean {close!r}?" if close else None)
    return name


def _seven(node: Node, high: float) -> Floats:
    values = np.zeros(len(EMOTIONS))
    for key, value in node.only(*EMOTIONS).items():
        values[EMOTION_INDEX[key.as_str()]] = value.as_float(0.0, high)
    return values


def texts(node: Node) -> dict[str, str]:
    """``{en: arms crossed, ja: 腕組み}``."""
    return {key.as_str(): value.as_str() for key, value in node.items()}


def words(node: Node) -> dict[str, tuple[str, ...]]:
    """``{en: [this, that], ja: [これ]}``."""
    return {key.as_str(): tuple(word.as_str() for word in value) for key, value in node.items()}


def parts(node: Node | None) -> frozenset[str]:
    """A list of body parts."""
    return frozenset(one_of(part, BODY_PARTS) for part in node) if node else frozenset()


def contact_frames(node: Node) -> dict[str, str]:
    """``{left_hand: chest}``: hand -> the frame in which its place must be kept."""
    node.only("left_hand", "right_hand")
    return {key.as_str(): one_of(value, CONTACT_FRAMES) for key, value in node.items()}


def units_text(units: Iterable[MotionUnit], transitions: Mapping[str, Mapping[str, int]]) -> str:
    """The text of a units file, the same for the same units on every run."""
    lines = [_HEADER + f"version: {VERSION}", "units:"]
    for unit in units:
        seen = {name: k for k, name in enumerate(EMOTIONS) if unit.exists[k]}
        lines += [f"  {_text(unit.name)}:", f"    layer: {unit.layer}"]
        if unit.kind:
            lines.append(f"    kind: {_text(unit.kind)}")
        lines.append(f"    label: {_flow(unit.label or {})}")
        if unit.words:
            lines.append(f"    words: {_flow({k: list(v) for k, v in unit.words.items()})}")
        lines.append(f"    uses: {_flow([p for p in BODY_PARTS if p in unit.uses])}")
        lines.append(f"    locks: {_flow([p for p in BODY_PARTS if p in unit.locks])}")
        if unit.contacts:
            lines.append(f"    contacts: {_flow(dict(unit.contacts))}")
        for field in ("intensity", "duration_s", "waiting_s"):
            values = getattr(unit, field)
            lines.append(f"    {field}: {_flow({name: _number(values[k]) for name, k in seen.items()})}")
        lines += [f"    duration_cv: {_number(unit.duration_cv)}", "    variants:" + ("" if unit.variants else " []")]
        for v in unit.variants:
            span: dict[str, object] = {"take": v.take, "emotion": EMOTIONS[v.emotion]}
            span |= {"start_s": _number(v.start_s), "end_s": _number(v.end_s)}
            if v.stroke_s is not None:
                span["stroke_s"] = _number(v.stroke_s)
            if (v.clean_start_s, v.clean_end_s) != (v.start_s, v.end_s):
                span["clean"] = [_number(v.clean_start_s), _number(v.clean_end_s)]
            lines.append(f"      - {_flow(span)}")
    lines.append("transitions:" + ("" if transitions else " {}"))
    lines += [f"  {_text(a)}: {_flow(dict(sorted(b.items())))}" for a, b in sorted(transitions.items())]
    return "\n".join(lines) + "\n"


def _number(value: float) -> float:
    return round(float(value), 6) + 0.0


def _text(value: str) -> str:
    """Plain where it cannot be misread, else quoted (JSON strings are YAML)."""
    return (
        value
        if value.isidentifier() and value.isascii() and not _reserved(value)
        else json.dumps(value, ensure_ascii=False)
    )


def _reserved(value: str) -> bool:
    return value.lower() in {"null", "true", "false", "yes", "no", "on", "off", "y", "n"}


def _flow(value: object) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_text(str(k))}: {_flow(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_flow(v) for v in value) + "]"
    return _text(value) if isinstance(value, str) else repr(value)
