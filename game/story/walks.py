"""Random talks through a script, by one seed: moves that nobody answers, places that no talk came to."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Mapping

from game.story.beat import Beat, Chose, Start
from game.story.engine import advance
from game.story.findings import Findings
from game.story.model import Script
from game.story.state import Memory, begin, memory_of
from game.story.vocabulary import OUTCOMES, Value

__all__ = ["walk_script"]

_ROUNDS = 6
_MOVES = 40
_VISITS = 4
_OFFERS: Mapping[str, str] = {"refused_offer": "refused", "insulted": "insult", "deal": "accepted"}
_LAST = ("rounds_out", "out_of_patience", "sudden_end")


def walk_script(script: Script, findings: Findings, walks: int, seed: int) -> None:
    """Play so many talks with random choices and a market that answers by chance; note what was found.

    Four visits in a row remember each other. The script must have no errors.
    """
    rng = random.Random(seed)
    unanswered: Counter[str] = Counter()
    nodes: set[str] = set()
    memory: Memory | None = None
    for number in range(walks):
        memory = None if number % _VISITS == 0 else memory
        item = rng.choice(list(script.items))
        state = begin(script, item, rng.getrandbits(32), memory=memory)
        price = float(script.items[item].list_price)
        env: dict[str, Value] = {"list_price": price, "ask": price, "price": price, "purse": 2 * price, "trust": 0.3}
        state, beat = advance(script, state, Start(), env)
        for round_ in range(_MOVES):
            if beat.ended is not None:
                break
            choice = rng.choice([option for option in beat.choices if option.available])
            outcome = _outcome(choice.act, round_, rng)
            _turn(env, outcome, round_, rng)
            state, beat = advance(script, state, Chose(choice.id, outcome), env)
            if not _answered(beat):
                unanswered[choice.id] += 1
        nodes |= set(state.visits)
        memory = memory_of(script, state)
    for name, times in unanswered.items():
        where = script.choices[name].where
        times_said = f"{times} time{'s' * (times != 1)}"
        hint = "more lines where it leads, or again: true on one"
        findings.add("W_NO_ANSWER", where, f"{name!r} was left without an answer {times_said} in {walks} talks", hint)
    for node in script.nodes.values():
        if node.id not in nodes:
            findings.add("I_NOT_WALKED", node.where, f"none of {walks} random talks came to {node.id!r}")


def _outcome(act: str, round_: int, rng: random.Random) -> str | None:
    """What the market makes of a move, by chance, within its own order of things."""
    if act == "leave":
        return rng.choice(["called_back", "walked_away"])
    outcome = None
    if act == "offer" or rng.random() < 0.3:
        outcome = rng.choice(["refused_offer", "refused_offer", "insulted", "deal"])
    if outcome != "deal" and round_ + 1 >= _ROUNDS:
        outcome = rng.choice(_LAST)
    return outcome


def _turn(env: dict[str, Value], outcome: str | None, round_: int, rng: random.Random) -> None:
    """What a script can ask about, after a move."""
    price = float(env["list_price"])
    offer = price * rng.uniform(0.4, 1.0) if outcome in _OFFERS else 0.0
    env.update(
        quality=rng.choice(["right", "neutral", "wrong"]),
        tells=rng.random() < 0.7,
        round=round_ + 1.0,
        patience=7.0 - round_ - rng.random(),
        tidying=round_ > 3 and rng.random() < 0.8,
        trust=min(max(float(env["trust"]) + rng.choice([-0.12, 0.0, 0.12, 0.12]), 0.0), 1.0),
        ask=float(env["ask"]) * rng.uniform(0.9, 1.0),
        offer=offer,
        offer_result=_OFFERS.get(outcome or "", "none"),
        deal_price=offer if outcome == "deal" else 0.0,
    )
    assert outcome is None or outcome in OUTCOMES


def _answered(beat: Beat) -> bool:
    return any(line.speaker != "player" for line in beat.lines)
