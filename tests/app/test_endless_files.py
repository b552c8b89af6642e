"""Pipes, devices and folders where a file belongs: every command says so in one line, and none of them waits."""

from __future__ import annotations

import os
import signal
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

import pytest

from game.app.cli import main
from game.app.reading import load_read
from game.app.settings import Settings, load_settings
from game.app.slots import look_into
from game.core.errors import BadInput
from game.render import load_picture

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes with names are a thing of POSIX")

WAIT_S = 30  # far longer than any of them takes


@pytest.fixture(autouse=True)
def no_waiting() -> Iterator[None]:
    """Who waits for a pipe is stopped, instead of stopping the whole suite."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise AssertionError(f"still reading after {WAIT_S} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(WAIT_S)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


COMMANDS = {
    "replay": "replay {pipe}.jsonl --headless",
    "inspect a motion": "inspect {pipe}.bvh",
    "inspect a model": "inspect {pipe}.glb",
    "retarget": "retarget {pipe}.bvh --out {out}.bvh",
    "compare": "compare {pipe}.png {pipe}.png",
    "heat": "graph flea -o {out}.html --heat {pipe}.jsonl",
    "avatar": "snapshot --avatar {pipe}.vrm --out {out}.png",
    "ratings": "face fit {pipe}.csv",
    "script": "autoplay --policy script:{pipe}.txt --episodes 1",
    "policy": "autoplay --policy {pipe}.py --episodes 1",
    "thresholds": "autoplay --require {pipe}.yaml --episodes 1",
}


@pytest.mark.parametrize("command", COMMANDS.values(), ids=COMMANDS)
@pytest.mark.parametrize("endless", [False, True], ids=["pipe", "device"])
def test_a_command_refuses_what_never_ends(
    command: str, endless: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pipe = tmp_path / "pipe"
    for suffix in (".jsonl", ".bvh", ".glb", ".png", ".vrm", ".csv", ".txt", ".py", ".yaml"):
        path = pipe.with_suffix(suffix)
        if endless:
            path.symlink_to("/dev/zero")
        else:
            os.mkfifo(path)
    code = main([word.format(pipe=pipe, out=tmp_path / "out") for word in command.split()])
    told = capsys.readouterr().err.strip().splitlines()
    assert (code, len(told)) == (2, 1), told
    assert str(pipe) in told[0]
    assert not list(tmp_path.glob("out*"))


def test_what_the_player_keeps_is_left_out_where_it_never_ends(tmp_path: Path) -> None:
    for name in ("settings.json", "read.json", "quick.json", "quick.png"):
        (tmp_path / name).symlink_to("/dev/zero")
    settings, told = load_settings(tmp_path)
    assert settings == Settings()
    assert "regular file" in str(told)
    assert load_read(tmp_path).stalls == {}
    assert look_into(tmp_path, "quick").picture is None


def test_a_picture_that_would_fill_the_memory_is_not_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "huge.png"
    head = struct.pack(">IIBBBBB", 60_000, 60_000, 8, 2, 0, 0, 0)
    chunk = struct.pack(">I", len(head)) + b"IHDR" + head + struct.pack(">I", zlib.crc32(b"IHDR" + head))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk)
    with pytest.raises(BadInput, match="60000×60000"):
        load_picture(path)
    path.write_bytes(b"GIF89a, or so it says")
    with pytest.raises(BadInput, match="PNG or JPEG"):
        load_picture(path)
