"""The authored numbers of a head of hair: scalp, locks, curls, stray hairs and whiskers."""

from __future__ import annotations

from dataclasses import dataclass

from game.formats import Node
from game.tools.modelling.records import Vector, number_value, record, value

__all__ = ["BeardSpec", "ClumpSpec", "CurlSpec", "HairSpec", "TuftSpec", "read_hair"]

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
    """A row of curly locks: ``count`` roots from one azimuth and polar angle to the other.

    length, width: of a lock, metres. lift: of its middle above the scalp. lean_deg: where it grows: 0 straight down,
    90 to his left. turns: of the hook at its end; hand: which way (1, -1; 0: now this, now that); roll_deg: 0 where it
    lies on the scalp, 90 where it stands out from it. join: how softly it grows out of the others, in widths. uneven:
    share by which sizes, places and directions differ from lock to lock.
    """

    azimuth_deg: tuple[float, float]
    polar_deg: tuple[float, float]
    count: int
    length: float
    width: float
    lift: float
    lean_deg: float = 0.0
    turns: float = 0.6
    roll_deg: float = 20.0
    hand: float = 0.0
    join: float = 0.25
    uneven: float = 0.2


@dataclass(frozen=True)
class BeardSpec:
    """A beard on the skin.

    line, under: rows (azimuth, polar) of its upper and lower edge by direction from the head's centre (polar 90 is
    level, 180 down), symmetric; it ends where they meet. thickness: over the skin. lips: half width, middle height and
    half height of what stays bare around the mouth, from the head's centre. curls: its locks.
    """

    line: tuple[tuple[float, float], ...]
    under: tuple[tuple[float, float], ...]
    thickness: float
    lips: Vector
    curls: tuple[CurlSpec, ...]


@dataclass(frozen=True)
class HairSpec:
    """radii, centre: the scalp. hairline: rows (azimuth, height) of the cap's lower edge, symmetric. nape: radius of
    the hair behind the ears (0 = shaved), crown: how much the cap rises between the locks of the crown, whiskers:
    tufts that do not swing, curls: locks that grow out of the cap, chains: spring bones by azimuth."""

    radii: Vector
    centre: Vector
    clumps: tuple[ClumpSpec, ...]
    tufts: tuple[TuftSpec, ...]
    chains: tuple[tuple[str, float], ...]
    whiskers: tuple[TuftSpec, ...] = ()
    curls: tuple[CurlSpec, ...] = ()
    beard: BeardSpec | None = None
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
        beard=record(node["beard"], BeardSpec) if "beard" in node else None,
        hairline=hairline,
        **optional,
    )
