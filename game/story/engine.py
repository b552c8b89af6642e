"""Running a talk: (script, state, event, what the game knows) -> (state, beat). Pure; chance comes from the state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from game.core.errors import BadInput
from game.story.beat import Beat, Choice, Event, Outcome, Spoken, Start, Stimulus, Warp, timer_at
from game.story.chance import pick_weighted, uniform
from game.story.draw import draw_choices, fresh_of
from game.story.expressions import Scope
from game.story.filling import filled
from game.story.model import BACK, HOME, Branch, ChoiceDef, EffectDef, LineDef, NodeDef, Script
from game.story.prepared import FIXED_NAMES, Offered, ReadyLine, Table, prepared
from game.story.state import StoryState
from game.story.text import Text
from game.story.vocabulary import OUTCOMES, Value, environment

__all__ = ["advance", "resume"]

# A walk from one waiting place to the next passes far fewer nodes; the reader refuses scripts that could loop.
_MAX_STEPS = 500
_MAX_RETURNS = 16
_DRAW_STREAM = 0x9E3779B9
_KEPT_NAMES = FIXED_NAMES | {"offer"}
_NOTHING: Table = ((), (), ())


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
        run.returns.clear()
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
    run.lines = [run.spoken(script.lines[name]) for name in state.last_lines]
    run.node = state.node
    usable = [(script.choices[choice], run.line_of(choice, text)) for choice, text in state.offered]
    if state.ended is None and not any(run.usable(choice) for choice, _ in usable):
        run.wait_at(script.nodes[state.node])
    else:
        run.offered = tuple([(choice, line, None) for choice, line in usable])
    fresh, beat = run.result()
    return replace(fresh, last_lines=state.last_lines), beat


def _known(kind: str, script: Script) -> str:
    if kind not in OUTCOMES:
        raise BadInput("outcome", expected=" | ".join(OUTCOMES), seen=kind)
    return kind


class _Run:
    """The working copy of a state during one step."""

    def __init__(self, script: Script, state: StoryState, env: Mapping[str, Value]) -> None:
        self.script = script
        self.state = state
        self.node = state.node
        self.counter = state.counter
        self.turn = state.turn
        self.ended = state.ended
        self.returns = list(state.returns)
        self.visits = dict(state.visits)
        # The state's own until something is added.
        self.said: set[str] | frozenset[str] = state.said
        self.chosen: set[str] | frozenset[str] = state.chosen
        self.heard = dict(state.heard)
        self.seen: set[str] | None = None
        self.names: dict[str, Value] = environment(env)
        self.names.update(state.variables)
        self.names["item"] = state.item
        self.names["visit"] = float(state.visit)
        told = str(self.names["quality"]) if self.names["tells"] else "none"
        self.told = "veiled" if told == "none" else told
        self.ready = prepared(script, state.item)
        self.says = self.ready.told(self.told)
        self.scope = Scope(self.names, self.visits, self.gather)
        self.lines: list[Spoken] = []
        self.stimuli: list[Stimulus] = []
        self.offered: tuple[Offered, ...] = ()
        self.table: Table | None = None

    def gather(self) -> set[str]:
        """Everything said, chosen or visited so far, from now on kept up to date by ``note``."""
        self.seen = {*self.state.earlier, *self.said, *self.chosen, *self.visits}
        return self.seen

    def note(self, seen: str) -> None:
        """Something is said, chosen or visited."""
        if self.seen is not None:
            self.seen.add(seen)

    def chance(self) -> float:
        self.counter += 1
        return uniform(self.state.seed, self.counter)

    # --- walking ---------------------------------------------------------------------------------------------
    def choose(self, choice_id: str) -> str:
        """Take a choice: its words, effects and feelings; the node it leads to."""
        choice = text = None
        for name, wording in self.state.offered:
            if name == choice_id:
                choice, text = self.script.choices.get(name), wording
        if choice is None or text is None or not self.usable(choice):
            known = [name for name, _ in self.state.offered]
            raise BadInput("choice", expected=" | ".join(known) or "none", seen=choice_id)
        if not choice.silent:
            self.say_line(self.line_of(choice_id, text))
        if choice.act != "offer" and self.names["offer_result"] != "none":
            self.say_offer()
        if choice_id not in self.chosen:
            self.chosen = {*self.chosen, choice_id}
            self.note(choice_id)
        # What the choice itself makes her feel is judged with its act, by whoever knows the feelings.
        self.apply(choice.effects, {}, choice_id)
        return self.branch(choice.to)

    def say_offer(self) -> None:
        """A line that carries an offer is followed by the words of an offer."""
        for choice in self.script.standing:
            if choice.act == "offer":
                self.say([(line, None) for line in choice.texts if self.holds(line)], "weighted")
                return

    def walk(self, target: str, pending: str | None) -> None:
        """Pass nodes until one waits for the player or the talk ends; ``pending`` is the market's outcome."""
        closing: str | None = None
        nodes = self.script.nodes
        for _ in range(_MAX_STEPS):
            node = nodes.get(target)
            if node is None:
                target = self.resolved(target)
                node = nodes[target]
            outcome_node = self.script.outcomes.get(pending) if pending else None
            ending = pending is not None and OUTCOMES[pending]
            if pending is not None and (node.waits or (node.end is not None and ending)):
                # The market's answer comes after the reaction and before the talk goes on.
                if ending:
                    closing, self.returns = pending, []
                elif outcome_node is not None:
                    self.push(target)
                pending = None
                if outcome_node is not None:
                    target = outcome_node
                    continue
            if closing is not None and node.waits:
                break
            self.enter(node)
            if node.end is not None:
                self.ended = node.end
                return
            if node.waits:
                if self.wait_at(node) or target == self.script.home:
                    return
                target = HOME
                continue
            if node.call is None:
                target = self.branch(node.to)
            else:
                self.push(f"after:{node.id}")
                target = node.call
        if closing is not None:
            self.ended = closing
        else:
            self.node = self.script.home
            self.wait_at(self.script.nodes[self.node])

    def resolved(self, target: str) -> str:
        """A node's own name; ``back`` and ``home`` looked up."""
        if target in self.script.nodes:
            return target
        while target == BACK or target.startswith("after:"):
            if target == BACK:
                target = self.returns.pop() if self.returns else HOME
            else:
                target = self.branch(self.script.nodes[target.removeprefix("after:")].to)
        return self.script.home if target == HOME else target

    def push(self, target: str) -> None:
        self.returns.append(target)
        del self.returns[:-_MAX_RETURNS]

    def branch(self, branches: tuple[Branch, ...]) -> str:
        for branch in branches:
            if branch.condition is None or branch.condition.evaluate(self.scope):
                return branch.target
        return HOME

    def enter(self, node: NodeDef) -> None:
        name = self.node = node.id
        self.visits[name] = self.visits.get(name, 0) + 1
        self.note(name)
        if node.effects or node.feel:
            self.apply(node.effects, node.feel, name)
        says = self.says.get(name)
        if says is None:
            says = self.ready.says(node, self.told)
        scope = self.scope
        for test, order, lines in says:
            if test is not None and not test(scope):
                continue
            if len(lines) > 1:
                self.say(lines, order)
                continue
            line, own = lines[0]
            if (line.again or line.id not in self.said) and (own is None or own(scope)):
                self.say_line(line)

    def apply(self, effects: tuple[EffectDef, ...], feel: Mapping[str, float], source: str) -> None:
        for effect in effects:
            self.names[effect.name] = effect.value.evaluate(self.scope)
        if feel:
            self.stimuli.append(Stimulus(feel, source))

    # --- speaking --------------------------------------------------------------------------------------------
    def say(self, lines: Sequence[ReadyLine], order: str) -> None:
        """One line of those that can be said now."""
        said, scope = self.said, self.scope
        fresh = [line for line, test in lines if (line.again or line.id not in said) and (test is None or test(scope))]
        if len(fresh) > 1:
            fresh = fresh_of(fresh, order, self.state.earlier, self.heard)
        if fresh:
            self.say_line(fresh[0] if len(fresh) == 1 else self.drawn(fresh))

    def drawn(self, lines: Sequence[LineDef]) -> LineDef:
        """One of several by their weights."""
        return lines[pick_weighted([line.weight for line in lines], self.chance())]

    def say_line(self, line: LineDef) -> None:
        name = line.id
        if name not in self.said:
            if isinstance(self.said, frozenset):
                self.said = set(self.said)
            self.said.add(name)
            self.note(name)
        elif not line.again:
            return
        if line.again:
            self.heard[name] = self.heard.get(name, 0) + 1
        known = self.ready.spoken.get(name)
        self.lines.append(self.spoken(line) if known is None else known)
        if line.feel:
            self.stimuli.append(Stimulus(line.feel, name))

    def holds(self, line: LineDef) -> bool:
        """Whether a line fits how the player's line landed, and its condition holds."""
        return line.when in (None, self.told) and (line.condition is None or bool(line.condition.evaluate(self.scope)))

    def spoken(self, line: LineDef) -> Spoken:
        known = self.ready.spoken.get(line.id)
        if known is None:
            text = self.filled(line.text)
            known = Spoken(line.id, line.speaker, text.en, text.ja, line.face, line.tone, line.gesture)
            if line.text.names <= FIXED_NAMES:
                self.ready.spoken[line.id] = known
        return known

    def filled(self, text: Text, *, keep: str = "") -> Text:
        """The words with the names in braces filled in, ``keep`` left as it stands."""
        return filled(self.script, self.state.item, self.names, text, keep=keep)

    # --- choices ---------------------------------------------------------------------------------------------
    def shown(self, choice: ChoiceDef) -> bool:
        """Whether a choice may be seen: not used up, and its condition holds."""
        once = choice.once
        if once != "never" and choice.id in (self.chosen if once == "talk" else self.scope.seen):
            return False
        return choice.condition is None or bool(choice.condition.evaluate(self.scope))

    def usable(self, choice: ChoiceDef) -> bool:
        """Whether it may be taken as well."""
        return self.shown(choice) and (choice.needs is None or bool(choice.needs.evaluate(self.scope)))

    def wait_at(self, node: NodeDef) -> bool:
        """Lay the choices of a node on the table; False where none can be taken."""
        # A stream of its own, by turns: what was said before must not shift which lines are offered.
        self.turn += 1
        self.table = self.ready.tables.get(node.id)
        if self.table is not None:
            return True
        drawn: list[ChoiceDef] = []
        if node.pools:
            groups, seed = self.ready.groups(node), self.state.seed ^ _DRAW_STREAM
            drawn = draw_choices(groups, self.scope, self.chosen, node.draw, self.script.acts, seed, self.turn * 64)
        offered: list[Offered] = [(choice, self.variant(choice), None) for choice in drawn]
        here = self.laid(node.id, node.choices)
        standing = self.laid("", self.script.standing) if node.standing else ()
        self.offered = (*offered, *here, *standing)
        fixed = isinstance(here, tuple) and isinstance(standing, tuple)
        if fixed and self.offered and not node.pools:
            seen = tuple([made for _, _, made in self.offered if made is not None])
            pairs = tuple([(choice.id, line.id) for choice, line, _ in self.offered])
            self.ready.tables[node.id] = self.table = (self.offered, pairs, seen)
            return True
        return bool(offered) or any(made is not None or self.usable(choice) for choice, _, made in self.offered)

    def laid(self, place: str, choices: Sequence[ChoiceDef]) -> Sequence[Offered]:
        """Those of a place's choices that may be seen."""
        fixed = self.ready.fixed(place, choices, self.made)
        if fixed is not None:
            return fixed
        return [(choice, self.variant(choice), None) for choice in filter(self.shown, choices)]

    def variant(self, choice: ChoiceDef) -> LineDef:
        """A wording not yet used in this talk, by chance; the first where all were."""
        if len(choice.texts) == 1:
            return choice.texts[0]
        said, plain = self.said, self.ready.wordings(choice)
        if plain is None:
            fresh = [line for line in choice.texts if line.id not in said and self.holds(line)]
        else:
            fresh = [line for line in plain if line.id not in said]
        if len(fresh) < 2:
            return fresh[0] if fresh else choice.texts[0]
        return self.drawn(fresh)

    def line_of(self, choice_id: str, text_id: str) -> LineDef:
        texts = self.script.choices[choice_id].texts
        if len(texts) == 1:
            return texts[0]
        return next((line for line in texts if line.id == text_id), texts[0])

    def made(self, choice: ChoiceDef, line: LineDef) -> Choice:
        """A choice that can be taken, in one of its wordings, as the player sees it."""
        key = (choice.id, line.id)
        known = self.ready.options.get(key)
        if known is None:
            text = self.filled(line.text, keep="offer")
            known = Choice(choice.id, choice.act, text.en, text.ja, True, None, choice.feel)
            if line.text.names <= _KEPT_NAMES:
                self.ready.options[key] = known
        return known

    def _choice(self, choice: ChoiceDef, line: LineDef) -> Choice:
        if self.usable(choice):
            return self.made(choice, line)
        text = self.filled(line.text, keep="offer")
        reason = None if choice.reason is None else self.filled(choice.reason)
        return Choice(choice.id, choice.act, text.en, text.ja, False, reason, choice.feel)

    def result(self) -> tuple[StoryState, Beat]:
        if self.ended is not None:
            _, pairs, choices = _NOTHING
        elif self.table is not None:
            _, pairs, choices = self.table
        else:
            pairs = tuple([(choice.id, line.id) for choice, line, _ in self.offered])
            choices = tuple(
                [self._choice(choice, line) if made is None else made for choice, line, made in self.offered]
            )
        timer = timer_at(self.script.nodes[self.node].timer, choices) if self.ended is None and self.node else None
        names = self.names
        lines = tuple(self.lines)
        state = self.state.moved(
            started=True,
            counter=self.counter,
            turn=self.turn,
            node=self.node,
            ended=self.ended,
            returns=tuple(self.returns),
            visits=self.visits,
            said=frozenset(self.said),
            chosen=frozenset(self.chosen),
            heard=self.heard,
            variables={name: names[name] for name in self.script.variables},
            offered=pairs,
            last_lines=tuple([line.id for line in lines]),
        )
        return state, Beat(self.node, lines, choices, tuple(self.stimuli), self.ended, timer)
