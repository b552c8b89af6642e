"""The words of the script format, defined once: the reader reads by these shapes, ``dialogue/schema.json`` is made of
them.

A shape is a mapping with known keys; each key has a kind, a line of help (what an editor shows on hover) and, for
numbers, its range.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from game.story.vocabulary import WHEN

__all__ = [
    *("ACT_HELP", "OUTCOME_HELP", "WHEN_HELP"),
    *("BRANCH", "CHOICE", "CURRENCY", "GROUP", "HEAD", "ITEM", "LINE", "NEEDS", "NODE", "ORDERS", "PART", "SHAPES"),
    *("NAME", "TIMER", "VARIABLES", "WORDS", "Key", "Kind", "Shape"),
]

# fmt: off
Kind = Literal[
    "id", "text", "number", "whole", "flag", "condition", "feel", "set", "once", "values", "option",
    "person", "node", "ways", "act", "face", "gesture", "speaker", "ending", "pools", "outcomes",
    "shape", "list", "mapping", "lists", "texts",
]
# fmt: on

ORDERS: tuple[str, ...] = ("weighted", "shuffled", "listed")

# What an editor shows beside the words of the language.
ACT_HELP: Mapping[str, str] = {
    "praise": "says something good about the thing, the stall or the person",
    "joke": "makes light of something",
    "empathise": "names what the other may feel, or offers understanding",
    "story": "asks where something comes from",
    "press": "hurries or pushes",
    "flaw": "finds fault with the thing",
    "apologise": "takes something back",
    "small_talk": "is about nothing that matters",
    "wait": "says nothing and watches (standing)",
    "leave": "turns to go (standing)",
    "offer": "puts a bare offer (standing)",
}
OUTCOME_HELP: Mapping[str, str] = {
    "deal": "an offer was accepted; ends the talk",
    "sudden_end": "something else ends the talk",
    "out_of_patience": "the shopkeeper has had enough; ends the talk",
    "rounds_out": "there was no more time; ends the talk",
    "walked_away": "the player left; ends the talk",
    "refused_offer": "an offer was refused, the talk goes on",
    "insulted": "the offer was far too low, the talk goes on",
    "called_back": "the player turned to go and is called back",
    "came_back": "where a later visit starts",
}
WHEN_HELP: Mapping[str, str] = {
    "right": "the player's line did good, and the words tell it",
    "neutral": "it did nothing, and the words tell it",
    "wrong": "it did harm, and the words tell it",
    "veiled": "the words do not tell how it landed: must fit every feeling",
}


@dataclass(frozen=True)
class Key:
    """One key of a shape. of: the shape of what stands in it; options: the words it may be."""

    name: str
    kind: Kind
    help: str
    required: bool = False
    low: float = 0.0
    high: float = 0.0
    of: str = ""
    options: tuple[str, ...] = ()


@dataclass(frozen=True)
class Shape:
    """A mapping with known keys. title: what a message calls it."""

    name: str
    title: str
    help: str
    keys: tuple[Key, ...]

    def __iter__(self) -> Iterator[str]:
        return (key.name for key in self.keys)

    def __contains__(self, name: object) -> bool:
        return any(key.name == name for key in self.keys)

    def __getitem__(self, name: str) -> Key:
        return next(key for key in self.keys if key.name == name)

    @property
    def required(self) -> tuple[str, ...]:
        """The keys that must be there."""
        return tuple(key.name for key in self.keys if key.required)


_EN = Key("en", "text", "The words in English. {item}, {ask}, {offer} … are filled in; {n:cup|cups} is a plural.")
_JA = Key("ja", "text", "The words in Japanese. {n:#つ} is a number with its counter.")
_ID = Key("id", "id", "Stays the same for good: saves, translations and memory hang on it.", required=True)
_IF = Key("if", "condition", "Only where this condition holds.")
_FEEL = Key("feel", "feel", "Changes what she feels, by a little: {joy: 0.1}.")
_SET = Key("set", "set", "Computes variables: {told: told + 1}.")
_FACE = Key("face", "face", "A named expression (dialogue/faces.yaml) while the line is spoken.")
_TONE = Key("tone", "text", "How it is said, for voice actors and translators.")
_NOTE = Key("note", "text", "A note for translators and writers; never shown.")
_WEIGHT = Key("weight", "number", "How likely it is drawn, beside the others (1).", low=0.001, high=1000.0)
_INCLUDE = Key("include", "texts", "Files with more nodes, pools, variables and endings, within the stall's folder.")

WORDS = Shape("words", "the words", "The same in both languages.", (_EN, _JA))
NAME = Shape(
    "name",
    "a name",
    "A name in both languages.",
    (
        Key("en", "text", "The name in English.", required=True),
        Key("ja", "text", "The name in Japanese.", required=True),
    ),
)
CURRENCY = Shape(
    "currency",
    "currency",
    "How an amount is written; {n} is the number.",
    (
        Key("en", "text", 'In English: "¥{n}".', required=True),
        Key("ja", "text", 'In Japanese: "{n}円".', required=True),
    ),
)
ITEM = Shape(
    "item",
    "an item",
    "A thing on the table.",
    (
        Key("name", "shape", "What it is called, with a small letter.", required=True, of="name"),
        Key("list_price", "whole", "The price on the card.", required=True, low=1, high=1_000_000),
        Key("about", "shape", "What one sees who takes it up: one or two short sentences.", of="words"),
        _NOTE,
    ),
)
VARIABLES = Shape(
    "variables",
    "variables:",
    "Variables by scope; the initial value gives the type.",
    (
        Key("talk", "values", "New in every talk."),
        Key("stall", "values", "Kept at this stall for the afternoon."),
        Key("afternoon", "values", "Shared by all stalls."),
    ),
)
LINE = Shape(
    "line",
    "a line",
    "One spoken line. It is never spoken twice in a talk.",
    (
        *(_ID, _EN, _JA, _IF),
        Key("when", "option", "How the player's line landed; veiled: her words do not tell.", options=WHEN),
        Key("speaker", "speaker", "The shopkeeper unless you say: you, narrator, or the person's id."),
        _FACE,
        Key("gesture", "gesture", "A named gesture with the line, on top of what its words call up."),
        *(_TONE, _NOTE, _WEIGHT),
        Key("again", "flag", "May be spoken again in the same talk."),
        _FEEL,
    ),
)
GROUP = Shape(
    "group",
    "a group",
    "One line of several.",
    (
        Key("any", "list", "The lines, of which one is said that fits and was not said yet.", required=True, of="line"),
        Key(
            "order",
            "option",
            "weighted: by chance and weight; shuffled: each once before any again; listed: the first that fits.",
            options=ORDERS,
        ),
        _IF,
        LINE["when"],
    ),
)
NEEDS = Shape(
    "needs",
    "needs:",
    "Greys the choice out, with a reason, where the condition fails.",
    (
        Key("if", "condition", "The choice can be taken where this holds.", required=True),
        Key("en", "text", "The reason in English."),
        Key("ja", "text", "The reason in Japanese."),
    ),
)
CHOICE = Shape(
    "choice",
    "a choice",
    "Something the player can say or do.",
    (
        _ID,
        Key("act", "act", "What kind of line it is: the rules know how each lands on each feeling.", required=True),
        *(_EN, _JA),
        Key("say", "list", "Several wordings instead of en and ja; none is used twice in a talk.", of="line"),
        Key("to", "ways", "Where the talk goes on: a node, or a list of ways. The hub where it is left out."),
        *(_FEEL, _SET, _IF),
        Key("needs", "shape", "Greyed out, with a reason, unless the condition holds.", of="needs"),
        Key("once", "once", "true: used up for this talk; stall: for good; false: never."),
        Key("silent", "flag", "The label is shown, nothing is spoken."),
        *(_WEIGHT, _FACE, _TONE, _NOTE),
    ),
)
BRANCH = Shape(
    "branch",
    "a way on",
    "A way on with a condition.",
    (
        Key("if", "condition", "Taken where this holds.", required=True),
        Key("to", "node", "The node to go to then.", required=True),
    ),
)
TIMER = Shape(
    "timer",
    "timer:",
    "The player has so long; then the default is taken. Off unless the player's settings turn timers on.",
    (
        Key("seconds", "number", "How long the choice stands.", required=True, low=2.0, high=120.0),
        Key(
            "default", "text", "The id of a choice of this node, or a standing one, that takes no offer.", required=True
        ),
    ),
)
NODE = Shape(
    "node",
    "a node",
    "A place in the talk: lines, then choices to wait at, a way on, or an end.",
    (
        Key("lines", "list", "What is said here, in order.", of="line_or_group"),
        Key("to", "ways", "Goes on by itself: a node, back, home, or a list of ways of which the first that holds."),
        Key("choices", "list", "Waits; these choices are always there.", of="choice"),
        Key("pool", "pools", "Waits; choices are drawn from this pool, or from several."),
        Key("draw", "whole", "How many are drawn from the pool.", low=0, high=8),
        Key("standing", "flag", "false leaves out the standing choices."),
        Key("timer", "shape", "A timed choice with its default.", of="timer"),
        Key("call", "node", "Plays another node first; its `to: back` returns here."),
        Key("end", "ending", "Ends the talk with this ending."),
        *(_SET, _FEEL, _NOTE),
    ),
)
_POOLS = Key("pools", "lists", "Choices by pool; the game draws from them.", of="choice")
_NODES = Key("nodes", "mapping", "The places of the talk.", required=True, of="node")
_ENDINGS = Key("endings", "mapping", "How a talk can end, with a caption each.", of="words")
_VARIABLES = Key("variables", "shape", "Variables by scope: talk, stall, afternoon.", of="variables")
_NOTES = Key("notes", "text", "For writers; never shown.")
HEAD = Shape(
    "stall",
    "a stall",
    "One stall of the market and everything that is said there.",
    (
        Key("stall", "id", "The stall's id: the file's name.", required=True),
        Key("title", "shape", "What the stall is called.", required=True, of="words"),
        Key("person", "person", "Who stands behind it: dialogue/people/NAME.yaml.", required=True),
        _INCLUDE,
        Key("currency", "shape", "How an amount is written (yen where it is left out).", of="currency"),
        Key("items", "mapping", "What is sold.", required=True, of="item"),
        Key("start", "node", "Where a talk begins.", required=True),
        Key("home", "node", "The hub that `home` means.", required=True),
        Key("outcomes", "outcomes", "What the market made of a move -> node.", required=True),
        Key("endings", "mapping", _ENDINGS.help, required=True, of="words"),
        _VARIABLES,
        _POOLS,
        Key(
            "standing", "list", "Choices that are always there: an offer, waiting, leaving.", required=True, of="choice"
        ),
        *(_NODES, _NOTES),
    ),
)
PART = Shape(
    "part",
    "a part",
    "A file that stalls include: nodes, pools, variables and endings that several share.",
    (
        Key("part", "id", "The part's id: the file's name.", required=True),
        *(_INCLUDE, _VARIABLES, _POOLS, Key("nodes", "mapping", _NODES.help, of="node"), _ENDINGS, _NOTES),
    ),
)
SHAPES: tuple[Shape, ...] = (
    *(HEAD, PART, ITEM, WORDS, NAME, CURRENCY, VARIABLES, NODE, LINE, GROUP, CHOICE, NEEDS, BRANCH, TIMER),
)
