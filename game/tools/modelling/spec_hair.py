"""The authored numbers of a head of hair: scalp, locks, curls, stray hairs and whiskers."""

from __future__ import annotations

from dataclasses import dataclass

from game.formats import Node
from game.tools.modelling.records import Vector, number_value, record, value

__all__ = ["ClumpSpec", "CurlSpec", "HairSpec", "TuftSpec", "read_hair"]

_LAYERS = ("fringe", "accent", "side", "back", "under", "crown")
_HAIRLINE = ((0, 0.110), (40, 0.075), (70, 0.020), (88, -0.035), (105, -0.092), (130, -0.128), (180, -0.142))


@dataclass(frozen=True)
class ClumpSpec:
    """One lock of hair on the skull: from azimuth/polar angle to azimuth/polar angle.

    layer: fringe | accent | side | back | under | crown. Beyond a polar angle of 90 degrees it hangs down; a negative
    one lies on the other side of the crown, so that a lock from -60 to 100 is combed right over the head. lift is
    the height above the scalp, bow the extra height at half length, tip the outward flick of the end, taper how far
    its beginning is narrowed (0 … 1).
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
    taper: float = 0.0


@dataclass(frozen=True)
class TuftSpec:
    """A stray hair, or a whisker: four Bezier points from the head's centre, metres."""

    name: str
    points: tuple[Vector, Vector, Vector, Vector]
    width: float
    thickness: float
    outward: Vector


@dataclass(frozen=True)
class CurlSpec:
    """A row of round curls on the scalp: ``count`` of them from one azimuth to the other at a polar angle.

    size: radius of a curl. lift: of its middle above the scalp. turns: windings of its spiral. uneven: share by which
    sizes, heights and angles differ from curl to curl.
    """

    azimuth_deg: tuple[float, float]
    polar_deg: tuple[float, float]
    count: int
    size: float
    lift: float
    turns: float = 1.5
    uneven: float = 0.2


@dataclass(frozen=True)
class HairSpec:
    """radii, centre: the scalp. hairline: rows (azimuth, height) of the cap's lower edge, symmetric. nape: radius of
    the hair behind the ears (0 = shaved), crown: how much the cap rises between the locks of the crown, whiskers:
    tufts that do not swing, beard: curls on the skin, by their direction from the head's centre (polar 90 is level,
    180 down), chains: spring bones by azimuth."""

    radii: Vector
    centre: Vector
    clumps: tuple[ClumpSpec, ...]
    tufts: tuple[TuftSpec, ...]
    chains: tuple[tuple[str, float], ...]
    whiskers: tuple[TuftSpec, ...] = ()
    curls: tuple[CurlSpec, ...] = ()
    beard: tuple[CurlSpec, ...] = ()
    hairline: tuple[tuple[float, float], ...] = _HAIRLINE
    nape: float = 0.160
    crown: float = 0.018
    cap_lift: float = 0.002


def read_hair(node: Node) -> HairSpec:
    """The section ``hair``. Raises BadInput with the place."""
    node.only(
        "radii",
        "centre",
        "clumps",
        "tufts",
        "chains",
        "whiskers",
        "curls",
        "beard",
        "hairline",
        "nape",
        "crown",
        "cap_lift",
    )

    def rows(key: str, kind: type) -> tuple:  # type: ignore[type-arg]  # rows of any record
        section = node.get(key)
        return () if section is None else tuple(record(row, kind) for row in section)

    clumps: tuple[ClumpSpec, ...] = rows("clumps", ClumpSpec)
    for row, clump in zip(node.get("clumps") or (), clumps, strict=True):
        if clump.layer not in _LAYERS:
            raise row["layer"].error(expected=" | ".join(_LAYERS))
    optional = {name: number_value(node[name]) for name in ("nape", "crown", "cap_lift") if name in node}
    hairline = value(node["hairline"], tuple[tuple[float, float], ...]) if "hairline" in node else _HAIRLINE
    chains = node.get("chains")
    return HairSpec(
        radii=value(node["radii"], Vector),
        centre=value(node["centre"], Vector),
        clumps=clumps,
        tufts=rows("tufts", TuftSpec),
        chains=() if chains is None else tuple((k.as_str(), v.as_float(-180, 180)) for k, v in chains.items()),
        whiskers=rows("whiskers", TuftSpec),
        curls=rows("curls", CurlSpec),
        beard=rows("beard", CurlSpec),
        hairline=hairline,
        **optional,
    )
