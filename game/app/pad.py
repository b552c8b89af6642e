"""A gamepad as plain actions. SDL knows the layouts; buttons are named as on an Xbox pad, other makes by place.

A confirm · B back · X wait · Y offer · bumpers lay a token · left trigger takes a word back · right trigger the asking
price · stick and cross move · back: what was said · start: menu · stick clicks: skip, go on by itself.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import pygame

from game.app.input import Action

__all__ = ["Pads"]

_BUTTONS: dict[int, Action] = {
    pygame.CONTROLLER_BUTTON_A: Action("confirm"),
    pygame.CONTROLLER_BUTTON_B: Action("back"),
    pygame.CONTROLLER_BUTTON_X: Action("key", key="w"),
    pygame.CONTROLLER_BUTTON_Y: Action("key", key="o"),
    pygame.CONTROLLER_BUTTON_BACK: Action("key", key="h"),
    pygame.CONTROLLER_BUTTON_START: Action("back"),
    pygame.CONTROLLER_BUTTON_LEFTSTICK: Action("key", key="tab"),
    pygame.CONTROLLER_BUTTON_RIGHTSTICK: Action("key", key="a"),
    pygame.CONTROLLER_BUTTON_LEFTSHOULDER: Action("key", key="t", fast=True),
    pygame.CONTROLLER_BUTTON_RIGHTSHOULDER: Action("key", key="t"),
    pygame.CONTROLLER_BUTTON_DPAD_UP: Action("up"),
    pygame.CONTROLLER_BUTTON_DPAD_DOWN: Action("down"),
    pygame.CONTROLLER_BUTTON_DPAD_LEFT: Action("left"),
    pygame.CONTROLLER_BUTTON_DPAD_RIGHT: Action("right"),
}
_AXES: dict[int, tuple[Action | None, Action]] = {
    pygame.CONTROLLER_AXIS_LEFTX: (Action("left"), Action("right")),
    pygame.CONTROLLER_AXIS_LEFTY: (Action("up"), Action("down")),
    pygame.CONTROLLER_AXIS_TRIGGERLEFT: (None, Action("key", key="backspace")),
    pygame.CONTROLLER_AXIS_TRIGGERRIGHT: (None, Action("key", key="p")),
}
PUSHED, LET_GO = 0.6, 0.35
"""A stick or trigger acts once beyond the first, and again only after it has come back below the second."""


@dataclass
class Pads:
    """The pads that are plugged in, and which of their sticks are pushed."""

    pads: dict[int, Any] = field(default_factory=dict)
    pushed: set[tuple[int, int, bool]] = field(default_factory=set)

    def start(self) -> None:
        """Listen for pads; without SDL's controllers there simply are none."""
        try:
            from pygame._sdl2 import controller

            controller.init()
        except (ImportError, pygame.error):
            return

    def action_of(self, event: pygame.event.Event) -> Action | None:
        """The action of a pad's event, None for any other. Pads that are plugged in later are taken in."""
        if event.type == pygame.CONTROLLERDEVICEADDED:
            self._open(event.device_index)
        elif event.type == pygame.CONTROLLERDEVICEREMOVED:
            self.pads.pop(event.instance_id, None)
        elif event.type == pygame.CONTROLLERBUTTONDOWN:
            return _BUTTONS.get(event.button)
        elif event.type == pygame.CONTROLLERAXISMOTION:
            return self._axis(int(getattr(event, "instance_id", 0)), event.axis, event.value / 32767.0)
        return None

    def _open(self, index: int) -> None:
        from pygame._sdl2 import controller

        try:
            pad = controller.Controller(index)
        except pygame.error:
            return
        self.pads[pad.as_joystick().get_instance_id()] = pad

    def _axis(self, pad: int, axis: int, value: float) -> Action | None:
        if axis not in _AXES:
            return None
        found = None
        for side, action in zip((False, True), _AXES[axis], strict=True):
            key, amount = (pad, axis, side), value if side else -value
            if key in self.pushed and amount < LET_GO:
                self.pushed.discard(key)
            elif key not in self.pushed and amount > PUSHED:
                self.pushed.add(key)
                found = action
        return found
