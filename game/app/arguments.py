"""Kinds of command line arguments that several commands share."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

from game.core.emotion_space import parse_emotion
from game.core.errors import BadInput
from game.core.paths import ASSETS

if TYPE_CHECKING:
    from game.app.avatar import Avatar

__all__ = ["add_avatar", "add_emotion", "avatar_of", "known", "parse_day_share", "parse_size"]

OPENS_MIN, CLOSES_MIN = 13 * 60, 18 * 60  # the market's afternoon, minutes of the day

MAX_SIDE = 8192
MAX_NOTES = 6


def known(folder: str) -> list[str]:
    """Names of the persons (``characters``) or stalls (``stalls``) whose files are there."""
    return sorted(path.stem for path in (ASSETS / folder).glob("*.yaml"))


def parse_size(text: str) -> tuple[int, int]:
    """``1280x720`` -> (1280, 720)."""
    match = re.fullmatch(r"(\d{2,5})[x×](\d{2,5})", text.strip())
    if match is None:
        raise argparse.ArgumentTypeError(f"expected WIDTHxHEIGHT such as 1280x720 but saw {text!r}")
    width, height = int(match[1]), int(match[2])
    if not (64 <= width <= MAX_SIDE and 64 <= height <= MAX_SIDE):
        raise argparse.ArgumentTypeError(f"expected sides from 64 to {MAX_SIDE} but saw {text!r}")
    return width, height


def parse_day_share(text: str) -> float:
    """``16:30`` -> 0.7, the share of the afternoon from 13:00 to 18:00."""
    match = re.fullmatch(r"(\d{1,2}):([0-5]\d)", text.strip())
    minutes = int(match[1]) * 60 + int(match[2]) if match else -1
    if not OPENS_MIN <= minutes <= CLOSES_MIN:
        raise argparse.ArgumentTypeError(f"expected a time from 13:00 to 18:00 but saw {text!r}")
    return (minutes - OPENS_MIN) / (CLOSES_MIN - OPENS_MIN)


def _emotion(text: str) -> object:
    try:
        return parse_emotion(text)
    except BadInput as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def add_emotion(parser: argparse.ArgumentParser) -> None:
    """``--emotion joy=0.8,fear=0.1``."""
    parser.add_argument(
        "--emotion", type=_emotion, default="neutral=1", metavar="NAME=X,…", help="what is felt (default neutral)"
    )


def add_avatar(parser: argparse.ArgumentParser) -> None:
    """``--avatar FILE`` and what belongs to it."""
    group = parser.add_argument_group("a foreign avatar in the shopkeeper's place")
    group.add_argument("--avatar", type=Path, metavar="FILE", help="VRM 0.x or 1.0, or skinned glTF with named joints")
    group.add_argument("--avatar-map", metavar="MAP", help="which joint is which: a YAML file, or a shipped map's name")
    group.add_argument("--avatar-faces", type=Path, metavar="YAML", help="its rated expressions (face fit --avatar)")


def avatar_of(args: argparse.Namespace, quiet: bool = False) -> Avatar | None:
    """The avatar asked for, its licence told in the terminal unless quiet. Raises BadInput."""
    from game.app.avatar import open_avatar
    from game.formats import find_map, load_map

    if args.avatar is None:
        if args.avatar_map is not None or args.avatar_faces is not None:
            raise BadInput("--avatar-map and --avatar-faces", expected="an --avatar that they belong to", seen="none")
        return None
    joints = load_map(find_map(args.avatar_map)) if args.avatar_map else None
    avatar = open_avatar(args.avatar, joints, args.avatar_faces)
    if quiet:
        return avatar
    print(f"avatar: {avatar.licence}")
    for note in avatar.notes[:MAX_NOTES]:
        print(f"note: {note}")
    if len(avatar.notes) > MAX_NOTES:
        print(f"note: and {len(avatar.notes) - MAX_NOTES} more; see run_game.py inspect")
    return avatar
