"""Running a talk: (script, state, event, what the game knows) -> (state, beat). Pure; chance comes from the state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from game.core.errors import BadInput
from game.story.beat import Beat, Choice, Event, Outcome, Spoken, Start, Stimulus, Timer, Warp
from game.story.chance import pick_weighted, uniform
from game.story.draw import draw_choices
from game.story.expressions import Scope
from game.story.filling import filled
from game.story.model import BACK, HOME, Branch, ChoiceDef, EffectDef, LineDef, NodeDef, Script
from game.story.prepared import FIXED_NAMES, ReadyLine, prepared
from game.story.state import StoryState
from game.story.text import Text
from game.story.vocabulary import OUTCOMES, Value, environment

__all__ = ["advance", "resume"]

# A walk from one waiting place to the next passes far fewer nodes; the reader refuses scripts that could loop.
_MAX_STEPS = 500
_MAX_RETURNS = 16
_DRAW_STREAM = 0x9E3779B9


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
        run.offered = usable
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
        self.said = set(state.said)
        self.chosen = set(state.chosen)
        self.heard = dict(state.heard)
        self.seen = {*state.earlier, *state.said, *state.chosen, *state.visits}
        self.names: dict[str, Value] = environment(env)
        self.names.update(state.variables)
        self.names["item"] = state.item
        self.names["visit"] = float(state.visit)
        told = str(self.names["quality"]) if self.names["tells"] else "none"
        self.told = "veiled" if told == "none" else told
        self.ready = prepared(script, state.item)
        self.scope = Scope(self.names, self.visits, self.seen)
        self.lines: list[Spoken] = []
        self.stimuli: list[Stimulus] = []
        self.offered: list[tuple[ChoiceDef, LineDef]] = []

    # --- chance ----------------------------------------------------------------------------------------------
    def chance(self) -> float:
        self.counter += 1
        return uniform(self.state.seed, self.counter)

    # --- walking ---------------------------------------------------------------------------------------------
    def choose(self, choice_id: str) -> str:
        """Take a choice: its words, effects and feelings; the node it leads to."""
        offered = dict(self.state.offered)
        choice = self.script.choices.get(choice_id) if choice_id in offered else None
        if choice is None or not self.usable(choice):
            raise BadInput("choice", expected=" | ".join(offered) or "none", seen=choice_id)
        if not choice.silent:
            self.say_line(self.line_of(choice_id, offered[choice_id]))
        if choice.act != "offer" and self.names["offer_result"] != "none":
            self.say_offer()
        self.chosen.add(choice_id)
        self.seen.add(choice_id)
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
        for _ in range(_MAX_STEPS):
            target = self.resolved(target)
            node = self.script.nodes[target]
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
            target = self.way_on(node)
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

    def way_on(self, node: NodeDef) -> str:
        if node.call is None:
            return self.branch(node.to)
        self.push(f"after:{node.id}")
        return node.call

    def push(self, target: str) -> None:
        self.returns.append(target)
        del self.returns[:-_MAX_RETURNS]

    def branch(self, branches: tuple[Branch, ...]) -> str:
        for branch in branches:
            if branch.condition is None or branch.condition.evaluate(self.scope):
                return branch.target
        return HOME

    def enter(self, node: NodeDef) -> None:
        self.node = node.id
        self.visits[node.id] = self.visits.get(node.id, 0) + 1
        self.seen.add(node.id)
        if node.effects or node.feel:
            self.apply(node.effects, node.feel, node.id)
        for test, order, lines in self.ready.says(node, self.told):
            if test is None or test(self.scope):
                self.say(lines, order)

    def apply(self, effects: tuple[EffectDef, ...], feel: Mapping[str, float], source: str) -> None:
        for effect in effects:
            self.names[effect.name] = effect.value.evaluate(self.scope)
        if feel:
            self.stimuli.append(Stimulus(feel, source))

    # --- speaking --------------------------------------------------------------------------------------------
    def say(self, lines: Sequence[ReadyLine], order: str) -> None:
        """One line of those that can be said now."""
        said, scope = self.said, self.scope
        fresh = [line for line, test in lines if (line.id not in said or line.again) and (test is None or test(scope))]
        if len(fresh) > 1:
            fresh = [self.pick(fresh, order)]
        if fresh:
            self.say_line(fresh[0])

    def pick(self, fresh: list[LineDef], order: str) -> LineDef:
        """By the order of the group; on a later visit, what was said on an earlier one comes last."""
        if earlier := self.state.earlier:
            fresh = [line for line in fresh if line.id not in earlier] or fresh
        if order == "shuffled":
            least = min(self.heard.get(line.id, 0) for line in fresh)
            fresh = [line for line in fresh if self.heard.get(line.id, 0) == least]
        if len(fresh) == 1 or order == "listed":
            return fresh[0]
        return fresh[pick_weighted([line.weight for line in fresh], self.chance())]

    def say_line(self, line: LineDef) -> None:
        if line.id in self.said and not line.again:
            return
        self.said.add(line.id)
        self.seen.add(line.id)
        if line.again:
            self.heard[line.id] = self.heard.get(line.id, 0) + 1
        self.lines.append(self.spoken(line))
        if line.feel:
            self.stimuli.append(Stimulus(line.feel, line.id))

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
        if once != "never" and choice.id in (self.chosen if once == "talk" else self.seen):
            return False
        return choice.condition is None or bool(choice.condition.evaluate(self.scope))

    def usable(self, choice: ChoiceDef) -> bool:
        """Whether it may be taken as well."""
        return self.shown(choice) and (choice.needs is None or bool(choice.needs.evaluate(self.scope)))

    def wait_at(self, node: NodeDef) -> bool:
        """Lay the choices of a node on the table; False where none can be taken."""
        # A stream of its own, by turns: what was said before must not shift which lines are offered.
        self.turn += 1
        drawn: list[ChoiceDef] = []
        if node.pools:
            groups, seed = self.ready.groups(node), self.state.seed ^ _DRAW_STREAM
            drawn = draw_choices(groups, self.scope, self.chosen, node.draw, self.script.acts, seed, self.turn * 64)
        others = (*node.choices, *self.script.standing) if node.standing else node.choices
        self.offered = [(choice, self.variant(choice)) for choice in (*drawn, *filter(self.shown, others))]
        return bool(drawn) or any(self.usable(choice) for choice, _ in self.offered)

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
        return fresh[pick_weighted([line.weight for line in fresh], self.chance())]

    def line_of(self, choice_id: str, text_id: str) -> LineDef:
        texts = self.script.choices[choice_id].texts
        return next((line for line in texts if line.id == text_id), texts[0])

    def _choice(self, offered: tuple[ChoiceDef, LineDef]) -> Choice:
        choice, line = offered
        key = (choice.id, line.id)
        usable = self.usable(choice)
        if usable and key in self.ready.options:
            return self.ready.options[key]
        text = self.filled(line.text, keep="offer")
        reason = None if usable or choice.reason is None else self.filled(choice.reason)
        made = Choice(choice.id, choice.act, text.en, text.ja, usable, reason, choice.feel)
        if usable and line.text.names <= {*FIXED_NAMES, "offer"}:
            self.ready.options[key] = made
        return made

    def result(self) -> tuple[StoryState, Beat]:
        offered = [] if self.ended is not None else self.offered
        before = self.state
        state = StoryState(
            stall=before.stall,
            item=before.item,
            seed=before.seed,
            visit=before.visit,
            earlier=before.earlier,
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
            variables={name: self.names[name] for name in self.script.variables},
            offered=tuple([(choice.id, line.id) for choice, line in offered]),
            last_lines=tuple([line.id for line in self.lines]),
        )
        choices = tuple([self._choice(pair) for pair in offered])
        return state, Beat(self.node, tuple(self.lines), choices, tuple(self.stimuli), self.ended, self.timer(choices))

    def timer(self, choices: Sequence[Choice]) -> Timer | None:
        """The timer of the place where the talk waits, if its default can be taken."""
        timer = self.script.nodes[self.node].timer if self.ended is None and self.node else None
        if timer is None or not any(choice.id == timer.default and choice.available for choice in choices):
            return None
        return Timer(timer.seconds, timer.default)
