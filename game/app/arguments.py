"""Kinds of command line arguments that several commands share."""

from __future__ import annotations

import argparse
import re

from game.core.emotion_space import parse_emotion
from game.core.errors import BadInput
from game.core.paths import ASSETS

__all__ = ["add_emotion", "known", "parse_day_share", "parse_size"]

OPENS_MIN, CLOSES_MIN = 13 * 60, 18 * 60  # the market's afternoon, minutes of the day

MAX_SIDE = 8192


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
