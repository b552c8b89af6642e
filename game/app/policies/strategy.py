"""How policies bargain: which line to say and what to offer, given a belief or none. Each kind has tuned numbers."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass, fields

from game.app.policies.beliefs import Acquaintance, Belief
from game.app.policies.views import Line, Table
from game.app.talk import MONEY_STEP, Choice
from game.core.emotion_space import EMOTION_INDEX
from game.formats.yaml_source import Node
from game.market import MarketRules
from game.story import ACTS

__all__ = ["Bargainer", "FixedPlan", "Strategy", "money"]

_JOY, _FEAR, _DISGUST = EMOTION_INDEX["joy"], EMOTION_INDEX["fear"], EMOTION_INDEX["disgust"]


def money(amount: float, limit: int) -> int:
    """A spoken price: whole tens, at least one step, at most the limit."""
    return max(min(round(amount / MONEY_STEP) * MONEY_STEP, limit), min(MONEY_STEP, limit))


@dataclass(frozen=True)
class Strategy:
    """Numbers of a bargainer that has a belief. Prices are shares of the list price.

    open: first offer; step: raise of a next one. hold: from this belief in joy or fear on the offer is repeated, so
    that the seller moves. turn: from this belief that it lands on, the player turns to go, once. neutral: worth of a
    line taken as neutral where right is 1 and wrong 0; wait, press: what these acts cost in worth. disgust: from this
    belief on no offer is put. shy: from this belief that the best line lands wrong on no offer is put with it.
    close_left, close_patience, close_gap: the ask is taken with so few rounds left, with so little patience thought
    to be left, or when so little stands between offer and ask.
    """

    open: float = 0.55
    step: float = 0.06
    hold: float = 0.7
    turn: float = 0.95
    neutral: float = 0.45
    wait: float = 0.25
    press: float = 0.1
    disgust: float = 0.5
    shy: float = 0.8
    close_left: float = 0.0
    close_patience: float = 1.6
    close_gap: float = 0.02

    @staticmethod
    def from_node(node: Node) -> Strategy:
        """Read one strategy. Raises BadInput with file:line:col."""
        names = [field.name for field in fields(Strategy)]
        node.only(*names)
        return Strategy(**{name: node[name].as_float(-1.0, 20.0) for name in names})


@dataclass(frozen=True)
class FixedPlan:
    """A strategy that looks at nobody. order: acts, the most wanted first; raises: by round, 0 repeats the offer."""

    order: tuple[str, ...]
    open: float
    raises: tuple[float, ...]
    close_left: float
    close_gap: float

    @staticmethod
    def from_node(node: Node) -> FixedPlan:
        """Read one plan. Raises BadInput with file:line:col."""
        node.only("order", "open", "raises", "close_left", "close_gap")
        order = [item.as_str() for item in node["order"].as_list()]
        if sorted(order) != sorted((*ACTS, "wait", "offer")):
            raise node["order"].error(expected="every act once, wait and offer too")
        return FixedPlan(
            tuple(order),
            node["open"].as_float(0.05, 1.0),
            tuple(item.as_float(0.0, 0.5) for item in node["raises"].as_list()),
            node["close_left"].as_float(-1.0, 20.0),
            node["close_gap"].as_float(-1.0, 1.0),
        )

    def move(self, table: Table) -> Choice:
        """The first line in the order that lies on the table, with the offer of the round."""
        rank = {act: at for at, act in enumerate(self.order)}
        line = min((line for line in table.lines if line.act in rank), key=lambda line: rank[line.act])
        limit = min(table.ask, table.purse)
        left = table.rounds - 1 - table.round
        gap = (table.ask - table.offer) / table.list_price
        if table.purse >= table.ask and (left <= self.close_left or (table.offer > 0 and gap <= self.close_gap)):
            return Choice(line.id if line.act != "wait" else "offer", table.ask)
        if line.act == "wait":
            return Choice(line.id)
        if table.offer == 0:
            return Choice(line.id, money(self.open * table.list_price, limit))
        rise = self.raises[min(table.round, len(self.raises) - 1)]
        return Choice(line.id, money(table.offer + rise * table.list_price, limit))


class Bargainer:
    """Says the line that is most likely welcome, and bargains by a strategy. Keeps what anybody can keep in mind."""

    def __init__(self, known: Acquaintance, market: MarketRules, plan: Strategy, rng: random.Random) -> None:
        self.known, self.market, self.plan, self.rng = known, market, plan, rng
        self.patience = known.person.patience
        self.last_act, self.last_landed = "", ""
        self.used: set[str] = set()
        self.turned = False

    def landed(self, act: str, how: str, wrong: float, right: float, offered: bool) -> None:
        """Keep in mind how a line went: for certain (``how``) or as likely as thought."""
        rules = self.market
        self.patience -= rules.patience_wait if act == "wait" else rules.patience_round
        if how:
            wrong, right = float(how == "wrong"), float(how == "right")
        self.patience -= rules.patience_wrong * wrong + rules.patience_right * right
        if offered:
            self.patience -= rules.patience_offer
        self.last_act, self.last_landed = act, how or ("right" if right > 0.5 else "")
        if act in self.known.once_right and self.last_landed == "right":
            self.used.add(act)

    def chances(self, belief: Belief, act: str) -> tuple[float, float]:
        """(right, wrong) of an act now; a welcome line repeated at once is only neutral."""
        judged = "turn_to_go" if act == "leave" else act
        right = belief.chance(judged, "right")
        if act in self.used or (act == self.last_act and self.last_landed == "right"):
            right = 0.0
        return right, belief.chance(judged, "wrong")

    def move(self, table: Table, belief: Belief) -> tuple[Choice, Line]:
        """The next move, and the line it takes."""
        plan = self.plan
        line, wrong = self._line(table, belief)
        limit = min(table.ask, table.purse)
        left = table.rounds - 1 - table.round
        gap = (table.ask - table.offer) / table.list_price
        tired = self.patience <= plan.close_patience or table.tidying
        if table.purse >= table.ask and (
            left <= plan.close_left or tired or (table.offer > 0 and gap <= plan.close_gap)
        ):
            offer = next(line for line in table.lines if line.act == "offer")
            best = line if line.act != "wait" else offer
            return Choice(best.id, table.ask), best
        leave = next((line for line in table.lines if line.act == "leave"), None)
        if leave is not None and not self.turned and self.chances(belief, "leave")[0] >= plan.turn and left > 0:
            self.turned = True
            return Choice(leave.id), leave
        shares = belief.now
        if line.act == "wait" or (line.act != "offer" and (shares[_DISGUST] >= plan.disgust or wrong >= plan.shy)):
            return Choice(line.id), line
        if table.offer == 0:
            return Choice(line.id, money(plan.open * table.list_price, limit)), line
        if shares[_JOY] + shares[_FEAR] >= plan.hold:
            return Choice(line.id, min(table.offer, limit)), line
        return Choice(line.id, money(table.offer + plan.step * table.list_price, limit)), line

    def _line(self, table: Table, belief: Belief) -> tuple[Line, float]:
        """The line worth most; ties are broken at random."""
        costs: Mapping[str, float] = {"wait": self.plan.wait, "press": self.plan.press}
        best, best_worth, best_wrong = None, -9.0, 0.0
        for line in table.lines:
            if line.act == "leave":
                continue
            right, wrong = self.chances(belief, line.act)
            worth = right + self.plan.neutral * (1.0 - right - wrong) - costs.get(line.act, 0.0)
            worth += 1e-3 * self.rng.random()
            if worth > best_worth:
                best, best_worth, best_wrong = line, worth, wrong
        assert best is not None  # the standing choices are always there
        return best, best_wrong
