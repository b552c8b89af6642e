"""Film strips that must look as they did: a talk as the player sees it, a body in a feeling; and how that is told."""

from __future__ import annotations

import argparse
import functools
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from game.app.cli import main
from game.app.loading import load_step_assets
from game.app.opening import open_session
from game.app.performance import fixed_world
from game.app.screens import TalkScreen
from game.app.stage import StageShow
from game.app.step import step
from game.app.studio import CAMERAS
from game.app.talk import Choice
from game.app.window import Window
from game.app.world import TICK_S, Intent
from game.core.emotion_space import EMOTIONS
from game.render import Device, level_named, load_picture, save_png
from game.tools.compare import Limits, compare_frames, flip, write_comparison

pytestmark = pytest.mark.gl
TALK, CELL = Path(__file__).resolve().parents[1] / "story" / "tiny.yaml", (480, 270)
GOLDENS = Path(__file__).resolve().parents[1] / "goldens" / "render"
assets_once = functools.cache(load_step_assets)


@pytest.fixture(scope="module")
def window(device: Device, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Window]:
    """The game with a talk of its own about the shipped stall's things, whose words nobody edits."""
    before = device.size
    device.resize(*CELL)
    folder = tmp_path_factory.mktemp("strip")
    script, text = folder / "flea.yaml", TALK.read_text(encoding="utf-8")
    for old, new in (("stall: tiny", "stall: flea"), ("cup", "vase"), ("pot", "teapot_gold")):
        text = text.replace(old, new)
    script.write_text(text, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MCG_USER_FOLDER", str(folder / "user"))
        patch.setattr("game.app.opening.load_step_assets", assets_once)
        told = argparse.Namespace(language="en", stall=str(script), seed=5, mode="full", overlay=False)
        made = Window(open_session(told), device, level=level_named("default"))
        made.session.taken_up = True
        yield made
        made.close()
    device.resize(*before)


def test_a_talk_looks_like_its_strip(window: Window, golden_strip) -> None:
    """The greeting, the choices, the player's line, the answer."""
    session = window.session
    session.open_day()
    session.begin_talk("vase")
    window.screen = TalkScreen()
    frames = []
    said = Intent(proceed=True)
    for moves in ((), (said,) * 4, (Intent(choice=Choice("praise_it")),), (said, said)):
        for move in moves:
            session.tick(move)
        for _ in range(24):
            window.advance(TICK_S)
        window.draw()
        frames.append(window.renderer.read_pixels())
    golden_strip(frames, "strip_talk", 2)


def test_an_angry_body_looks_like_its_strip(window: Window, golden_strip) -> None:
    assets, show = window.session.assets, StageShow(window.stage)
    felt = np.zeros(7)
    felt[EMOTIONS.index("anger")] = 0.9
    world, frames = fixed_world(assets, felt, 3), []
    for tick in range(1, 151):
        world = step(assets, world, Intent())
        assert world.body.pose is not None
        assert world.body.face_params is not None
        show.tick(world.body.pose, TICK_S, world.body)
        if tick % 25 == 0:
            view = show.frame(world.body.face_params, camera=CAMERAS["body"], time_s=world.time_s)
            frames.append(window.renderer.snapshot(view, (200, 220)))
    golden_strip(frames, "strip_anger", 3)


# --- how that is told ----------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def hero() -> np.ndarray:
    return load_picture(GOLDENS / "hero.png")


def test_what_an_eye_does_not_see_passes_and_a_lost_detail_does_not(hero: np.ndarray) -> None:
    rng = np.random.default_rng(1)
    noisy = np.clip(hero.astype(int) + rng.integers(-1, 2, hero.shape), 0, 255).astype(np.uint8)
    eye = hero.copy()
    rows, columns = slice(120, 138), slice(288, 306)
    eye[rows, columns] = hero[rows, columns].mean(axis=(0, 1))  # an eye rubbed out
    warm = np.clip(hero * np.array([1.0, 0.9, 0.8]), 0, 255).astype(np.uint8)
    told = compare_frames([("same", hero, hero), ("noise", hero, noisy), ("eye", hero, eye), ("colour", hero, warm)])
    assert [frame.same for frame in told] == [True, True, False, False]
    assert told[0].mean == 0.0
    assert told[2].mean < Limits().mean < told[3].mean, "a lost eye only its tile tells"
    assert told[2].difference[rows, columns].mean() > 10 * told[2].mean


def test_the_difference_is_that_of_its_inventors() -> None:
    """Means of their flip-evaluator 1.7 for the same pictures at 67.02 pixels a degree."""
    y, x = np.mgrid[0:180, 0:320]
    discs = np.stack([(x * 0.8) % 256, 255 - y, ((x - 160) ** 2 + (y - 90) ** 2 < 3600) * 200], axis=-1)
    plain = discs.astype(np.uint8)
    noisy = np.clip(discs + np.random.default_rng(0).integers(-6, 7, discs.shape), 0, 255).astype(np.uint8)
    for other, theirs in ((noisy, 0.053346), (np.roll(plain, 2, axis=1), 0.059307)):
        assert flip(plain, other).mean() == pytest.approx(theirs, abs=1e-4)
    black, white = np.zeros((8, 8, 3), np.uint8), np.full((8, 8, 3), 255, np.uint8)
    assert flip(black, white).min() > 0.95


def test_pages_show_what_differs_first_and_need_nothing_else(hero: np.ndarray, tmp_path: Path) -> None:
    small = hero[::4, ::4]
    frames = compare_frames([("calm", small, small), ("a <b>", small, 255 - small)])
    write_comparison(tmp_path / "page.html", "strip", frames, Limits())
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 6
    assert page.index("a &lt;b&gt;") < page.index("calm")
    assert "http" not in page


def test_compare_judges_strips_folders_and_refuses_what_does_not_fit(
    hero: np.ndarray, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    small, other = hero[:128, :256], hero[:128, :256].copy()
    other[:, 128:] = 255 - other[:, 128:]
    for folder, pixels in (("a", small), ("b", other)):
        (tmp_path / folder).mkdir()
        save_png(tmp_path / folder / "x.png", pixels)
    a, b = tmp_path / "a", tmp_path / "b"
    assert main(["compare", str(a), str(a)]) == 0
    words = ["compare", str(a / "x.png"), str(b / "x.png"), "--cell", "128x128", "--json"]
    capsys.readouterr()
    assert main([*words, "--out", str(tmp_path / "page.html")]) == 1
    told = json.loads(capsys.readouterr().out)
    assert [frame["same"] for frame in told["frames"]] == [True, False]
    assert (tmp_path / "page.html").is_file()
    save_png(b / "y.png", small)
    for bad in ([*words[:4], "100x128"], ["compare", str(a), str(b)], ["compare", str(a / "x.png"), str(a / "n.png")]):
        assert main(bad) == 2
        assert capsys.readouterr().err.count("\n") == 1
