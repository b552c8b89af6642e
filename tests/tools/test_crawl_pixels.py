"""The crawler that draws: what only pixels tell is found where it was put, and nowhere else."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from game.app.loading import load_step_assets
from game.app.shots import SHOTS
from game.app.ui import PALETTE, hex_colour
from game.render import FontSet, level_named
from game.tools.crawl import (
    ContactSheet,
    Darkroom,
    Letters,
    Look,
    Moment,
    Photographs,
    Seen,
    judge,
    moments_of,
    write_page,
)
from game.tools.crawl.paper import Box
from game.tools.crawl.pixels import contrast_of

PAPER, INK = (250, 244, 230), (59, 26, 28)


@pytest.fixture(scope="module")
def fonts() -> FontSet:
    return FontSet.for_language("en")


def written(text: str, x: int, y: int, colour: tuple[int, int, int], fonts: FontSet) -> Letters:
    share = (*(value / 255.0 for value in colour), 1.0)
    box = Box(x, y, fonts.width(text, "body", 20), fonts.height("body", 20), text, 20.0)
    return Letters(box, "body", 20, share, x, y)  # type: ignore[arg-type]


def drawn(ground: NDArray[np.uint8], letters: Letters, fonts: FontSet) -> NDArray[np.uint8]:
    """The ground with letters on it."""
    cover = fonts.draw(letters.box.text, "body", 20).coverage[..., None] / 255.0
    out, (rows, columns) = ground.astype(float), cover.shape[:2]
    spot = out[letters.top_px : letters.top_px + rows, letters.left_px : letters.left_px + columns]
    spot[:] = (
        spot * (1 - cover[: len(spot), : spot.shape[1]])
        + np.array(letters.colour[:3]) * 255 * cover[: len(spot), : spot.shape[1]]
    )
    return out.astype(np.uint8)


def scene() -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """A street, with and without somebody in its middle."""
    empty = np.tile(np.linspace(120, 220, 320).astype(np.uint8)[None, :, None], (180, 1, 3))
    full = empty.copy()
    full[30:150, 130:190] = (40, 60, 150)
    return full, empty


def panelled(full: NDArray[np.uint8], x: int, y: int, w: int, h: int) -> NDArray[np.uint8]:
    out = full.copy()
    out[y : y + h, x : x + w] = PAPER
    return out


def seen(hand: tuple[float, float] = (140.0, 140.0), *, wanted: bool = True) -> Seen:
    around = np.array([(x, y) for x in range(-4, 5, 2) for y in range(-4, 5, 2)], dtype=float)
    return Seen(around + (160, 45), {"left": around + hand, "right": around + (180, 140)}, wanted)


def kinds(found: list[object]) -> list[str]:
    return [fault.kind for fault in found]  # type: ignore[attr-defined]


def test_a_good_picture_has_no_faults(fonts: FontSet) -> None:
    full, empty = scene()
    letterless = panelled(full, 200, 20, 110, 40)
    letters = written("Good day", 206, 26, INK, fonts)
    shots = Photographs(drawn(letterless, letters, fonts), letterless, full, empty)
    assert judge(shots, [letters], seen(), fonts, 1.0) == []


@pytest.mark.parametrize(
    ("colour", "kind"),
    [((240, 230, 215), "contrast"), (PAPER, "contrast"), (INK, "unseen")],
    ids=["pale", "same", "lost"],
)
def test_letters_that_nobody_can_read_are_found(fonts: FontSet, colour: tuple[int, int, int], kind: str) -> None:
    full, empty = scene()
    letterless = panelled(full, 200, 20, 110, 40)
    letters = written("Good day", 206, 26, colour, fonts)
    whole = letterless if kind == "unseen" else drawn(letterless, letters, fonts)
    assert kinds(judge(Photographs(whole, letterless, full, empty), [letters], seen(), fonts, 1.0)) == [kind]


def test_what_is_cut_covered_or_missing_is_found(fonts: FontSet) -> None:
    full, empty = scene()

    def found(whole: NDArray[np.uint8], where: Seen, scene: NDArray[np.uint8] = full) -> list[str]:
        return kinds(judge(Photographs(whole, whole, scene, empty), [], where, fonts, 1.0))

    assert found(panelled(full, 120, 130, 50, 30), seen()) == ["hands"]  # one hand under the words
    assert found(panelled(full, 120, 130, 90, 30), seen(wanted=False)) == []  # a close-up is the face's
    assert found(panelled(full, 140, 30, 40, 25), seen()) == ["head"]
    assert found(full, seen((-3.0, 140.0))) == ["hands"]  # beyond the left edge
    assert found(panelled(full, 290, 20, 30, 40), seen()) == ["edge"]
    assert found(empty, seen(), empty) == ["person"]
    tall = full.copy()
    tall[:40, 140:170] = (40, 60, 150)
    assert found(tall, seen(), tall) == ["head"]  # cut by the picture
    blank = np.full_like(full, 90)
    assert kinds(judge(Photographs(blank, blank, blank, blank), [], None, fonts, 1.0)) == ["blank"]
    shade = (full * 0.4).astype(np.uint8)
    assert found(shade, seen(wanted=False)) == ["head"]  # all over, as a menu is: not at the edge


def test_contrast_is_that_of_the_standard() -> None:
    black, white, grey = (np.array([v, v, v], float) for v in (0, 255, 119))
    assert float(contrast_of(black, white)) == pytest.approx(21.0)
    assert float(contrast_of(grey, white)) == pytest.approx(4.48, abs=0.01)
    assert float(contrast_of(white, white)) == 1.0


# --- drawn -----------------------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Darkroom]:
    """The smallest stall there is, at the flea market."""
    text = (Path(__file__).parents[1] / "story" / "tiny.yaml").read_text(encoding="utf-8")
    for old, new in (("stall: tiny", "stall: flea"), ("cup", "vase"), ("pot", "teapot_gold")):
        text = text.replace(old, new)
    path = tmp_path_factory.mktemp("drawn") / "flea.yaml"
    path.write_text(text, encoding="utf-8")
    made = Darkroom(load_step_assets(str(path)), Look("en", 1.0), (640, 360), level_named("low"))
    yield made
    made.close()


@pytest.fixture(scope="module")
def moments(room: Darkroom) -> dict[str, Moment]:
    return {moment.node: moment for moment in moments_of(room.assets)}


def test_every_node_that_says_something_or_asks_is_met(room: Darkroom, moments: dict[str, Moment]) -> None:
    speaking = {name for name, node in room.assets.talk.script.nodes.items() if any(say.lines for say in node.says)}
    assert speaking <= set(moments)
    assert all(moments[node].met for node in ("hello", "hub", "answer", "tale", "gone"))
    assert moments["hub"].asks
    assert not moments["gone"].asks


@pytest.mark.gl
def test_a_good_stall_has_no_faults_and_the_same_pictures_again(room: Darkroom, moments: dict[str, Moment]) -> None:
    first = list(room.node(moments["hello"]))
    assert [taken.kind for taken in first] == ["says", "asks"]
    assert [fault for taken in first for fault in taken.faults] == []
    assert first[0].words == "Hello!"
    list(room.node(moments["tale"]))
    again = list(room.node(moments["hello"]))
    assert all(np.array_equal(a.picture, b.picture) for a, b in zip(first, again, strict=True))


@pytest.mark.gl
def test_a_faulty_interface_and_a_word_too_long_are_found(
    room: Darkroom, moments: dict[str, Moment], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    moment = moments["hub"]
    word = "Donaudampfschifffahrtsgesellschaftskapitaensmuetzenfabrik"
    beat = moment.talk.beat
    choices = tuple(replace(choice, en=word) if i == 0 else choice for i, choice in enumerate(beat.choices))
    longer = replace(moment, lines=(), talk=replace(moment.talk, beat=beat._replace(choices=choices)))
    monkeypatch.setitem(PALETTE, "faint", hex_colour("E8DCC8"))
    monkeypatch.setitem(SHOTS, "talk", replace(SHOTS["talk"], fov_deg=9.0))
    (taken,) = room.node(longer)
    found = {fault.kind for fault in taken.faults}
    assert found >= {"contrast", "edge", "hands"}
    pale = [fault.text for fault in taken.faults if fault.kind == "contrast"]
    assert any(text.startswith("Purse") for text in pale)
    assert beat.choices[1].en not in pale
    sheet = ContactSheet()
    sheet.add(taken)
    write_page(tmp_path / "crawl.html", "flea", [], [], 0, sheet)
    page = (tmp_path / "crawl.html").read_text(encoding="utf-8")
    assert page.count("<img") == 1
    assert page.count("<rect") == len(taken.faults)
    assert "data:image/jpeg;base64,/9j/" in page
