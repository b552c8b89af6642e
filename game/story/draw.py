"""Which lines the player is given in a round: drawn without a look at what the shopkeeper feels."""

from __future__ import annotations

from collections.abc import Sequence

from game.story.acts import ActTable
from game.story.chance import pick_weighted, shuffled, uniform
from game.story.model import ChoiceDef

__all__ = ["draw_choices"]


def draw_choices(pool: Sequence[ChoiceDef], count: int, acts: ActTable, seed: int, counter: int) -> list[ChoiceDef]:
    """``count`` choices of different acts, by the numbers of stream ``seed`` from ``counter`` on.

    The set of acts is drawn from those in which some line is right for at least six of the seven emotions (or for
    as many as the pool allows), so that the offer tells nothing about what is felt. Too few acts in the pool: the
    rest is filled with further choices.
    """
    if not pool or count <= 0:
        return []
    by_act: dict[str, list[ChoiceDef]] = {}
    for choice in pool:
        by_act.setdefault(choice.act, []).append(choice)
    sets = acts.fair_sets(tuple(by_act), count)
    chosen_acts = sets[int(uniform(seed, counter + 1) * len(sets))]
    counter += 1
    drawn: list[ChoiceDef] = []
    for act in chosen_acts:
        counter += 1
        options = by_act[act]
        if len(options) == 1:
            drawn.append(options[0])
        else:
            drawn.append(options[pick_weighted([choice.weight for choice in options], uniform(seed, counter))])
    rest = [choice for choice in pool if choice not in drawn] if len(drawn) < count else []
    while len(drawn) < count and rest:
        counter += 1
        drawn.append(rest.pop(int(uniform(seed, counter) * len(rest))))
    order = shuffled(len(drawn), seed, counter + 1)
    return [drawn[i] for i in order]
