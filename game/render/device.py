"""The GL device: a headless one through EGL or a window of pygame; programs from shader files; owned GL objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from ctypes.util import find_library
from typing import Any, Protocol, TypeVar, cast

import moderngl
import numpy as np
from numpy.typing import NDArray

from game.core.errors import MissingPart
from game.render.shader_source import ShaderError, explain_log, load_stage

__all__ = ["PREMULTIPLIED", "Device", "LostContext", "Owner", "Releasable", "layout", "set_uniforms"]

PREMULTIPLIED = (moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA)  # the blend function of everything translucent


class Releasable(Protocol):
    """Anything that holds GL objects."""

    def release(self) -> Any: ...


_R = TypeVar("_R", bound=Releasable)


class Owner:
    """Keeps GL objects and releases them together, last made first."""

    def __init__(self) -> None:
        self._owned: list[Releasable] = []

    def own(self, item: _R) -> _R:
        self._owned.append(item)
        return item

    def release(self) -> None:
        while self._owned:
            self._owned.pop().release()


class LostContext(MissingPart):
    """The GL context is gone: a driver that was reset, a display that went away."""


class Device:
    """A GL 3.3+ context and where its pictures go. All sizes are device pixels."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int], *, windowed: bool) -> None:
        self.context = context
        self.size = size
        self.windowed = windowed
        info = context.info
        self.name = f"{info['GL_RENDERER']}"
        # Software rasterisers pay for every vertex and pixel; a few choices (who selects silhouettes) depend on it.
        self.software = any(word in self.name.lower() for word in ("llvmpipe", "softpipe", "swiftshader", "software"))
        self.max_samples = min(4, int(info.get("GL_MAX_SAMPLES", 4)))
        pixel = context.renderbuffer((1, 1))
        # Bound where nothing is drawn: GL wants a complete framebuffer even for transform feedback, which EGL without
        # a surface does not have, and the bound one must not be released.
        self.nowhere = context.framebuffer([pixel])
        self._pixel = pixel
        self._pulse = context.buffer(b"here")

    @classmethod
    def headless(cls, width: int, height: int) -> Device:
        """A device without a window, through EGL. Raises MissingPart, in one line, where EGL is not to be had."""
        try:
            # Without libGL, EGL itself hands out every function: libegl1 and a driver are enough.
            options: dict[str, Any] = {"backend": "egl", "libgl": find_library("GL") or find_library("EGL")}
            context = moderngl.create_context(require=330, standalone=True, **options)
        except Exception as error:  # glcontext raises whatever the loader met: ImportError, OSError, its own Exception
            reason = " ".join(str(error).split())[:120]
            raise MissingPart(
                f"no OpenGL without a window ({reason}); install EGL and a software rasteriser: "
                "apt-get install libegl1 libgl1-mesa-dri"
            ) from error
        return cls(context, (width, height), windowed=False)

    @classmethod
    def window(
        cls, width: int, height: int, title: str = "", *, vsync: bool = True, fullscreen: bool = False
    ) -> Device:
        """A device on a new pygame window (the caller owns the event loop and has called ``pygame.display.init``).

        Raises MissingPart, in one line, where no OpenGL window can be opened.
        """
        import pygame

        try:
            for attribute, value in (
                (pygame.GL_CONTEXT_MAJOR_VERSION, 4),
                (pygame.GL_CONTEXT_MINOR_VERSION, 1),  # the most macOS has
                (pygame.GL_CONTEXT_PROFILE_MASK, pygame.GL_CONTEXT_PROFILE_CORE),
                (pygame.GL_CONTEXT_FLAGS, pygame.GL_CONTEXT_FORWARD_COMPATIBLE_FLAG),
                (pygame.GL_DEPTH_SIZE, 0),  # the frame is finished off screen; the window only shows it
                (pygame.GL_MULTISAMPLESAMPLES, 0),
            ):
                pygame.display.gl_set_attribute(attribute, value)
            flags = pygame.OPENGL | pygame.DOUBLEBUF | pygame.RESIZABLE
            if fullscreen:
                flags |= pygame.FULLSCREEN
            try:
                pygame.display.set_mode((width, height), flags, vsync=int(vsync))
            except pygame.error:  # some drivers refuse vsync
                pygame.display.set_mode((width, height), flags)
            pygame.display.set_caption(title)
            context = moderngl.create_context(require=330)
        except Exception as error:  # pygame.error without a display, glcontext's own Exception without a driver
            reason = " ".join(str(error).split())[:120]
            raise MissingPart(
                f"no OpenGL window ({reason}); install a graphics driver with OpenGL 3.3 (Mesa: libgl1-mesa-dri)"
            ) from error
        return cls(context, pygame.display.get_window_size(), windowed=True)

    def ensure_alive(self) -> None:
        """Raises LostContext where the context is gone. GL itself would not tell: without a context its calls do
        nothing, report no error, and what is read back is whatever lay in memory."""
        try:
            alive = self._pulse.read() == b"here"
        except moderngl.Error:
            alive = False
        if not alive:
            raise LostContext("the graphics context was lost; start the program again")

    def resize(self, width: int, height: int) -> None:
        """Tell the device that its window, or the wanted picture, has another size."""
        self.size = (max(1, width), max(1, height))

    def program(
        self,
        vertex: str,
        fragment: str | None = None,
        geometry: str | None = None,
        *,
        defines: Mapping[str, str | int | float] | None = None,
        varyings: Sequence[str] = (),
    ) -> moderngl.Program:
        """Compile a program from shader files. Raises ShaderError with file:line.

        ``varyings`` are captured by transform feedback, each into a buffer of its own.
        """
        given = dict(defines or {})
        files: list[str] = []
        stages: dict[str, Any] = {}
        used: set[str] = set()
        for key, name in (("vertex_shader", vertex), ("geometry_shader", geometry), ("fragment_shader", fragment)):
            if name is not None:
                source = load_stage(name, given, files)
                stages[key] = source.text
                used |= source.used
        unused = sorted(set(given) - used)
        if unused:
            raise ShaderError(f"{files[0]}: no file of this program needs the define {unused[0]}")
        try:
            program = self.context.program(**stages, varyings=tuple(varyings), varyings_capture_mode="separate")
        except moderngl.Error as error:
            raise ShaderError(explain_log(str(error), files)) from error
        for block, binding in (("Frame", 0), ("Joints", 1)):
            if block in program:
                cast(moderngl.UniformBlock, program[block]).binding = binding
        return program

    def vertex_array(
        self, program: moderngl.Program, entries: Sequence[tuple[Any, ...]], index: moderngl.Buffer | None = None
    ) -> moderngl.VertexArray:
        """A vertex array of ``layout`` entries; those of which the program uses nothing are left out."""
        return self.context.vertex_array(program, [entry for entry in entries if len(entry) > 2], index)

    def release(self) -> None:
        self.nowhere.release()
        self._pixel.release()
        self._pulse.release()
        self.context.release()


def set_uniforms(program: moderngl.Program, **values: float | tuple[float, ...] | NDArray[np.floating]) -> None:
    """Set uniforms by name; matrices are (r, c) arrays as written on paper. A name the compiler dropped is skipped."""
    for name, value in values.items():
        uniform = program.get(name, None)
        if not isinstance(uniform, moderngl.Uniform):
            continue
        if isinstance(value, np.ndarray):
            uniform.write(np.ascontiguousarray(value.T if value.ndim == 2 else value, dtype=np.float32))
        else:
            uniform.value = value


def layout(program: moderngl.Program, buffer: moderngl.Buffer, **formats: str) -> tuple[Any, ...]:
    """A vertex array entry for one interleaved buffer: attribute name -> moderngl format, in the buffer's order.

    Attributes the compiler dropped become padding; names that start with ``_`` always are. A ``/i`` after a format
    advances the attribute per instance.
    """
    sizes = {"f": 4, "i": 4, "u": 4, "f1": 1, "u1": 1, "x": 1}
    parts, names, rate = [], [], ""
    for name, text in formats.items():
        kind, _, per = text.partition("/")
        rate = f"/{per}" if per else rate
        if name.startswith("_") or name not in program:
            parts.append(f"{int(kind[0]) * sizes[kind[1:]]}x")
        else:
            parts.append(kind)
            names.append(name)
    return (buffer, " ".join(parts) + (" " + rate if rate else ""), *names)
