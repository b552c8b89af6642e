"""Own policies: a Python file that answers one function, run in a process of its own with hard limits.

The file says what it wants to see and answers with a choice::

    SEES = "body"                      # table, words, face, body, reader or oracle

    def move(view, memory, rng):
        if "fist" in [name for layer, name in view["quiet"]]:
            return {"choice": "wait"}
        return {"choice": view["table"]["lines"][0]["id"], "offer": 900}

``view`` is plain data (``game.app.policies.views``), ``memory`` a dict that lasts for one talk, ``rng`` a seeded
``random.Random``. What this guards against and what not stands in docs/autoplay.md: it stops mistakes (endless
loops, lost memory, written files), it is no wall against somebody who means harm.
"""

from __future__ import annotations

import ast
import contextlib
import json
import queue
import random
import subprocess
import sys
import tempfile
import threading
import weakref
from dataclasses import asdict
from pathlib import Path
from typing import Any

from game.app.policies import own_worker
from game.app.policies.views import Table, View
from game.app.talk import Choice
from game.core.errors import BadInput, Where
from game.formats.files import decode_utf8, read_bytes

__all__ = ["ALLOWED_IMPORTS", "OwnPolicy"]

ALLOWED_IMPORTS = tuple(own_worker.PUBLIC)
VIEWS = ("table", "words", "face", "body", "reader", "oracle")
MOVE_S = 5.0
"""A single move may take so long …"""
CPU_S = 600
"""… and all of a process together so much of a processor …"""
TALKS = 1000
"""(a process plays so many talks, then another follows) …"""
MEMORY_BYTES = 512 * 1024 * 1024
"""… and so much memory."""
_MAX_BYTES = 200_000
_MAX_ANSWER = 10_000
_FORBIDDEN = own_worker.AWAY
_INSIDE = ("f_", "tb_", "gi_", "cr_", "ag_", "co_")
"""Attributes of frames, tracebacks, generators and code: through them one walks out of the file."""


class OwnPolicy:
    """A checked file; ``sit`` starts its process at the first talk and keeps it."""

    def __init__(self, path: Path, source: str, sees: str) -> None:
        self.path, self.source, self.sees = path, source, sees
        self._process: _Process | None = None

    @staticmethod
    def load(path: Path) -> OwnPolicy:
        """Check a file without running it. Raises BadInput with the line that is not allowed."""
        if not path.is_file():
            raise BadInput("policy", where=Where(path), expected="a Python file that exists", seen="none")
        source = decode_utf8(read_bytes(path, max_bytes=_MAX_BYTES, what="policy"), path)
        try:
            tree = ast.parse(source, str(path))
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            line = error.lineno if isinstance(error, SyntaxError) else None
            raise BadInput(
                "policy", where=Where(str(path), line), expected="Python", seen=str(error) or type(error).__name__
            ) from None
        sees, moves = "", False
        for node in ast.walk(tree):
            _check(node, path)
        for statement in tree.body:
            if isinstance(statement, ast.Assign) and [ast.unparse(target) for target in statement.targets] == ["SEES"]:
                sees = str(statement.value.value) if isinstance(statement.value, ast.Constant) else ""
            moves |= isinstance(statement, ast.FunctionDef) and statement.name == "move"
        if sees not in VIEWS:
            raise BadInput("policy SEES", where=Where(str(path)), expected=" | ".join(VIEWS), seen=sees or "none")
        if not moves:
            raise BadInput("policy", where=Where(str(path)), expected="def move(view, memory, rng)", seen="none")
        return OwnPolicy(path, source, sees)

    def sit(self, rng: random.Random) -> _OwnPlayer:
        """A new talk."""
        if self._process is None or self._process.talks >= TALKS:
            # One that still plays lives as long as its players.
            self._process = _Process(self.path, self.source)
        return _OwnPlayer(self._process, rng.getrandbits(48))


def _check(node: ast.AST, path: Path) -> None:
    wrong = ""
    if isinstance(node, ast.Import | ast.ImportFrom):
        names = [node.module or ""] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names]
        if getattr(node, "level", 0) or any(name not in ALLOWED_IMPORTS for name in names):
            wrong = f"import of {', '.join(names)} (allowed: {', '.join(ALLOWED_IMPORTS)})"
        elif any(alias.name.startswith("_") for alias in node.names):
            wrong = "import of a name that begins with an underscore"
    elif isinstance(node, ast.Name) and (node.id.startswith("__") or node.id in _FORBIDDEN):
        wrong = f"the name {node.id}"
    else:
        # Patterns read attributes too: ``case tuple(__class__=c)``.
        read = [node.attr] if isinstance(node, ast.Attribute) else []
        read += node.kwd_attrs if isinstance(node, ast.MatchClass) else []
        for name in read:
            if name in {"format", "format_map"}:
                wrong = f"the attribute {name} (use f-strings)"
            elif name.startswith(("_", *_INSIDE)):
                wrong = f"the attribute {name}"
    if wrong:
        place = Where(str(path), getattr(node, "lineno", None), getattr(node, "col_offset", 0) + 1)
        raise BadInput(f"{wrong} is not allowed in a policy", where=place)


class _OwnPlayer:
    """One talk; many may be played side by side in one process."""

    def __init__(self, process: _Process, seed: int) -> None:
        self.process = process
        process.talks += 1
        self.talk = process.talks
        process.send({"talk": self.talk, "seed": seed})
        weakref.finalize(self, process.over.append, self.talk)

    def move(self, view: View) -> Choice:
        """Ask the file."""
        kind = asdict(view)
        answer = self.process.ask(self.talk, {"table": kind} if isinstance(view, Table) else kind)
        choice, offer = answer.get("choice"), answer.get("offer")
        if not isinstance(choice, str) or not (offer is None or type(offer) is int):
            raise BadInput(f"policy {self.process.path}", expected='{"choice": ID, "offer": whole number or None}',
                           seen=json.dumps(answer)[:80])  # fmt: skip
        return Choice(choice, offer)


class _Process:
    """The file's process (``own_worker``): plain data in and out, nothing inherited but its source."""

    def __init__(self, path: Path, source: str) -> None:
        self.path, self.talks, self.over = path, 0, list[int]()
        self.folder = tempfile.TemporaryDirectory(prefix="mcg-policy-")
        self.popen = subprocess.Popen(
            [sys.executable, "-I", "-S", own_worker.__file__],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
            cwd=self.folder.name, env={"PYTHONHASHSEED": "0"}, start_new_session=True,
        )  # fmt: skip
        self._end = weakref.finalize(self, _kill, self.popen, self.folder)
        self.answers: queue.Queue[bytes] = queue.Queue()
        threading.Thread(target=_listen, args=(self.popen, self.answers), daemon=True).start()
        self.send({"source": source, "cpu_s": CPU_S, "memory": MEMORY_BYTES, "answer": _MAX_ANSWER})

    def send(self, message: dict[str, Any]) -> None:
        """One line to the file's process, and which talks are over since the last."""
        over, self.over[:] = list(self.over), []
        message = {**message, "over": over}
        assert self.popen.stdin is not None
        try:
            self.popen.stdin.write(json.dumps(message).encode() + b"\n")
            self.popen.stdin.flush()
        except BrokenPipeError:
            raise self._gone() from None

    def ask(self, talk: int, view: dict[str, Any]) -> dict[str, Any]:
        """One move. Raises BadInput where the file fails, is too slow or says nothing of use."""
        self.send({"talk": talk, "view": view})
        try:
            line = self.answers.get(timeout=MOVE_S)
        except queue.Empty:
            self._end()
            raise BadInput(f"policy {self.path}", expected=f"a move within {MOVE_S:g} s", seen="none") from None
        if not line.endswith(b"\n"):
            self._end()
            raise self._gone()
        answer = json.loads(line)
        if "error" in answer:
            where = Where(str(self.path), answer.get("line"))
            raise BadInput("policy", where=where, expected="a move", seen=answer["error"])
        return dict(answer)

    def _gone(self) -> BadInput:
        limits = f"{MEMORY_BYTES // 2**20} MiB and {CPU_S} s of a processor"
        return BadInput(f"policy {self.path}", expected=f"a policy that keeps within {limits}", seen="its end")


def _listen(popen: subprocess.Popen[bytes], answers: queue.Queue[bytes]) -> None:
    """Answers as they come; an empty or broken one is the last."""
    assert popen.stdout is not None
    with contextlib.suppress(OSError, ValueError), popen.stdout:
        while True:
            line = popen.stdout.readline(_MAX_ANSWER)
            answers.put(line)
            if not line.endswith(b"\n"):
                return


def _kill(popen: subprocess.Popen[bytes], folder: tempfile.TemporaryDirectory[str]) -> None:
    popen.kill()
    popen.wait()
    if popen.stdin is not None:
        with contextlib.suppress(OSError):
            popen.stdin.close()
    folder.cleanup()
