"""Loops compiled to WebAssembly: memory that Python sees, calls, and what happens where a module is missing."""

from __future__ import annotations

import gc
import importlib.util
import weakref
from pathlib import Path

import numpy as np
import pytest
import wasmtime
from wasmtime import _bindings

from game.core.compiled import Machine, compile_ahead
from game.core.errors import MissingPart
from game.core.paths import ROOT
from game.tools.compiling import compile_module, sources

# double(count, from, to): what the C sources of a package come down to.
SOURCE = """
(module
  (memory (export "memory") 1)
  (global (export "parameters") i32 (i32.const 1024))
  (global (export "__heap_base") i32 (i32.const 2000))
  (func (export "double") (local $at i32) (local $end i32) (local $to i32)
    (local.set $at (i32.load (i32.const 1028)))
    (local.set $to (i32.load (i32.const 1032)))
    (local.set $end (i32.add (local.get $at) (i32.mul (i32.load (i32.const 1024)) (i32.const 4))))
    (block $done (loop $next
      (br_if $done (i32.ge_u (local.get $at) (local.get $end)))
      (f32.store (local.get $to) (f32.mul (f32.load (local.get $at)) (f32.const 2)))
      (local.set $at (i32.add (local.get $at) (i32.const 4)))
      (local.set $to (i32.add (local.get $to) (i32.const 4)))
      (br $next)))))
"""


@pytest.fixture
def machine(tmp_path: Path) -> Machine:
    path = tmp_path / "double.wasm"
    path.write_bytes(wasmtime.wat2wasm(SOURCE))
    return Machine(path)


def test_a_call_reads_and_writes_what_python_sees(machine: Machine) -> None:
    double = machine.function("double", "III")
    given = machine.kept(np.arange(12.0).reshape(3, 4), np.float32)
    found = machine.block((3, 4), np.float32)
    double(12, given.address, found.address)
    assert np.array_equal(found.data, 2.0 * np.arange(12.0).reshape(3, 4))
    with pytest.raises(ValueError, match="read-only"):
        given.data[0] = 1.0


def test_what_goes_wrong_inside_is_raised_and_the_next_call_works(machine: Machine) -> None:
    double = machine.function("double", "III")
    given, found = machine.kept(np.ones(4), np.float32), machine.block(4, np.float32)
    for _ in range(2):
        with pytest.raises(wasmtime.Trap, match="out of bounds"):
            double(4, given.address, 0xFFFFFFF0)
        double(4, given.address, found.address)
        assert (found.data == 2.0).all()


def test_views_stay_where_they_are_while_the_memory_grows(machine: Machine) -> None:
    first = machine.kept(np.ones(100), np.float32)
    large = [machine.block(3_000_000, np.float32) for _ in range(4)]
    machine.function("double", "III")(100, first.address, large[-1].address)
    assert (first.data == 1.0).all()
    assert (large[-1].data[:100] == 2.0).all()


def test_room_is_used_again_only_when_nobody_sees_it(machine: Machine) -> None:
    block = machine.block((10, 10), np.float32)
    address, view = block.address, block.data[3]
    del block
    gc.collect()
    assert machine.block((10, 10), np.float32).address != address
    del view
    gc.collect()
    taken = [machine.block((10, 10), np.float32) for _ in range(2)]
    assert address in {block.address for block in taken}


def test_an_array_outlives_its_machine(tmp_path: Path) -> None:
    path = tmp_path / "double.wasm"
    path.write_bytes(wasmtime.wat2wasm(SOURCE))
    machine = Machine(path)
    row = machine.kept(np.arange(6.0).reshape(2, 3), np.float64).data[1]
    del machine
    gc.collect()
    assert row.tolist() == [3.0, 4.0, 5.0]


def test_a_function_outlives_its_machine(tmp_path: Path) -> None:
    path = tmp_path / "double.wasm"
    path.write_bytes(wasmtime.wat2wasm(SOURCE))
    machine = Machine(path)
    double, block = machine.function("double", "III"), machine.kept(np.ones(8), np.float32)
    gone = weakref.ref(machine)
    del machine
    gc.collect()
    assert gone() is None
    double(8, block.address, block.address)
    assert block.data.tolist() == [2.0] * 8


def test_what_a_function_runs_into_is_told(machine: Machine) -> None:
    double, block = machine.function("double", "III"), machine.kept(np.ones(8), np.float32)
    for _ in range(2):
        with pytest.raises(wasmtime.Trap, match="out of bounds"):
            double(8, 1 << 31, block.address)
        double(8, block.address, block.address)
    assert block.data.tolist() == [4.0] * 8


@pytest.mark.parametrize("gone", [(_bindings, "wasmtime_func_call"), (wasmtime.Store, "_context")])
def test_calls_do_not_need_what_the_package_keeps_to_itself(
    machine: Machine, monkeypatch: pytest.MonkeyPatch, gone: tuple[object, str]
) -> None:
    with monkeypatch.context() as lacking:
        lacking.delattr(*gone)
        double = machine.function("double", "III")
    block = machine.kept(np.ones(4), np.float32)
    calls: list[wasmtime.Func] = []
    offered = wasmtime.Func.__call__

    def counted(function: wasmtime.Func, store: wasmtime.Store) -> None:
        calls.append(function)
        offered(function, store)

    monkeypatch.setattr(wasmtime.Func, "__call__", counted)
    double(4, block.address, block.address)
    assert block.data.tolist() == [2.0] * 4
    assert len(calls) == 1
    with pytest.raises(wasmtime.Trap, match="out of bounds"):
        double(4, 1 << 31, block.address)


def test_a_module_that_is_missing_or_broken_is_named_in_one_line(tmp_path: Path) -> None:
    broken = tmp_path / "broken.wasm"
    broken.write_bytes(b"no module")
    for path in (tmp_path / "missing.wasm", broken):
        compile_ahead([path])  # that it cannot be had is told when it is wanted
        with pytest.raises(MissingPart, match="build compiled") as caught:
            Machine(path)
        assert path.name in str(caught.value)
        assert "\n" not in str(caught.value)


def test_every_module_is_made_of_sources_and_every_source_is_in_one() -> None:
    kept = {str(path.relative_to(ROOT)) for path in (ROOT / "game").rglob("*.wasm")}
    assert kept == set(sources())


@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the compiler is of the extra `build`")
@pytest.mark.parametrize("name", sources())
def test_a_module_is_what_its_sources_make(name: str, tmp_path: Path) -> None:
    compile_module(sources()[name], tmp_path / "made.wasm")
    assert (tmp_path / "made.wasm").read_bytes() == (ROOT / name).read_bytes()
