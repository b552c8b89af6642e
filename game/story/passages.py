"""The way from one place where a talk can take a turn to the next, as stretches: what happens there in any case, and
what is still to be asked."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from game.story.beat import Spoken, Stimulus
from game.story.ready import ReadyChoice, ReadyEffect, ReadyNode, ReadySay

__all__ = ["Passage", "Stretch", "passage_from"]


class Stretch(NamedTuple):
    """Part of a passage. First what happens in any case: nodes passed and lines said, the bits of which are ``past``;
    then the effects, then the groups of lines of which one each may be said; then what follows, None at the end."""

    nodes: tuple[str, ...] = ()
    lines: tuple[Spoken, ...] = ()
    past: int = 0
    stimuli: tuple[Stimulus, ...] = ()
    effects: tuple[ReadyEffect, ...] = ()
    says: tuple[ReadySay, ...] = ()
    then: Stretch | None = None

    @staticmethod
    def taking(choice: ReadyChoice, *, said: bool) -> Stretch:
        """A choice of which one thing can be said. said: whether it was said before."""
        line = choice.texts[0]
        if choice.silent or (said and not line.again):
            return Stretch(past=choice.bit, effects=choice.effects)
        stimuli = () if line.stimulus is None else (line.stimulus,)
        return Stretch((), line.fixed, choice.bit | line.bit, stimuli, choice.effects)

    def after(self, node: ReadyNode) -> Stretch:
        """The same with a node passed as well, which nothing has been asked before."""
        stimuli = self.stimuli if node.stimulus is None else (*self.stimuli, node.stimulus)
        nodes, past = (*self.nodes, node.id), self.past | node.bit
        return self._replace(nodes=nodes, past=past, stimuli=stimuli, effects=node.effects)

    def saying(self, say: ReadySay) -> Stretch:
        """The same with a group of lines as well."""
        test, group = say
        line = None if test is not None or self.effects or self.says else group.only
        if line is None or not line.always:
            return self._replace(says=(*self.says, say))
        stimuli = self.stimuli if line.stimulus is None else (*self.stimuli, line.stimulus)
        return self._replace(lines=(*self.lines, *line.always), past=self.past | line.bit, stimuli=stimuli)


Passage = tuple[ReadyNode, Stretch]
"""Nodes that follow one another whatever holds: the last one, where the talk waits, ends or takes a turn, and what
happens up to and in it. Where the talk waits or ends there, it is the only one, since the market's answer may come
before it."""


def passage_from(
    beginning: Stretch,
    first: ReadyNode,
    nodes: Callable[[str], ReadyNode | None],
    says: Callable[[ReadyNode], Sequence[ReadySay]],
) -> Passage:
    """The passage that goes on with a node.

    nodes: by the name of a way, the node; None where it depends on the talk which it is. says: what a node can say.
    """
    stretches = [beginning]
    passed: dict[str, ReadyNode] = {}
    following: ReadyNode | None = first
    while following is not None:
        node = passed[following.id] = following
        if stretches[-1].effects or stretches[-1].says:
            stretches.append(Stretch())
        stretches[-1] = stretches[-1].after(node)
        for say in says(node):
            stretches[-1] = stretches[-1].saying(say)
        goes_on = not node.halts and node.call is None and node.way
        following = nodes(node.way) if goes_on else None
        if following is not None and (following.halts or following.id in passed):
            following = None
    whole = stretches.pop()
    while stretches:
        whole = stretches.pop()._replace(then=whole)
    return node, whole
