"""Before the first picture: settings, the first stall, the other stalls behind it, and the game that was saved last."""

from __future__ import annotations

import argparse
import os
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from game.app.afternoon import Afternoon
from game.app.bazaar import load_bazaar
from game.app.loading import load_step_assets
from game.app.market import Market, Stall, StallLoader, stall_of
from game.app.reading import load_read
from game.app.save_reader import read_json
from game.app.saves import read_game
from game.app.session import Session
from game.app.settings import load_settings, user_folder
from game.app.step import new_world
from game.app.strings import load_strings
from game.app.world import leave_talk
from game.core.compiled import compile_ahead
from game.core.errors import BadInput
from game.core.paths import ROOT

if TYPE_CHECKING:
    from game.app.avatar import Avatar

__all__ = ["open_session", "resume_game", "take_up"]

AUTOSAVE = "autosave.json"


def open_session(args: argparse.Namespace, avatar: Avatar | None = None) -> Session:
    """Settings, assets and world; the saved game is taken up once every stall's dialogue has been read.

    ``args.stall`` None opens the whole market; a name or a dialogue file opens that stall alone. avatar: who stands
    in for every shopkeeper.
    """
    # While files are read: all that moves is compiled.
    compile_ahead(sorted((ROOT / "game").glob("*/*.wasm")))
    settings, message = load_settings()
    if args.language:
        settings = replace(settings, language=args.language)
    bazaar = load_bazaar()
    first = args.stall or bazaar.stalls[0]
    assets = load_step_assets(first)
    # A designer's own stall may be played before there are pictures of it.
    stall = Stall("", assets) if args.stall is None else stall_of(assets.talk, assets, stand_in=True)
    stall.id = assets.talk.script.stall
    others = () if args.stall else bazaar.stalls[1:]
    market = Market(bazaar, {stall.id: stall}, expected=(stall.id, *others), avatar=avatar)
    seed = args.seed if args.seed is not None else int(time.time()) & 0x7FFFFFFF
    world = leave_talk(
        replace(new_world(assets, seed, language=settings.language, text_speed=settings.text_speed), mode=args.mode)
    )
    strings = load_strings(settings.language)
    session = Session(assets, world, strings, settings, Afternoon(seed=seed), market)
    if message:
        session.say(strings("settings_kept", reason=message))
    session.read = load_read(user_folder())
    if args.overlay:
        session.overlays |= {"feelings", "units"}
    if others:
        session.loader = StallLoader(market, others, assets)
    else:
        take_up(session)
    return session


def take_up(session: Session) -> None:
    """Continue the game saved last, if any. A save that cannot be read is kept beside, never overwritten unseen."""
    session.taken_up = True
    path = user_folder() / AUTOSAVE
    if not path.exists():
        return
    try:
        resume_game(session, path)
    except BadInput as error:
        aside = path.with_suffix(".unreadable.json")
        try:
            os.replace(path, aside)
        except OSError:
            aside = path
        session.say(session.strings("save_kept", reason=str(error)[:120]))


def resume_game(session: Session, path: Path) -> None:
    """Take a saved game up. Raises BadInput where it cannot be read; nothing has changed then."""
    root = read_json(path)
    session.take_up(read_game(root, session.market.bazaar, session.market.talks()), root.data)
