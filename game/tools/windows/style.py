"""Fonts and colours of the tools' windows: the game's own."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from imgui_bundle import imgui

from game.core import MissingPart

__all__ = ["FONT_SIZE", "Fonts", "colour", "load_fonts", "set_style"]

FONT_SIZE = 20.0
_COLOURS = {
    "ink": "3B1A1C",
    "faint": "8A6A5C",
    "line": "6E4034",
    "red": "C23A2D",
    "blue": "34608A",
    "green": "2F7D4F",
    "blank": "EADFC8",
    "paper": "FFFDF6",
    "chosen": "F7D79A",
}


@dataclass(frozen=True)
class Fonts:
    """ImGui's fonts; sizes are chosen where they are used."""

    body: imgui.ImFont
    bold: imgui.ImFont


def load_fonts() -> Fonts:
    """The interface's fonts. Raises MissingPart where their package is not installed."""
    spec = find_spec("font_source_sans_pro")
    folder = Path(next(iter(spec.submodule_search_locations or [""]))) if spec is not None else Path()
    files = [next(iter(sorted(folder.rglob(f"*Pro-{weight}.ttf"))), None) for weight in ("Regular", "Semibold")]
    if spec is None or files[0] is None or files[1] is None:
        raise MissingPart("no interface font; install it: pip install font-source-sans-pro")
    fonts = imgui.get_io().fonts
    body, bold = (fonts.add_font_from_file_ttf(str(path), FONT_SIZE) for path in files)
    return Fonts(body, bold)


def _vector(code: str, alpha: float = 1.0) -> imgui.ImVec4:
    return imgui.ImVec4(int(code[0:2], 16) / 255, int(code[2:4], 16) / 255, int(code[4:6], 16) / 255, alpha)


@cache
def colour(name: str, alpha: float = 1.0) -> int:
    """A named colour, packed as ImGui's draw lists want it."""
    return int(imgui.color_convert_float4_to_u32(_vector(_COLOURS[name], alpha)))


def set_style() -> None:
    """Warm paper instead of ImGui's grey."""
    imgui.style_colors_light()
    style = imgui.get_style()
    style.frame_rounding, style.frame_border_size = 5.0, 1.0
    style.popup_rounding = style.grab_rounding = style.tab_rounding = 5.0
    style.window_padding = imgui.ImVec2(8.0, 6.0)
    slots = imgui.Col_
    for slot, code in (
        (slots.text, "3B1A1C"),
        (slots.text_disabled, "A8988C"),
        (slots.border, "B79C8A"),
        (slots.frame_bg, "FFFDF6"),
        (slots.frame_bg_hovered, "FFF1CF"),
        (slots.frame_bg_active, "FFE9BF"),
        (slots.popup_bg, "FFFDF6"),
        (slots.window_bg, "FFFDF6"),
        (slots.button, "FFFDF6"),
        (slots.button_hovered, "FFE9BF"),
        (slots.button_active, "F7D79A"),
        (slots.check_mark, "2A7B78"),
        (slots.slider_grab, "2A7B78"),
        (slots.slider_grab_active, "1D5A58"),
        (slots.header, "FFE9BF"),
        (slots.header_hovered, "FFF1CF"),
        (slots.header_active, "F7D79A"),
        (slots.tab, "EADFC8"),
        (slots.tab_hovered, "FFE9BF"),
        (slots.tab_selected, "F7D79A"),
        (slots.tab_selected_overline, "C23A2D"),
        (slots.table_header_bg, "EADFC8"),
        (slots.table_row_bg_alt, "F8F1E2"),
        (slots.title_bg, "EADFC8"),
        (slots.title_bg_active, "F7D79A"),
        (slots.separator, "D9C8B4"),
        (slots.scrollbar_bg, "FBF4E3"),
        (slots.scrollbar_grab, "D9C8B4"),
        (slots.text_selected_bg, "F7D79A"),
    ):
        style.set_color_(slot, _vector(code))
