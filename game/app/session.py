"""The running game as its screens see it, and what a screen is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

from game.app.afternoon import Afternoon
from game.app.input import Action
from game.app.settings import Settings
from game.app.step import StepAssets
from game.app.strings import Strings
from game.app.ui import Canvas
from game.app.world import Intent, World

__all__ = ["MenuScreen", "Screen", "Session"]


@dataclass
class Session:
    """The running game as the screens see it. ``world`` is replaced by every tick; screens never change it."""

    assets: StepAssets
    world: World
    strings: Strings
    settings: Settings
    afternoon: Afternoon
    overlays: set[str] = field(default_factory=set)
    message: str = ""
    running: bool = True

    def money(self, amount: float) -> str:
        """An amount as the stall's currency writes it in the present language."""
        return self.assets.talk.script.currency.text(amount).get(self.strings.language)


class Screen(Protocol):
    """One screen of the game. ``handle`` may return another screen to go to; ``intent`` is what the next tick does.

    scene: which framing it wants, one of the director's scenes.
    """

    scene: str

    def handle(self, session: Session, action: Action) -> Screen | None: ...

    def intent(self) -> Intent: ...

    def after_tick(self, session: Session) -> Screen | None: ...

    def draw(self, session: Session, canvas: Canvas) -> None: ...


class MenuScreen:
    """What screens without a talk have in common: they ask nothing of the tick and wait for the player."""

    scene = "title"

    def intent(self) -> Intent:
        return Intent()

    def after_tick(self, session: Session) -> Screen | None:
        return None
