"""Dear ImGui on moderngl and pygame: textures, triangles, events. The only place that knows how ImGui is drawn.

Needs imgui-bundle (the `tools` extra).
"""

from __future__ import annotations

import ctypes
from typing import Any

import moderngl
import numpy as np
import pygame
from imgui_bundle import imgui
from numpy.typing import NDArray

__all__ = ["ImguiBackend", "ImguiTexture"]

_VERTEX = """
#version 330
uniform vec2 screen;
in vec2 position;
in vec2 uv;
in vec4 colour;
out vec2 at;
out vec4 tint;
void main() {
    at = uv;
    tint = colour;
    gl_Position = vec4(2.0 * position.x / screen.x - 1.0, 1.0 - 2.0 * position.y / screen.y, 0.0, 1.0);
}
"""
_FRAGMENT = """
#version 330
uniform sampler2D picture;
in vec2 at;
in vec4 tint;
out vec4 colour;
void main() { colour = tint * texture(picture, at); }
"""

_NAMED = {
    "LEFT": "left_arrow", "RIGHT": "right_arrow", "UP": "up_arrow", "DOWN": "down_arrow", "PAGEUP": "page_up",
    "PAGEDOWN": "page_down", "HOME": "home", "END": "end", "INSERT": "insert", "DELETE": "delete",
    "BACKSPACE": "backspace", "SPACE": "space", "RETURN": "enter", "KP_ENTER": "keypad_enter", "ESCAPE": "escape",
    "TAB": "tab", "LCTRL": "left_ctrl", "RCTRL": "right_ctrl", "LALT": "left_alt", "RALT": "right_alt",
    "LSHIFT": "left_shift", "RSHIFT": "right_shift", "LSUPER": "left_super", "RSUPER": "right_super",
}  # fmt: skip
_BUTTONS = {1: 0, 2: 2, 3: 1}  # pygame's left, middle, right


def _keys() -> dict[int, Any]:
    keys = {getattr(pygame, f"K_{ours}"): getattr(imgui.Key, theirs) for ours, theirs in _NAMED.items()}
    # ImGui knows the letters of its own shortcuts (copy, paste, undo) by key, not by what they type.
    return keys | {getattr(pygame, f"K_{c}"): getattr(imgui.Key, c) for c in "abcdefghijklmnopqrstuvwxyz"}


class ImguiTexture:
    """A picture that ImGui can show, (h, w, 3) or (h, w, 4) uint8, first row at the top, smooth when smaller."""

    def __init__(self, backend: ImguiBackend, pixels: NDArray[np.uint8]) -> None:
        height, width = pixels.shape[:2]
        if pixels.shape[2] == 3:
            pixels = np.dstack([pixels, np.full((height, width), 255, np.uint8)])
        self._backend = backend
        self.size = (width, height)
        self._texture = backend.context.texture((width, height), 4, np.ascontiguousarray(pixels).tobytes())
        self._texture.build_mipmaps()
        self._texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
        backend.register(self._texture)
        self.ref = imgui.ImTextureRef(self._texture.glo)

    def write(self, pixels: NDArray[np.uint8]) -> None:
        """Another picture of the same size, (h, w, 3) uint8."""
        filled = np.dstack([pixels, np.full(pixels.shape[:2], 255, np.uint8)])
        self._texture.write(np.ascontiguousarray(filled).tobytes())
        self._texture.build_mipmaps()

    def release(self) -> None:
        """Give the texture back; it must not be shown any more."""
        self._backend.forget(self._texture)
        self._texture.release()


class ImguiBackend:
    """One ImGui context on one pygame window. ``feed`` events, ``begin``, draw with ImGui, ``end``."""

    def __init__(self, context: moderngl.Context) -> None:
        self.context = context
        imgui.create_context()
        self._io = imgui.get_io()
        self._io.set_ini_filename("")  # nothing is remembered in a file of whatever folder this runs in
        self._io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
        limit = int(context.info["GL_MAX_TEXTURE_SIZE"])
        platform = imgui.get_platform_io()
        platform.renderer_texture_max_width = platform.renderer_texture_max_height = limit
        self._keys = _keys()
        self._textures: dict[int, moderngl.Texture] = {}
        self._owned: dict[int, moderngl.Texture] = {}
        self._program = context.program(vertex_shader=_VERTEX, fragment_shader=_FRAGMENT)
        self._vertices = context.buffer(reserve=1 << 18, dynamic=True)
        self._indices = context.buffer(reserve=1 << 16, dynamic=True)
        self._array = self._make_array()

    def _make_array(self) -> moderngl.VertexArray:
        return self.context.vertex_array(
            self._program,
            [(self._vertices, "2f 2f 4f1", "position", "uv", "colour")],
            self._indices,
            index_element_size=imgui.INDEX_SIZE,
        )

    # -- textures ----------------------------------------------------------------------------------------------------

    def register(self, texture: moderngl.Texture) -> None:
        """Make a texture known by its GL name."""
        self._textures[texture.glo] = texture

    def forget(self, texture: moderngl.Texture) -> None:
        """The texture is about to go."""
        self._textures.pop(texture.glo, None)

    def _update_textures(self) -> None:
        """What ImGui wants of its own textures (the font atlas grows as characters are met)."""
        status = imgui.ImTextureStatus
        for wanted in imgui.get_platform_io().textures:
            if wanted.status == status.want_create:
                pixels = np.asarray(wanted.get_pixels_array(), dtype=np.uint8)
                texture = self.context.texture((wanted.width, wanted.height), 4, pixels.tobytes())
                texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
                self._owned[texture.glo] = texture
                self.register(texture)
                wanted.set_tex_id(texture.glo)
                wanted.status = status.ok
            elif wanted.status == status.want_updates:
                pixels = np.asarray(wanted.get_pixels_array(), dtype=np.uint8)
                pixels = pixels.reshape(wanted.height, wanted.width, wanted.bytes_per_pixel)
                for r in wanted.updates:
                    piece = np.ascontiguousarray(pixels[r.y : r.y + r.h, r.x : r.x + r.w])
                    self._textures[wanted.get_tex_id()].write(piece.tobytes(), viewport=(r.x, r.y, r.w, r.h))
                wanted.status = status.ok
            elif wanted.status == status.want_destroy:
                texture = self._owned.pop(wanted.get_tex_id())
                self.forget(texture)
                texture.release()
                wanted.set_tex_id(0)
                wanted.status = status.destroyed

    # -- events ------------------------------------------------------------------------------------------------------

    def feed(self, event: pygame.event.Event, pixel_ratio: float = 1.0) -> None:
        """Tell ImGui of an event. ``pixel_ratio``: device pixels per window pixel."""
        io = self._io
        if event.type == pygame.MOUSEMOTION:
            io.add_mouse_pos_event(event.pos[0] * pixel_ratio, event.pos[1] * pixel_ratio)
        elif event.type in {pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP} and event.button in _BUTTONS:
            io.add_mouse_pos_event(event.pos[0] * pixel_ratio, event.pos[1] * pixel_ratio)
            io.add_mouse_button_event(_BUTTONS[event.button], event.type == pygame.MOUSEBUTTONDOWN)
        elif event.type == pygame.MOUSEWHEEL:
            io.add_mouse_wheel_event(float(event.x), float(event.y))
        elif event.type in {pygame.KEYDOWN, pygame.KEYUP}:
            for held, key in (
                (pygame.KMOD_CTRL, imgui.Key.mod_ctrl),
                (pygame.KMOD_SHIFT, imgui.Key.mod_shift),
                (pygame.KMOD_ALT, imgui.Key.mod_alt),
                (pygame.KMOD_META, imgui.Key.mod_super),
            ):
                io.add_key_event(key, bool(event.mod & held))
            if event.key in self._keys:
                io.add_key_event(self._keys[event.key], event.type == pygame.KEYDOWN)
        elif event.type == pygame.TEXTINPUT:
            io.add_input_characters_utf8(event.text)
        elif event.type == pygame.WINDOWFOCUSLOST:
            io.add_focus_event(False)
        elif event.type == pygame.WINDOWFOCUSGAINED:
            io.add_focus_event(True)

    @property
    def typing(self) -> bool:
        """Whether the keys belong to a text field now."""
        return bool(self._io.want_text_input)

    # -- frames ------------------------------------------------------------------------------------------------------

    def begin(self, size: tuple[int, int], elapsed_s: float) -> None:
        """Start a frame of so many device pixels."""
        self._io.display_size = imgui.ImVec2(float(size[0]), float(size[1]))
        self._io.delta_time = min(max(elapsed_s, 1e-4), 0.25)
        imgui.new_frame()

    def end(self, size: tuple[int, int]) -> None:
        """Draw the frame into the bound framebuffer."""
        imgui.render()
        self._update_textures()
        context = self.context
        context.enable_only(moderngl.BLEND)
        context.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        self._program["screen"] = (float(size[0]), float(size[1]))
        for commands in imgui.get_draw_data().cmd_lists:
            self._draw(commands, size)
        context.scissor = None

    def _draw(self, commands: Any, size: tuple[int, int]) -> None:
        vertices, indices = commands.vtx_buffer, commands.idx_buffer
        self._upload(
            ctypes.string_at(vertices.data_address(), vertices.size() * imgui.VERTEX_SIZE),
            ctypes.string_at(indices.data_address(), indices.size() * imgui.INDEX_SIZE),
        )
        for command in commands.cmd_buffer:
            left, top, right, bottom = (round(v) for v in command.clip_rect)
            left, top, right, bottom = max(left, 0), max(top, 0), min(right, size[0]), min(bottom, size[1])
            texture = self._textures.get(command.tex_ref.get_tex_id())
            if right <= left or bottom <= top or texture is None:
                continue
            texture.use(0)
            self.context.scissor = (left, size[1] - bottom, right - left, bottom - top)
            self._array.render(moderngl.TRIANGLES, vertices=command.elem_count, first=command.idx_offset)

    def _upload(self, vertices: bytes, indices: bytes) -> None:
        if len(vertices) > self._vertices.size or len(indices) > self._indices.size:
            for thing in (self._array, self._vertices, self._indices):
                thing.release()
            self._vertices = self.context.buffer(reserve=2 * len(vertices), dynamic=True)
            self._indices = self.context.buffer(reserve=2 * len(indices), dynamic=True)
            self._array = self._make_array()
        self._vertices.orphan()
        self._vertices.write(vertices)
        self._indices.orphan()
        self._indices.write(indices)

    def release(self) -> None:
        """End the ImGui context and give its GL objects back."""
        for texture in imgui.get_platform_io().textures:
            texture.set_tex_id(0)
            texture.status = imgui.ImTextureStatus.destroyed
        for owned in self._owned.values():
            owned.release()
        for thing in (self._array, self._vertices, self._indices, self._program):
            thing.release()
        self._io.backend_flags &= ~imgui.BackendFlags_.renderer_has_textures
        imgui.destroy_context()
