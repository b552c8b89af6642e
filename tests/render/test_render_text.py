from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from game.render import Device, FontSet, Hud, MissingFont, rgba
from game.render.atlas import LineAtlas
from game.render.text import japanese_font

ENGLISH = "The quick brown fox jumps over the lazy dog. 0123456789 – “Hm…?” ×½ é ü"
JAPANESE = "いらっしゃいませ！この猫は四十コインです。値段は高いね、骨董品、ゔゐ々〜「」"


@pytest.fixture(scope="module")
def english() -> FontSet:
    return FontSet.for_language("en")


@pytest.fixture(scope="module")
def japanese() -> FontSet:
    if japanese_font() is None:
        pytest.skip("no Japanese font on this machine")
    return FontSet.for_language("ja")


def test_no_glyph_of_english_is_missing(english: FontSet) -> None:
    for role in ("body", "bold", "title"):
        assert english.missing(ENGLISH, role) == ""


def test_no_glyph_of_japanese_is_missing(japanese: FontSet) -> None:
    for role in ("body", "bold", "title"):
        assert japanese.missing(JAPANESE + ENGLISH, role) == ""


def test_a_missing_glyph_is_reported(english: FontSet) -> None:
    assert english.missing("a\u0378b") == "\u0378"


def test_a_line_is_as_wide_as_measured(english: FontSet) -> None:
    line = english.draw("Forty coins", "body", 32)
    assert abs(line.coverage.shape[1] - english.width("Forty coins", "body", 32)) <= 2
    assert line.coverage.max() == 255
    assert line.ascent == english.ascent("body", 32)


def test_larger_sizes_are_drawn_larger_not_scaled(english: FontSet) -> None:
    small, large = english.draw("Forty", "body", 20).coverage, english.draw("Forty", "body", 40).coverage
    assert large.shape[1] == pytest.approx(2 * small.shape[1], rel=0.1)
    # Crisp: the share of half-covered pixels falls with the size.
    assert ((large > 30) & (large < 220)).mean() < ((small > 30) & (small < 220)).mean()


def test_english_wraps_between_words(english: FontSet) -> None:
    rows = english.wrap("one two three four five six seven", "body", 24, 140)
    assert " ".join(rows) == "one two three four five six seven"
    assert len(rows) > 1
    assert all(english.width(row, "body", 24) <= 140 for row in rows)


def test_japanese_wraps_anywhere_but_before_closing_marks(japanese: FontSet) -> None:
    rows = japanese.wrap("ああああ。いいいい、うううう。", "body", 24, 24 * 4 + 6)
    assert "".join(rows) == "ああああ。いいいい、うううう。"
    assert all(row[0] not in "。、" for row in rows)


def test_japanese_breaks_where_a_phrase_ends_if_that_costs_no_line(japanese: FontSet) -> None:
    clause = "男の子が一時間も独楽を回してさ、"
    rows = japanese.wrap(clause + "どんぐりで払ってった。いいどんぐりだよ!", "body", 24, 24 * 23)
    assert rows[0] == clause
    rows = japanese.wrap("そのセーター、通りじゅうが明るくなりますね。", "body", 18, 300)
    assert rows == ["そのセーター、通りじゅうが", "明るくなりますね。"]
    solid = "ア" * 19
    assert [len(row) for row in japanese.wrap(solid, "body", 24, 24 * 10 + 6)] == [10, 9], (
        "nothing to go by: full lines"
    )


def test_wrapping_keeps_line_breaks(english: FontSet) -> None:
    assert english.wrap("a\n\nb", "body", 24, 500) == ["a", "", "b"]


def test_no_japanese_font_is_one_line_with_advice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("game.render.text.japanese_font", lambda: None)
    with pytest.raises(MissingFont, match="pip install matplotlib-fontja") as caught:
        FontSet.for_language("ja")
    assert "\n" not in str(caught.value)
    FontSet.for_language("en")


def test_system_fonts_are_found_by_name(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    wanted = tmp_path / "deep" / "IPAexG.ttf"
    for name in ("other.ttf", "deep/IPAexG.ttf", "deep/readme.txt"):
        (tmp_path / name).touch()
    assert japanese_font([tmp_path]) == wanted


@pytest.mark.gl
def test_the_atlas_keeps_lines_and_says_when_it_is_full(device: Device, english: FontSet) -> None:
    atlas = LineAtlas(device, english, size=128)
    first = atlas.find("coins", "body", 30)
    assert first is not None
    assert atlas.find("coins", "body", 30) is first
    row = np.frombuffer(atlas.texture.read(), np.uint8).reshape(128, 128)
    assert np.array_equal(
        row[first.y : first.y + first.height, first.x : first.x + first.width],
        english.draw("coins", "body", 30).coverage,
    )
    for i in range(20):
        if atlas.find(f"line {i}", "body", 30) is None:
            break
    else:
        pytest.fail("twenty lines cannot fit")
    atlas.clear()
    assert atlas.find("line 0", "body", 30) is not None
    atlas.release()


@pytest.mark.gl
def test_shapes_and_text_land_where_they_should(device: Device, english: FontSet) -> None:
    hud = Hud(device, english)
    context = device.context
    texture = context.texture((640, 360), 4)
    target = context.framebuffer([texture])
    target.use()
    target.clear()
    hud.begin((640, 360))
    assert hud.width == pytest.approx(1280)
    hud.rect(100, 100, 200, 100, fill=rgba("#ff0000"), radius=20, border=4, edge=rgba("#0000ff"))
    hud.circle(600, 150, 50, fill=rgba("#00ff00", 0.5))
    hud.line(800, 100, 1000, 200, rgba("#ffffff"), 6)
    hud.text("MMMM", 640, 400, size=48, colour=rgba("#ffffff"), align=0.5)
    hud.end()
    assert hud.draw_calls == 2
    picture = np.frombuffer(target.read(components=4), np.uint8).reshape(360, 640, 4)[::-1]
    assert tuple(picture[75, 100]) == (255, 0, 0, 255)  # inside the box
    assert tuple(picture[75, 51]) == (0, 0, 255, 255)  # its border
    assert picture[51, 51, 3] < 40  # its round corner
    assert picture[75, 300, 1] == pytest.approx(128, abs=2)  # half green, premultiplied
    assert picture[75, 450, 3] == 255  # the line's middle
    ink = picture[200:232, :, 3].sum(axis=0)
    columns = np.flatnonzero(ink)
    assert (columns[0] + columns[-1]) / 2 == pytest.approx(320, abs=3)  # text centred
    for item in (hud, target, texture):
        item.release()


@pytest.mark.gl
def test_a_full_atlas_starts_over_within_a_frame(device: Device, english: FontSet) -> None:
    hud = Hud(device, english)
    hud._atlas.release()
    hud._atlas = hud.own(LineAtlas(device, english, size=256))
    texture = device.context.texture((640, 360), 4)
    target = device.context.framebuffer([texture])
    target.use()
    target.clear()
    hud.begin((640, 360))
    for i in range(40):
        hud.text(f"number {i}", 20, 10 + 17 * i, size=30)
    hud.end()
    assert hud.draw_calls > 1
    picture = np.frombuffer(target.read(components=4), np.uint8).reshape(360, 640, 4)[::-1, :, 3]
    assert all(picture[5 + int(8.5 * i) : 5 + int(8.5 * i) + 16].max() > 200 for i in range(40))
    for item in (hud, target, texture):
        item.release()
