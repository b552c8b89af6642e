"""A moment of a recording as a picture, or all of it as a film, without a display."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from game.app.pictures import check_png, write_png
from game.app.recording import Divergence, Player, Recording
from game.app.recording.talks import TalkPlayer
from game.app.replay import open_replay
from game.app.screens.replay import ReplayScreen
from game.app.video import check_film, write_film
from game.app.window import Window
from game.app.world import TICK_S
from game.core.errors import BadInput
from game.render import Device, level_named

__all__ = ["draw_frame", "film"]

AFTER_S = 1.5
"""A film goes on for a moment after its last event."""


class _Cinema:
    """A window without a display in which a recording is shown."""

    def __init__(self, recording: Recording, args: argparse.Namespace) -> None:
        self.session, self.player = open_replay(recording, args.stall)
        # Nothing but the recording: pictures of a film move smoothly whatever the viewer's settings are.
        self.session.settings = replace(self.session.settings, reduced_motion=False)
        self.device = Device.headless(*args.size)
        screen = ReplayScreen(self.player, strip=False)
        self.window = Window(self.session, self.device, level=level_named(args.level), screen=screen)
        self.window.populate()

    def picture(self) -> NDArray[np.uint8]:
        """(h, w, 3) of now."""
        self.window.draw()
        return self.window.renderer.read_pixels()

    def close(self) -> None:
        """Give the GL objects back."""
        self.window.close()
        self.device.release()


def draw_frame(recording: Recording, args: argparse.Namespace) -> Divergence | None:
    """Draw the moment ``args.at`` into ``args.out``. Raises BadInput beyond the recording's end."""
    check_png(args.out)
    cinema = _Cinema(recording, args)
    try:
        player = cinema.player
        while cinema.session.ticks * TICK_S < args.at and not player.done:
            cinema.window.advance(TICK_S)
        if cinema.session.ticks * TICK_S < args.at and player.divergence is None:
            length_s = cinema.session.ticks * TICK_S
            raise BadInput("--at", expected=f"at most {length_s:.1f}, the recording's end", seen=args.at)
        write_png(args.out, cinema.picture())
        return player.divergence
    finally:
        cinema.close()


def film(recording: Recording, args: argparse.Namespace) -> Divergence | None:
    """Film it from beginning to end into ``args.video``."""
    check_film(args.video)
    cinema = _Cinema(recording, args)
    try:
        speed = args.speed or 1.0
        write_film(args.video, _pictures(cinema, cinema.player, args.fps, speed), args.fps)
        return cinema.player.divergence
    finally:
        cinema.close()


def _pictures(cinema: _Cinema, player: Player | TalkPlayer, fps: int, speed: float) -> Iterator[NDArray[np.uint8]]:
    after = round(AFTER_S * fps)
    while after > 0:
        yield cinema.picture()
        left = speed / fps
        while left > 1e-9:
            cinema.window.advance(min(left, TICK_S))
            left -= TICK_S
        after -= player.done
