"""The words of a line as they are read: both languages there, no row too long, nothing unknown in braces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from game.formats.yaml_source import Node
from game.story.findings import Findings
from game.story.forms import FORMS, PERSON_SLOTS, form_texts, person_word
from game.story.model import Currency, Person, Variable
from game.story.source import Source
from game.story.text import LANGUAGES, ROW_CHARS, Text, fill, forms_in, slots, wrap
from game.story.vocabulary import ENV, Type

__all__ = ["Wording"]


@dataclass(frozen=True)
class Wording:
    """Reads words of one script and checks them."""

    source: Source
    findings: Findings
    variables: Mapping[str, Variable]
    items: Sequence[Text]
    currency: Currency
    person: Person

    def text(self, fields: Mapping[str, Node], place: Node, rows: int, *, required: bool = True) -> Text:
        """``en`` and ``ja`` of a line: present, not too long, with the same names in braces."""
        words = {}
        for language in LANGUAGES:
            node = fields.get(language)
            value = self.source.text(node)
            if node is None and required:
                self.findings.add("W_MISSING_TRANSLATION", place.where, f"no {language!r} text")
            if node is not None and value is not None:
                if not value.strip():
                    self.findings.add("W_MISSING_TRANSLATION", node.where, f"the {language!r} text is empty")
                self._check_slots(node, value)
                self._check_forms(node, value, language)
                self._check_length(node, value, language, rows)
            words[language] = (value or "").strip()
        text = Text(words["en"], words["ja"])
        if text.en and text.ja:
            one_only = {name for name, _ in slots(text.en)} ^ {name for name, _ in slots(text.ja)}
            # Pronouns are where the languages differ most: one says "she", the other says nothing.
            one_only -= {*PERSON_SLOTS}
            if one_only and one_only <= {*ENV, *self.variables}:
                found = ", ".join(sorted(one_only))
                self.findings.add("W_SLOT_MISMATCH", fields["ja"].where, f"in one language only: {{{found}}}")
        return text

    def _type_of(self, name: str) -> Type | None:
        if name in ENV:
            return None if ENV[name].hidden else ENV[name].type
        variable = self.variables.get(name)
        return variable.type if variable else None

    def _check_slots(self, node: Node, value: str) -> None:
        place = self.source.inside(node)
        allowed = [name for name in (*ENV, *self.variables) if self._type_of(name) in {"number", "text"}]
        allowed += PERSON_SLOTS
        for name, offset in slots(value):
            if name in {"{", "}"}:
                self.findings.add("E_UNKNOWN_NAME", place(offset), f"a lone {name}", "names stand in {braces}")
            elif name not in allowed:
                self.findings.add(
                    "E_UNKNOWN_NAME", place(offset), f"no name {name!r} to fill in", self.findings.hint(name, allowed)
                )

    def _check_forms(self, node: Node, value: str, language: str) -> None:
        place = self.source.inside(node)
        few, many = FORMS[language]
        for name, forms, offset in forms_in(value):
            count = forms.count("|") + 1
            money = name in ENV and ENV[name].money
            if not forms.strip() or not few <= count <= many:
                shape = "one|other or none|one|other" if language == "en" else "other or none|other"
                self.findings.add("E_BAD_FORMS", place(offset), f"{count} forms in {language!r}", shape)
            elif name != "they" and (self._type_of(name) not in {"number", None} or money or name in PERSON_SLOTS):
                self.findings.add("E_BAD_FORMS", place(offset), f"{name!r} is no number that things are counted by")

    def _check_length(self, node: Node, value: str, language: str, rows: int) -> None:
        def widest(name: str) -> str | None:
            if name == "item":
                return max((item.get(language) for item in self.items), key=len, default="")
            if name in PERSON_SLOTS:
                return person_word(name, self.person.name.get(language), "they", language)
            return self.currency.text(88888).get(language) if name in ENV and ENV[name].money else "88"

        # Each form with the longest of its own: put in as plain words, so that nothing has to be counted.
        longest = value
        for name, forms, _ in forms_in(value):
            longest = longest.replace(f"{{{name}:{forms}}}", max(form_texts(forms, language), key=len))
        wrapped = wrap(fill(longest, widest), language)
        width = ROW_CHARS[language]
        if len(wrapped) > rows or any(len(row) > width + (2 if language == "ja" else 0) for row in wrapped):
            self.findings.add(
                "W_LONG_LINE",
                node.where,
                f"{len(wrapped)} rows of up to {max(map(len, wrapped))} characters in {language!r}",
                f"at most {rows} rows of {width}",
            )
