"""The game in a window.

examples:
  run_game.py
  run_game.py play --avatar somebody.vrm
  run_game.py play --language ja --seed 7
  run_game.py play --mode gestures --size 1600x900
  run_game.py play --watch my_shop                  bodies by my_shop/units.yaml, taken up anew whenever it changes
  run_game.py play --stall flea --at deal_fair --item vase
  run_game.py play --record talk.jsonl               for run_game.py replay talk.jsonl

keys in a talk: 1-4 say a line, O put an offer with it, left/right the amount (shift: larger steps), P the asking
price, B only the offer, W wait, G go; space or a click goes on; F1 feelings, F2 active nodes, F3 networks, F8 frame
times, F9 photo mode, F11 full screen, Esc back. F4 opens the designer's inspector: sliders, variables, back to the
last choice. A dialogue file that is edited while it is played is read anew; the talk goes on where it stood.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np
import pygame

from game.app.arguments import parse_size
from game.app.designer import warp_session
from game.app.display_loss import watch_display
from game.app.input import action_of
from game.app.opening import open_session
from game.app.pad import Pads
from game.app.recording import LAST_SESSION, Recorder, record_session
from game.app.screens import TalkScreen
from game.app.session import Screen, Session
from game.app.settings import Settings, user_folder
from game.app.units_reload import UnitsWatch, watched_units
from game.app.window import Window
from game.app.world import World
from game.core.errors import BadInput, MissingPart
from game.render import Device, Level, LostContext, level_named, pick_level

__all__ = ["Window", "add_arguments", "need_display", "open_session", "play_until_closed", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``play``."""
    from game.app.arguments import add_avatar

    add_avatar(parser)
    parser.add_argument("--seed", type=int, default=None, help="seed of the afternoon (default: from the clock)")
    parser.add_argument("--language", choices=["en", "ja"], help="language (kept in the settings otherwise)")
    parser.add_argument("--stall", help="only this stall: its name or a dialogue file (default: the whole market)")
    parser.add_argument("--size", type=parse_size, default=(1280, 720), metavar="WxH", help="window size")
    parser.add_argument("--mode", choices=["full", "gestures", "body", "face"], default="full", help="what is acted")
    parser.add_argument("--at", metavar="NODE", help="start in a talk at this node (designer mode; with --stall)")
    parser.add_argument("--item", help="with --at: the thing talked about (default: the first)")
    parser.add_argument("--watch", type=Path, metavar="DIR", help="motion units of this folder, again as they change")
    parser.add_argument("--overlay", action="store_true", help="start with feelings and active nodes shown")
    parser.add_argument("--record", type=Path, metavar="FILE", help="record the play (the last one is always kept)")


def _choose_level(window: Window, settings: Settings) -> None:
    if settings.quality != "auto":
        window.set_quality(level_named(settings.quality), fixed=True)
        return

    def draw(level: Level) -> None:
        if window.renderer.level is not level:
            window.renderer.set_level(level)
        window.draw()
        window.device.context.finish()

    window.set_quality(pick_level(draw), fixed=False)


def run(args: argparse.Namespace) -> int:
    """Open the window and play until it is closed."""
    from game.app.arguments import avatar_of

    # What is loaded stays: collecting garbage among it would only cost time, now and at every later collection.
    gc.disable()
    try:
        avatar = avatar_of(args)
        need_display()
        session = open_session(args, avatar)
        screen = _warped(session, args)
        units = None if args.watch is None else watched_units(args.watch)
        width, height = args.size
        device = Device.window(width, height, session.strings("title"), fullscreen=session.settings.fullscreen)
    except MissingPart as error:
        pygame.display.quit()
        print(f"error: {error}; all the same without a window: run_game.py autoplay | snapshot", file=sys.stderr)
        return 2
    recorder = _recorder(session, args)
    window = Window(session, device, screen=screen)
    window.inspector.units = None if units is None else UnitsWatch(units)

    def loop() -> None:
        window.draw()
        _set_icon(window)
        pygame.display.flip()
        window.populate()
        gc.freeze()
        gc.enable()
        _choose_level(window, session.settings)
        _loop(window)

    try:
        with watch_display(lambda: _keep(window, recorder)):
            play_until_closed(window, recorder, loop)
    finally:
        with suppress(moderngl.Error, pygame.error):
            window.close()
            device.release()
        pygame.display.quit()
    if args.record is not None and recorder is not None and recorder.trouble:
        raise BadInput(recorder.trouble)
    return 0


def play_until_closed(window: Window, recorder: Recorder | None, loop: Callable[[], None]) -> None:
    """Run the loop; however it ends, the game and its recording are kept. Raises MissingPart where the picture is lost
    (a driver that was reset, a display that went away)."""
    try:
        loop()
    except (moderngl.Error, pygame.error, LostContext) as error:
        raise MissingPart(f"the picture was lost ({error}); the game was saved, start it again to go on") from None
    finally:
        _keep(window, recorder)


def _keep(window: Window, recorder: Recorder | None) -> None:
    window.keep()
    if recorder is not None:
        recorder.close(window.session)


def _recorder(session: Session, args: argparse.Namespace) -> Recorder | None:
    """Every play is recorded, the last one kept; without ``--record`` a folder that cannot be written is no matter."""
    designed = [name for name in ("at", "watch") if getattr(args, name) is not None]
    if designed:
        if args.record is not None:
            expected = "a play without --at and --watch: what a designer does is not replayed"
            raise BadInput("--record", expected=expected, seen=f"--{designed[0]}")
        return None
    try:
        return record_session(session, args.record or user_folder() / LAST_SESSION, stall=args.stall)
    except BadInput:
        if args.record is not None:
            raise
        return None


def _warped(session: Session, args: argparse.Namespace) -> Screen | None:
    """The talk that ``--at`` asks for; None where nothing is asked. Raises BadInput for unknown nodes and items."""
    if args.at is None:
        if args.item is not None:
            raise BadInput("--item", expected="--at NODE with it", seen="none")
        return None
    warp_session(session, args.at, args.item)
    return TalkScreen()


def need_display() -> None:
    """Start SDL's video. Raises MissingPart where there is no screen (SDL would quietly draw into nothing)."""
    nowhere = MissingPart("no display (no X11 or Wayland session found); start a desktop session, or xvfb-run")
    # Windows would otherwise blow up a small picture on a dense screen.
    os.environ.setdefault("SDL_WINDOWS_DPI_AWARENESS", "permonitorv2")
    asked = os.environ.get("SDL_VIDEODRIVER")
    if sys.platform.startswith("linux") and not asked and not {"DISPLAY", "WAYLAND_DISPLAY"} & set(os.environ):
        raise nowhere
    try:
        pygame.display.init()
    except pygame.error as error:
        raise MissingPart(f"no display ({error}); start a desktop session, or xvfb-run") from None
    driver = pygame.display.get_driver()
    if driver in {"offscreen", "dummy"} and asked != driver:
        raise nowhere


def _set_icon(window: Window) -> None:
    """The shopkeeper's head of the first picture is the window's icon."""
    pixels = window.renderer.read_pixels()
    side = pixels.shape[0] // 2
    top, left = pixels.shape[0] // 14, (pixels.shape[1] - side) // 2
    head = np.ascontiguousarray(pixels[top : top + side, left : left + side])
    picture = pygame.image.frombuffer(head.tobytes(), (side, side), "RGB")
    pygame.display.set_icon(pygame.transform.smoothscale(picture, (64, 64)))


def _loop(window: Window) -> None:
    session = window.session
    fullscreen, quality = session.settings.fullscreen, session.settings.quality
    pads = Pads()
    pads.start()
    before = time.perf_counter()
    while session.running:
        for event in pygame.event.get():
            action = action_of(event, _pixel_ratio(window), session.settings.keys) or pads.action_of(event)
            if action is not None and action.kind == "resize":
                window.device.resize(*pygame.display.get_window_size())
            elif action is not None:
                window.handle(action)
        if session.settings.fullscreen != fullscreen:
            fullscreen = session.settings.fullscreen
            pygame.display.toggle_fullscreen()
            window.device.resize(*pygame.display.get_window_size())
        if session.settings.quality != quality:
            quality = session.settings.quality
            _choose_level(window, session.settings)
        session.world = replace_speed(session.world, session.settings.text_speed)
        now = time.perf_counter()
        window.advance(now - before)
        window.note_frame((now - before) * 1e3)
        before = now
        window.draw()
        pygame.display.flip()


def replace_speed(world: World, text_speed: str) -> World:
    """The world with another speed of text, the same one where nothing changed."""
    return world if world.text_speed == text_speed else replace(world, text_speed=text_speed)


def _pixel_ratio(window: Window) -> float:
    """Device pixels per window pixel: mouse positions come in window pixels on high-DPI screens."""
    width = pygame.display.get_window_size()[0]
    return window.device.size[0] / max(width, 1)
