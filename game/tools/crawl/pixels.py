"""What only pixels tell: texts that cannot be read, interface at the picture's edge, a person cut off or covered.

Four pictures of the same moment are compared: as it is, without the letters, without the interface, without the person.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.render import FontSet
from game.tools.crawl.paper import Box, Fault
from game.tools.crawl.probe import Letters

__all__ = ["Photographs", "Seen", "contrast_of", "judge", "whole_box"]

Picture = NDArray[np.uint8]
Mask = NDArray[np.bool_]

INK = 0.6
"""A pixel is a letter's where the letter covers so much of it, of the most it covers anywhere."""
LEGIBLE, LEGIBLE_SMALL = 3.0, 4.5
"""WCAG 2.2, success criterion 1.4.3: contrast of large text and of the rest …"""
LARGE = 18.0
"""… large from this size in design pixels on: what is to be read at leisure."""
UNREADABLE_SHARE = 0.25
"""Of a text's pixels so many may have less contrast: a letter over a dark spot of the scene is still guessed."""
SEEN_SHARE = 0.5
"""So much of a text's ink must be seen."""
DIFFERENT = 24
"""Pixels that differ by more, of 255, differ to the eye."""
EDGE_PX = 2
BLANK = 3.0
"""Standard deviation of grey below which a picture shows nothing."""
PERSON_SHARE = 0.01
COVERED = 0.5
"""A hand is covered when the interface lies on so much of what is seen of it; a head, on a fifth."""
HEAD_COVERED = 0.2


@dataclass(frozen=True, eq=False)
class Photographs:
    """One moment four times, (h, w, 3) each."""

    whole: Picture
    letterless: Picture
    scene: Picture
    empty: Picture


@dataclass(frozen=True, eq=False)
class Seen:
    """Where the person's parts are in the picture: (n, 2) x, y in pixels, of the head and of each hand's joints.

    hands_wanted: whether they have to be in this shot.
    """

    head: NDArray[np.float64]
    hands: dict[str, NDArray[np.float64]]
    hands_wanted: bool


def _light(colour: NDArray[np.floating]) -> NDArray[np.float64]:
    """Relative luminance (WCAG 2.2) of (…, 3) sRGB in 0 to 255."""
    share = np.asarray(colour, np.float64) / 255.0
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return np.asarray(linear @ np.array([0.2126, 0.7152, 0.0722]))


def contrast_of(one: NDArray[np.floating], other: NDArray[np.floating]) -> NDArray[np.float64]:
    """WCAG contrast ratio, 1 to 21, of (…, 3) sRGB colours in 0 to 255."""
    a, b = _light(one), _light(other)
    return np.asarray((np.maximum(a, b) + 0.05) / (np.minimum(a, b) + 0.05))


def judge(
    photographs: Photographs, letters: Sequence[Letters], seen: Seen | None, fonts: FontSet, scale: float
) -> list[Fault]:
    """Everything wrong with a moment. scale: device pixels of a design pixel."""
    found = list(_blank(photographs, scale))
    for written in letters:
        found += _unread(photographs, written, fonts, scale)
    found += _at_the_edge(photographs, scale)
    if seen is not None:
        found += _cut_or_covered(photographs, seen, scale)
    return found


def whole_box(picture: Picture, scale: float) -> Box:
    """All of a picture, in design pixels."""
    return Box(0.0, 0.0, picture.shape[1] / scale, picture.shape[0] / scale)


def _blank(photographs: Photographs, scale: float) -> Iterator[Fault]:
    for name, picture in (("the picture", photographs.whole), ("the scene", photographs.scene)):
        spread = float(picture.astype(np.float64).mean(axis=2).std())
        if spread < BLANK:
            yield Fault("blank", name, f"one colour all over (deviation {spread:.1f})", whole_box(picture, scale))
            return


def _unread(photographs: Photographs, written: Letters, fonts: FontSet, scale: float) -> Iterator[Fault]:
    place = _ink_of(written, fonts, photographs.whole.shape[:2])
    if place is None:
        return
    rows, columns = place
    ground = photographs.letterless[rows, columns].astype(np.float64)
    alpha = written.colour[3]
    colour = np.asarray(written.colour[:3]) * 255.0 * alpha + ground * (1.0 - alpha)
    ratio = float(np.quantile(contrast_of(colour, ground), UNREADABLE_SHARE))
    if written.outline is not None:
        ratio = max(ratio, float(contrast_of(colour.mean(axis=0), np.asarray(written.outline[:3]) * 255.0)))
    box = written.box
    least = LEGIBLE if box.size >= LARGE or written.disabled else LEGIBLE_SMALL
    if ratio < least:
        yield Fault("contrast", box.text, f"contrast {ratio:.2f}, {least:g} is legible", box)
        return
    changed = np.abs(photographs.whole[rows, columns].astype(np.float64) - ground).max(axis=1)
    due = np.abs(colour - ground).max(axis=1)
    share = float((changed > 0.35 * due).mean())
    if share < SEEN_SHARE:
        yield Fault("unseen", box.text, f"{share:.0%} of its ink is seen", box)


def _ink_of(
    written: Letters, fonts: FontSet, shape: tuple[int, ...]
) -> tuple[NDArray[np.intp], NDArray[np.intp]] | None:
    """Rows and columns of the picture that the letters' strokes cover; None where nothing of them is in it."""
    coverage = fonts.draw(written.box.text, written.role, written.size_px).coverage
    if not coverage.any():
        return None
    rows, columns = np.nonzero(coverage >= INK * coverage.max())
    rows, columns = rows + written.top_px, columns + written.left_px
    inside = (rows >= 0) & (rows < shape[0]) & (columns >= 0) & (columns < shape[1])
    if written.shown_px is not None:
        inside &= columns < written.left_px + written.shown_px
    return (rows[inside], columns[inside]) if inside.any() else None


def _differ(one: Picture, other: Picture) -> Mask:
    return np.asarray(np.abs(one.astype(np.int16) - other).max(axis=2) > DIFFERENT)


def _at_the_edge(photographs: Photographs, scale: float) -> Iterator[Fault]:
    interface = _differ(photographs.whole, photographs.scene)
    height, width = interface.shape
    sides = {
        "left": interface[:, :EDGE_PX], "right": interface[:, width - EDGE_PX :],
        "top": interface[:EDGE_PX], "bottom": interface[height - EDGE_PX :],
    }  # fmt: skip
    if all(side.mean() > 0.5 for side in sides.values()):
        return  # a shade over everything
    for name, side in sides.items():
        if not side.any():
            continue
        along = np.flatnonzero(side.any(axis=1 if name in {"left", "right"} else 0))
        low, high = float(along[0]) / scale, float(along[-1] + 1) / scale
        wide, high_px = width / scale, height / scale
        box = {
            "left": Box(0.0, low, 24.0, high - low), "right": Box(wide - 24.0, low, 24.0, high - low),
            "top": Box(low, 0.0, high - low, 24.0), "bottom": Box(low, high_px - 24.0, high - low, 24.0),
        }[name]  # fmt: skip
        yield Fault("edge", "the interface", f"reaches the {name} edge over {high - low:.0f} px", box)


def _cut_or_covered(photographs: Photographs, seen: Seen, scale: float) -> Iterator[Fault]:
    person = _differ(photographs.scene, photographs.empty)
    whole = whole_box(photographs.whole, scale)
    if person.mean() < PERSON_SHARE:
        yield Fault("person", "nobody", f"{person.mean():.1%} of the picture is the person", whole)
        return
    top = np.flatnonzero(person[:EDGE_PX].any(axis=0))
    if len(top) > EDGE_PX:
        wide = float(top[-1] - top[0] + 1) / scale
        yield Fault("head", "the head", "cut by the top edge", Box(float(top[0]) / scale, 0.0, wide, 24.0))
    interface = _differ(photographs.whole, photographs.scene)
    yield from _covered("head", "the head", seen.head, person, interface, HEAD_COVERED, scale)
    for side, points in seen.hands.items():
        if not seen.hands_wanted:
            continue
        out = _outside(points, person.shape)
        if out.any():
            cut = f"{int(out.sum())} of {len(points)} joints beyond the edge"
            yield Fault("hands", f"the {side} hand", cut, _around(points, scale))
        yield from _covered("hands", f"the {side} hand", points, person, interface, COVERED, scale)


def _covered(
    kind: str, name: str, points: NDArray[np.float64], person: Mask, interface: Mask, most: float, scale: float
) -> Iterator[Fault]:
    inside = points[~_outside(points, person.shape)].astype(np.intp)
    if not len(inside):
        return
    columns, rows = inside.T
    visible = person[rows, columns]
    if not visible.any():
        return  # behind the goods: the stall's own picture
    share = float(interface[rows, columns][visible].mean())
    if share > most:
        yield Fault(kind, name, f"{share:.0%} of it under the interface", _around(points, scale))


def _outside(points: NDArray[np.float64], shape: tuple[int, ...]) -> Mask:
    x, y = points.T
    return np.asarray((x < 0) | (y < 0) | (x >= shape[1]) | (y >= shape[0]))


def _around(points: NDArray[np.float64], scale: float) -> Box:
    (left, top), (right, bottom) = points.min(axis=0) / scale, points.max(axis=0) / scale
    return Box(float(left) - 8, float(top) - 8, float(right - left) + 16, float(bottom - top) + 16)
