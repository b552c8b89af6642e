"""How the street looks: the sky over the market, the strip with clock and purse, a stall's front with its sign."""

from __future__ import annotations

from math import cos, pi, sin

from game.app.score import standing
from game.app.session import Session
from game.app.ui import INK, PALETTE, Button, Canvas, Colour, Rect, fade, hex_colour

__all__ = ["draw_sky", "draw_stall", "draw_top"]

EVENING: Colour = hex_colour("C4563A", 0.34)
DUSK: Colour = hex_colour("4B2A63", 0.40)
AWNING_H = 46.0
SIGN_H = 104.0


def draw_sky(session: Session, canvas: Canvas) -> None:
    """The market behind, out of focus, in the light of the hour."""
    whole = Rect(0, 0, canvas.width, canvas.height)
    if not canvas.picture("backdrop", whole, cover=True):
        canvas.panel(whole, hex_colour("F3D9B1"), radius=0)
    late = max(session.day_share - 0.45, 0.0) / 0.55
    canvas.panel(whole, fade(EVENING, late), radius=0)
    canvas.panel(whole, fade(DUSK, max(late - 0.6, 0.0) / 0.4), radius=0)
    ground = Rect(0, canvas.height * 0.74, canvas.width, canvas.height * 0.26 + 2)
    canvas.gradient(ground, hex_colour("C99E6C", 0.0), hex_colour("8C5A3C", 0.85))


def draw_top(session: Session, canvas: Canvas) -> None:
    """Clock and purse: the sun's way from opening to closing."""
    s, bazaar = session.strings, session.market.bazaar
    bar = Rect(0, 0, canvas.width, 62)
    canvas.panel(bar, fade(PALETTE["shade"], 1.15), radius=0)
    canvas.text(28, 13, s("day", day=session.afternoon.day), 22, PALETTE["white"], font="title")
    canvas.text(
        canvas.width - 28, 15, s("purse", money=session.money(session.afternoon.purse)), 21, PALETTE["white"],
        font="bold", align="right",
    )  # fmt: skip
    left, right, base = canvas.width * 0.32, canvas.width * 0.68, 46.0
    points = []
    for i in range(33):
        turn = pi * i / 32
        points.append((left + (right - left) * i / 32, base - 26 * sin(turn)))
    canvas.lines(points, 3, fade(PALETTE["white"], 1.0) if session.settings.high_contrast else hex_colour("B08A78"))
    share = session.day_share
    x, y = left + (right - left) * share, base - 26 * sin(pi * share)
    for k in range(8):
        a = k * pi / 4
        canvas.lines([(x + 13 * cos(a), y + 13 * sin(a)), (x + 17 * cos(a), y + 17 * sin(a))], 2.5, PALETTE["gold"])
    canvas.dot(x, y, 10, PALETTE["gold"])
    canvas.text(left - 24, base - 16, bazaar.clock(0), 15, PALETTE["paper_warm"], align="right")
    canvas.text(right + 24, base - 16, bazaar.clock(bazaar.length_min), 15, PALETTE["paper_warm"])
    canvas.text(
        (left + right) / 2, 28, bazaar.clock(session.minutes), 22, PALETTE["white"], font="bold", align="center"
    )


def draw_stall(session: Session, canvas: Canvas, button: Button, *, focused: bool, closed: bool) -> None:
    """A stall's front: awning, the view, the sign with who stands there and what you remember of them."""
    s, market, place, name = session.strings, session.market, button.rect, button.id
    dark, light, wood = (hex_colour(code[1:]) for code in market.bazaar.colours.get(name, _PLAIN))
    stall = market.stalls.get(name)
    if focused:
        place = Rect(place.x - 4, place.y - 5, place.w + 8, place.h + 8)
        canvas.panel(Rect(place.x - 7, place.y - 7, place.w + 14, place.h + 14), PALETTE["gold"], radius=22, shadow=18)
    canvas.panel(place, wood, radius=16, shadow=16)
    view = Rect(place.x + 10, place.y + 10, place.w - 20, place.h - SIGN_H - 10)
    seen = stall is not None and canvas.picture(f"card:{name}", view, cover=True)
    if not seen:
        canvas.gradient(view, light, hex_colour("CDB394"))
        text = s("not_open") if stall is None and name in market.left_out else s("setting_up")
        canvas.text(view.x + view.w / 2, view.y + view.h / 2, text, 18, INK, align="center")
    if closed:
        _draw_cloth(canvas, view, dark)
    _draw_awning(canvas, Rect(place.x - 6, place.y - 8, place.w + 12, AWNING_H), dark, light)
    _draw_sign(session, canvas, Rect(place.x + 10, place.y + place.h - SIGN_H, place.w - 20, SIGN_H - 8), name)
    if button.enabled:
        canvas.dot(place.x + 30, view.y + view.h - 22, 15, PALETTE["red"] if focused else PALETTE["teal"])
        canvas.text(place.x + 30, view.y + view.h - 33, button.key, 17, PALETTE["white"], font="bold", align="center")


_PLAIN = ("#8A5538", "#FFF2D8", "#6E4034")


def _draw_awning(canvas: Canvas, place: Rect, dark: Colour, light: Colour) -> None:
    count = 8
    width = place.w / count
    canvas.panel(Rect(place.x, place.y + 6, place.w, place.h - 8), fade(PALETTE["shade"], 0.7), radius=14)
    for i in range(count):
        colour = dark if i % 2 == 0 else light
        canvas.panel(Rect(place.x + i * width, place.y, width, place.h - width / 2), colour, radius=0)
        canvas.panel(Rect(place.x + i * width, place.y + place.h - width, width, width), colour, radius=width / 2)
    canvas.panel(Rect(place.x - 3, place.y - 4, place.w + 6, 12), PALETTE["line"], radius=6)


def _draw_cloth(canvas: Canvas, view: Rect, colour: Colour) -> None:
    canvas.panel(Rect(view.x, view.y + view.h * 0.2, view.w, view.h * 0.8), fade(colour, 0.93), radius=6)
    for i in range(1, 8):
        x = view.x + view.w * i / 8
        canvas.lines([(x, view.y + view.h * 0.22), (x + 5, view.y + view.h - 3)], 3, fade(PALETTE["shade"], 0.5))


def _draw_sign(session: Session, canvas: Canvas, sign: Rect, name: str) -> None:
    s, market, afternoon = session.strings, session.market, session.afternoon
    canvas.panel(sign, hex_colour("FFF3DA"), radius=10, border=2)
    stall = market.stalls.get(name)
    if stall is None:
        why = market.left_out.get(name)
        title = s("setting_up") if why is None else s("not_open")
        canvas.text(sign.x + 16, sign.y + 10, title, 20, INK, font="title")
        words = "" if why is None else s(why.kind, place=why.place)
        canvas.paragraph(Rect(sign.x + 16, sign.y + 40, sign.w - 32, 48), words, 15, PALETTE["faint"])
        return
    script = stall.script
    canvas.text(sign.x + 16, sign.y + 7, script.title.get(s.language), 23, INK, font="title")
    owned = sum(b.stall == name for b in afternoon.bought)
    if owned:
        tag = s("yours_count", count=owned)
        width = canvas.measure(tag, 14, "bold") + 20
        spot = Rect(sign.x + sign.w - width - 12, sign.y + 11, width, 24)
        canvas.panel(spot, PALETTE["teal"], radius=12)
        canvas.text(spot.x + width / 2, spot.y + 3, tag, 14, PALETTE["white"], font="bold", align="center")
    person = script.person.name.get(s.language)
    canvas.paragraph(
        Rect(sign.x + 16, sign.y + 41, sign.w - 32, 50), f"{person} · {remembered(session, name)}", 16, INK
    )


def remembered(session: Session, stall: str) -> str:
    """What the player remembers of a person, in one line."""
    known = session.afternoon.at(stall)
    how = standing(known)
    if how == "unmet":
        return session.strings("met_before" if known.memory is not None else "not_met")
    if known.annoyance > 0:
        return session.strings("left_sore" if how == "sore" else "left_cooling")
    if how == "warm":
        return session.strings("left_warm")
    return session.strings("left_deal" if known.deals else "left_even")
