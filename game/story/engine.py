"""Running a talk: (script, state, event, what the game knows) -> (state, beat). Pure; chance comes from the state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from game.core.errors import BadInput
from game.story.beat import Beat, Choice, Chose, Event, Outcome, Spoken, Start, Stimulus, Warp, timer_at
from game.story.chance import Lots, uniforms
from game.story.draw import draw_choices
from game.story.expressions import Scope
from game.story.filling import filled
from game.story.model import BACK, HOME, Script
from game.story.ready import ReadyChoice, ReadyEffect, ReadyGroup, ReadyLine, ReadyNode, Way, offered, spoken
from game.story.standing import StoryState
from game.story.state import restore, save
from game.story.text import Text
from game.story.vocabulary import OUTCOMES, Value, checked

__all__ = ["advance", "resume"]

# A walk from one waiting place to the next passes far fewer nodes; the reader refuses scripts that could loop.
_STEPS = range(500)
_MAX_RETURNS = 16
_DRAW_STREAM = 0x9E3779B9
_AHEAD = 6
# Every step makes a state and a beat: without the detour over the names of their fields, at half the price.
_tuple = tuple.__new__


def advance(script: Script, state: StoryState, event: Event, env: Mapping[str, Value]) -> tuple[StoryState, Beat]:
    """One step of the talk.

    env: names of ``ENV`` as the game knows them now, with the event's own results already in; missing ones take
    their default. Raises BadInput for an event that does not fit: a choice that is not offered, an unknown
    outcome, anything after the end.
    """
    run = _Run(state, env)
    if run.ready.script is not script:
        run = _Run(restore(script, save(state)), env)
    if run.ended is not None:
        raise BadInput("talk", expected="one that goes on", seen=f"ended: {run.ended}")
    if isinstance(event, Chose) and run.started:
        outcome = event.outcome
        run.walk(run.choose(event.choice), None if outcome is None else _known(outcome, script))
    elif isinstance(event, Warp):
        if event.node not in script.nodes:
            raise BadInput("node", expected=f"one of {script.stall}", seen=event.node)
        run.returns = ()
        run.walk(event.node, None)
    elif isinstance(event, Start) == run.started:
        raise BadInput("event", expected="Start once, and first", seen=type(event).__name__)
    elif isinstance(event, Start):
        came_back = script.outcomes.get("came_back") if run.talk.visit > 1 else None
        run.walk(came_back or script.start, None)
    else:
        assert isinstance(event, Outcome)
        run.walk(run.node, _known(event.kind, script))
    return run.result()


def resume(script: Script, state: StoryState, env: Mapping[str, Value]) -> tuple[StoryState, Beat]:
    """The last beat again, after a load: its lines, and the same choices. Nothing advances.

    Where a script was edited so that nothing of the offer is left, a new one is drawn.
    """
    if not state.started:
        return state, Beat("", (), (), (), None)
    if state.talk.ready.script is not script:
        state = restore(script, save(state))
    run = _Run(state, env)
    if state.ended is None and not any(run.usable(choice) for choice, _ in run.laid):
        run.wait_at(run.ready.node(state.node))
    else:
        run.lay(run.laid)
    last = run.heard[len(run.heard) - run.last :]
    for line in last:
        run.lines += run.spoken(run.ready.line(script.lines[line.id]))
    fresh, beat = run.result()
    return fresh._replace(lines=run.heard), beat


def _known(kind: str, script: Script) -> str:
    if kind not in OUTCOMES:
        raise BadInput("outcome", expected=" | ".join(OUTCOMES), seen=kind)
    return kind


class _Run(Scope):
    """The working copy of where a talk stands during one step.

    told: how the player's line landed, ``veiled`` where the words hide it; offering: whether an offer went with it;
    kept: what conditions and lines may use, without what the game says of this step; nodes: all that were passed;
    heard: the lines before this step, of which ``last`` came in the step before; lines, stimuli: what came in this one;
    options: the choices as the player sees them.
    """

    names: Mapping[str, Value]
    kept: Mapping[str, Value]
    __slots__ = (
        "ahead", "counter", "ended", "heard", "kept", "laid", "last", "lines", "node", "nodes", "offering", "options",
        "past", "ready", "returns", "started", "stimuli", "talk", "told", "turn",
    )  # fmt: skip

    def __init__(self, before: StoryState, env: Mapping[str, Value]) -> None:
        (
            self.talk, self.node, self.started, self.ended, self.counter, self.turn, self.returns, self.past, kept,
            self.laid, self.nodes, self.heard, self.last,
        ) = before  # fmt: skip
        self.ready = self.talk.ready
        self.names = self.kept = kept
        self.told, self.offering = "veiled", False
        if env:
            names = self.names = {**kept, **checked(env), "item": kept["item"], "visit": kept["visit"]}
            if names["tells"] and names["quality"] != "none":
                self.told = str(names["quality"])
            self.offering = names["offer_result"] != "none"
        self.ahead: list[float] | None = None
        self.lines: tuple[Spoken, ...] = ()
        self.stimuli: tuple[Stimulus, ...] = ()
        self.options: tuple[Choice, ...] = ()

    # --- what conditions ask ---------------------------------------------------------------------------------
    def visits(self, node: str) -> int:
        return self.nodes.count(node)

    def seen(self, name: str) -> bool:
        return bool(self.everything & self.ready.script.bits.seen[name])

    @property
    def everything(self) -> int:
        """The bits of what was said, chosen or passed, on earlier visits, too."""
        return self.past | self.talk.earlier_bits

    def chance(self) -> float:
        # Numbers come cheaper by the half dozen; those that nobody takes are drawn again in the next step.
        if not self.ahead:
            self.ahead = uniforms(self.talk.seed, self.counter + 1, _AHEAD)
            self.ahead.reverse()
        self.counter += 1
        return self.ahead.pop()

    # --- walking ---------------------------------------------------------------------------------------------
    def choose(self, choice_id: str) -> str:
        """Take a choice: its words, effects and feelings; the node it leads to, or its own passage with all of that."""
        for choice, line in self.laid:  # noqa: B007 - the one that is found
            if choice.id == choice_id and (choice.always or self.usable(choice)):
                break
        else:
            ids = " | ".join([choice.id for choice, _ in self.laid])
            raise BadInput("choice", expected=ids or "none", seen=choice_id)
        if choice.onward and not self.offering:
            return choice.onward[1 if self.past & line.bit else 0]
        if not choice.silent:
            self.say(line)
        if self.offering and choice.act != "offer":
            # A line that carries an offer is followed by the words of an offer.
            offer = self.ready.offer(self.told)
            if offer is not None:
                self.say_one(offer)
        self.past |= choice.bit
        if choice.effects:
            # What the choice itself makes her feel is judged with its act, by whoever knows the feelings.
            self.apply(choice.effects)
        return choice.way or self.way(choice.ways)

    def walk(self, target: str, pending: str | None) -> None:
        """Pass nodes until one waits for the player or the talk ends; ``pending`` is the market's outcome."""
        closing: str | None = None
        ready, told = self.ready, self.told
        passages = ready.passages[told]
        for _ in _STEPS:
            node, stretch = passages.get(target) or ready.passage(self.resolved(target), told)
            if pending is not None and node.halts:
                ending = OUTCOMES[pending]
                if node.waits or ending:
                    # The market's answer comes after the reaction and before the talk goes on.
                    outcome_node = ready.script.outcomes.get(pending)
                    if ending:
                        closing, self.returns = pending, ()
                    elif outcome_node is not None:
                        self.push(node.id)
                    pending = None
                    if outcome_node is not None:
                        target = outcome_node
                        continue
            if closing is not None and node.waits:
                break
            self.node = node.id
            while True:
                nodes, lines, past, stimuli, effects, says, then = stretch
                self.nodes += nodes
                self.past |= past
                if lines:
                    self.lines += lines
                if stimuli:
                    self.stimuli += stimuli
                if effects:
                    self.apply(effects)
                if says:
                    for test, group in says:
                        if test is None or test(self):
                            self.say_one(group)
                if then is None:
                    break
                stretch = then
            if not node.halts:
                if node.call is None:
                    for test, target in node.ways:  # noqa: B007 - the first that is open
                        if test is None or test(self):
                            break
                else:
                    self.push(node.after)
                    target = node.call
            elif node.end is not None:
                self.ended = node.end
                return
            elif node.table is not None:
                self.turn += 1
                self.laid, self.options = node.table
                return
            elif self.wait_at(node) or node.id == ready.script.home:
                return
            else:
                target = HOME
        if closing is not None:
            self.ended = closing
        else:
            self.node = ready.script.home
            self.wait_at(ready.node(self.node))

    def resolved(self, target: str) -> str:
        """A node's own name; ``back`` and ``home`` looked up."""
        if target in self.ready.script.nodes:
            return target
        while target == BACK or target.startswith("after:"):
            if target == BACK:
                target = self.returns[-1] if self.returns else HOME
                self.returns = self.returns[:-1]
            else:
                target = self.way(self.ready.node(target.removeprefix("after:")).ways)
        return self.ready.script.home if target == HOME else target

    def push(self, target: str) -> None:
        self.returns = (*self.returns, target)[-_MAX_RETURNS:]

    def way(self, ways: Sequence[Way]) -> str:
        for test, target in ways:
            if test is None or test(self):
                return target
        return HOME

    def apply(self, effects: Sequence[ReadyEffect]) -> None:
        kept = {**self.kept}
        names = self.names = kept if self.names is self.kept else {**self.names}
        self.kept = kept
        for name, value in effects:
            names[name] = kept[name] = value(self)

    # --- speaking --------------------------------------------------------------------------------------------
    def say_one(self, group: ReadyGroup) -> None:
        """One line of those that can be said now."""
        line = group.only
        if line is not None:
            if (line.again or not self.past & line.bit) and (line.test is None or line.test(self)):
                self.say(line)
        else:
            lots = group.left(self.past, self.talk.earlier_bits).usable(self)
            if group.recalls:
                lots = group.least_heard(lots, [line.id for line in (*self.heard, *self.lines)])
            if lots.items:
                self.say(lots.only or lots.draw(self.chance()))

    def say(self, line: ReadyLine) -> None:
        if not self.past & line.bit:
            self.past |= line.bit
        elif not line.again:
            return
        self.lines += line.fixed or self.spoken(line)
        if line.stimulus is not None:
            self.stimuli += (line.stimulus,)

    def holds(self, line: ReadyLine) -> bool:
        """Whether a line fits how the player's line landed, and its condition holds."""
        return line.when in (None, self.told) and (line.test is None or bool(line.test(self)))

    def spoken(self, line: ReadyLine) -> tuple[Spoken, ...]:
        """A line with its words filled in."""
        key = tuple([self.names.get(name) for name in line.asks])
        known = line.spoken.get(key)
        if known is None:
            known = line.spoken.keep(key, (spoken(line.line, self.filled(line.line.text)),))
            line.fixed = () if line.asks else known
        return known

    def filled(self, text: Text, *, keep: str = "") -> Text:
        """The words with the names in braces filled in, ``keep`` left as it stands."""
        return filled(self.ready.script, self.ready.item, self.names, text, keep=keep)

    # --- choices ---------------------------------------------------------------------------------------------
    def shown(self, choice: ReadyChoice) -> bool:
        """Whether a choice may be seen: not used up, and its condition holds."""
        if self.past & choice.used or (choice.gone and choice.gone & self.everything):
            return False
        return choice.shown is None or bool(choice.shown(self))

    def usable(self, choice: ReadyChoice) -> bool:
        """Whether it may be taken as well."""
        return self.shown(choice) and (choice.needs is None or bool(choice.needs(self)))

    def wait_at(self, node: ReadyNode) -> bool:
        """Lay the choices of a node on the table; False where none can be taken."""
        # A stream of its own, by turns: what was said before must not shift which lines are offered.
        self.turn += 1
        if node.table is not None:
            self.laid, self.options = node.table
            return True
        drawn: Sequence[ReadyChoice] = ()
        if node.pool is not None:
            seed = self.talk.seed ^ _DRAW_STREAM
            drawn = draw_choices(node.pool, self, self.past, self.everything, seed, self.turn * 64)
        laid = [(choice, self.variant(choice)) for choice in drawn]
        laid += [(choice, self.variant(choice)) for choice in node.laid if choice.always or self.shown(choice)]
        return self.lay(laid, usable=len(drawn))

    def lay(self, laid: Sequence[tuple[ReadyChoice, ReadyLine]], *, usable: int = 0) -> bool:
        """Put choices on the table; ``usable``: so many of the first are known to be. Whether any can be taken."""
        taken, options = usable > 0, []
        for at, (choice, line) in enumerate(laid):
            if at < usable or choice.always or self.usable(choice):
                options.append(line.offered or self.option(choice, line))
                taken = True
            else:
                options.append(self.greyed(choice, line))
        self.laid, self.options = tuple(laid), tuple(options)
        return taken

    def variant(self, choice: ReadyChoice) -> ReadyLine:
        """A wording not yet used in this talk, by chance; the first where all were."""
        texts = choice.texts
        if len(texts) == 1:
            return texts[0]
        said = self.past & choice.mask
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
            known = offered(choice, self.filled(line.line.text, keep="offer"))
            line.option.keep(key, known)
            line.offered = None if line.keeps else known
        return known

    def greyed(self, choice: ReadyChoice, line: ReadyLine) -> Choice:
        """A choice that can be seen and not taken, and why."""
        text, why = self.filled(line.line.text, keep="offer"), choice.choice.reason
        reason = None if why is None else self.filled(why)
        return Choice(choice.id, choice.act, text.en, text.ja, False, reason, choice.choice.feel)

    # --- what came of it -------------------------------------------------------------------------------------
    def result(self) -> tuple[StoryState, Beat]:
        """Where the talk stands now, and what the player is told of it."""
        timed = None
        if self.ended is not None:
            self.laid, self.options = (), ()
        elif self.node in self.ready.timers:
            timed = timer_at(self.ready.timers[self.node], self.options)
        fresh = _tuple(StoryState, (
            self.talk, self.node, True, self.ended, self.counter, self.turn, self.returns, self.past, self.kept,
            self.laid, self.nodes, self.heard + self.lines, len(self.lines),
        ))  # fmt: skip
        beat = _tuple(Beat, (self.node, self.lines, self.options, self.stimuli, self.ended, timed))
        return fresh, beat
