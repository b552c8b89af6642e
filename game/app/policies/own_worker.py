"""The process of an own policy: limits, a few names of a few modules, and nothing that outlasts a talk.

Run by path with ``-I -S``, apart from the game: nothing is imported but the standard library. Lines of JSON come in
(first the source and the limits, then seeds and views with their talk) and go out (moves, or errors).
"""

from __future__ import annotations

import builtins
import contextlib
import dataclasses
import json
import os
import random
import sys
import types
from collections.abc import Iterable, Mapping
from typing import Any

PUBLIC = {
    "collections": ("ChainMap", "Counter", "OrderedDict", "defaultdict", "deque", "namedtuple"),
    "dataclasses": ("dataclass", "field"),
    "functools": ("cache", "cmp_to_key", "lru_cache", "partial", "reduce"),
    "itertools": (),
    "math": (),
    "statistics": (),
}
"""What policies may import, and of it what: all public names where none are given. Whole modules would hand out their
own imports (``dataclasses.sys``), and what copies attributes by name would reach what begins with an underscore."""
AWAY = frozenset({
    "open", "exec", "eval", "compile", "input", "breakpoint", "globals", "locals", "vars", "getattr", "setattr",
    "delattr", "type", "object", "memoryview", "help", "exit", "quit", "print", "id",
})  # fmt: skip
"""Builtins that policies do without."""

_MISSING = object()


def limit(told: Mapping[str, Any]) -> None:
    """Processor, memory, files and processes; where the system has no such limits, none."""
    try:
        import resource
    except ImportError:
        return
    for what, most in (
        ("RLIMIT_CPU", told["cpu_s"]), ("RLIMIT_AS", told["memory"]), ("RLIMIT_FSIZE", 0), ("RLIMIT_NOFILE", 3),
        ("RLIMIT_NPROC", 0), ("RLIMIT_CORE", 0),
    ):  # fmt: skip
        if hasattr(resource, what):
            with contextlib.suppress(ValueError, OSError):
                resource.setrlimit(getattr(resource, what), (most, most))


def public(name: str) -> dict[str, Any]:
    """What a policy sees of a module; never a module."""
    real = __import__(name)
    names: Iterable[str] = PUBLIC[name] or getattr(real, "__all__", None) or dir(real)
    found = {key: getattr(real, key) for key in names if key[0] != "_"}
    return {key: value for key, value in found.items() if not isinstance(value, types.ModuleType)}


class Unchanged:
    """Restores what a policy could hang something on: classes and functions written in Python."""

    def __init__(self, things: Iterable[Any]) -> None:
        self._kept: list[tuple[Any, dict[str, Any]]] = []
        waiting, seen = list(things), set[int]()
        while waiting:
            thing = waiting.pop()
            python = isinstance(thing, types.FunctionType) or (isinstance(thing, type) and thing.__flags__ & (1 << 9))
            if not python or id(thing) in seen:
                continue
            seen.add(id(thing))
            self._kept.append((thing, dict(vars(thing))))
            if isinstance(thing, type):
                waiting += [getattr(value, "__func__", value) for value in vars(thing).values()]

    def restore(self) -> None:
        """As it was."""
        for thing, before in self._kept:
            now = vars(thing)
            for name in [name for name in now if name not in before]:
                delattr(thing, name)
            for name, value in before.items():
                if now.get(name, _MISSING) is not value:
                    setattr(thing, name, value)


class Policy:
    """A checked source; every talk runs it anew. Talks may be played side by side, and know nothing of each other."""

    def __init__(self, source: str) -> None:
        self.code = compile(source, "policy", "exec")
        self.modules = {name: public(name) for name in PUBLIC}
        self.unchanged = Unchanged(value for module in self.modules.values() for value in module.values())
        self.talks: dict[int, _Talk] = {}

    def begin(self, talk: int, seed: int) -> None:
        """A new talk: nothing of another is left, so that no result depends on who played it."""
        self.unchanged.restore()
        shown: dict[str, types.SimpleNamespace] = {}

        def limited(
            name: str, globals: object = None, locals: object = None, fromlist: tuple[str, ...] = (), level: int = 0
        ) -> types.SimpleNamespace:
            if level or name not in self.modules:
                raise ImportError(name)
            if name not in shown:
                shown[name] = types.SimpleNamespace(**self.modules[name])
            return shown[name]

        safe = {name: value for name, value in vars(builtins).items() if name not in AWAY and name[0] != "_"}
        safe |= {"__import__": limited, "__build_class__": builtins.__build_class__}
        begun = self.talks[talk] = _Talk({"__builtins__": safe, "__name__": "policy"}, {}, random.Random(seed))
        try:
            exec(self.code, begun.space)
        except BaseException as error:
            begun.broken = _told(error)

    def move(self, talk: int, view: Any) -> dict[str, Any]:
        """What the file answers, or an error."""
        own = self.talks[talk]
        if own.broken:
            return own.broken
        self.unchanged.restore()
        try:
            answer = own.space["move"](view, own.memory, own.rng)
            return answer if isinstance(answer, dict) else {"error": f"move gave {answer!r}"[:200]}
        except BaseException as error:  # SystemExit among them
            return _told(error)


@dataclasses.dataclass
class _Talk:
    space: dict[str, Any]
    memory: dict[Any, Any]
    rng: random.Random
    broken: dict[str, Any] = dataclasses.field(default_factory=dict)


def _told(error: BaseException) -> dict[str, Any]:
    """The error, and the last line of the file it came by."""
    told: dict[str, Any] = {"error": f"{type(error).__name__}: {error}"[:200]}
    trace = error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == "policy":
            told["line"] = trace.tb_lineno
        trace = trace.tb_next
    return told


def main() -> None:
    """Answer until nobody asks."""
    first = json.loads(sys.stdin.readline())
    for name in PUBLIC:
        __import__(name)
    limit(first)
    policy, told_most = Policy(first["source"]), first["answer"]
    for line in sys.stdin:
        message = json.loads(line)
        for over in message["over"]:
            policy.talks.pop(over, None)
        if "seed" in message:
            policy.begin(message["talk"], message["seed"])
            continue
        answer = policy.move(message["talk"], message["view"])
        try:
            told = json.dumps(answer)
            if len(told) >= told_most:
                told = json.dumps({"error": f"an answer of {len(told)} characters"})
        except (TypeError, ValueError, RecursionError) as error:
            told = json.dumps({"error": f"{type(error).__name__}: {error}"[:200]})
        sys.stdout.write(told + "\n")
        sys.stdout.flush()
    # A worker of a pool ends without a word, and with it who would clear this away.
    with contextlib.suppress(OSError):
        os.rmdir(os.getcwd())


if __name__ == "__main__":
    main()
