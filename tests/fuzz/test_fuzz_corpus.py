"""Every reader on its corpus, whole and damaged: it reads, or it refuses in one line."""

from __future__ import annotations

import importlib.util
import random
import sys
from pathlib import Path
from types import ModuleType

import pytest

HERE = Path(__file__).resolve().parent
NAMES = sorted(path.name for path in (HERE / "corpus").iterdir())
MUTANTS = 60
NASTY = (b"\0", b"-", b"1e999", b"nan", b"9" * 30, b"[", b"{", b'"', b"\xff\xfe", b": &a *a")


def _module(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"fuzz_{name}_under_test", HERE / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def readers() -> ModuleType:
    return _module("readers")


@pytest.fixture(scope="module")
def mutators() -> ModuleType:
    return _module("mutators")


def damaged(data: bytes, rng: random.Random) -> bytes:
    """A copy with something cut, doubled, flipped or put in."""
    out = bytearray(data)
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(out) + 1)
        kind = rng.randrange(5)
        if kind == 0:
            del out[at : at + rng.randint(1, 40)]
        elif kind == 1:
            out[at:at] = out[at : at + rng.randint(1, 40)]
        elif kind == 2 and at < len(out):
            out[at] = rng.randrange(256)
        elif kind == 3:
            out[at:at] = rng.choice(
                [b"\0", b"-", b"1e999", b"nan", b"9" * 30, b"[", b"{", b'"', b"\xff\xfe", b": &a *a"]
            )
        else:
            del out[at:]
    return bytes(out)


def test_every_reader_has_a_corpus_and_a_mutator(readers: ModuleType, mutators: ModuleType) -> None:
    assert set(NAMES) == set(readers.READERS) == set(mutators.STRUCTURED)


@pytest.mark.parametrize("name", NAMES)
def test_a_reader_takes_its_good_files_and_survives_damaged_ones(
    readers: ModuleType, mutators: ModuleType, name: str, tmp_path: Path
) -> None:
    rng = random.Random(f"damage {name}")
    for path in sorted((HERE / "corpus" / name).iterdir()):
        data = path.read_bytes()
        assert len(data) <= 20_000, "the corpus stays small"
        taken = readers.feed(name, data, tmp_path)
        if path.name.startswith("good"):
            assert taken, f"{path.name} is a good file"
        if path.name.startswith("good"):
            changed = [mutators.mutate_structure(name, data, 1_000_000, rng.getrandbits(31)) for _ in range(MUTANTS)]
            assert sum(made is not None and made != data for made in changed) > MUTANTS // 2
            for made in [*changed, *(damaged(data, rng) for _ in range(MUTANTS))]:
                if made is not None:
                    readers.feed(name, made, tmp_path)
