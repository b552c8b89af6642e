"""Which lines the player is given in a round: drawn without a look at what the shopkeeper feels."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from game.story.acts import ActTable
from game.story.chance import pick_weighted, shuffled, uniform
from game.story.expressions import Scope
from game.story.model import ChoiceDef, LineDef
from game.story.prepared import Group, ReadyChoice

__all__ = ["draw_choices", "fresh_of"]


def draw_choices(
    groups: Sequence[Group],
    scope: Scope,
    chosen: Collection[str],
    count: int,
    acts: ActTable,
    seed: int,
    counter: int,
) -> list[ChoiceDef]:
    """``count`` choices of different acts, by the numbers of stream ``seed`` from ``counter`` on.

    groups: by act, what the pool holds; scope and chosen tell which of it can be taken now. The set of acts is drawn
    from those in which some line is right for at least six of the seven emotions (or for as many as the pool
    allows), so that the offer tells nothing about what is felt. Too few acts in the pool: the rest is filled with
    further choices.
    """
    members = dict(groups)
    here = tuple(act for act, choices in groups if _any_usable(choices, scope, chosen))
    if not here or count <= 0:
        return []
    sets = acts.fair_sets(here, count)
    counter += 1
    chosen_acts = sets[int(uniform(seed, counter) * len(sets))]
    drawn: list[ChoiceDef] = []
    for act in chosen_acts:
        counter += 1
        options = _usable(members[act], scope, chosen)
        if len(options) == 1:
            drawn.append(options[0])
        else:
            drawn.append(options[pick_weighted([choice.weight for choice in options], uniform(seed, counter))])
    if len(drawn) < count:
        rest = [choice for act in here for choice in _usable(members[act], scope, chosen) if choice not in drawn]
        while len(drawn) < count and rest:
            counter += 1
            drawn.append(rest.pop(int(uniform(seed, counter) * len(rest))))
    return [drawn[i] for i in shuffled(len(drawn), seed, counter + 1)]


def fresh_of(lines: list[LineDef], order: str, earlier: Collection[str], heard: Mapping[str, int]) -> list[LineDef]:
    """Of several lines that fit, those among which chance decides, by the order of their group. earlier: what was said
    on earlier visits, which comes last; heard: how often lines that may come again were said."""
    if earlier:
        lines = [line for line in lines if line.id not in earlier] or lines
    if order == "shuffled":
        least = min(heard.get(line.id, 0) for line in lines)
        lines = [line for line in lines if heard.get(line.id, 0) == least]
    return lines[:1] if order == "listed" else lines


def _usable(choices: Sequence[ReadyChoice], scope: Scope, chosen: Collection[str]) -> list[ChoiceDef]:
    seen = scope.seen
    return [
        choice
        for choice, in_talk, at_stall, test in choices
        if not (in_talk and choice.id in chosen)
        and not (at_stall and choice.id in seen)
        and (test is None or test(scope))
    ]


def _any_usable(choices: Sequence[ReadyChoice], scope: Scope, chosen: Collection[str]) -> bool:
    """Whether ``_usable`` finds any; the talk's innermost loop, which mostly ends with the first choice."""
    seen = scope.seen
    for choice, in_talk, at_stall, test in choices:
        if in_talk and choice.id in chosen:
            continue
        if at_stall and choice.id in seen:
            continue
        if test is None or test(scope):
            return True
    return False
