"""F4: the inside of a talk while it runs. Sliders for feelings and goodwill, the script's variables, ways back."""

from __future__ import annotations

from dataclasses import dataclass, field

from game.app.designer import go_back, set_felt, set_goodwill, set_shown, set_variable
from game.app.input import Action
from game.app.reload import Reloader
from game.app.session import Session
from game.app.ui import FEELING_COLOURS, PALETTE, Canvas, Rect, fade, hex_colour
from game.app.units_reload import UnitsWatch
from game.core.emotion_space import SIX

__all__ = ["Inspector"]

WIDTH, ROW, LINE = 344.0, 23.0, 19.0
LEFT, TOP = 14.0, 14.0
_BACK = hex_colour("221726", 0.93)
_RAIL = (1.0, 1.0, 1.0, 0.16)
_WHITE = PALETTE["white"]
_QUIET = fade(_WHITE, 0.62)
_MAX_VARIABLES = 7


@dataclass(frozen=True)
class _Slider:
    """kind: felt, shown or goodwill; name: an emotion, trust, patience or ask; its rail, and its range."""

    kind: str
    name: str
    rail: Rect
    low: float
    high: float

    def value_at(self, x: float) -> float:
        return self.low + (self.high - self.low) * min(max((x - self.rail.x) / self.rail.w, 0.0), 1.0)

    @property
    def grip(self) -> Rect:
        """Where it can be taken hold of: taller than the rail that is drawn."""
        return Rect(self.rail.x - 6, self.rail.y - 6, self.rail.w + 12, self.rail.h + 12)


@dataclass
class Inspector:
    """The panel's state: what is held by the mouse, and the last frame's places. It draws; ``designer`` does."""

    reloader: Reloader = field(default_factory=Reloader)
    units: UnitsWatch | None = None
    open: bool = False
    held: _Slider | None = None
    sliders: list[_Slider] = field(default_factory=list)
    taps: list[tuple[Rect, str, float | bool | str]] = field(default_factory=list)

    # --- input ---------------------------------------------------------------------------------------------------
    def handle(self, session: Session, action: Action) -> bool:
        """Whether the action was meant for the panel."""
        if action.kind == "key" and action.key == "f4":
            self.open = not self.open
            self.held = None
            return True
        if not self.open or session.world.talk is None:
            return False
        if action.kind == "key" and action.key in {"backspace", "f5"}:
            go_back(session)
            return True
        if action.kind == "release":
            was, self.held = self.held, None
            return was is not None
        if action.kind == "pointer" and self.held is not None and action.at is not None:
            self._set(session, self.held, self.held.value_at(action.at[0]))
            return True
        if action.kind != "click" or action.at is None:
            return False
        for slider in self.sliders:
            if slider.grip.holds(action.at):
                self.held = slider
                self._set(session, slider, slider.value_at(action.at[0]))
                return True
        for rect, name, value in self.taps:
            if rect.holds(action.at):
                self._tap(session, name, value)
                return True
        return Rect(LEFT, TOP, WIDTH, 10_000).holds(action.at)

    def _set(self, session: Session, slider: _Slider, value: float) -> None:
        {"felt": set_felt, "shown": set_shown, "goodwill": set_goodwill}[slider.kind](session, slider.name, value)

    def _tap(self, session: Session, name: str, value: float | bool | str) -> None:
        if name == "\0back":
            go_back(session)
        else:
            set_variable(session, name, value)

    # --- drawing -------------------------------------------------------------------------------------------------
    def draw(self, session: Session, canvas: Canvas) -> None:
        """The panel if it is open; what hot reload has to say in any case."""
        self.sliders, self.taps = [], []
        if self.open and session.world.talk is not None:
            self._draw_panel(session, canvas)
        elif session.designed and not self.reloader.findings:
            self._badge(session, canvas, canvas.width / 2 - 80, 10)
        self._draw_news(session, canvas)

    def _badge(self, session: Session, canvas: Canvas, x: float, y: float) -> None:
        text = session.strings("designer_mode")
        width = canvas.measure(text, 14, "bold") + 24
        canvas.panel(Rect(x, y, width, 24), PALETTE["red"], radius=12)
        canvas.text(x + 12, y + 3, text, 14, _WHITE, font="bold")

    def _draw_panel(self, session: Session, canvas: Canvas) -> None:
        s, world = session.strings, session.world
        talk = world.talk
        assert talk is not None
        variables = list(session.assets.talk.script.variables.items())
        shown_variables = variables[:_MAX_VARIABLES]
        height = 80 + 9 * ROW + 30 + len(shown_variables) * LINE + 54
        canvas.panel(Rect(LEFT, TOP, WIDTH, height), _BACK, radius=14, shadow=10)
        self._badge(session, canvas, LEFT + 14, TOP + 12)
        y = TOP + 46
        canvas.text(LEFT + 104, y, s("felt"), 14, _WHITE, font="bold")
        canvas.text(LEFT + 226, y, s("shown"), 14, _QUIET, font="bold")
        y += 24
        for i, emotion in enumerate(SIX):
            canvas.text(LEFT + 16, y - 5, s(emotion), 15, _WHITE)
            self._slider(canvas, "felt", emotion, LEFT + 104, y, 104, float(talk.feeling.felt[i]), 0, 1, emotion)
            self._slider(canvas, "shown", emotion, LEFT + 226, y, 104, float(world.shown_target[i]), 0, 1, emotion)
            y += ROW
        y += 8
        bargain = talk.bargain
        for name, value, low, high in (
            ("trust", bargain.trust, 0.0, 1.0),
            ("patience", bargain.patience, 0.0, 12.0),
            ("ask", bargain.ask, bargain.lowest, 1.0),
        ):
            canvas.text(LEFT + 16, y - 5, s(f"designer_{name}"), 15, _WHITE)
            self._slider(canvas, "goodwill", name, LEFT + 104, y, 170, value, low, high)
            canvas.text(LEFT + WIDTH - 14, y - 5, f"{value:.2f}", 14, _WHITE, align="right")
            y += ROW
        canvas.text(LEFT + 16, y, s("designer_lowest", share=f"{bargain.lowest:.2f}"), 13, _QUIET)
        canvas.text(LEFT + WIDTH - 14, y, f"{talk.beat.node} · {talk.item}", 13, _WHITE, align="right")
        y += 22
        for name, _ in shown_variables:
            self._variable(canvas, name, talk.story.variables[name], y)
            y += LINE
        more = len(variables) - len(shown_variables)
        if more:
            canvas.text(LEFT + 16, y - 1, f"+{more}", 12, _QUIET)
        y += 16
        button = Rect(LEFT + 14, y, WIDTH - 28, 30)
        can = bool(world.marks) and world.marks[-1].before is not None
        canvas.panel(button, fade(PALETTE["teal"], 1.0 if can else 0.4), radius=12)
        canvas.text(button.x + button.w / 2, button.y + 5, s("designer_back"), 15, _WHITE, align="center")
        if can:
            self.taps.append((button, "\0back", 0.0))

    def _slider(
        self,
        canvas: Canvas,
        kind: str,
        name: str,
        x: float,
        y: float,
        width: float,
        value: float,
        low: float,
        high: float,
        emotion: str = "",
    ) -> None:
        slider = _Slider(kind, name, Rect(x, y, width, 8), low, high)
        colour = FEELING_COLOURS[emotion] if emotion else PALETTE["gold"]
        share = (value - low) / (high - low) if high > low else 0.0
        canvas.bar(slider.rail, share, colour if kind != "shown" else fade(colour, 0.7), _RAIL)
        held = self.held is not None and (self.held.kind, self.held.name) == (kind, name)
        canvas.dot(x + width * min(max(share, 0.0), 1.0), y + 4, 9 if held else 7, _WHITE)
        self.sliders.append(slider)

    def _variable(self, canvas: Canvas, name: str, value: float | bool | str, y: float) -> None:
        canvas.text(LEFT + 16, y, name, 14, _QUIET)
        right = LEFT + WIDTH - 14
        if isinstance(value, bool):
            place = Rect(right - 60, y, 60, 17)
            canvas.panel(place, PALETTE["teal"] if value else _RAIL, radius=10)
            canvas.text(place.x + 30, y, str(value).lower(), 13, _WHITE, align="center")
            self.taps.append((place, name, not value))
        elif isinstance(value, float):
            canvas.text(right - 44, y, f"{value:g}", 14, _WHITE, align="center")
            for sign, x in ((-1.0, right - 88), (1.0, right - 20)):
                place = Rect(x, y, 20, 17)
                canvas.panel(place, _RAIL, radius=10)
                canvas.text(x + 10, y - 1, "−" if sign < 0 else "+", 14, _WHITE, align="center")
                self.taps.append((place, name, value + sign))
        else:
            canvas.text(right, y, value or '""', 14, _WHITE, align="right")

    def _draw_news(self, session: Session, canvas: Canvas) -> None:
        """What hot reload found: a short word of a good file, every error of a broken one until it is mended."""
        reloader, left = self.reloader, LEFT + (WIDTH + 14 if self.open else 0)
        width = min(canvas.width - left - 420, 860.0)
        if reloader.findings:
            rows = [session.strings("reload_broken", count=len(reloader.findings))]
            rows += [str(finding) for finding in reloader.findings[:5]]
            lines = [(i == 0, row) for i, text in enumerate(rows) for row in canvas.rows(text, width - 32, 15)]
            canvas.panel(
                Rect(left, TOP, width, 22 + 21 * len(lines)),
                _BACK,
                radius=14,
                border=3,
                border_colour=PALETTE["red"],
                shadow=10,
            )
            for i, (first, row) in enumerate(lines):
                canvas.text(left + 16, TOP + 10 + 21 * i, row, 15, _WHITE, font="bold" if first else "body")
        elif reloader.said:
            wide = canvas.measure(reloader.said, 15) + 32
            canvas.panel(Rect(left, TOP, wide, 34), PALETTE["teal"], radius=14)
            canvas.text(left + 16, TOP + 7, reloader.said, 15, _WHITE)
        units = self.units
        if units is not None and units.said:
            rows = list(canvas.rows(units.said, width - 32, 15))
            wide = max(canvas.measure(row, 15) for row in rows) + 32
            back, edge = (_BACK, PALETTE["red"]) if units.broken else (PALETTE["teal"], PALETTE["teal"])
            panel = Rect(left, TOP + 42, wide, 14 + 21 * len(rows))
            canvas.panel(panel, back, radius=14, border=2, border_colour=edge)
            for i, row in enumerate(rows):
                canvas.text(left + 16, TOP + 49 + 21 * i, row, 15, _WHITE)
