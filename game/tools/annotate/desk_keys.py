"""Everything the desk does with a key: one table for the keyboard and for the sheet that F1 shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pygame

from game.tools.annotate.desk_actions import Actions

__all__ = ["BINDINGS", "Binding", "binding_of"]


@dataclass(frozen=True)
class Binding:
    """keys: as the sheet shows them; key: pygame's; held: of "ctrl", "shift", "alt" exactly these."""

    group: str
    keys: str
    does: str
    key: int
    held: frozenset[str]
    run: Callable[[Actions], object]

    @property
    def again(self) -> bool:
        """Whether a key that is held down does it over and over."""
        return self.key in _AGAIN


_AGAIN = {
    pygame.K_LEFT, pygame.K_RIGHT, pygame.K_TAB, pygame.K_z, pygame.K_y,
    pygame.K_PLUS, pygame.K_EQUALS, pygame.K_MINUS, pygame.K_KP_PLUS, pygame.K_KP_MINUS,
}  # fmt: skip


def _b(group: str, keys: str, does: str, key: int, run: Callable[[Actions], object], *held: str) -> Binding:
    return Binding(group, keys, does, key, frozenset(held), run)


_PLAY, _SPAN, _NAME, _LOOK, _FILE = "Play", "Spans", "What it is", "Look", "Files and help"

BINDINGS: tuple[Binding, ...] = (
    _b(_PLAY, "Space", "play, pause", pygame.K_SPACE, lambda a: a.desk.clock.toggle()),
    _b(_PLAY, "←  →", "one frame back, on", pygame.K_LEFT, lambda a: a.step(-1)),
    _b(_PLAY, "", "", pygame.K_RIGHT, lambda a: a.step(1)),
    _b(_PLAY, "Shift ←  →", "half a second", pygame.K_LEFT, lambda a: a.step(-a.half_second), "shift"),
    _b(_PLAY, "", "", pygame.K_RIGHT, lambda a: a.step(a.half_second), "shift"),
    _b(_PLAY, "Home  End", "to the start, the end", pygame.K_HOME, lambda a: a.step(-(10**9))),
    _b(_PLAY, "", "", pygame.K_END, lambda a: a.step(10**9)),
    _b(_PLAY, ",  .", "slower, faster", pygame.K_COMMA, lambda a: a.desk.clock.slower(1)),
    _b(_PLAY, "", "", pygame.K_PERIOD, lambda a: a.desk.clock.slower(-1)),
    _b(_PLAY, "L", "loop the selected span, or not", pygame.K_l, lambda a: a.desk.loop_selection()),
    _b(_SPAN, "Enter", "begin a span here; again: end it", pygame.K_RETURN, lambda a: a.desk.begin_or_end()),
    _b(_SPAN, "", "", pygame.K_KP_ENTER, lambda a: a.desk.begin_or_end()),
    _b(_SPAN, "↑  ↓", "the layer above, below", pygame.K_UP, lambda a: a.desk.change_layer(-1)),
    _b(_SPAN, "", "", pygame.K_DOWN, lambda a: a.desk.change_layer(1)),
    _b(_SPAN, "Tab  Shift Tab", "next span, the one before", pygame.K_TAB, lambda a: a.desk.neighbour(1)),
    _b(_SPAN, "", "", pygame.K_TAB, lambda a: a.desk.neighbour(-1), "shift"),
    _b(_SPAN, "G", "next stretch without a posture", pygame.K_g, lambda a: a.desk.next_gap()),
    _b(_SPAN, "Alt ←  →", "move by a frame", pygame.K_LEFT, lambda a: a.desk.nudge(-1), "alt"),
    _b(_SPAN, "", "", pygame.K_RIGHT, lambda a: a.desk.nudge(1), "alt"),
    _b(_SPAN, "[  ]", "start, end here", pygame.K_LEFTBRACKET, lambda a: a.desk.trim_here("start")),
    _b(_SPAN, "", "", pygame.K_RIGHTBRACKET, lambda a: a.desk.trim_here("end")),
    _b(_SPAN, "S", "split here", pygame.K_s, lambda a: a.desk.split_here()),
    _b(_SPAN, "M", "merge the selected, or with the next", pygame.K_m, lambda a: a.desk.merge()),
    _b(_SPAN, "Ctrl C  X  V", "copy, cut, paste here", pygame.K_c, lambda a: a.desk.copy(), "ctrl"),
    _b(_SPAN, "", "", pygame.K_x, lambda a: a.cut(), "ctrl"),
    _b(_SPAN, "", "", pygame.K_v, lambda a: a.desk.paste(), "ctrl"),
    _b(_SPAN, "Del", "delete", pygame.K_DELETE, lambda a: a.desk.delete()),
    _b(_SPAN, "", "", pygame.K_BACKSPACE, lambda a: a.desk.delete()),
    _b(_SPAN, "X", "snapping on, off", pygame.K_x, lambda a: a.toggle_snap()),
    _b(_SPAN, "Esc", "let go", pygame.K_ESCAPE, lambda a: a.let_go()),
    _b(_NAME, "B", "behaviour: type to search, Enter", pygame.K_b, lambda a: a.ask_behaviour()),
    _b(_NAME, "K", "the stroke is here", pygame.K_k, lambda a: a.desk.stroke_here()),
    _b(_NAME, "W  N", "words, note", pygame.K_w, lambda a: a.ask_text("words")),
    _b(_NAME, "", "", pygame.K_n, lambda a: a.ask_text("note")),
    _b(_NAME, "P", "propose, learnt from other takes", pygame.K_p, lambda a: a.propose()),
    _b(_NAME, "A  R", "accept, reject the selected", pygame.K_a, lambda a: a.desk.accept()),
    _b(_NAME, "", "", pygame.K_r, lambda a: a.desk.reject()),
    _b(_NAME, "Shift A  R", "accept, reject all", pygame.K_a, lambda a: a.desk.accept(everything=True), "shift"),
    _b(_NAME, "", "", pygame.K_r, lambda a: a.desk.reject(everything=True), "shift"),
    _b(_LOOK, "+  −  0", "nearer, further, everything", pygame.K_PLUS, lambda a: a.zoom(1)),
    _b(_LOOK, "", "", pygame.K_EQUALS, lambda a: a.zoom(1)),
    _b(_LOOK, "", "", pygame.K_KP_PLUS, lambda a: a.zoom(1)),
    _b(_LOOK, "", "", pygame.K_MINUS, lambda a: a.zoom(-1)),
    _b(_LOOK, "", "", pygame.K_KP_MINUS, lambda a: a.zoom(-1)),
    _b(_LOOK, "", "", pygame.K_0, lambda a: a.desk.view.fit()),
    _b(_LOOK, "F", "fold, unfold the layer", pygame.K_f, lambda a: a.fold()),
    _b(_LOOK, "1  2  3  4", "from the front, left, back, right", pygame.K_1, lambda a: a.orbit.look_from("front")),
    _b(_LOOK, "", "", pygame.K_2, lambda a: a.orbit.look_from("left")),
    _b(_LOOK, "", "", pygame.K_3, lambda a: a.orbit.look_from("back")),
    _b(_LOOK, "", "", pygame.K_4, lambda a: a.orbit.look_from("right")),
    _b(_LOOK, "C", "character, at the stall, stick figure", pygame.K_c, lambda a: a.next_style()),
    _b(_LOOK, "Page up  down", "the take before, the next", pygame.K_PAGEUP, lambda a: a.take(-1)),
    _b(_LOOK, "", "", pygame.K_PAGEDOWN, lambda a: a.take(1)),
    _b(_FILE, "Ctrl Z  Y", "undo, redo, without end", pygame.K_z, lambda a: a.desk.undo(), "ctrl"),
    _b(_FILE, "", "", pygame.K_y, lambda a: a.desk.redo(), "ctrl"),
    _b(_FILE, "", "", pygame.K_z, lambda a: a.desk.redo(), "ctrl", "shift"),
    _b(_FILE, "Ctrl S", "save", pygame.K_s, lambda a: a.desk.save(), "ctrl"),
    _b(_FILE, "F5", "try it: save, count, into the game", pygame.K_F5, lambda a: a.try_it()),
    _b(_FILE, "F1", "this sheet", pygame.K_F1, lambda a: a.toggle_help()),
)


def binding_of(key: int, mod: int, unicode: str = "") -> Binding | None:
    """What a key press means. Characters that keyboards put in different places count by what they type."""
    held = {
        name
        for name, mask in (
            ("ctrl", pygame.KMOD_CTRL | pygame.KMOD_META), ("shift", pygame.KMOD_SHIFT), ("alt", pygame.KMOD_ALT)
        )
        if mod & mask
    }  # fmt: skip
    if unicode in {"[", "]", "+", "-", ",", "."} and "ctrl" not in held:
        key, held = ord(unicode), set()
    return next((b for b in BINDINGS if b.key == key and b.held == held), None)
