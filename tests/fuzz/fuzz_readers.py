"""Coverage-guided fuzzing of every reader (extra ``fuzz``):

    python tests/fuzz/fuzz_readers.py bvh -max_total_time=300
    python tests/fuzz/fuzz_readers.py vrm -runs=100000 /tmp/more_corpus

What is found lies as crash-… in the present folder; put it, made small, into tests/fuzz/corpus/READER, where
tests/fuzz/test_fuzz_corpus.py reads it ever after.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import atheris

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

with atheris.instrument_imports(include=["game"]):
    from readers import READERS, feed, scratch

from mutators import mutate_structure  # noqa: E402 - a mutator is no part of what is measured

STRUCTURED_SHARE = 6
"""So many of ten changes are made to what a file says, the others to its bytes."""


def mutator(name: str) -> Callable[[bytes, int, int], bytes]:
    """libFuzzer's custom mutator for a reader: what a file says is changed, or its bytes."""

    def mutate(data: bytes, max_size: int, seed: int) -> bytes:
        made = mutate_structure(name, data, max_size, seed) if seed % 10 < STRUCTURED_SHARE else None
        return bytes(atheris.Mutate(data, max_size)) if made is None else made

    return mutate


def main() -> None:
    if len(sys.argv) < 2 or sys.argv[1] not in READERS:
        sys.exit(f"usage: fuzz_readers.py {'|'.join(READERS)} [libFuzzer options]")
    name, folder = sys.argv.pop(1), scratch()
    new = scratch()  # libFuzzer keeps what it finds in the first folder: the small corpus stays small
    seeds = [str(new), str(HERE / "corpus" / name)]
    atheris.Setup([*sys.argv, *seeds], lambda data: feed(name, data, folder), custom_mutator=mutator(name))
    atheris.Fuzz()


if __name__ == "__main__":
    main()
