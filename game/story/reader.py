"""From a YAML file to a Script: the head, the pools and the nodes, with every fault noted on the way."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import cast

from game.core.errors import BadInput, Where
from game.core.paths import DIALOGUE
from game.formats.files import decode_utf8, read_bytes
from game.formats.yaml_source import Node
from game.story.checks import check_structure
from game.story.expressions import Names
from game.story.findings import Findings
from game.story.forms import PERSON_SLOTS
from game.story.grammar import CURRENCY, HEAD, ITEM, NAME, NODE, TIMER, VARIABLES, WORDS
from game.story.includes import included
from game.story.model import (
    ChoiceDef,
    Currency,
    EndingDef,
    Item,
    NodeDef,
    Script,
    Speaker,
    TimerDef,
    Variable,
    VariableScope,
)
from game.story.parts import Parts
from game.story.source import Source
from game.story.surroundings import Surroundings, gesture_names, surroundings
from game.story.text import ROWS_PER_BOX, Text
from game.story.vocabulary import ACTS, ENV, OPTIONAL_OUTCOMES, OUTCOMES, Type
from game.story.wording import Wording

__all__ = ["is_stall", "load_script", "read_script", "shipped_stalls"]

_TYPES: Mapping[type, Type] = {bool: "bool", int: "number", float: "number", str: "text"}
_YEN = Currency(Text("¥{n}", "{n}円"))
_MAX_BYTES = 2_000_000


def shipped_stalls(folder: Path = DIALOGUE) -> tuple[Path, ...]:
    """The stall scripts of a dialogue folder, by name."""
    return tuple(path for path in sorted(folder.glob("*.yaml")) if is_stall(path))


def is_stall(path: Path) -> bool:
    """Whether a file calls itself a stall; broken files do if they say so at the start of a row."""
    text = decode_utf8(read_bytes(path, max_bytes=_MAX_BYTES, what="YAML file"), path)
    return any(row.startswith("stall:") for row in text.split("\n"))


def load_script(path: Path) -> Script:
    """Read one stall. Raises BadInput for its first error, telling how many more there are."""
    findings = Findings()
    script = read_script(path, findings, traps=False)
    errors = sorted(findings.errors, key=lambda f: (f.where.line or 0, f.where.col or 0))
    if errors or script is None:
        first = errors[0]
        more = f"and {len(errors) - 1} more; run_game.py lint shows all" if len(errors) > 1 else None
        hint = "; ".join(part for part in (first.hint, more) if part)
        raise BadInput(f"{first.code} {first.message}", where=first.where, hint=hint or None)
    return script


def read_script(path: Path, findings: Findings, text: str | None = None, *, traps: bool = True) -> Script | None:
    """Read one stall, noting all faults; None where too little is left to look further into.

    A script with errors may still come back, for more checks; it must not be run. ``traps``: also look for words
    that other YAML tools misread.
    """
    if text is None:
        try:
            text = decode_utf8(read_bytes(path, max_bytes=_MAX_BYTES, what="YAML file"), path)
        except BadInput as error:
            findings.take("E_YAML", error)
            return None
    source = Source(path, text, findings, traps=traps)
    if source.root is None:
        return None
    head = source.mapping(source.root, HEAD)
    parts = included(path, source, head, findings)
    around = surroundings(head.get("person"), source, path, findings)
    if around is None or "nodes" not in head or not source.entries(head["nodes"]):
        return None
    return _Reader(source, findings, (head, *parts), around).script()


class _Reader:
    """One script being read."""

    def __init__(
        self, source: Source, findings: Findings, heads: Sequence[Mapping[str, Node]], around: Surroundings
    ) -> None:
        self.source = source
        self.findings = findings
        self.head = heads[0]
        # The stall's own head, then those of the files it includes.
        self.heads = heads
        self.around = around
        self.variables = self._variables()
        self.node_keys = self._node_keys()
        self.items = self._items()
        ids = {name for head in heads for name, _ in _ids(head)} | set(self.node_keys)
        types: dict[str, Type] = {name: known.type for name, known in ENV.items()}
        types |= {name: variable.type for name, variable in self.variables.items()}
        currency = self._currency()
        people: dict[str, Speaker] = {"you": "player", "narrator": "narrator", around.person.id: "shopkeeper"}
        self.parts = Parts(
            source=source,
            findings=findings,
            wording=Wording(
                source, findings, self.variables, [item.name for item in self.items.values()], currency, around.person
            ),
            names=Names(types, tuple(self.node_keys), frozenset(ids)),
            variables=self.variables,
            people=people,
            faces=around.faces,
            gestures=gesture_names,
            items=tuple(self.items),
            ids={name: key for name, (key, _) in self.node_keys.items()},
        )
        for name, item in self._abouts():
            self.items[name] = replace(self.items[name], about=self.parts.wording.text(*item, ROWS_PER_BOX))

    def _entries(self, key: str) -> Iterator[tuple[Node, Node]]:
        """(key, value) of a part of the head, in the stall's own file and then in those it includes."""
        return chain.from_iterable(self.source.entries(head.get(key)) for head in self.heads)

    def script(self) -> Script | None:
        head, parts, source = self.head, self.parts, self.source
        pools = self._pools()
        standing = parts.choices(head.get("standing"))
        endings = self._endings()
        nodes = {
            name: self._node(name, key, value, pools, endings, standing)
            for name, (key, value) in self.node_keys.items()
        }
        title = parts.wording.text(source.mapping(head["title"], WORDS), head["title"], 1) if "title" in head else None
        start, home = self._known_node("start"), self._known_node("home")
        stall = source.identifier(head.get("stall"))
        if title is None or start is None or home is None or stall is None:
            return None
        script = Script(
            stall=stall,
            path=source.path,
            where=source.root.where if source.root is not None else Where(source.path),
            files=tuple(source.rows),
            title=title,
            person=self.around.person,
            currency=parts.wording.currency,
            items=self.items,
            start=start,
            home=home,
            outcomes=self._outcomes(),
            endings=endings,
            variables=self.variables,
            pools=pools,
            standing=standing,
            nodes=nodes,
            faces=self.around.faces,
            acts=self.around.acts,
            names=parts.names,
            lowest_share=self.around.lowest_share,
        )
        check_structure(script, self.findings, head["home"].where, head.get("standing", head["home"]).where)
        return script

    # --- the head --------------------------------------------------------------------------------------------
    def _variables(self) -> dict[str, Variable]:
        out: dict[str, Variable] = {}
        scopes = [self.source.mapping(head["variables"], VARIABLES) for head in self.heads if "variables" in head]
        for scope, group in [pair for found in scopes for pair in found.items()]:
            for key, value in self.source.entries(group):
                name = self.source.identifier(key)
                if name is None:
                    continue
                if name in out or name in ENV or name in PERSON_SLOTS:
                    who = "another variable" if name in out else "the game"
                    self.findings.add("E_DUPLICATE_ID", key.where, f"the name {name!r} is taken by {who}")
                    continue
                kind = _TYPES.get(type(value.value)) if value.kind == "scalar" else None
                if kind is None or (kind == "number" and self.source.number(value, -1e9, 1e9) is None):
                    if kind is None:
                        self.findings.take("E_BAD_VALUE", value.error(expected="a number, text, true or false"))
                    continue
                initial = float(value.raw) if kind == "number" else cast("str | bool", value.value)
                out[name] = Variable(name, cast(VariableScope, scope), kind, initial, key.where)
        return out

    def _items(self) -> dict[str, Item]:
        out: dict[str, Item] = {}
        for key, value in self.source.entries(self.head.get("items")):
            name = self.source.identifier(key)
            fields = self.source.mapping(value, ITEM)
            price = self.source.whole_of(fields, ITEM, "list_price")
            words = self.source.mapping(fields["name"], NAME) if "name" in fields else {}
            texts = {language: self.source.text(node) or "" for language, node in words.items()}
            if name and price is not None and len(texts) == 2:
                out[name] = Item(name, Text(texts["en"], texts["ja"]), price, key.where)
        if not out and "items" in self.head:
            self.findings.add("E_MISSING_KEY", self.head["items"].where, "a stall sells at least one thing")
        return out

    def _abouts(self) -> Iterator[tuple[str, tuple[Mapping[str, Node], Node]]]:
        """Where the things' descriptions stand; one that is missing is noted."""
        for key, value in self.source.entries(self.head.get("items")):
            name = str(key.value)
            about = value.get("about") if name in self.items else None
            if about is not None:
                yield name, (self.source.mapping(about, WORDS), about)
            elif name in self.items:
                hint = "about: {en: …, ja: …}, what one sees who takes it up"
                self.findings.add("W_NO_ABOUT", key.where, f"{name!r} has no description", hint)

    def _currency(self) -> Currency:
        node = self.head.get("currency")
        if node is None:
            return _YEN
        fields = self.source.mapping(node, CURRENCY)
        texts = {}
        for language, item in fields.items():
            value = self.source.text(item)
            if value is not None and "{n}" not in value:
                self.findings.add("E_BAD_VALUE", item.where, "no {n} for the number", 'like "¥{n}"')
            texts[language] = value or "{n}"
        return Currency(Text(texts.get("en", "{n}"), texts.get("ja", "{n}")))

    def _endings(self) -> dict[str, EndingDef]:
        out: dict[str, EndingDef] = {}
        for key, value in self._entries("endings"):
            name = self.source.identifier(key)
            caption = self.parts.wording.text(self.source.mapping(value, WORDS), value, ROWS_PER_BOX)
            if name in out:
                self.findings.add("E_DUPLICATE_ID", key.where, f"the ending {name!r} is declared twice")
            elif name:
                out[name] = EndingDef(name, caption, key.where)
        return out

    def _outcomes(self) -> dict[str, str]:
        node = self.head.get("outcomes")
        out: dict[str, str] = {}
        for key, value in self.source.entries(node):
            kind = str(key.value)
            if kind not in OUTCOMES:
                self.findings.add(
                    "E_UNKNOWN_OUTCOME", key.where, f"unknown outcome {kind!r}", self.findings.hint(kind, OUTCOMES)
                )
                continue
            target = self.source.one_of(value, self.node_keys, "E_MISSING_TARGET", "node")
            if target:
                out[kind] = target
        if node is not None:
            given = {str(key.value) for key, _ in self.source.entries(node)}
            for kind in OUTCOMES:
                if kind not in given and kind not in OPTIONAL_OUTCOMES:
                    self.findings.add("E_MISSING_OUTCOME", node.where, f"no node for the outcome {kind!r}")
        return out

    def _known_node(self, key: str) -> str | None:
        return self.source.one_of(self.head.get(key), self.node_keys, "E_MISSING_TARGET", "node")

    # --- the body --------------------------------------------------------------------------------------------
    def _pools(self) -> dict[str, tuple[ChoiceDef, ...]]:
        out: dict[str, tuple[ChoiceDef, ...]] = {}
        for key, value in self._entries("pools"):
            name = self.source.identifier(key)
            if name:
                # An included file may add choices to a pool of the stall.
                out[name] = out.get(name, ()) + self.parts.choices(value, ACTS)
        return out

    def _node_keys(self) -> dict[str, tuple[Node, Node]]:
        out: dict[str, tuple[Node, Node]] = {}
        for key, value in self._entries("nodes"):
            name = self.source.identifier(key)
            if name in out:
                self.findings.add(
                    "E_DUPLICATE_ID", key.where, f"the node {name!r} is taken", f"first: {out[name][0].where}"
                )
            elif name in {"back", "home"}:
                self.findings.add("E_BAD_ID", key.where, f"{name!r} has a meaning of its own", "choose another name")
            elif name:
                out[name] = (key, value)
        return out

    def _node(
        self,
        name: str,
        key: Node,
        value: Node,
        pools: Mapping[str, Sequence[ChoiceDef]],
        endings: Mapping[str, EndingDef],
        standing: Sequence[ChoiceDef],
    ) -> NodeDef:
        source, parts = self.source, self.parts
        fields = source.mapping(value, NODE)
        choices = parts.choices(fields.get("choices"))
        node = NodeDef(
            id=name,
            where=key.where,
            says=parts.says(fields.get("lines")),
            to=parts.branches(fields.get("to")),
            choices=choices,
            pools=self._pool_names(fields.get("pool"), pools),
            draw=self._draw(fields),
            standing=source.flag(fields.get("standing"), True),
            call=source.one_of(fields.get("call"), self.node_keys, "E_MISSING_TARGET", "node"),
            end=source.one_of(fields.get("end"), endings, "E_UNKNOWN_ENDING", "ending"),
            effects=parts.effects(fields.get("set")),
            feel=parts.feel(fields.get("feel")),
            timer=self._timer(fields, choices, standing),
        )
        ways = [word for word in ("to", "choices", "pool", "end") if word in fields]
        if not ways:
            self.findings.add(
                "E_NO_WAY_ON", key.where, f"the node {name!r} leads nowhere", "give it to:, choices:, pool: or end:"
            )
        elif len(ways) > 1 and ways != ["choices", "pool"]:
            second = fields[ways[1]]
            self.findings.add("E_UNKNOWN_KEY", second.where, f"{ways[1]!r} beside {ways[0]!r}", "a node has one way on")
        return node

    def _draw(self, fields: Mapping[str, Node]) -> int:
        count = self.source.whole_of(fields, NODE, "draw")
        return self.around.acts.lines_on_offer if count is None else count

    def _timer(
        self, fields: Mapping[str, Node], choices: Sequence[ChoiceDef], standing: Sequence[ChoiceDef]
    ) -> TimerDef | None:
        """``timer:``, whose default must be a choice that is always there and asks for no offer."""
        node = fields.get("timer")
        if node is None:
            return None
        found = self.source.mapping(node, TIMER)
        seconds = self.source.number_of(found, TIMER, "seconds")
        here = [*choices, *(standing if self.source.flag(fields.get("standing"), True) else ())]
        known = [c.id for c in here if c.act != "offer" and c.condition is None and c.needs is None]
        default = self.source.one_of(found.get("default"), known, "E_MISSING_TARGET", "choice")
        if not ({"choices", "pool"} & {*fields}):
            self.findings.add(
                "E_UNKNOWN_KEY", node.where, "'timer' where nothing is chosen", "beside choices: or pool:"
            )
            return None
        return None if seconds is None or default is None else TimerDef(seconds, default, node.where)

    def _pool_names(self, node: Node | None, pools: Mapping[str, Sequence[ChoiceDef]]) -> tuple[str, ...]:
        if node is None:
            return ()
        items = node.as_list() if node.kind == "sequence" else [node]
        names = [self.source.one_of(item, pools, "E_UNKNOWN_POOL", "pool") for item in items]
        return tuple(name for name in names if name)


def _ids(head: Mapping[str, Node]) -> Iterator[tuple[str, Where]]:
    """Every ``id:`` below the head, so that ``seen('…')`` may look ahead."""
    stack = list(head.values())
    while stack:
        node = stack.pop()
        if node.kind == "mapping":
            for key, value in node.items():
                if key.value == "id" and isinstance(value.value, str):
                    yield value.value, value.where
                stack.append(value)
        elif node.kind == "sequence":
            stack.extend(node.as_list())
