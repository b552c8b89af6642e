"""behaviours.yaml: the names spans may carry, and what no statistics can tell (parts, contacts, words, labels)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from game.embos.findings import Findings
from game.embos.units import LAYERS
from game.embos.units_file import contact_frames, one_of, parts, texts, words
from game.formats.yaml_source import Node, load_yaml

__all__ = ["Behaviour", "read_repertoire"]


@dataclass(frozen=True)
class Behaviour:
    """One behaviour of the repertoire; see MotionUnit for the fields."""

    name: str
    layer: str
    kind: str
    label: Mapping[str, str]
    words: Mapping[str, tuple[str, ...]]
    uses: frozenset[str]
    locks: frozenset[str]
    contacts: Mapping[str, str]


def read_repertoire(path: Path, findings: Findings) -> dict[str, Behaviour]:
    """Name -> Behaviour in file order; what is wrong goes into the findings, the rest is read."""
    result: dict[str, Behaviour] = {}
    with findings.collect(reading=True):
        for key, node in load_yaml(path).only("behaviours")["behaviours"].items():
            with findings.collect():
                result[key.as_str()] = _behaviour(key.as_str(), node)
    return result


def _behaviour(name: str, node: Node) -> Behaviour:
    node.only("layer", "kind", "label", "words", "uses", "locks", "contacts")
    kind, label, called_by, contacts = (node.get(k) for k in ("kind", "label", "words", "contacts"))
    return Behaviour(
        name=name,
        layer=one_of(node["layer"], LAYERS),
        kind=kind.as_str() if kind else "",
        label=texts(label) if label else {"en": name.replace("_", " ")},
        words=words(called_by) if called_by else {},
        uses=parts(node.get("uses")),
        locks=parts(node.get("locks")),
        contacts=contact_frames(contacts) if contacts else {},
    )
