"""From the state of a talk to what each kind of policy may see of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property

import numpy as np

from game.app.policies.views import (
    BodyView,
    FaceView,
    Line,
    OracleView,
    ReaderView,
    Sign,
    Table,
    View,
    WordsView,
)
from game.app.talk import TalkAssets, TalkState, ask_money
from game.core.emotion_space import EMOTIONS
from game.emotion import shown_values
from game.face import FaceAsset, load_face
from game.story import Script

__all__ = ["Drawn", "Eyes", "FaceEye"]

Drawn = tuple[tuple[str, ...], float, float]
"""A face as drawn: parts by region, valence, arousal."""
_GRAIN = 50.0
_MOST_FACES = 20_000


class FaceEye:
    """The face that the face model draws for a shown emotion; feelings are told apart to 1/50."""

    def __init__(self, asset: FaceAsset) -> None:
        self.asset = asset
        self._known: dict[tuple[float, ...], Drawn] = {}

    def drawn(self, shown7: tuple[float, ...]) -> Drawn:
        """Parts, valence and arousal of the face for seven shown values, at rest."""
        key = tuple(round(v * _GRAIN) / _GRAIN for v in shown7[:6])
        found = self._known.get(key)
        if found is None:
            if len(self._known) >= _MOST_FACES:
                self._known.clear()
            found = self._known[key] = self._draw(key)
        return found

    def _draw(self, six: tuple[float, ...]) -> Drawn:
        total = sum(six)
        search, model = self.asset.search, self.asset.model
        numbers = search.numbers(search.best(search.score_emotion(np.array([*six, max(1.0 - total, 0.0)]))))
        mean, _ = model.mean_cov(numbers)
        # Parts are drawn as far as anything is shown at all.
        valence, arousal = (float(v) for v in mean * min(total, 1.0))
        return model.parts.face(numbers).parts, valence, arousal


class Eyes:
    """Makes the views of one stall's talks. What a view lacks, its policy cannot know."""

    def __init__(self, assets: TalkAssets, layers: Mapping[str, str] | None = None) -> None:
        """layers: the layer of each motion unit by name, where bodies are seen."""
        self.assets = assets
        self.layers: Mapping[str, str] = layers or {}
        self._lands = _landings(assets.script)
        self._lines = {choice.id: Line(choice.id, choice.act) for choice in assets.script.all_choices()}
        self._views: Mapping[str, Callable[[Table, TalkState, tuple[Sign, ...], tuple[Sign, ...]], View]] = {
            "table": lambda table, state, signs, quiet: table,
            "words": lambda table, state, signs, quiet: WordsView(table, self._said(state), self.told(state)),
            "face": lambda table, state, signs, quiet: FaceView(table, *self.face(state)),
            "body": lambda table, state, signs, quiet: BodyView(table, signs, quiet),
            "reader": lambda table, state, signs, quiet: ReaderView(
                table, self._said(state), self.told(state), *self.face(state), signs, quiet
            ),
            "oracle": lambda table, state, signs, quiet: OracleView(
                table, dict(zip(EMOTIONS, state.feeling.felt7, strict=True))
            ),
        }

    @cached_property
    def face_eye(self) -> FaceEye:
        """The shipped face."""
        return FaceEye(load_face())

    def view(self, kind: str, state: TalkState, signs: tuple[Sign, ...] = (), quiet: tuple[Sign, ...] = ()) -> View:
        """What a policy of a kind (table, words, face, body, reader, oracle) sees now."""
        return self._views[kind](self.table(state), state, signs, quiet)

    def table(self, state: TalkState) -> Table:
        """What lies open."""
        lines = tuple([self._lines[option.id] for option in state.beat.choices if option.available])
        bargain = state.bargain
        return Table(
            item=state.item,
            list_price=state.list_price,
            ask=ask_money(state.list_price, bargain.ask),
            purse=state.purse,
            offer=round(bargain.offer * state.list_price),
            answer=state.answer.result,
            round=bargain.round,
            rounds=self.assets.market.rounds,
            tidying=state.answer.tidying,
            lines=lines,
        )

    def signs(self, names: Mapping[str, None]) -> tuple[Sign, ...]:
        """Units by name as signs."""
        return tuple((self.layers[name], name) for name in names)

    def face(self, state: TalkState) -> Drawn:
        """The face that stands when everything is said."""
        return self.face_eye.drawn(shown_values(self.assets.person, state.feeling))

    def told(self, state: TalkState) -> str:
        """How the player's line landed, where a line that was really spoken tells it."""
        for line in state.beat.lines:
            landed = self._lands.get(line.id)
            if landed:
                return landed
        return ""

    @staticmethod
    def _said(state: TalkState) -> tuple[str, ...]:
        return tuple(line.en for line in state.beat.lines if line.speaker == "shopkeeper")


def _landings(script: Script) -> dict[str, str]:
    """Lines that are only said when the player's line landed in one way."""
    told = {}
    for node in script.nodes.values():
        for say in node.says:
            for line in say.lines:
                landed = line.when or say.when
                if landed in ("right", "neutral", "wrong"):
                    told[line.id] = landed
    return told
