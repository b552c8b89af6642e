"""A recording in a window."""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import pygame

from game.app.input import action_of
from game.app.play import need_display
from game.app.recording import Divergence, Recording
from game.app.replay import open_replay
from game.app.screens.replay import ReplayScreen
from game.app.settings import load_settings
from game.app.window import Window
from game.app.world import TICK_S
from game.render import Device, level_named

__all__ = ["show"]

FASTEST_TICKS = 40
"""At the greatest speed this many ticks are made for every picture."""


def show(recording: Recording, args: argparse.Namespace) -> Divergence | None:
    """Play it until its end, or until the window is closed. Raises MissingPart where there is no screen."""
    need_display()
    session, player = open_replay(recording, args.stall)
    kept = load_settings()[0]
    session.settings = replace(
        session.settings, ui_scale=kept.ui_scale, reduced_motion=kept.reduced_motion, captions=kept.captions
    )
    width, height = args.size
    device = Device.window(width, height, session.strings("title"), fullscreen=False)
    screen = ReplayScreen(player)
    window = Window(session, device, level=level_named(args.level), screen=screen)
    try:
        window.populate()
        before = time.perf_counter()
        while session.running:
            for event in pygame.event.get():
                action = action_of(event)
                if action is not None and action.kind == "resize":
                    device.resize(*pygame.display.get_window_size())
                elif action is not None:
                    window.handle(action)
            now = time.perf_counter()
            elapsed, before = now - before, now
            if not (screen.paused or player.done):
                _advance(window, args.speed, elapsed)
            window.draw()
            pygame.display.flip()
    finally:
        window.close()
        device.release()
        pygame.display.quit()
    return player.divergence


def _advance(window: Window, speed: float, elapsed_s: float) -> None:
    """Real time into ticks; 0: as fast as pictures can be drawn."""
    left = FASTEST_TICKS * TICK_S if speed == 0.0 else min(elapsed_s * speed, FASTEST_TICKS * TICK_S)
    while left > 0.0:
        window.advance(min(left, TICK_S))
        left -= TICK_S
