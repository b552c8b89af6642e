"""How long each pass of a frame takes: on the GPU by timer queries where there is one, on the CPU everywhere."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

import moderngl

from game.render.device import Device

__all__ = ["PASSES", "FrameTimes"]

PASSES = ("bake", "crowd", "face", "skin", "life", "person", "output", "interface")
_SMOOTH = 0.08
_RING = 4  # frames until a query is read: by then its answer is there and nobody waits for it


class FrameTimes:
    """Smoothed milliseconds by pass. Costs nothing while ``on`` is False.

    cpu_ms: time spent giving orders, and on a software rasteriser part of the drawing; gpu_ms: empty without a GPU.
    """

    def __init__(self, device: Device) -> None:
        self.on = False
        self.cpu_ms: dict[str, float] = {}
        self.gpu_ms: dict[str, float] = {}
        self._context = device.context
        self._has_gpu = not device.software
        self._queries: dict[tuple[str, int], moderngl.Query] = {}
        self._asked: set[tuple[str, int]] = set()
        self._frame = 0

    def next_frame(self) -> None:
        """A frame begins."""
        self._frame = (self._frame + 1) % _RING

    @contextmanager
    def measured(self, name: str) -> Iterator[None]:
        """Measure what happens inside as the pass ``name``; passes do not nest."""
        if not self.on:
            yield
            return
        start = perf_counter()
        if self._has_gpu:
            with self._query(name):
                yield
        else:
            yield
        self._add(self.cpu_ms, name, (perf_counter() - start) * 1e3)

    def _query(self, name: str) -> moderngl.Query:
        key = (name, self._frame)
        if key not in self._queries:
            self._queries[key] = self._context.query(time=True)
        elif key in self._asked:
            self._add(self.gpu_ms, name, self._queries[key].elapsed * 1e-6)
        self._asked.add(key)
        return self._queries[key]

    @staticmethod
    def _add(table: dict[str, float], name: str, value: float) -> None:
        before = table.get(name, 0.0)  # from nothing: the first time a pass runs it builds what it needs
        table[name] = before + (value - before) * _SMOOTH
