"""Compiled loops: what has to be done for every joint of every character in every frame, as WebAssembly.

The C sources of a module stand in the folder of its name beside it: ``game/animation/skin/*.c`` is
``game/animation/skin.wasm``, made by ``run_game.py build compiled``. WebAssembly, because one small file runs on every
machine and every Python, gives the same bits on every processor, is compiled to machine code in milliseconds at load,
and cannot reach anything but its own memory.

A function takes no arguments but a struct in the module's memory: a call from Python costs about as much as a handful
of array operations, whatever it is told.
"""

from __future__ import annotations

import ctypes
import math
import struct
import threading
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import wasmtime
from numpy.typing import DTypeLike, NDArray

from game.core.errors import MissingPart

__all__ = ["Block", "Machine", "compile_ahead"]

_PAGE = 1 << 16
_ALIGN = 64
_CLASSES = 4
"""Sizes of freed memory are rounded up to so many steps between two powers of two, so that blocks are used again."""


@dataclass(frozen=True, eq=False)
class Block:
    """An array in a machine's memory. address: what the compiled side is told; data: what Python sees of it."""

    address: int
    data: NDArray[Any]


class _Lease:
    """Gives a block's room back when the last view of it is gone."""

    __slots__ = ("_address", "_free", "_store")

    def __init__(self, store: wasmtime.Store, free: list[int], address: int) -> None:
        self._store, self._free, self._address = store, free, address

    def __del__(self) -> None:
        self._free.append(self._address)


class Machine:
    """A compiled module with memory of its own, for one thread at a time."""

    def __init__(self, path: Path) -> None:
        """path: the .wasm file. Raises MissingPart where it is not there or cannot run here."""
        engine, module = _compiling(path).module()
        self._store = wasmtime.Store(engine)
        try:
            exports = wasmtime.Instance(self._store, module, []).exports(self._store)
        except wasmtime.WasmtimeError as reason:
            raise MissingPart(f"{path.name} cannot run here: {str(reason).splitlines()[0]}") from None
        self._exports = exports
        memory, base, parameters = exports["memory"], exports["__heap_base"], exports["parameters"]
        assert isinstance(memory, wasmtime.Memory)
        assert isinstance(base, wasmtime.Global)
        assert isinstance(parameters, wasmtime.Global)
        self._memory = memory
        self._origin = ctypes.addressof(memory.data_ptr(self._store).contents)
        self._end = -(-int(base.value(self._store)) // _ALIGN) * _ALIGN
        self._free: dict[int, list[int]] = {}
        # 256 bytes: see parameters in compiled.h.
        self._parameters = (ctypes.c_ubyte * 256).from_address(self._origin + int(parameters.value(self._store)))

    def function(self, name: str, parameters: str) -> Callable[..., None]:
        """An exported function as a callable. parameters: its struct as ``struct`` formats write it, standard sizes:
        I or i for addresses and counts, f for numbers."""
        function = self._exports[name]
        assert isinstance(function, wasmtime.Func)
        write, room = struct.Struct("<" + parameters).pack_into, self._parameters
        enter = _entry(self._store, function)

        def call(*values: float) -> None:
            write(room, 0, *values)
            enter()

        return call

    def block(self, shape: int | Sequence[int], dtype: DTypeLike) -> Block:
        """Room for an array, not cleared. It is free again when the last view of its data is gone."""
        kind = np.dtype(dtype)
        count = shape if isinstance(shape, int) else math.prod(shape)
        size = max(count * kind.itemsize, 1)
        room = _rounded(size)
        free = self._free.setdefault(room, [])
        address = free.pop() if free else self._more(room)
        view: Any = (ctypes.c_ubyte * size).from_address(self._origin + address)
        # The memory, and this room in it, are kept for as long as anybody sees the array.
        view.lease = _Lease(self._store, free, address)
        return Block(address, np.ndarray(shape, dtype=kind, buffer=view))

    def kept(self, array: NDArray[Any], dtype: DTypeLike) -> Block:
        """An array's values, for the compiled side to read: nobody writes to them any more."""
        block = self.block(array.shape, dtype)
        block.data[...] = array
        block.data.setflags(write=False)
        return block

    def _more(self, room: int) -> int:
        address, self._end = self._end, self._end + room
        lacking = self._end - self._memory.data_len(self._store)
        if lacking > 0:
            self._memory.grow(self._store, max(-(-lacking // _PAGE), 16))
        return address


def _entry(store: wasmtime.Store, function: wasmtime.Func) -> Callable[[], None]:
    """A call of a function without arguments and results.

    What the package offers asks for the function's type at every call, which takes ten microseconds of eleven; so this
    is the C function below that, where the package still has it under its name.
    """
    try:
        from wasmtime._bindings import wasm_trap_t, wasmtime_func_call

        context, address = store._context(), ctypes.byref(function._func)
        trapped, failed = wasmtime.Trap._from_ptr, wasmtime.WasmtimeError._from_ptr
    except (ImportError, AttributeError):
        return lambda: function(store)
    trap = ctypes.POINTER(wasm_trap_t)()
    where = ctypes.byref(trap)

    def enter(_kept: wasmtime.Store = store) -> None:  # the context does not keep its store
        nonlocal trap, where
        error = wasmtime_func_call(context, address, None, 0, None, 0, where)
        if trap:
            reason, trap = trap, ctypes.POINTER(wasm_trap_t)()
            where = ctypes.byref(trap)
            raise trapped(reason)
        if error:
            raise failed(error)

    return enter


def _rounded(size: int) -> int:
    """The size of the room for so many bytes: a multiple of _ALIGN."""
    step = max(1 << max(size.bit_length() - _CLASSES.bit_length(), 0), _ALIGN)
    return -(-size // step) * step


class _Compiling(threading.Thread):
    """Makes machine code of a module, beside what goes on meanwhile."""

    def __init__(self, path: Path) -> None:
        super().__init__(daemon=True, name=f"compiling {path.name}")
        config = wasmtime.Config()
        config.memory_may_move = False  # NumPy looks at it: it grows into room that is reserved
        self._path, self._engine = path, wasmtime.Engine(config)
        self._module: wasmtime.Module | None = None
        self._reason = ""
        self.start()

    def run(self) -> None:
        try:
            self._module = wasmtime.Module.from_file(self._engine, str(self._path))
        except (OSError, wasmtime.WasmtimeError) as reason:
            self._reason = str(reason).splitlines()[0]

    def module(self) -> tuple[wasmtime.Engine, wasmtime.Module]:
        """When it is there. Raises MissingPart."""
        self.join()
        if self._module is None:
            raise MissingPart(f"{self._path}: {self._reason}; put it back, or run: run_game.py build compiled")
        return self._engine, self._module


@lru_cache(maxsize=16)
def _compiling(path: Path) -> _Compiling:
    """Once in a process."""
    return _Compiling(path)


def compile_ahead(modules: Iterable[Path]) -> None:
    """Begin with modules that will be wanted soon: a Machine then finds them ready."""
    for path in modules:
        _compiling(path)
