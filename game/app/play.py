"""The game in a window.

examples:
  run_game.py
  run_game.py play --language ja --seed 7
  run_game.py play --mode gestures --size 1600x900

keys in a talk: 1-4 say a line, O put an offer with it, left/right the amount (shift: larger steps), P the asking
price, B only the offer, W wait, G go; space or a click goes on; F1 feelings, F2 active nodes, F3 networks, F11 full
screen, Esc back.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pygame

from game.app.afternoon import Afternoon
from game.app.arguments import parse_size
from game.app.director import direct, moment_of, start_direction
from game.app.input import Action, action_of
from game.app.loading import load_step_assets
from game.app.saves import load_game, save_game
from game.app.screens import TalkScreen, TitleScreen
from game.app.session import Screen, Session
from game.app.settings import Settings, load_settings, user_folder
from game.app.stage import StageShow, load_stage
from game.app.step import new_world, step
from game.app.strings import load_strings
from game.app.ui import Canvas
from game.app.world import TICK_S, World, leave_talk
from game.core.errors import BadInput, MissingPart
from game.render import DEFAULT, Device, FontSet, Hud, Level, MissingFont, Renderer, level_named, pick_level

__all__ = ["Window", "add_arguments", "need_display", "run"]

MAX_TICKS_A_FRAME = 5
"""After a stall (a dragged window) the simulation catches up by at most this much, then lets time go."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``play``."""
    parser.add_argument("--seed", type=int, default=None, help="seed of the afternoon (default: from the clock)")
    parser.add_argument("--language", choices=["en", "ja"], help="language (kept in the settings otherwise)")
    parser.add_argument("--stall", default="flea", help="stall name or a dialogue file (default flea)")
    parser.add_argument("--size", type=parse_size, default=(1280, 720), metavar="WxH", help="window size")
    parser.add_argument("--mode", choices=["full", "gestures", "body", "face"], default="full", help="what is acted")
    parser.add_argument("--overlay", action="store_true", help="start with feelings and active nodes shown")


class Window:
    """The window loop: events in, fixed ticks, one frame out. Everything it does to the game is an Intent."""

    def __init__(self, session: Session, device: Device, level: Level | None = None) -> None:
        self.session = session
        self.device = device
        self.stage = load_stage()
        level = level or DEFAULT
        self.renderer = Renderer(
            device,
            self.stage.model,
            self.stage.stall,
            self.stage.backdrop,
            level=level,
            fonts=FontSet.for_language("en"),
        )
        self.show = StageShow(self.stage)
        self.screen: Screen = TitleScreen()
        self.direction = start_direction(session.assets.talk.script.stall)
        self._language = _speakable(session)
        self._late_s = 0.0
        self._tick(None)

    def close(self) -> None:
        """Give the GL objects back."""
        self.renderer.release()

    def handle(self, action: Action) -> None:
        """One action of the player."""
        if action.kind == "quit":
            self.session.running = False
            return
        if action.kind == "key" and action.key == "f11":
            self.session.settings = self.session.settings.next("fullscreen")
            return
        self._go(self.screen.handle(self.session, self._in_reference(action)))

    def _in_reference(self, action: Action) -> Action:
        if action.at is None:
            return action
        scale = min(self.device.size[0] / 1280.0, self.device.size[1] / 720.0)
        return replace(action, at=(action.at[0] / scale, action.at[1] / scale))

    def _go(self, screen: Screen | None) -> None:
        if screen is not None:
            self.screen = screen
            self._autosave()

    def _autosave(self) -> None:
        world = self.session.world
        talk = world.talk if world.talk is not None and not world.talk.ended else None
        try:
            save_game(user_folder() / "autosave.json", self.session.afternoon, talk)
        except BadInput as error:
            self.session.message = str(error)

    def _tick(self, intent_from: Screen | None) -> None:
        from game.app.world import Intent

        session = self.session
        intent = Intent() if intent_from is None else intent_from.intent()
        session.world = step(session.assets, session.world, intent)
        assert session.world.body.pose is not None
        self.show.tick(session.world.body.pose, TICK_S)
        if intent.choice is not None:
            self._autosave()
        self._go(self.screen.after_tick(session))
        self._direct()

    def _direct(self) -> None:
        session, screen = self.session, self.screen
        offering = isinstance(screen, TalkScreen) and screen.offering
        moment = moment_of(session.world, screen.scene, place=session.assets.talk.script.stall, offering=offering)
        self.direction = direct(self.direction, moment, reduced_motion=session.settings.reduced_motion)

    def advance(self, elapsed_s: float) -> None:
        """Let the game run for some real time, in whole ticks."""
        self._late_s = min(self._late_s + elapsed_s, MAX_TICKS_A_FRAME * TICK_S)
        while self._late_s >= TICK_S:
            self._late_s -= TICK_S
            self._tick(self.screen)

    def draw(self) -> None:
        """One frame of whatever is on screen."""
        session = self.session
        if session.settings.language != self._language:
            self._language = _speakable(session)
        params = session.world.body.face_params
        assert params is not None
        view = self.show.frame(
            params,
            camera=self.direction.camera(session.world.time_s + self._late_s),
            share=self._late_s / TICK_S,
            show_face=session.world.mode != "body",
            hidden_items=self.stage.gone(session.afternoon.owned),
            time_s=session.world.time_s,
            hud=self._draw_hud,
        )
        self.renderer.draw(view)

    def _draw_hud(self, hud: Hud) -> None:
        settings = self.session.settings
        self.screen.draw(self.session, Canvas(hud, settings.language, settings.ui_scale))


def _speakable(session: Session) -> str:
    """The language there is a font for: without a Japanese one the game says so and stays in English."""
    if session.settings.language == "ja":
        try:
            FontSet.for_language("ja")
        except MissingFont as error:
            session.message = str(error)
            session.settings = replace(session.settings, language="en")
            session.strings = session.strings.switched("en")
            session.world = replace(session.world, language="en")
    return session.settings.language


def open_session(args: argparse.Namespace) -> Session:
    """Settings, assets, world and, where there is one, the game that was saved last."""
    settings, message = load_settings()
    if args.language:
        settings = replace(settings, language=args.language)
    assets = load_step_assets(args.stall)
    seed = args.seed if args.seed is not None else int(time.time()) & 0x7FFFFFFF
    world = leave_talk(
        replace(new_world(assets, seed, language=settings.language, text_speed=settings.text_speed), mode=args.mode)
    )
    session = Session(
        assets, world, load_strings(settings.language), settings, Afternoon(seed=seed), message=message or ""
    )
    if args.overlay:
        session.overlays |= {"feelings", "units"}
    _take_up(session, user_folder() / "autosave.json")
    return session


def _take_up(session: Session, path: Path) -> None:
    """Continue a saved game. A save that cannot be read is kept beside, never overwritten unseen."""
    if not path.exists():
        return
    try:
        afternoon, talk = load_game(path, session.assets.talk)
    except BadInput as error:
        aside = path.with_suffix(".unreadable.json")
        try:
            os.replace(path, aside)
        except OSError:
            aside = path
        session.message = session.strings("save_kept", reason=str(error)[:120])
        return
    session.afternoon = afternoon
    if talk is not None:
        from game.app.world import enter_talk

        session.world = enter_talk(session.assets, session.world, talk)


def _choose_level(window: Window, settings: Settings) -> None:
    if settings.quality != "auto":
        window.renderer.set_level(level_named(settings.quality))
        return

    def draw(level: Level) -> None:
        if window.renderer.level is not level:
            window.renderer.set_level(level)
        window.draw()
        window.device.context.finish()

    window.renderer.set_level(pick_level(draw))


def run(args: argparse.Namespace) -> int:
    """Open the window and play until it is closed."""
    # What is loaded stays: collecting garbage among it would only cost time, now and at every later collection.
    gc.disable()
    try:
        need_display()
        session = open_session(args)
        width, height = args.size
        device = Device.window(width, height, session.strings("title"), fullscreen=session.settings.fullscreen)
    except MissingPart as error:
        pygame.display.quit()
        print(f"error: {error}; all the same without a window: run_game.py autoplay | snapshot", file=sys.stderr)
        return 2
    window = Window(session, device)
    try:
        window.draw()
        _set_icon(window)
        pygame.display.flip()
        gc.freeze()
        gc.enable()
        _choose_level(window, session.settings)
        _loop(window)
    finally:
        window.close()
        device.release()
        pygame.display.quit()
    return 0


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
    before = time.perf_counter()
    while session.running:
        for event in pygame.event.get():
            action = action_of(event, _pixel_ratio(window))
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
