"""Pictures of faces for the authoring window, drawn a few per frame so that dragging stays smooth."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from time import perf_counter

from game.face import INDEX, Face, Parts
from game.tools.face.author import Change
from game.tools.face.heads import HeadStudio
from game.tools.windows.imgui_backend import ImguiBackend, ImguiTexture

__all__ = ["Gallery"]

BUDGET_S = 0.03
KEPT = 300


class Gallery:
    """Face -> texture. What is not there yet is drawn in the order it was asked for, as far as a frame's time goes."""

    def __init__(
        self, backend: ImguiBackend, studio: HeadStudio, parts: Parts, clock: Callable[[], float] = perf_counter
    ) -> None:
        self._backend, self._studio, self._parts, self._clock = backend, studio, parts, clock
        self._pictures: OrderedDict[tuple[Face, Change], ImguiTexture] = OrderedDict()
        self._asked: dict[tuple[Face, Change], None] = {}

    def get(self, face: Face, change: Change = ()) -> ImguiTexture | None:
        """The picture, or None while it waits to be drawn; change: numbers beyond those of the parts."""
        key = (face, change)
        picture = self._pictures.get(key)
        if picture is None:
            self._asked[key] = None
        else:
            self._pictures.move_to_end(key)
        return picture

    def work(self) -> bool:
        """Draw what the last frame asked for: one at least, more while the budget lasts. True where some is left."""
        end = self._clock() + BUDGET_S
        for key in list(self._asked):
            face, change = key
            params = self._parts.params(self._parts.numbers(face)).copy()
            for name, value in change:
                params[INDEX[name]] = value
            self._pictures[key] = ImguiTexture(self._backend, self._studio.draw(params))
            del self._asked[key]
            if self._clock() > end:
                break
        left = bool(self._asked)
        self._asked.clear()  # the next frame asks for what it still shows
        while len(self._pictures) > KEPT:
            self._pictures.popitem(last=False)[1].release()
        return left

    def release(self) -> None:
        """Give all textures back."""
        while self._pictures:
            self._pictures.popitem()[1].release()
