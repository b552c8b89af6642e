"""What has been said in this talk, and what the game has told in passing, to read again."""

from __future__ import annotations

from game.app.input import Action
from game.app.session import MenuScreen, Screen, Session
from game.app.ui import INK, PALETTE, Button, Buttons, Canvas, Rect, fade

__all__ = ["HistoryScreen"]

PAGE = 6


class HistoryScreen(MenuScreen):
    """The lines of the talk, then the game's own messages, the last ones first to be seen; up, down and the wheel turn
    back and forth."""

    def __init__(self, before: Screen) -> None:
        self._before, self.scene = before, before.scene
        self._buttons = Buttons()
        self.back = 0
        """How many lines lie below the page."""

    def handle(self, session: Session, action: Action) -> Screen | None:
        most = max(len(_rows(session)) - 1, 0)
        steps = {"up": 1, "down": -1, "left": PAGE, "right": -PAGE}
        if action.kind in steps or action.kind == "wheel":
            change = action.amount if action.kind == "wheel" else steps[action.kind]
            self.back = min(max(self.back + change, 0), most)
            return None
        if self._buttons.handle(action) or action.kind == "back" or (action.kind == "key" and action.key == "h"):
            return self._before
        return None

    def draw(self, session: Session, canvas: Canvas) -> None:
        s, lines = session.strings, _rows(session)
        canvas.panel(Rect(0, 0, canvas.width, canvas.height), fade(PALETTE["shade"], 1.25), radius=0)
        left, width = (canvas.width - 860) / 2, 860.0
        canvas.text(left, 28, s("history"), 32, PALETTE["white"], font="title")
        bottom, top = canvas.height - 92, 84.0
        end = len(lines) - min(self.back, max(len(lines) - 1, 0))
        y = bottom
        for speaker, name, text in reversed(lines[:end]):
            rows = canvas.rows(text, width - 180, 20)
            step = 20 * canvas.text_scale * 1.3
            height = len(rows) * step + 20
            if y - height < top:
                break
            y -= height + 8
            box = Rect(left, y, width, height)
            mine = speaker == "player"
            canvas.panel(box, PALETTE["paper_warm"] if mine else PALETTE["paper"], radius=12)
            colour = {"player": PALETTE["indigo"], "game": PALETTE["faint"]}.get(speaker, PALETTE["red"])
            canvas.text(left + 16, y + 10, name, 17, colour, font="bold")
            for i, row in enumerate(rows):
                canvas.text(left + 150, y + 10 + i * step, row, 20, INK, whole=True)
        self._buttons.lay([Button("back", s("back"), Rect(canvas.width / 2 - 110, canvas.height - 66, 220, 46))])
        self._buttons.draw(canvas)


def _rows(session: Session) -> list[tuple[str, str, str]]:
    """(speaker, name, words): the talk's lines while there is one, then the messages."""
    s, lines = session.strings, session.world.backlog if session.world.talk is not None else ()
    person = session.assets.talk.script.person.name.get(s.language)
    names = {"shopkeeper": person, "player": s("you"), "narrator": ""}
    told = [("game", s("notice"), notice.text) for notice in session.notices.told]
    return [(line.speaker, names[line.speaker], line.text(s.language)) for line in lines] + told
