"""The log: one JSON line per decision, the same bytes for the same seed."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import lru_cache

from game.app.autoplay.episodes import Decision
from game.app.talk import ask_money
from game.core.emotion_space import EMOTIONS

__all__ = ["log_lines"]


_PLACES = 4
"""Feelings, patience and trust are written to so many decimals."""
_TEXT = json.JSONEncoder(ensure_ascii=False, separators=(",", ":")).encode
_FEELINGS = "{" + "".join(f"{_TEXT(name)}:%.{_PLACES}f," for name in EMOTIONS)


@lru_cache(maxsize=4096)
def _quoted(text: str | None) -> str:
    """A text as JSON has it; the same ids come again and again."""
    return _TEXT(text)


def _numbers(values: Sequence[float]) -> str:
    """As JSON has them once they are rounded: without zeros at the end, which is written faster than rounded."""
    long = _FEELINGS % tuple(values)
    short = long.replace("000,", ",").replace("00,", ",").replace("0,", ",").replace(".,", ".0,")
    return f"{short[:-1]}}}"


def _row(head: str, decision: Decision) -> str:
    """One decision without the closing brace; put together by hand, which costs a third of what an encoder does."""
    before, after = decision.before, decision.after
    record = dict(after.record)
    earlier = before.story.visits
    bargain, beat, offer = after.bargain, after.beat, decision.choice.offer
    passed = [_quoted(node) for node, count in after.story.visits.items() if count != earlier.get(node, 0)]
    return (
        f'{head},"round":{bargain.round},"item":{_quoted(after.item)},"node":{_quoted(before.beat.node)}'
        f',"choice":{_quoted(decision.choice.id)},"act":{_quoted(record["act"])}'
        f',"offer":{"null" if offer is None else offer},"quality":{_quoted(record["quality"])}'
        f',"felt_label":{_quoted(record["felt_label"])},"felt":{_numbers(record["felt"])}'
        f',"shown":{_numbers(record["shown"])},"result":{_quoted(record["result"])}'
        f',"outcome":{_quoted(record["outcome"])},"ask":{ask_money(after.list_price, bargain.ask)}'
        f',"patience":{round(bargain.patience, _PLACES)!r},"trust":{round(bargain.trust, _PLACES)!r}'
        f',"nodes":[{",".join(passed)}],"lines":[{",".join([_quoted(line.id) for line in beat.lines])}]'
        f',"ended":{_quoted(beat.ended)}'
    )


def log_lines(
    stall: str, policy: str, episode: int, decisions: Sequence[Decision], mode: str | None, visit: int = 0
) -> str:
    """The lines of one talk; mode: which of the body's layers acted, where bodies were played; visit: its number, 0
    where every episode is a single visit."""
    head = f'{{"stall":{_quoted(stall)},"policy":{_quoted(policy)},"episode":{episode}'
    head += f',"visit":{visit}' if visit else ""
    lines = []
    for decision in decisions:
        row = _row(head, decision)
        if decision.shown is not None:
            shown = {"mode": mode, "units": list(decision.shown.units), "starts": decision.shown.starts}
            row = f"{row},{_TEXT(shown)[1:-1]}"
        lines.append(row + "}\n")
    return "".join(lines)
