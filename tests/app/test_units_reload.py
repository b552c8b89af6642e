"""Motion units that change while the game runs are taken up; broken ones leave the old ones going, with a message."""

from __future__ import annotations

import argparse
import gc
import shutil
import weakref
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from game.app.opening import open_session
from game.app.session import Session
from game.app.step import step
from game.app.units_reload import Known, UnitsWatch, load_body, watched_units
from game.app.world import Intent
from game.core.errors import BadInput
from game.core.paths import ASSETS
from game.embos.units_file import read_units, units_text

MOTION = ASSETS / "motion"


@pytest.fixture
def shop(tmp_path: Path) -> Path:
    """A folder of one's own: takes, units and clips."""
    (tmp_path / "takes").mkdir()
    for name in ("units.yaml", "clips.npz"):
        shutil.copy(MOTION / name, tmp_path / name)
    return tmp_path


@pytest.fixture(scope="module")
def opened(tmp_path_factory) -> Session:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MCG_USER_FOLDER", str(tmp_path_factory.mktemp("user")))
        return open_session(argparse.Namespace(language="en", stall="flea", seed=5, mode="full", overlay=False))


def _look(watch: UnitsWatch, session: Session) -> None:
    """As many frames as it takes to see a change, read it and take it up."""
    for _ in range(4):
        watch.advance(session, 0.25)
        watch.wait()


def test_new_units_are_taken_up_and_broken_ones_leave_the_old_going(opened: Session, shop: Path) -> None:
    session = opened
    session.open_day()
    session.begin_talk("vase")
    played = weakref.ref(session.assets.planner)
    turned = []
    for _ in range(40):
        session.world = step(session.assets, session.world, Intent())
        turned.append(session.world.body.pose.rotation[0])
    talk, tick = session.world.talk, session.world.tick
    watch = UnitsWatch(watched_units(shop / "takes"))
    _look(watch, session)
    first = session.assets.planner
    assert watch.said.endswith("motion units taken up")
    assert first.library.clips is not None
    gc.collect()
    assert played() is None, "what is played no more is kept nowhere"

    units, transitions = read_units(shop / "units.yaml")
    kept = [u for u in units if u.name != "nod"]
    rows = {a: {b: n for b, n in row.items() if b != "nod"} for a, row in transitions.items() if a != "nod"}
    (shop / "units.yaml").write_text(units_text(kept, rows), encoding="utf-8")
    _look(watch, session)
    second = session.assets.planner
    assert "nod" in first.library.index
    assert "nod" not in second.library.index
    assert session.market.stalls["flea"].assets.planner is second
    assert session.world.talk is talk, "the talk goes on where it stood"
    for _ in range(60):
        session.world = step(session.assets, session.world, Intent())
        turned.append(session.world.body.pose.rotation[0])
    assert session.world.tick == tick + 60
    way = np.array(turned, dtype=np.float64)
    angle = 2.0 * np.arccos(np.minimum(np.abs((way[1:] * way[:-1]).sum(-1)), 1.0))
    assert angle[39].max() < 1.2 * angle[36:39].max(), "the body goes on from where it was, as fast as it was"
    assert session.designed, "such an afternoon is not scored"

    text = (shop / "units.yaml").read_text(encoding="utf-8")
    (shop / "units.yaml").write_text(text[: len(text) // 2], encoding="utf-8")
    _look(watch, session)
    assert watch.broken
    assert "units.yaml" in watch.said
    assert session.assets.planner is second, "the old ones go on"
    (shop / "clips.npz").write_bytes(b"PK")
    (shop / "units.yaml").write_text(text, encoding="utf-8")
    _look(watch, session)
    assert watch.broken
    assert "clips.npz" in watch.said
    shutil.copy(MOTION / "clips.npz", shop / "clips.npz")
    _look(watch, session)
    assert not watch.broken
    assert "nod" not in session.assets.planner.library.index


def test_what_did_not_change_is_not_made_anew_and_comes_out_the_same(shop: Path) -> None:
    known = Known()
    units = [
        replace(unit, variants=tuple(v for v in unit.variants if v.take == "neutral"))
        for unit in read_units(shop / "units.yaml")[0]
    ]
    units = [unit for unit in units if unit.variants][::3]
    (shop / "units.yaml").write_text(units_text(units, {}), encoding="utf-8")
    first_planner, first = load_body(shop / "units.yaml", known)
    index = next(i for i, u in enumerate(units) if u.layer == "posture" and u.variants[0].length_s > 2.0)
    shorter = replace(units[index].variants[0], clean_end_s=units[index].variants[0].clean_start_s + 0.8)
    units[index] = replace(units[index], variants=(shorter, *units[index].variants[1:]))
    (shop / "units.yaml").write_text(units_text(units, {}), encoding="utf-8")
    old_units = dict(known.units.units)
    planner, again = load_body(shop / "units.yaml", known)
    assert all(planner.library.clips[n] is clip for n, clip in first_planner.library.clips.items())
    assert sum(known.units.units[key] is old_units.get(key) for key in known.units.units) == len(units) - 1
    _, fresh = load_body(shop / "units.yaml")
    for name, value in vars(fresh.bank).items():
        np.testing.assert_array_equal(getattr(again.bank, name), value, err_msg=name)
    assert not np.array_equal(first.bank.frames, fresh.bank.frames)


def test_what_is_watched_is_a_folder_with_units_or_the_takes_beside_them(shop: Path, tmp_path: Path) -> None:
    assert watched_units(shop) == shop / "units.yaml"
    assert watched_units(shop / "takes") == shop / "units.yaml"
    with pytest.raises(BadInput, match="--watch"):
        watched_units(tmp_path / "nowhere")
