"""The authored numbers of clothes: one record per kind of outfit, the legs' clothes, headwear and spectacles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import ClassVar

from game.tools.modelling.records import Vector

__all__ = [
    "CLOTHES",
    "BandSpec",
    "CapSpec",
    "ClothesSpec",
    "CoatSpec",
    "DungareesSpec",
    "HaoriSpec",
    "LegSpec",
    "SpectaclesSpec",
]


@dataclass(frozen=True)
class ClothesSpec:
    """What every outfit's record has. Lengths in metres: along the arm from the shoulder, or heights above the ground.

    materials: palette entries it needs; swings: kinds of spring chains it has; legs: whether trousers belong to it.
    """

    kind: str
    legs: ClassVar[bool] = False
    materials: ClassVar[tuple[str, ...]] = ()
    swings: ClassVar[tuple[str, ...]] = ()


@dataclass(frozen=True)
class CoatSpec(ClothesSpec):
    """A happi coat over a bib apron and a shirt with rolled sleeves, a scarf around the neck."""

    sleeve_end: float
    sleeve_radius: Vector
    sleeve_stripe: float
    coat_hem: float
    coat_flare: float
    apron_top: float
    apron_hem: float
    cuff_from: float
    cuff_to: float
    crest_radius: float
    materials = ("shirt", "apron", "apron2", "indigo", "cream", "red", "teal")
    swings = ("scarf",)


@dataclass(frozen=True)
class HaoriSpec(ClothesSpec):
    """A haori with wide sleeves over a waistcoat and a crossed kimono collar; cords, watch chain, pocket square.

    sleeve: radius at the shoulder, radius at the opening, how far the sleeve's pouch hangs below the arm.
    opening: half width of the front at hem, waist, chest and collar bone.
    """

    sleeve_end: float
    sleeve: Vector
    hem: float
    flare: float
    opening: tuple[float, float, float, float]
    collar_width: float
    vest_top: float
    vest_hem: float
    under_sleeve: Vector
    crest_radius: float
    materials = ("ivory", "vest", "vest2", "haori", "haori2", "lining", "brass", "cord")
    swings = ("sleeve", "cord")


@dataclass(frozen=True)
class DungareesSpec(ClothesSpec):
    """Bib and brace over a striped jumper with pushed-up sleeves.

    jumper: thickness over the body. stripe: height of a pair of stripes. sleeve: radii at shoulder, elbow, end.
    bib: half width at the top and at the waist.
    """

    jumper: float
    stripe: float
    sleeve: Vector
    sleeve_end: float
    waist: float
    bib: tuple[float, float]
    bib_top: float
    strap_x: tuple[float, float]
    strap_width: float
    materials = ("jumper", "jumper2", "denim", "denim2", "stitch", "brass", "rag")
    swings = ("strap", "rag")
    legs = True


CLOTHES: Mapping[str, type[ClothesSpec]] = MappingProxyType(
    {"coat": CoatSpec, "haori": HaoriSpec, "dungarees": DungareesSpec}
)
"""Kind in the YAML -> its record."""


@dataclass(frozen=True)
class LegSpec:
    """Trousers, socks and shoes. hem, sock_top: heights. radius: of a trouser leg at hip and hem, metres.

    The materials are palette entries: trouser leg, its turn-up, sock, shoe, toe cap, sole.
    """

    trouser_hem: float
    radius: tuple[float, float]
    sock_top: float
    trousers: str = "trousers"
    turn_up: str = "trousers2"
    sock: str = "cream"
    shoe: str = "red"
    toe_cap: str = "cream"
    sole: str = "cream"
    turn_up_m: float = 0.022
    trouser_top: float = 0.60

    @property
    def materials(self) -> tuple[str, ...]:
        return (self.trousers, self.turn_up, self.sock, self.shoe, self.toe_cap, self.sole)


@dataclass(frozen=True)
class BandSpec:
    """The headband and its bow. polar_deg: mean height and how much it dips in front."""

    polar_deg: tuple[float, float]
    width: float
    thickness: float
    knot_deg: tuple[float, float]
    bow_scale: float


@dataclass(frozen=True)
class CapSpec:
    """A small cap with a button and a peak. at: of its middle, from the head's centre. radii: of the crown.

    tilt_deg: leaning back (+), to the wearer's left (+). peak: length, half width, thickness.
    """

    at: Vector
    radii: Vector
    tilt_deg: tuple[float, float]
    band: float
    peak: Vector


@dataclass(frozen=True)
class SpectaclesSpec:
    """Round spectacles. at: the left lens, ear: end of the side, from the head's centre; turn_deg: lenses outward."""

    at: Vector
    radius: float
    rim: float
    turn_deg: float
    ear: Vector
