"""What the player does, as plain actions: the only place that knows pygame's events."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pygame

__all__ = ["COMMANDS", "Action", "action_of", "command_of"]


@dataclass(frozen=True)
class Action:
    """kind: up down left right confirm back pointer click release wheel key resize quit focus_lost.

    at: device pixels for pointer, click, release. key: a character or function key's name. amount: wheel notches.
    move, held: device pixels since the last event, and the button that is down: "", left or middle (pointer).
    fast: whether shift is held (larger steps). raw: the key that was really pressed, where keys have changed places.
    """

    kind: str
    at: tuple[float, float] | None = None
    key: str = ""
    amount: int = 0
    fast: bool = False
    move: tuple[float, float] = (0.0, 0.0)
    held: str = ""
    raw: str = ""


COMMANDS = ("o", "p", "b", "w", "g", "t", "h", "a", "tab", "backspace", "l", "f6", "f7", "f11")
"""What can be given another key, by the usual one."""


_KEYS = {
    pygame.K_UP: "up",
    pygame.K_DOWN: "down",
    pygame.K_LEFT: "left",
    pygame.K_RIGHT: "right",
    pygame.K_RETURN: "confirm",
    pygame.K_KP_ENTER: "confirm",
    pygame.K_SPACE: "confirm",
    pygame.K_ESCAPE: "back",
}


def action_of(
    event: pygame.event.Event, pixel_ratio: float = 1.0, keys: Mapping[str, str] | None = None
) -> Action | None:
    """The action of a pygame event, None where it means nothing. ``pixel_ratio``: device pixels per window pixel.

    keys: command -> the key it has instead of its usual one.
    """
    if event.type == pygame.QUIT:
        return Action("quit")
    if event.type == pygame.KEYDOWN:
        fast = bool(event.mod & pygame.KMOD_SHIFT)
        if event.key == pygame.K_RETURN and event.mod & pygame.KMOD_ALT:
            return Action("key", key="f11")
        if event.key in _KEYS:
            return Action(_KEYS[event.key], fast=fast)
        name = pygame.key.name(event.key).lower()
        return Action("key", key=command_of(name, keys or {}), fast=fast, raw=name)
    if event.type == pygame.MOUSEMOTION:
        down = getattr(event, "buttons", (0, 0, 0))
        held = "left" if down[0] else "middle" if down[1] else ""
        fast = bool(held and pygame.key.get_mods() & pygame.KMOD_SHIFT)
        move = _scaled(getattr(event, "rel", (0, 0)), pixel_ratio)
        return Action("pointer", at=_scaled(event.pos, pixel_ratio), move=move, held=held, fast=fast)
    if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
        return Action("click", at=_scaled(event.pos, pixel_ratio))
    if event.type == pygame.MOUSEBUTTONUP and event.button == 1:
        return Action("release", at=_scaled(event.pos, pixel_ratio))
    if event.type == pygame.MOUSEBUTTONDOWN and event.button == 3:
        return Action("back")
    if event.type == pygame.MOUSEWHEEL:
        return Action("wheel", amount=int(event.y))
    if event.type in {pygame.VIDEORESIZE, pygame.WINDOWSIZECHANGED}:
        return Action("resize")
    return None


def command_of(name: str, keys: Mapping[str, str]) -> str:
    """The command a key stands for; a key that was taken away from one without another stands for nothing."""
    for command, key in keys.items():
        if key == name:
            return command
    return "" if name in keys else name


def _scaled(at: tuple[int, int], ratio: float) -> tuple[float, float]:
    return at[0] * ratio, at[1] * ratio
