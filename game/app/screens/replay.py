"""A recording on screen: what was shown then, with a line of where one is."""

from __future__ import annotations

from game.app.input import Action
from game.app.recording import Player
from game.app.recording.talks import TalkPlayer
from game.app.screens.market import MarketScreen
from game.app.screens.outcome import OutcomeScreen
from game.app.screens.table import TableScreen
from game.app.screens.talk import TalkScreen
from game.app.screens.title import TitleScreen
from game.app.session import MenuScreen, Screen, Session
from game.app.ui import PALETTE, Canvas, Rect, fade
from game.app.world import TICK_S

__all__ = ["ReplayScreen"]


class ReplayScreen(MenuScreen):
    """Shows the screens of a recorded session; nothing the viewer does reaches it, but a pause and the end."""

    def __init__(self, player: Player | TalkPlayer, *, strip: bool = True) -> None:
        self.player = player
        self.scene = player.scene
        self.paused = False
        self._strip = strip
        self._talk = TalkScreen()
        self._screens: dict[str, Screen] = {
            "title": TitleScreen(),
            "market": MarketScreen(),
            "table": TableScreen(),
            "talk": self._talk,
        }
        if isinstance(player, Player):
            player.on_book = self._book

    def _book(self, session: Session) -> None:
        self._screens["outcome"] = OutcomeScreen.of(session)

    def handle(self, session: Session, action: Action) -> Screen | None:
        if action.kind == "back":
            session.running = False
        elif action.kind in {"confirm", "click"}:
            self.paused = not self.paused
        return None

    def after_tick(self, session: Session) -> Screen | None:
        self._talk.after_tick(session)
        self.scene = self.player.scene
        return None

    def draw(self, session: Session, canvas: Canvas) -> None:
        scene = self.scene
        if scene == "talk" and session.world.talk is None:
            scene = "table"
        shown = self._screens.get(scene)
        if shown is not None:
            shown.draw(session, canvas)
        if self._strip:
            self._draw_strip(session, canvas)

    def _draw_strip(self, session: Session, canvas: Canvas) -> None:
        s, player = session.strings, self.player
        at, whole = session.ticks, player.recording.ticks
        clock = f"▶ {_clock(at * TICK_S)}"
        if isinstance(player, Player):
            clock += f" / {_clock(whole * TICK_S)}"
        if player.divergence is not None:
            clock = s("replay_differs", where=str(player.divergence)[:110])
        elif player.done:
            clock += f"  {s('replay_done')}"
        elif self.paused:
            clock += f"  {s('replay_paused')}"
        room = Rect(20, 18, canvas.measure(clock, 15, "bold") + 28, 30)
        colour = PALETTE["red"] if player.divergence is not None else fade(PALETTE["shade"], 1.1)
        canvas.panel(room, colour, radius=15)
        canvas.text(room.x + 14, room.y + 6, clock, 15, PALETTE["white"], font="bold")


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"
