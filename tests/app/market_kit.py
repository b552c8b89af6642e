"""A market of three stalls made of the shipped one under other names: for tests that must not wait for more."""

from __future__ import annotations

import argparse
import shutil
from dataclasses import replace
from pathlib import Path

from game.app.content import load_talk_assets
from game.app.market import Market, Stall
from game.app.opening import open_session, take_up
from game.app.session import Session
from game.app.stage import load_stage
from game.core.paths import DIALOGUE

NAMES = ("flea", "antiques", "toys")
TITLES = {"antiques": "Aoyagi & Sons", "toys": "The Bright Side"}


def copies(folder: Path) -> dict[str, Path]:
    """The shipped stall's dialogue as three files with three stall ids, rules and people beside them."""
    shutil.copytree(DIALOGUE, folder, dirs_exist_ok=True)
    text = (DIALOGUE / "flea.yaml").read_text(encoding="utf-8")
    out = {}
    for name in NAMES:
        changed = text.replace("stall: flea", f"stall: {name}", 1).replace(
            "Seven Cups,", f"{TITLES.get(name, 'Seven Cups')},", 1
        )
        out[name] = folder / f"{name}.yaml"
        out[name].write_text(changed, encoding="utf-8")
    return out


def three_stalls(folder: Path, *, seed: int = 5, language: str = "en", look: bool = True) -> Session:
    """A session whose market has three open stalls, all loaded."""
    args = argparse.Namespace(language=language, stall="flea", seed=seed, mode="full", overlay=False)
    session = open_session(args)
    scripts = folder / "dialogue"
    scripts.mkdir(exist_ok=True)
    stage = load_stage() if look else None
    market = Market(session.market.bazaar, expected=NAMES)
    for name, path in copies(scripts).items():
        market.stalls[name] = Stall(name, replace(session.assets, talk=load_talk_assets(path)), stage)
    session.market, session.assets = market, market.stalls["flea"].assets
    take_up(session)
    return session
