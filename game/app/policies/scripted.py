"""``script:FILE``: moves played one after the other, to bring a talk to a place again and again."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from game.app.policies.strategy import money
from game.app.policies.views import Line, Table
from game.app.talk import Choice
from game.core.errors import BadInput, Where
from game.formats.yaml_source import Node, load_yaml

__all__ = ["ScriptedMove", "ScriptedPlayer", "load_moves"]


@dataclass(frozen=True)
class ScriptedMove:
    """One move: a choice by id, or the first line of an act; offer: money, a share of the list price, or the ask."""

    choice: str = ""
    act: str = ""
    offer: int = 0
    share: float = 0.0
    ask: bool = False


def load_moves(path: Path) -> tuple[ScriptedMove, ...]:
    """Read a list such as ``[{act: praise, share: 0.6}, {choice: offer, offer: ask}]``. Raises BadInput."""
    if not path.is_file():
        raise BadInput("policy script", where=Where(path), expected="a file that exists", seen="none")
    return tuple(_move(node) for node in load_yaml(path).only("moves")["moves"].as_list())


def _move(node: Node) -> ScriptedMove:
    node.only("choice", "act", "offer", "share")
    choice, act = node.get("choice"), node.get("act")
    if (choice is None) == (act is None):
        raise node.error(expected="either choice: ID or act: ACT")
    offer, share = node.get("offer"), node.get("share")
    ask = offer is not None and offer.raw == "ask"
    return ScriptedMove(
        choice="" if choice is None else choice.as_str(),
        act="" if act is None else act.as_str(),
        offer=0 if offer is None or ask else offer.as_int(1, 10**9),
        share=0.0 if share is None else share.as_float(0.01, 1.0),
        ask=ask,
    )


@dataclass
class ScriptedPlayer:
    """Plays the moves; where one is not on the table it waits, and after the last one it leaves."""

    moves: tuple[ScriptedMove, ...]
    at: int = field(default=0)

    def move(self, view: Table) -> Choice:
        """The next move."""
        if self.at >= len(self.moves):
            return Choice(self._by_act(view, "leave").id)
        wanted = self.moves[self.at]
        self.at += 1
        line = next(
            (line for line in view.lines if line.id == wanted.choice or (wanted.act and line.act == wanted.act)),
            None,
        )
        if line is None:
            return Choice(self._by_act(view, "wait").id)
        limit = min(view.ask, view.purse)
        amount: int | None = None
        if wanted.ask:
            amount = limit
        elif wanted.offer:
            amount = min(wanted.offer, limit)
        elif wanted.share:
            amount = money(wanted.share * view.list_price, limit)
        if line.act == "offer" and amount is None:
            amount = limit
        return Choice(line.id, amount)

    @staticmethod
    def _by_act(view: Table, act: str) -> Line:
        return next((line for line in view.lines if line.act == act), view.lines[-1])
