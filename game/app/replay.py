"""Play a recording again, exactly: in a window, without one, as a picture or as a film.

examples:
  run_game.py replay talk.jsonl                              in a window; space pauses, Esc ends
  run_game.py replay talk.jsonl --speed 4
  run_game.py replay talk.jsonl --headless --json            does it come out the same? exit code 1 where not
  run_game.py replay talk.jsonl --at 42.5 --out frame.png
  run_game.py replay talk.jsonl --video talk.mp4             needs the extra `video`; a folder gets numbered PNGs

Recordings come from `play --record FILE`, from `autoplay --record DIR`, and from every play by hand: the last one lies
in the user's folder as last-session.jsonl. One made with other content says where it first goes another way.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from game.app.afternoon import Afternoon
from game.app.arguments import parse_size
from game.app.bazaar import load_bazaar
from game.app.content import load_talk_assets, stall_path
from game.app.loading import load_step_assets
from game.app.market import LeftOut, Market, Stall, read_stall
from game.app.recording import Divergence, Player, Recording, content_hashes, content_note, read_recording
from game.app.recording.talks import TalkPlayer, play_talk
from game.app.reload import watched_files
from game.app.session import Session
from game.app.settings import Settings
from game.app.step import new_world
from game.app.strings import load_strings
from game.app.world import TICK_S, Intent, leave_talk
from game.core.errors import BadInput, GameError

__all__ = ["add_arguments", "open_replay", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of ``replay``."""
    parser.add_argument("file", type=Path, help="the recording")
    parser.add_argument("--speed", type=_speed, default=1.0, metavar="X", help="times as fast, or max (default 1)")
    parser.add_argument("--headless", action="store_true", help="no window: play it through and compare")
    parser.add_argument("--at", type=float, metavar="SECONDS", help="the moment of the picture for --out")
    parser.add_argument("--out", type=Path, metavar="PNG", help="draw the moment --at, then end")
    parser.add_argument("--video", type=Path, metavar="FILE", help="film it: an .mp4, or a folder for numbered PNGs")
    parser.add_argument("--fps", type=int, default=30, help="pictures a second of the film (default 30)")
    parser.add_argument("--stall", help="play it at this stall's file instead of the recorded one")
    parser.add_argument("--size", type=parse_size, default=(1280, 720), metavar="WxH", help="default 1280x720")
    parser.add_argument("--level", default="default", help="quality level (default: default)")
    parser.add_argument("--json", action="store_true", help="tell the result as JSON")


def _speed(text: str) -> float:
    if text == "max":
        return 0.0
    try:
        speed = float(text)
    except ValueError:
        speed = -1.0
    if not 0.05 <= speed <= 100.0:
        raise argparse.ArgumentTypeError(f"expected 0.05 to 100, or max, but saw {text!r}")
    return speed


def open_replay(
    recording: Recording, stall: str | None = None, *, language: str | None = None, body: bool = True
) -> tuple[Session, Player | TalkPlayer]:
    """A fresh session like the one recorded, and who plays it. Raises BadInput where content cannot be read."""
    header = recording.header
    bazaar = load_bazaar()
    only = stall or header.stall
    assets = load_step_assets(only or bazaar.stalls[0], body=body)
    first = Stall("", assets) if only is None else read_stall(only, assets, stand_in=True)
    first.id = assets.talk.script.stall
    others = () if only else bazaar.stalls[1:]
    market = Market(bazaar, {first.id: first}, expected=(first.id, *others))
    for name in others:
        try:
            found = read_stall(name, assets)
            market.stalls[found.id] = found
        except GameError as error:
            market.left_out[name] = LeftOut.of(name, error)
    world = new_world(assets, header.seed, language=header.language, text_speed=header.text_speed)
    spoken = language or header.language
    session = Session(
        assets,
        leave_talk(replace(world, mode=header.mode)),  # type: ignore[arg-type]
        load_strings(spoken),
        Settings(language=spoken),
        Afternoon(seed=header.seed),
        market,
    )
    player = TalkPlayer(recording) if header.kind == "talk" else Player(recording, body=body)
    player.start(session)
    return session, player


def run(args: argparse.Namespace) -> int:
    """Read, play, compare; 1 where it goes another way."""
    if (args.at is None) != (args.out is None):
        raise BadInput("replay", expected="--at SECONDS and --out PNG together", seen="one of them")
    if args.at is not None and not 0.0 <= args.at <= 24 * 3600:
        raise BadInput("--at", expected="0 to 86400", seen=args.at)
    if not 1 <= args.fps <= 120:
        raise BadInput("--fps", expected="1 to 120", seen=args.fps)
    recording = read_recording(args.file)
    note = _note(recording, args.stall)
    if args.out is not None or args.video is not None:
        from game.app.replay_pictures import draw_frame, film

        divergence = draw_frame(recording, args) if args.out is not None else film(recording, args)
        return _tell(args, recording, note, {"out": str(args.out or args.video)}, divergence)
    if not args.headless:
        from game.app.replay_window import show

        divergence = show(recording, args)
        return _tell(args, recording, note, {}, divergence)
    if recording.header.kind == "talk":
        assets = load_talk_assets(stall_path(args.stall or str(recording.header.stall)))
        talk, divergence, moves = play_talk(assets, recording)
        ended = None if talk is None else talk.beat.ended
        return _tell(args, recording, note, {"decisions": moves, "ended": ended}, divergence)
    session, player = open_replay(recording, args.stall)
    while not player.done:
        session.tick(Intent())
    found: dict[str, Any] = {"decisions": player.decisions, "compared": player.checks}
    found["seconds"] = round(session.ticks * TICK_S, 1)
    return _tell(args, recording, note, found, player.divergence)


def _note(recording: Recording, stall: str | None) -> str:
    """What has changed since; "" where nothing has."""
    name = stall or recording.header.stall
    own = () if name is None else watched_files(load_talk_assets(stall_path(name)).script)
    return content_note(recording.header.content, content_hashes(own))


def _tell(
    args: argparse.Namespace, recording: Recording, note: str, found: dict[str, Any], divergence: Divergence | None
) -> int:
    end = recording.events[-1].values.get("why", "") if recording.whole else "cut off"
    result = {"file": str(args.file), "same": divergence is None, **found, "end": end, "content": note}
    if divergence is not None:
        result["diverges"] = {
            "seconds": round(divergence.tick * TICK_S, 3), "line": divergence.line, "decision": divergence.decision,
            "what": divergence.what, "expected": divergence.expected, "seen": divergence.seen,
        }  # fmt: skip
    if args.json:
        print(json.dumps(result, ensure_ascii=False))
        return 0 if divergence is None else 1
    if note:
        print(f"{args.file}: recorded with other content ({note})")
    if divergence is not None:
        print(f"{args.file}: goes another way at {divergence}")
        return 1
    told = ", ".join(f"{name} {value}" for name, value in found.items())
    how = "the same to where it was cut off" if end == "cut off" else "the same"
    print(f"{args.file}: {how}{f' ({told})' if told else ''}")
    return 0
