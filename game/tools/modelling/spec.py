"""A character's authored numbers: dataclasses filled strictly from a YAML file, one record per section.

Every value a designer can change stands in ``assets/characters/<id>.yaml``; unknown keys and wrong types are refused
with their place in the file. Lengths are metres, angles in the tables degrees (keys that end in ``_deg``). The body
is modelled at the reference humanoid's size; ``proportions`` then stretches it to the person's own.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from game.face import DEFAULT_STYLE, FaceStyle, read_style
from game.formats import Node, load_yaml
from game.tools.modelling.proportions import Proportions
from game.tools.modelling.records import Vector, record
from game.tools.modelling.spec_hair import CurlSpec, HairSpec, TuftSpec, read_hair
from game.tools.modelling.spec_wear import CLOTHES, BandSpec, CapSpec, ClothesSpec, LegSpec, SpectaclesSpec
from game.tools.modelling.weave_spec import Weave, read_weaves

__all__ = [
    "BodySpec",
    "CharacterSpec",
    "CurlSpec",
    "HairSpec",
    "HandSpec",
    "HeadSpec",
    "SpringSpec",
    "Swatch",
    "TuftSpec",
    "load_character",
    "read_palette",
]

Part = TypeVar("Part")
_SECTIONS = (
    *("id", "name", "authors", "palette", "face", "proportions", "head", "body", "hand", "clothes", "legs", "hair"),
    *("band", "cap", "spectacles", "springs", "weaves"),
)


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
    nose_radius: float = 0.0075
    nose_drop: float = 0.014
    ear_x: float = 0.170
    brow_plane: Vector = (0.30, 0.42, 0.318)
    """Radii of the large ellipsoid 16 cm behind the centre that planes off brow and cheeks."""


@dataclass(frozen=True)
class BodySpec:
    """Radii of the trunk's masses and of the limbs, metres. belly: none where its first radius is 0."""

    chest: Vector
    waist: Vector
    pelvis: Vector
    shoulder_radius: float
    forearm_elbow: float
    forearm_wrist: float
    knee: float
    ankle: float
    calf: float
    belly: Vector = (0.0, 0.0, 0.0)
    belly_at: Vector = (0.0, 0.68, 0.0)
    forearm_from: float = 0.034
    """Where the bare forearm begins, from the elbow: under long sleeves near the wrist, or it shows when they bend."""


@dataclass(frozen=True)
class HandSpec:
    """Radii in metres. fingers: index, middle, ring, little."""

    fingers: tuple[float, float, float, float]
    thumb: float
    palm_half: Vector


@dataclass(frozen=True)
class SpringSpec:
    """Dynamics of one kind of chain, in the units of VRMC_springBone."""

    stiffness: float
    drag: float
    gravity: float
    radius: float


@dataclass(frozen=True)
class CharacterSpec:
    """One person. clothes: the record of its kind (coat, haori, dungarees)."""

    id: str
    name: str
    authors: tuple[str, ...]
    palette: dict[str, Swatch]
    face: FaceStyle
    proportions: Proportions
    head: HeadSpec
    body: BodySpec
    hand: HandSpec
    clothes: ClothesSpec
    legs: LegSpec
    hair: HairSpec
    band: BandSpec | None
    cap: CapSpec | None
    spectacles: SpectaclesSpec | None
    springs: dict[str, SpringSpec] = field(repr=False)
    weaves: dict[str, Weave] = field(default_factory=dict)


def read_palette(node: Node) -> dict[str, Swatch]:
    """``name: [class, lit, shade, deep]`` -> swatches by name."""
    palette = {}
    for key, row in node.items():
        items = row.as_list()
        if len(items) != 4:
            raise row.error(expected="[class, lit, shade, deep]")
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


def _clothes(node: Node) -> ClothesSpec:
    kind = node["kind"].as_str()
    if kind not in CLOTHES:
        raise node["kind"].error(expected=" | ".join(CLOTHES))
    return record(node, CLOTHES[kind])


def _optional(node: Node, key: str, kind: type[Part]) -> Part | None:
    part = node.get(key)
    return None if part is None else record(part, kind)


def _swings(spec_hair: HairSpec, clothes: ClothesSpec, band: BandSpec | None) -> set[str]:
    """The kinds of chain the person has, each of which needs its dynamics."""
    kinds = set(clothes.swings)
    kinds |= {"hair"} if spec_hair.chains else set()
    kinds |= {"tuft"} if spec_hair.tufts else set()
    return kinds | ({"bow"} if band else set())


def load_character(path: Path) -> CharacterSpec:
    """Read ``assets/characters/<id>.yaml``. Raises BadInput with file:line:col."""
    node = load_yaml(path)
    node.only(*_SECTIONS)
    hair, clothes, band = read_hair(node["hair"]), _clothes(node["clothes"]), _optional(node, "band", BandSpec)
    springs = node["springs"].only(*sorted(_swings(hair, clothes, band)))
    legs = record(node["legs"], LegSpec)
    palette = read_palette(node["palette"])
    needed = {"skin", "face", "hair", *clothes.materials, *legs.materials}
    needed |= {"red"} if band else set()
    needed |= {"cap", "cap_band"} if "cap" in node else set()
    needed |= {"rims"} if "spectacles" in node else set()
    for name in sorted(needed - set(palette)):
        raise node["palette"].error(f"no colours for the material {name!r}", expected=", ".join(sorted(needed)))
    style = node.get("face")
    proportions = _optional(node, "proportions", Proportions)
    return CharacterSpec(
        id=node["id"].as_str(),
        name=node["name"].as_str(),
        authors=tuple(item.as_str() for item in node["authors"]),
        palette=palette,
        face=DEFAULT_STYLE if style is None else read_style(style),
        proportions=proportions or Proportions(),
        head=record(node["head"], HeadSpec),
        body=record(node["body"], BodySpec),
        hand=record(node["hand"], HandSpec),
        clothes=clothes,
        legs=legs,
        hair=hair,
        band=band,
        cap=_optional(node, "cap", CapSpec),
        spectacles=_optional(node, "spectacles", SpectaclesSpec),
        springs={name: record(springs[name], SpringSpec) for name in sorted(_swings(hair, clothes, band))},
        weaves=read_weaves(node.get("weaves"), palette),
    )
