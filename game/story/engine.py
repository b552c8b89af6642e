"""Running a talk: (script, state, event, what the game knows) -> (state, beat). Pure; chance comes from the state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from game.core.errors import BadInput
from game.story.beat import Beat, Choice, Event, Outcome, Spoken, Start, Stimulus, Warp, timer_at
from game.story.chance import Lots, uniforms
from game.story.draw import draw_choices
from game.story.expressions import Scope
from game.story.filling import filled
from game.story.model import BACK, HOME, Script
from game.story.prepared import prepared
from game.story.ready import Pair, ReadyChoice, ReadyEffect, ReadyGroup, ReadyLine, ReadyNode, Way
from game.story.state import Past, StoryState
from game.story.text import Text
from game.story.vocabulary import OUTCOMES, Value, environment

__all__ = ["advance", "resume"]

# A walk from one waiting place to the next passes far fewer nodes; the reader refuses scripts that could loop.
_MAX_STEPS = 500
_MAX_RETURNS = 16
_DRAW_STREAM = 0x9E3779B9
_AHEAD = 6


def advance(script: Script, state: StoryState, event: Event, env: Mapping[str, Value]) -> tuple[StoryState, Beat]:
    """One step of the talk.

    env: names of ``ENV`` as the game knows them now, with the event's own results already in; missing ones take
    their default. Raises BadInput for an event that does not fit: a choice that is not offered, an unknown
    outcome, anything after the end.
    """
    if state.ended is not None:
        raise BadInput("talk", expected="one that goes on", seen=f"ended: {state.ended}")
    if isinstance(event, Start) == state.started and not isinstance(event, Warp):
        raise BadInput("event", expected="Start once, and first", seen=type(event).__name__)
    run = _Run(script, state, env)
    if isinstance(event, Start):
        came_back = script.outcomes.get("came_back") if state.visit > 1 else None
        run.walk(came_back or script.start, None)
    elif isinstance(event, Warp):
        if event.node not in script.nodes:
            raise BadInput("node", expected=f"one of {script.stall}", seen=event.node)
        run.returns = ()
        run.walk(event.node, None)
    elif isinstance(event, Outcome):
        run.walk(state.node, _known(event.kind, script))
    else:
        outcome = None if event.outcome is None else _known(event.outcome, script)
        run.walk(run.choose(event.choice), outcome)
    return run.result()


def resume(script: Script, state: StoryState, env: Mapping[str, Value]) -> tuple[StoryState, Beat]:
    """The last beat again, after a load: its lines, and the same choices. Nothing advances.

    Where a script was edited so that nothing of the offer is left, a new one is drawn.
    """
    if not state.started:
        return state, Beat("", (), (), (), None)
    run = _Run(script, state, env)
    run.lines = [run.spoken(run.ready.line(script.lines[name])) for name in state.last_lines]
    again = [run.ready.choice(script.choices[choice]) for choice, _ in state.offered]
    if state.ended is None and not any(run.usable(choice) for choice in again):
        run.wait_at(run.ready.node(state.node))
    else:
        texts = [text for _, text in state.offered]
        run.lay([(choice, _wording(choice, text)) for choice, text in zip(again, texts, strict=True)])
    fresh, beat = run.result()
    return replace(fresh, last_lines=state.last_lines), beat


def _known(kind: str, script: Script) -> str:
    if kind not in OUTCOMES:
        raise BadInput("outcome", expected=" | ".join(OUTCOMES), seen=kind)
    return kind


def _wording(choice: ReadyChoice, text: str) -> ReadyLine:
    """One of a choice's wordings by its id, the first where it has none such."""
    return next((line for line in choice.texts if line.id == text), choice.texts[0])


class _Run:
    """The working copy of a state during one step. said, chosen: as bits; seen: ids of all that was said, chosen or
    visited, on earlier visits, too."""

    __slots__ = (
        "ahead", "choices", "chosen", "counter", "earlier", "ended", "heard", "lines", "names", "node", "pairs", "past",
        "ready", "returns", "said", "scope", "script", "seen", "state", "stimuli", "told", "turn", "variables",
        "visits",
    )  # fmt: skip

    def __init__(self, script: Script, state: StoryState, env: Mapping[str, Value]) -> None:
        self.script, self.state = script, state
        self.node, self.counter, self.turn, self.ended = state.node, state.counter, state.turn, state.ended
        # The state's own until something is added.
        self.returns, self.variables = state.returns, state.variables
        self.heard: dict[str, int] = state.heard  # type: ignore[assignment]
        self.visits = dict(state.visits)
        past = self.past = Past.of(script, state)
        self.said, self.chosen, self.earlier = past.said, past.chosen, past.earlier
        self.seen = set(past.seen)
        names = self.names = environment(env)
        names.update(state.variables)
        names["item"], names["visit"] = state.item, float(state.visit)
        told = str(names["quality"]) if names["tells"] else "none"
        self.told = "veiled" if told == "none" else told
        self.ready = prepared(script, state.item)
        self.scope = Scope(names, self.visits, self.seen)
        self.ahead: list[float] = []
        self.lines: list[Spoken] = []
        self.stimuli: list[Stimulus] = []
        self.pairs: tuple[Pair, ...] = ()
        self.choices: tuple[Choice, ...] = ()

    def chance(self) -> float:
        # Numbers come cheaper by the half dozen; those that nobody takes are drawn again in the next step.
        if not self.ahead:
            self.ahead = uniforms(self.state.seed, self.counter + 1, _AHEAD)
            self.ahead.reverse()
        self.counter += 1
        return self.ahead.pop()

    # --- walking ---------------------------------------------------------------------------------------------
    def choose(self, choice_id: str) -> str:
        """Take a choice: its words, effects and feelings; the node it leads to."""
        texts, known = dict(self.state.offered), self.script.choices.get(choice_id)
        choice = None if known is None or choice_id not in texts else self.ready.choice(known)
        if choice is None or not self.usable(choice):
            raise BadInput("choice", expected=" | ".join(texts) or "none", seen=choice_id)
        if not choice.silent:
            self.say(_wording(choice, texts[choice_id]))
        if choice.act != "offer" and self.names["offer_result"] != "none":
            # A line that carries an offer is followed by the words of an offer.
            offer = self.ready.offer(self.told)
            if offer is not None:
                self.say_one(offer)
        self.chosen |= choice.bit
        self.seen.add(choice_id)
        if choice.effects:
            # What the choice itself makes her feel is judged with its act, by whoever knows the feelings.
            self.apply(choice.effects)
        return choice.way or self.way(choice.ways)

    def walk(self, target: str, pending: str | None) -> None:
        """Pass nodes until one waits for the player or the talk ends; ``pending`` is the market's outcome."""
        closing: str | None = None
        ready, scope, told, visits, seen = self.ready, self.scope, self.told, self.visits, self.seen
        nodes = ready.nodes
        for _ in range(_MAX_STEPS):
            node = nodes.get(target) or ready.node(self.resolved(target))
            name = node.id
            if pending is not None:
                ending = OUTCOMES[pending]
                if node.waits or (ending and node.end is not None):
                    # The market's answer comes after the reaction and before the talk goes on.
                    outcome_node = self.script.outcomes.get(pending)
                    if ending:
                        closing, self.returns = pending, ()
                    elif outcome_node is not None:
                        self.push(name)
                    pending = None
                    if outcome_node is not None:
                        target = outcome_node
                        continue
            if closing is not None and node.waits:
                break
            self.node = name
            visits[name] = visits.get(name, 0) + 1
            seen.add(name)
            if node.effects:
                self.apply(node.effects)
            if node.stimulus is not None:
                self.stimuli.append(node.stimulus)
            for test, group in node.says.get(told) or ready.says(node, told):
                if test is None or test(scope):
                    self.say_one(group)
            if node.end is not None:
                self.ended = node.end
                return
            if node.waits:
                if self.wait_at(node) or name == self.script.home:
                    return
                target = HOME
            elif node.call is None:
                target = node.way or self.way(node.ways)
            else:
                self.push(node.after)
                target = node.call
        if closing is not None:
            self.ended = closing
        else:
            self.node = self.script.home
            self.wait_at(ready.node(self.node))

    def resolved(self, target: str) -> str:
        """A node's own name; ``back`` and ``home`` looked up."""
        if target in self.script.nodes:
            return target
        while target == BACK or target.startswith("after:"):
            if target == BACK:
                target = self.returns[-1] if self.returns else HOME
                self.returns = self.returns[:-1]
            else:
                target = self.way(self.ready.node(target.removeprefix("after:")).ways)
        return self.script.home if target == HOME else target

    def push(self, target: str) -> None:
        self.returns = (*self.returns, target)[-_MAX_RETURNS:]

    def way(self, ways: Sequence[Way]) -> str:
        for test, target in ways:
            if test is None or test(self.scope):
                return target
        return HOME

    def apply(self, effects: Sequence[ReadyEffect]) -> None:
        names = self.names
        for name, value in effects:
            names[name] = value(self.scope)
        self.variables = {name: names[name] for name in self.script.variables}

    # --- speaking --------------------------------------------------------------------------------------------
    def say_one(self, group: ReadyGroup) -> None:
        """One line of those that can be said now."""
        line = group.only
        if line is not None:
            if (line.again or not self.said & line.bit) and (line.test is None or line.test(self.scope)):
                self.say(line)
        else:
            lots = group.left(self.said, self.earlier).usable(self.scope)
            if group.recalls:
                lots = group.least_heard(lots, self.heard)
            if lots.items:
                self.say(lots.only or lots.draw(self.chance()))

    def say(self, line: ReadyLine) -> None:
        if not self.said & line.bit:
            self.said |= line.bit
            self.seen.add(line.id)
        elif not line.again:
            return
        if line.again:
            if self.heard is self.state.heard:
                self.heard = dict(self.heard)
            self.heard[line.id] = self.heard.get(line.id, 0) + 1
        self.lines.append(line.fixed or self.spoken(line))
        if line.stimulus is not None:
            self.stimuli.append(line.stimulus)

    def holds(self, line: ReadyLine) -> bool:
        """Whether a line fits how the player's line landed, and its condition holds."""
        return line.when in (None, self.told) and (line.test is None or bool(line.test(self.scope)))

    def spoken(self, line: ReadyLine) -> Spoken:
        key = tuple([self.names.get(name) for name in line.asks])
        known = line.spoken.get(key)
        if known is None:
            given = line.line
            text = self.filled(given.text)
            known = Spoken(given.id, given.speaker, text.en, text.ja, given.face, given.tone, given.gesture)
            line.spoken.keep(key, known)
            line.fixed = None if line.asks else known
        return known

    def filled(self, text: Text, *, keep: str = "") -> Text:
        """The words with the names in braces filled in, ``keep`` left as it stands."""
        return filled(self.script, self.state.item, self.names, text, keep=keep)

    # --- choices ---------------------------------------------------------------------------------------------
    def shown(self, choice: ReadyChoice) -> bool:
        """Whether a choice may be seen: not used up, and its condition holds."""
        if self.chosen & choice.used or (choice.gone and choice.id in self.seen):
            return False
        return choice.shown is None or bool(choice.shown(self.scope))

    def usable(self, choice: ReadyChoice) -> bool:
        """Whether it may be taken as well."""
        return self.shown(choice) and (choice.needs is None or bool(choice.needs(self.scope)))

    def wait_at(self, node: ReadyNode) -> bool:
        """Lay the choices of a node on the table; False where none can be taken."""
        # A stream of its own, by turns: what was said before must not shift which lines are offered.
        self.turn += 1
        if node.table is not None:
            self.pairs, self.choices = node.table
            return True
        drawn: Sequence[ReadyChoice] = ()
        if node.pool is not None:
            seen = self.earlier | self.said | self.chosen
            seed = self.state.seed ^ _DRAW_STREAM
            drawn = draw_choices(node.pool, self.scope, self.chosen, seen, seed, self.turn * 64)
        offered = [(choice, self.variant(choice)) for choice in drawn]
        offered += [(choice, self.variant(choice)) for choice in node.laid if choice.always or self.shown(choice)]
        taken = self.lay(offered, usable=len(drawn))
        if node.always:
            node.table = (self.pairs, self.choices)
        return taken

    def lay(self, offered: Sequence[tuple[ReadyChoice, ReadyLine]], *, usable: int = 0) -> bool:
        """Put choices on the table; ``usable``: so many of the first are known to be. Whether any can be taken."""
        taken, options = usable > 0, []
        for at, (choice, line) in enumerate(offered):
            if at < usable or choice.always or self.usable(choice):
                options.append(line.offered or self.option(choice, line))
                taken = True
            else:
                options.append(self.greyed(choice, line))
        self.pairs = tuple([line.pair for _, line in offered])
        self.choices = tuple(options)
        return taken

    def variant(self, choice: ReadyChoice) -> ReadyLine:
        """A wording not yet used in this talk, by chance; the first where all were."""
        texts = choice.texts
        if len(texts) == 1:
            return texts[0]
        said = self.said & choice.mask
        if choice.fits:
            lots = choice.fresh.get(said)
            if lots is None:
                lots = choice.fresh.keep(said, Lots([line for line in texts if not said & line.bit]))
        else:
            lots = Lots([line for line in texts if not said & line.bit and self.holds(line)])
        return lots.only or (lots.draw(self.chance()) if lots.items else texts[0])

    def option(self, choice: ReadyChoice, line: ReadyLine) -> Choice:
        """A choice that can be taken, in one of its wordings, as the player sees it."""
        key = tuple([self.names.get(name) for name in line.keeps])
        known = line.option.get(key)
        if known is None:
            text = self.filled(line.line.text, keep="offer")
            known = Choice(choice.id, choice.act, text.en, text.ja, True, None, choice.choice.feel)
            line.option.keep(key, known)
            line.offered = None if line.keeps else known
        return known

    def greyed(self, choice: ReadyChoice, line: ReadyLine) -> Choice:
        """A choice that can be seen and not taken, and why."""
        text, why = self.filled(line.line.text, keep="offer"), choice.choice.reason
        reason = None if why is None else self.filled(why)
        return Choice(choice.id, choice.act, text.en, text.ja, False, reason, choice.choice.feel)

    def result(self) -> tuple[StoryState, Beat]:
        if self.ended is not None:
            self.pairs, self.choices = (), ()
        timer = self.script.nodes[self.node].timer if self.ended is None and self.node else None
        state, past = self.state, self.past
        fresh = StoryState.stepped(
            {
                "stall": state.stall,
                "item": state.item,
                "seed": state.seed,
                "visit": state.visit,
                "counter": self.counter,
                "turn": self.turn,
                "node": self.node,
                "started": True,
                "ended": self.ended,
                "returns": self.returns,
                "visits": self.visits,
                "heard": self.heard,
                "earlier": state.earlier,
                "variables": self.variables,
                "offered": self.pairs,
                "last_lines": tuple([line.id for line in self.lines]),
                "past": Past(past.script, self.said, self.chosen, past.earlier, self.seen, past.strange),
            }
        )
        timed = None if timer is None else timer_at(timer, self.choices)
        return fresh, Beat(self.node, tuple(self.lines), self.choices, tuple(self.stimuli), self.ended, timed)
