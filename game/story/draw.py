"""Which lines the player is given in a round: drawn without a look at what the shopkeeper feels."""

from __future__ import annotations

from game.story.chance import shuffled, uniform, uniforms
from game.story.expressions import Scope
from game.story.pools import Pool
from game.story.ready import ReadyChoice

__all__ = ["draw_choices"]


def draw_choices(pool: Pool, scope: Scope, past: int, seen: int, seed: int, counter: int) -> list[ReadyChoice]:
    """Choices of different acts, by the numbers of stream ``seed`` from ``counter`` on.

    scope, and the bits of what happened in the talk (past) and ever at the stall (seen), tell which can be taken now.
    The set of acts is drawn from those in which some line is right for at least six of the seven emotions (or for as
    many as the pool allows), so that the offer tells nothing about what is felt. Too few acts in the pool: the rest is
    filled with further choices.
    """
    here, sets = pool.round(past, seen).sets(scope)
    if not sets:
        return []
    # One number for the set, one for each of its acts, and those that shuffle.
    count = pool.count
    chances = uniforms(seed, counter + 1, 2 * count)
    drawn: list[ReadyChoice] = []
    for name, chance in zip(sets[int(chances[0] * len(sets))], chances[1:], strict=False):
        lots = here[name].usable(scope)
        drawn.append(lots.only or lots.draw(chance))
    counter += 2 + len(drawn)
    if len(drawn) == count:
        return [drawn[i] for i in shuffled(count, chances[1 + count :])]
    rest = [choice for left in here.values() for choice in left.usable(scope).items if choice not in drawn]
    while len(drawn) < count and rest:
        drawn.append(rest.pop(int(uniform(seed, counter) * len(rest))))
        counter += 1
    return [drawn[i] for i in shuffled(len(drawn), uniforms(seed, counter, len(drawn) - 1))]
