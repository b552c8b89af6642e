"""The log: one JSON line per decision, the same bytes for the same seed."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from game.app.autoplay.episodes import Decision
from game.app.talk import ask_money
from game.core.emotion_space import EMOTIONS

__all__ = ["log_lines"]


def _numbers(values: Sequence[float]) -> dict[str, float]:
    return {name: round(float(v), 4) for name, v in zip(EMOTIONS, values, strict=True)}


def _row(stall: str, policy: str, episode: int, visit: int, decision: Decision) -> dict[str, Any]:
    before, after = decision.before, decision.after
    record = dict(after.record)
    earlier = before.story.visits
    return {
        "stall": stall,
        "policy": policy,
        "episode": episode,
        **({"visit": visit} if visit else {}),
        "round": after.bargain.round,
        "item": after.item,
        "node": before.beat.node,
        "choice": decision.choice.id,
        "act": record["act"],
        "offer": decision.choice.offer,
        "quality": record["quality"],
        "felt_label": record["felt_label"],
        "felt": _numbers(record["felt"]),
        "shown": _numbers(record["shown"]),
        "result": record["result"],
        "outcome": record["outcome"],
        "ask": ask_money(after.list_price, after.bargain.ask),
        "patience": round(after.bargain.patience, 4),
        "trust": round(after.bargain.trust, 4),
        "nodes": [node for node, count in after.story.visits.items() if count != earlier.get(node, 0)],
        "lines": [line.id for line in after.beat.lines],
        "ended": after.beat.ended,
    }


def log_lines(
    stall: str, policy: str, episode: int, decisions: Sequence[Decision], mode: str | None, visit: int = 0
) -> str:
    """The lines of one talk; mode: which of the body's layers acted, where bodies were played; visit: its number, 0
    where every episode is a single visit."""
    lines = []
    for decision in decisions:
        row = _row(stall, policy, episode, visit, decision)
        if decision.shown is not None:
            row |= {"mode": mode, "units": list(decision.shown.units), "starts": decision.shown.starts}
        lines.append(json.dumps(row, ensure_ascii=False, separators=(",", ":")))
    return "".join(line + "\n" for line in lines)
