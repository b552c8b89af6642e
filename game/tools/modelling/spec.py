"""A character's authored numbers: dataclasses filled strictly from a YAML file, one record per section.

Every value a designer can change stands in ``assets/characters/<id>.yaml``; unknown keys and wrong types are refused
with their place in the file. Lengths are metres, angles in the tables degrees (keys that end in ``_deg``).
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, TypeVar, get_type_hints

from game.formats import Node, load_yaml

__all__ = [
    "BandSpec",
    "BodySpec",
    "CharacterSpec",
    "ClothesSpec",
    "ClumpSpec",
    "HairSpec",
    "HandSpec",
    "HeadSpec",
    "SpringSpec",
    "Swatch",
    "TuftSpec",
    "load_character",
    "read_palette",
]

Vector = tuple[float, float, float]
Record = TypeVar("Record")


@dataclass(frozen=True)
class Swatch:
    """A palette entry: ``kind`` is the shading class; lit, shade and deep are sRGB "#rrggbb"."""

    kind: str
    lit: str
    shade: str
    deep: str


@dataclass(frozen=True)
class HeadSpec:
    """Radii and places in metres from the head's centre."""

    skull: Vector
    jaw: Vector
    jaw_at: Vector
    chin: float
    chin_at: Vector
    cheek: float
    cheek_at: Vector
    eye_hollow: Vector
    nose_length: float
    ear: Vector
    neck_radius: float
    neck_base_radius: float


@dataclass(frozen=True)
class BodySpec:
    """Radii of the trunk's three masses and of the limbs, metres."""

    chest: Vector
    waist: Vector
    pelvis: Vector
    shoulder_radius: float
    forearm_elbow: float
    forearm_wrist: float
    knee: float
    ankle: float
    calf: float


@dataclass(frozen=True)
class HandSpec:
    """Radii in metres. fingers: index, middle, ring, little."""

    fingers: tuple[float, float, float, float]
    thumb: float
    palm_half: Vector


@dataclass(frozen=True)
class ClothesSpec:
    """Lengths in metres: along the arm from the shoulder, or heights above the ground."""

    sleeve_end: float
    sleeve_radius: Vector
    sleeve_stripe: float
    coat_hem: float
    coat_flare: float
    apron_top: float
    apron_hem: float
    cuff_from: float
    cuff_to: float
    trouser_hem: float
    trouser_radius: float
    sock_top: float
    crest_radius: float


@dataclass(frozen=True)
class ClumpSpec:
    """One lock of hair on the skull: from azimuth/polar angle to azimuth/polar angle.

    layer: fringe | accent | side | back | under | crown. Beyond a polar angle of 90 degrees it hangs down. lift is
    the height above the scalp, bow the extra height at half length, tip the outward flick of the end.
    """

    layer: str
    azimuth_deg: tuple[float, float]
    polar_deg: tuple[float, float]
    width: float
    thickness: float
    lift: float
    bow: float
    tip: float
    curl_deg: float
    ease: float
    widest: float


@dataclass(frozen=True)
class TuftSpec:
    """A stray hair: four Bezier points from the head's centre, metres."""

    name: str
    points: tuple[Vector, Vector, Vector, Vector]
    width: float
    thickness: float
    outward: Vector


@dataclass(frozen=True)
class HairSpec:
    radii: Vector
    centre: Vector
    clumps: tuple[ClumpSpec, ...]
    tufts: tuple[TuftSpec, ...]
    chains: tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class BandSpec:
    """The headband and its bow. polar_deg: mean height and how much it dips in front."""

    polar_deg: tuple[float, float]
    width: float
    thickness: float
    knot_deg: tuple[float, float]
    bow_scale: float


@dataclass(frozen=True)
class SpringSpec:
    """Dynamics of one kind of chain, in the units of VRMC_springBone."""

    stiffness: float
    drag: float
    gravity: float
    radius: float


@dataclass(frozen=True)
class CharacterSpec:
    id: str
    name: str
    authors: tuple[str, ...]
    palette: dict[str, Swatch]
    head: HeadSpec
    body: BodySpec
    hand: HandSpec
    clothes: ClothesSpec
    hair: HairSpec
    band: BandSpec
    springs: dict[str, SpringSpec]


def _numbers(node: Node, count: int) -> tuple[float, ...]:
    items = node.as_list()
    if len(items) != count:
        raise node.error(expected=f"{count} numbers")
    return tuple(item.as_float(-1000.0, 1000.0) for item in items)


def _value(node: Node, kind: Any) -> Any:
    if kind is float:
        return node.as_float(-1000.0, 1000.0)
    if kind is str:
        return node.as_str()
    arguments = kind.__args__
    if arguments[0] is float:
        return _numbers(node, len(arguments))
    return tuple(_numbers(item, 3) for item in node.as_list())


def _record(node: Node, kind: type[Record]) -> Record:
    """A dataclass from a mapping with exactly its fields."""
    hints = get_type_hints(kind)
    names = [f.name for f in fields(kind)]  # type: ignore[arg-type]  # every Record here is a dataclass
    node.only(*names)
    return kind(**{name: _value(node[name], hints[name]) for name in names})


def read_palette(node: Node) -> dict[str, Swatch]:
    """``name: [class, lit, shade, deep]`` -> swatches by name."""
    palette = {}
    for key, value in node.items():
        items = value.as_list()
        if len(items) != 4:
            raise value.error(expected="[class, lit, shade, deep]")
        kind, *colours = (item.as_str() for item in items)
        if kind not in ("skin", "face", "hair", "cloth", "gloss", "flat"):
            raise items[0].error(expected="skin | face | hair | cloth | gloss | flat")
        for item, colour in zip(items[1:], colours, strict=True):
            if (
                len(colour) != 7
                or not colour.startswith("#")
                or not all(c in "0123456789ABCDEFabcdef" for c in colour[1:])
            ):
                raise item.error(expected='a colour "#rrggbb"')
        palette[key.as_str()] = Swatch(kind, *colours)
    return palette


def _hair(node: Node) -> HairSpec:
    node.only("radii", "centre", "clumps", "tufts", "chains")
    return HairSpec(
        radii=_value(node["radii"], Vector),
        centre=_value(node["centre"], Vector),
        clumps=tuple(_record(row, ClumpSpec) for row in node["clumps"]),
        tufts=tuple(_record(row, TuftSpec) for row in node["tufts"]),
        chains=tuple((key.as_str(), value.as_float(-180, 180)) for key, value in node["chains"].items()),
    )


def load_character(path: Path) -> CharacterSpec:
    """Read ``assets/characters/<id>.yaml``. Raises BadInput with file:line:col."""
    node = load_yaml(path)
    node.only("id", "name", "authors", "palette", "head", "body", "hand", "clothes", "hair", "band", "springs")
    return CharacterSpec(
        id=node["id"].as_str(),
        name=node["name"].as_str(),
        authors=tuple(item.as_str() for item in node["authors"]),
        palette=read_palette(node["palette"]),
        head=_record(node["head"], HeadSpec),
        body=_record(node["body"], BodySpec),
        hand=_record(node["hand"], HandSpec),
        clothes=_record(node["clothes"], ClothesSpec),
        hair=_hair(node["hair"]),
        band=_record(node["band"], BandSpec),
        springs={key.as_str(): _record(value, SpringSpec) for key, value in node["springs"].items()},
    )
