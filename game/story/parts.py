"""Reading the parts of a script: lines, choices, ways on, effects. Faults are noted; what can be read is returned."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import cast

from game.core.emotion_space import EMOTIONS, SIX
from game.formats.yaml_source import Node
from game.story.expressions import Expression, ExpressionError, Names, compile_expression
from game.story.findings import Findings
from game.story.grammar import BRANCH, CHOICE, GROUP, LINE, NEEDS, ORDERS
from game.story.model import (
    BACK,
    HOME,
    Branch,
    ChoiceDef,
    EffectDef,
    LineDef,
    Order,
    SayDef,
    Speaker,
    Variable,
)
from game.story.source import Source
from game.story.text import LANGUAGES, ROWS_PER_BOX, Text
from game.story.vocabulary import ACTS, ENV, STANDING_ACTS, WHEN, Type
from game.story.wording import Wording

__all__ = ["Parts"]

_CHOICE_ROWS = 2
_ONCE = {True: "talk", False: "never"}


@dataclass
class Parts:
    """Reads parts of one script.

    names: what expressions may mention; gestures: known named gestures, asked for only where a line names one; ids:
    where each id was given first.
    """

    source: Source
    findings: Findings
    wording: Wording
    names: Names
    variables: Mapping[str, Variable]
    people: Mapping[str, Speaker]
    faces: Mapping[str, Mapping[str, float]]
    gestures: Callable[[], Sequence[str]]
    items: Sequence[str]
    ids: dict[str, Node]

    # --- expressions -----------------------------------------------------------------------------------------
    def expression(self, node: Node | None, wanted: Type | None) -> Expression | None:
        """A checked expression; YAML numbers and true/false are expressions too."""
        if node is None:
            return None
        if node.kind != "scalar":
            self.findings.take("E_BAD_VALUE", node.error(expected="an expression"))
            return None
        source = node.raw.lower() if isinstance(node.value, bool) else node.raw
        try:
            expression = compile_expression(source, self.names, self.source.inside(node), wanted=wanted)
            self._check_values(expression)
            return expression
        except ExpressionError as error:
            self.findings.add(error.code, error.where or node.where, error.plain, error.hint)
            return None

    def _check_values(self, expression: Expression) -> None:
        """Text that a name is compared with must be a value it can have."""
        for name, constants in expression.compared.items():
            known = self.items if name == "item" else [str(value) for value in ENV[name].values] if name in ENV else ()
            for constant in sorted(str(value) for value in constants if isinstance(value, str)):
                if known and constant not in known:
                    code = "E_UNKNOWN_ITEM" if name == "item" else "W_UNKNOWN_VALUE"
                    message = f"{name} is never {constant!r}"
                    self.findings.add(code, expression.where, message, self.findings.hint(constant, known))

    def effects(self, node: Node | None) -> tuple[EffectDef, ...]:
        """``set: {name: expression}``."""
        out = []
        for key, value in self.source.entries(node):
            name = str(key.value)
            if name not in self.variables:
                hint = self.findings.hint(name, self.variables)
                if name in ENV:
                    hint = "this one is set by the game"
                self.findings.add("E_UNKNOWN_NAME", key.where, f"no variable {name!r} to set", hint)
                continue
            expression = self.expression(value, self.variables[name].type)
            if expression is not None:
                out.append(EffectDef(name, expression, key.where))
        return tuple(out)

    def feel(self, node: Node | None) -> dict[str, float]:
        """``feel: {joy: 0.2}``: signed changes of the six emotions."""
        out = {}
        for key, value in self.source.entries(node):
            name = str(key.value)
            if name not in SIX:
                hint = "neutral is what is left" if name in EMOTIONS else self.findings.hint(name, SIX)
                self.findings.add("E_UNKNOWN_EMOTION", key.where, f"unknown emotion {name!r}", hint)
                continue
            amount = self.source.number(value, -1.0, 1.0)
            if amount is not None:
                out[name] = amount
        return out

    # --- lines -----------------------------------------------------------------------------------------------
    def says(self, node: Node | None) -> tuple[SayDef, ...]:
        """``lines:``: single lines, and ``any:`` groups of which one is said."""
        out = []
        for item in self.source.items(node):
            if item.kind == "mapping" and "any" in item:
                fields = self.source.mapping(item, GROUP)
                lines = [self.line(line) for line in self.source.items(fields.get("any"))]
                group = tuple(line for line in lines if line is not None)
                condition, when = self.expression(fields.get("if"), "bool"), self._when(fields.get("when"))
                order = self.source.one_of(fields.get("order"), ORDERS, "E_BAD_VALUE", "order")
                if group:
                    out.append(SayDef(group, item.where, condition, when, cast(Order, order or "weighted")))
                else:
                    self.findings.add("E_MISSING_KEY", item.where, "any: needs at least one line")
            else:
                line = self.line(item)
                if line is not None:
                    out.append(SayDef((line,), item.where))
        return tuple(out)

    def line(self, node: Node, speaker: Speaker = "shopkeeper", rows: int = ROWS_PER_BOX) -> LineDef | None:
        """One line."""
        fields = self.source.mapping(node, LINE)
        if not fields:
            return None
        name = self.identifier(fields.get("id"))
        text = self.wording.text(fields, node, rows)
        spoken_by = self.source.one_of(fields.get("speaker"), self.people, "E_BAD_VALUE", "speaker")
        face = self.source.one_of(fields.get("face"), self.faces, "E_UNKNOWN_FACE", "expression")
        weight = self.source.number_of(fields, LINE, "weight")
        line = LineDef(
            id=name or "",
            text=text,
            where=node.where,
            speaker=self.people[spoken_by] if spoken_by else speaker,
            condition=self.expression(fields.get("if"), "bool"),
            when=self._when(fields.get("when")),
            face=face,
            gesture=self._gesture(fields.get("gesture")),
            tone=self.source.text(fields.get("tone")),
            note=self.source.text(fields.get("note")),
            weight=1.0 if weight is None else weight,
            again=self.source.flag(fields.get("again"), False),
            feel=self.feel(fields.get("feel")),
        )
        return line if name else None

    def _gesture(self, node: Node | None) -> str | None:
        return None if node is None else self.source.one_of(node, self.gestures(), "E_UNKNOWN_GESTURE", "gesture")

    def _when(self, node: Node | None) -> str | None:
        return self.source.one_of(node, WHEN, "E_UNKNOWN_NAME", "`when`")

    def identifier(self, node: Node | None) -> str | None:
        """An id that nobody else has."""
        name = self.source.identifier(node)
        if name is None or node is None:
            return None
        first = self.ids.get(name)
        if first is not None and first is not node:
            place = f"{first.where.line}:{first.where.col}"
            if first.where.path != node.where.path:
                place = str(first.where)
            self.findings.add("E_DUPLICATE_ID", node.where, f"the id {name!r} is taken", f"first used at {place}")
            return None
        self.ids[name] = node
        return name

    # --- choices ---------------------------------------------------------------------------------------------
    def choices(self, node: Node | None, acts: Sequence[str] = (*ACTS, *STANDING_ACTS)) -> tuple[ChoiceDef, ...]:
        """A list of choices; ``acts``: those allowed here."""
        found = [self.choice(item, acts) for item in self.source.items(node)]
        return tuple(choice for choice in found if choice is not None)

    def choice(self, node: Node, acts: Sequence[str]) -> ChoiceDef | None:
        """One choice: either its words, or ``say:`` with several wordings of it."""
        fields = self.source.mapping(node, CHOICE)
        if not fields:
            return None
        name = self.identifier(fields.get("id"))
        act = self.source.one_of(fields.get("act"), acts, "E_UNKNOWN_ACT", "act")
        texts = self._wordings(fields, node, name or "")
        needs, reason = self._needs(fields.get("needs"))
        weight = self.source.number_of(fields, CHOICE, "weight")
        choice = ChoiceDef(
            id=name or "",
            act=act or "",
            texts=texts,
            where=node.where,
            to=self.branches(fields.get("to")) or (Branch(HOME, node.where),),
            feel=self.feel(fields.get("feel")),
            effects=self.effects(fields.get("set")),
            condition=self.expression(fields.get("if"), "bool"),
            needs=needs,
            reason=reason,
            once=self._once(fields.get("once")),  # type: ignore[arg-type]  # one of the three by construction
            silent=self.source.flag(fields.get("silent"), False),
            weight=1.0 if weight is None else weight,
        )
        return choice if name and act and texts else None

    def _wordings(self, fields: Mapping[str, Node], node: Node, name: str) -> tuple[LineDef, ...]:
        if "say" in fields:
            for language in LANGUAGES:
                if language in fields:
                    where = fields[language].where
                    self.findings.add("E_UNKNOWN_KEY", where, f"{language!r} beside say:", "put it into the list")
            found = [self.line(item, "player", _CHOICE_ROWS) for item in self.source.items(fields["say"])]
            texts = tuple(line for line in found if line is not None)
            if not texts:
                self.findings.add("E_MISSING_KEY", fields["say"].where, "say: needs at least one wording")
            return texts
        words = self.wording.text(fields, node, _CHOICE_ROWS)
        face = self.source.one_of(fields.get("face"), self.faces, "E_UNKNOWN_FACE", "expression")
        tone, note = self.source.text(fields.get("tone")), self.source.text(fields.get("note"))
        return (LineDef(name, words, node.where, "player", face=face, tone=tone, note=note),)

    def _needs(self, node: Node | None) -> tuple[Expression | None, Text | None]:
        if node is None:
            return None, None
        fields = self.source.mapping(node, NEEDS)
        return self.expression(fields.get("if"), "bool"), self.wording.text(fields, node, _CHOICE_ROWS)

    def _once(self, node: Node | None) -> str:
        if node is None:
            return "talk"
        if isinstance(node.value, bool):
            return _ONCE[node.value]
        if node.value == "stall":
            return "stall"
        self.findings.take("E_BAD_VALUE", node.error(expected="true, false or stall"))
        return "talk"

    # --- ways on ---------------------------------------------------------------------------------------------
    def branches(self, node: Node | None) -> tuple[Branch, ...]:
        """``to: node`` or ``to: [{if: …, to: node}, …, node]``."""
        if node is None:
            return ()
        if node.kind != "sequence":
            target = self.target(node)
            return (Branch(target, node.where),) if target else ()
        out: list[Branch] = []
        for item in node.as_list():
            if item.kind == "mapping":
                fields = self.source.mapping(item, BRANCH)
                condition, target = self.expression(fields.get("if"), "bool"), self.target(fields.get("to"))
                if condition is not None and target:
                    out.append(Branch(target, item.where, condition))
            else:
                target = self.target(item)
                if target:
                    out.append(Branch(target, item.where))
        if out and out[-1].condition is not None:
            self.findings.add(
                "W_FALLS_THROUGH", out[-1].where, "the last way on has a condition", "end the list with a plain node"
            )
        return tuple(out)

    def target(self, node: Node | None) -> str | None:
        """A node's id, ``back`` or ``home``."""
        known = [*self.names.nodes, BACK, HOME]
        return self.source.one_of(node, known, "E_MISSING_TARGET", "node")
