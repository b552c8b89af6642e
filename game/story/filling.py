"""The names in braces of a text, filled in as the game knows them; and any line or choice as it would be said now."""

from __future__ import annotations

from collections.abc import Mapping

from game.story.beat import Choice, Spoken
from game.story.forms import PERSON_SLOTS, number_text, person_word
from game.story.model import ChoiceDef, LineDef, Script
from game.story.prepared import prepared
from game.story.ready import spoken
from game.story.text import Text, fill
from game.story.vocabulary import DEFAULTS, ENV, Value, checked

__all__ = ["filled", "rehearse_choice", "rehearse_line"]


def filled(script: Script, item: str, names: Mapping[str, Value], text: Text, *, keep: str = "") -> Text:
    """The words with the names in braces filled in, ``keep`` left as it stands."""
    if not text.names or text.names == {keep}:
        return text
    person = script.person

    def value(name: str, language: str) -> str | None:
        if name in PERSON_SLOTS:
            return person_word(name, person.name.get(language), person.pronoun, language)
        if name == keep or name not in names:
            return None
        if name == "item":
            return script.items[item].name.get(language)
        found = names[name]
        if name in ENV and ENV[name].money and not isinstance(found, str):
            return prepared(script, item).money(found).get(language)
        if isinstance(found, float):
            return number_text(found)
        return str(found).lower() if isinstance(found, bool) else found

    def number_of(name: str) -> float | None:
        """What decides a plural: a number, or how many a pronoun speaks of."""
        if name == "they":
            return 2.0 if person.pronoun == "they" else 1.0
        found = names.get(name)
        return found if isinstance(found, float) else None

    return Text(
        fill(text.en, lambda name: value(name, "en"), number_of, "en"),
        fill(text.ja, lambda name: value(name, "ja"), number_of, "ja"),
    )


def rehearse_line(script: Script, item: str, line: LineDef, env: Mapping[str, Value]) -> Spoken:
    """A line as it would be said, whether or not it could be said now. env: as in ``advance``."""
    return spoken(line, filled(script, item, _names(script, item, env), line.text))


def rehearse_choice(script: Script, item: str, choice: ChoiceDef, line: LineDef, env: Mapping[str, Value]) -> Choice:
    """A choice in one of its wordings as it would be offered, whether or not it could be."""
    text = filled(script, item, _names(script, item, env), line.text, keep="offer")
    return Choice(choice.id, choice.act, text.en, text.ja, True, None, choice.feel)


def _names(script: Script, item: str, env: Mapping[str, Value]) -> dict[str, Value]:
    start = {name: variable.initial for name, variable in script.variables.items()}
    return {**DEFAULTS, **checked(env), **start, "item": item}
