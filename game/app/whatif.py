"""What would have happened otherwise: the talk played again from one of its rounds with another word.

A talk is a pure function of its state and the choice, chance included (each round draws from a stream of its own), so
this is no estimate: the same offers, one other line, and what then follows.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from game.app.talk import Choice, TalkAssets, TalkState, ask_money, choose
from game.app.world import Mark
from game.core.emotion_space import EMOTIONS

__all__ = ["WhatIf", "play_on", "turning_point", "worth"]

WORTH_TELLING = 0.01
"""Gains below this share of the list price are no turning point."""


@dataclass(frozen=True, eq=False)
class WhatIf:
    """mark: the round where most was lost; choice: what else could have been said; state: how that talk stands at its
    end; feeling: what would have been felt less then, from ``felt`` to ``felt_then``; gain: share of the list price.
    """

    mark: Mark
    choice: Choice
    line_en: str
    line_ja: str
    state: TalkState
    gain: float
    feeling: str
    felt: float
    felt_then: float

    def line(self, language: str) -> str:
        """The other words."""
        return self.line_ja if language == "ja" and self.line_ja else self.line_en


def worth(state: TalkState) -> float:
    """What a talk came to, in shares of the list price: any deal is worth more than none, then a lower ask."""
    if state.deal_price:
        return 1.0 - state.deal_price / state.list_price
    return -1.0 - state.bargain.ask


def play_on(assets: TalkAssets, state: TalkState, moves: Iterable[Choice]) -> TalkState:
    """Go on with the same moves as far as they are still on the table; else the same offer alone, or silence."""
    for move in moves:
        if state.ended:
            break
        open_to = {choice.id: choice.act for choice in state.beat.choices if choice.available}
        offer = move.offer
        if offer is not None:
            offer = min(offer, ask_money(state.list_price, state.bargain.ask), state.purse)
        acts = {act: name for name, act in open_to.items()}
        if move.id in open_to:
            state = choose(assets, state, Choice(move.id, offer))
        elif offer and "offer" in acts:
            state = choose(assets, state, Choice(acts["offer"], offer))
        elif "wait" in acts:
            state = choose(assets, state, Choice(acts["wait"]))
        else:
            break
    return state


def turning_point(assets: TalkAssets, marks: tuple[Mark, ...], end: TalkState) -> WhatIf | None:
    """The round and the other line with the largest gain, None where nothing else would have gained."""
    moves = [mark for mark in marks if mark.before is not None and mark.choice is not None]
    best: WhatIf | None = None
    for i, mark in enumerate(moves):
        assert mark.before is not None
        assert mark.choice is not None
        later = [m.choice for m in moves[i + 1 :] if m.choice is not None]
        for other in mark.before.beat.choices:
            offer = None if other.act == "wait" else mark.choice.offer
            if not other.available or other.id == mark.choice.id or other.act == "leave":
                continue
            if other.act == "offer" and offer is None:
                continue
            move = Choice(other.id, offer)
            after = choose(assets, mark.before, move)
            state = play_on(assets, after, later)
            gain = worth(state) - worth(end)
            if gain >= WORTH_TELLING and (best is None or gain > best.gain + 1e-12):
                felt = dict(after.record)["felt"]
                worst = max(range(6), key=lambda k, f=felt, m=mark: (m.felt[k] - f[k]) * (k != 2))  # type: ignore[misc]
                best = WhatIf(
                    mark, move, other.en, other.ja, state, gain,
                    EMOTIONS[worst], float(mark.felt[worst]), float(felt[worst]),
                )  # fmt: skip
    return best
