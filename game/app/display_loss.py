"""When the display goes away under the game: its server ends, the connection is cut, somebody destroys the window.

Xlib then tells a callback and ends the process as soon as that returns: no exception is raised and no ``finally`` runs.
So what is to be kept is kept in the callback, and the process ends there with one line. Elsewhere (Wayland, Windows,
macOS) the loss comes as a quit event or an error of SDL, which the loop handles.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pygame

__all__ = ["watch_display"]

LOST_STATUS = 2


class _XErrorEvent(ctypes.Structure):
    """Of Xlib.h: what a request that the server refused was about."""

    _fields_ = (
        ("type", ctypes.c_int),
        ("display", ctypes.c_void_p),
        ("resource", ctypes.c_ulong),
        ("serial", ctypes.c_ulong),
        ("code", ctypes.c_ubyte),
        ("request", ctypes.c_ubyte),
        ("minor", ctypes.c_ubyte),
    )


_Lost = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p)
_Refused = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(_XErrorEvent))


@contextmanager
def watch_display(keep: Callable[[], None]) -> Iterator[None]:
    """While the block runs, a display that is lost calls ``keep``, says so in one line and ends the process."""
    xlib = _xlib()
    if xlib is None:
        yield
        return
    window = int(pygame.display.get_wm_info()["window"])

    def end(why: str) -> None:
        try:
            keep()
        finally:
            print(f"error: the picture was lost ({why}); the game was saved, start it again to go on", file=sys.stderr)
            sys.stderr.flush()
            os._exit(LOST_STATUS)  # Xlib would end the process anyhow, and would ask the lost server first

    def lost(display: int) -> int:
        end("the display went away")
        return 0

    def refused(display: int, error: ctypes._Pointer[_XErrorEvent]) -> int:
        if error.contents.resource == window:
            end("the window was destroyed")
        return 0  # what else a server may refuse (a mode, a cursor) is no reason to end a game

    callbacks = _Lost(lost), _Refused(refused)
    xlib.XSetIOErrorHandler(callbacks[0])
    before = xlib.XSetErrorHandler(callbacks[1])
    try:
        yield
    finally:
        xlib.XSetErrorHandler(ctypes.c_void_p(before))
        xlib.XSetIOErrorHandler(None)


def _xlib() -> ctypes.CDLL | None:
    """The Xlib that SDL uses; None where there is none."""
    if not sys.platform.startswith("linux") or pygame.display.get_driver() != "x11":
        return None
    try:
        xlib = ctypes.CDLL("libX11.so.6")
    except OSError:
        return None
    for name in ("XSetIOErrorHandler", "XSetErrorHandler"):
        getattr(xlib, name).restype = ctypes.c_void_p
    return xlib
