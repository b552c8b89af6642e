"""Whether a deal can be struck at a stall at all: by its script, and within the player's purse."""

from __future__ import annotations

from game.story.findings import Findings
from game.story.model import BACK, HOME, Script
from game.story.reach import Reach
from game.story.vocabulary import ACTS

__all__ = ["check_winnable"]


def check_winnable(script: Script, reach: Reach, findings: Findings, purse: int | None) -> None:
    """Note a stall where no offer can ever be put, and things that the purse cannot pay for at their lowest price."""
    if not _can_offer(script, reach):
        findings.add(
            "W_UNWINNABLE",
            script.nodes[script.start].where,
            f"no offer can ever be put: from {script.start!r} no place is reached where the player may speak",
            "a hub with a pool, or a standing choice with act: offer",
        )
    for item in script.items.values() if purse is not None else ():
        least = script.lowest_share * item.list_price
        if purse is not None and least > purse:
            findings.add(
                "W_UNWINNABLE",
                item.where,
                f"{item.id!r} costs {least:,.0f} at the very least, the purse holds {purse:,}",
                f"a list price of at most {purse / script.lowest_share:,.0f}",
            )


def _can_offer(script: Script, reach: Reach) -> bool:
    """Whether a talk from its start comes to a choice that is an offer or can carry one."""
    queue, done = [script.start], set()
    while queue:
        name = queue.pop()
        name = script.home if name in {HOME, BACK} else name
        if name in done or name not in script.nodes:
            continue
        done.add(name)
        node = script.nodes[name]
        queue.extend([node.call] if node.call else [])
        queue.extend(branch.target for branch in node.to if reach.holds(branch.condition))
        for choice in script.choices_at(node) if node.waits else ():
            if reach.holds(choice.condition) and reach.holds(choice.needs):
                if choice.act in {*ACTS, "offer"}:
                    return True
                queue.extend(branch.target for branch in choice.to)
    return False
