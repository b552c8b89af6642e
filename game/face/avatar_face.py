"""The face of a foreign avatar: its own expressions, driven by what drives the painted face.

Three vocabularies, whichever the file has: VRM's presets (those of 0.x under their 1.0 names), custom expressions
with a telling name, and the 52 blend shapes of ARKit. What is felt behind a mask breaks through all three for 1/25 to
1/5 s, as on the painted face. Blinking, looking and speaking give way where an expression says
so (overrideBlink, overrideLookAt, overrideMouth of VRMC_vrm 1.0).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from game.core.emotion_space import EMOTION_INDEX, EMOTIONS
from game.face.arkit import arkit_weights, find_arkit
from game.face.params import FaceParams
from game.face.rated import RatedExpression, rated_shares
from game.face.speech import VISEMES
from game.face.state import FaceLeak, FaceSignal
from game.formats import VrmExpression, VrmLookAt

__all__ = ["AvatarFace", "AvatarFaceWeights", "emotion_recipes"]

Floats = NDArray[np.float64]

BLINK = ("blink", "blinkLeft", "blinkRight")
LOOK = ("lookUp", "lookDown", "lookLeft", "lookRight")
MOUTH = ("aa", "ih", "ou", "ee", "oh")
_MOUTH_OF = dict(zip(VISEMES, ("aa", "ih", "ou", "ee", "oh"), strict=False))
_WORDS: Mapping[str, tuple[str, ...]] = {
    "anger": ("angry", "anger", "ikari", "okori", "怒"),
    "fear": ("fear", "scared", "afraid", "kowai", "怖", "恐"),
    "joy": ("happy", "joy", "smile", "yorokobi", "egao", "喜", "笑"),
    "sadness": ("sad", "sorrow", "cry", "kanashii", "悲", "泣"),
    "disgust": ("disgust", "yuck", "iya", "嫌"),
    "surprise": ("surprise", "surprised", "shock", "odoroki", "bikkuri", "驚"),
    "neutral": ("neutral",),
}
"""How expressions are called that show an emotion: the first that is there is taken."""
_INSTEAD: Mapping[str, tuple[tuple[str, float], ...]] = {
    "fear": (("surprise", 0.55), ("sadness", 0.6)),
    "disgust": (("anger", 0.5), ("sadness", 0.35)),
    "surprise": (("oh", 0.55),),
    "anger": (("disgust", 0.9),),
    "sadness": (("fear", 0.5),),
    "joy": (("relaxed", 1.0),),
}
"""What an emotion is composed of where the avatar has no expression for it."""
_CALM_JOY, _FULL_JOY = 0.25, 0.6
"""A little joy is the relaxed face, from the second on it is the happy one."""


@dataclass(frozen=True, eq=False)
class AvatarFaceWeights:
    """weight: (E,) 0..1 of the avatar's expressions, in their order; look: what share of the gaze the eyes follow."""

    weight: Floats
    look: float


def emotion_recipes(names: Sequence[str]) -> dict[str, tuple[tuple[str, float], ...]]:
    """Emotion -> the avatar's expressions that show it, with their weights; () where it has none."""
    folded = {name.lower(): name for name in names}
    found: dict[str, str] = {}
    for emotion, words in _WORDS.items():
        exact = next((folded[word] for word in words if word in folded), None)
        within = next((name for low, name in folded.items() for word in words if _tells(word) and word in low), None)
        chosen = exact or within
        if chosen is not None:
            found[emotion] = chosen
    recipes: dict[str, tuple[tuple[str, float], ...]] = {}
    for emotion in EMOTIONS:
        if emotion in found:
            recipes[emotion] = ((found[emotion], 1.0),)
        else:
            parts = ((found.get(part, folded.get(part, "")), share) for part, share in _INSTEAD.get(emotion, ()))
            recipes[emotion] = tuple((name, share) for name, share in parts if name)
    return recipes


def _tells(word: str) -> bool:
    """Whether a word inside a longer name still says what it says alone."""
    return len(word) > 2 or not word.isascii()


class AvatarFace:
    """Weights of an avatar's expressions for each moment. Immutable."""

    def __init__(
        self,
        expressions: Mapping[str, VrmExpression],
        look_at: VrmLookAt | None = None,
        rated: tuple[Mapping[str, RatedExpression], Floats] | None = None,
        smile: str | None = None,
    ) -> None:
        """rated: what people saw in the expressions (face rate, face fit) and where the seven emotions lie: chosen by
        these where they are given. smile: the expression that shows joy where the file's own does not."""
        self.names = tuple(expressions)
        self.expressions = tuple(expressions.values())
        self._index = {name: i for i, name in enumerate(self.names)}
        self._look_at = look_at
        known, self._places = rated if rated is not None else ({}, np.zeros((len(EMOTIONS), 2)))
        self._rated = {name: row for name, row in known.items() if name in self._index}
        self._arkit = find_arkit(self.names)
        self._emotion = np.zeros((len(EMOTIONS), len(self.names)))
        for emotion, parts in emotion_recipes(self.names).items():
            for name, share in parts:
                self._emotion[EMOTION_INDEX[emotion], self._index[name]] += share
        if smile is not None:
            self._emotion[EMOTION_INDEX["joy"]] = 0.0
            self._emotion[EMOTION_INDEX["joy"], self._index[smile]] = 1.0
        self._relaxed = self._index.get("relaxed")
        self._override = {
            kind: [getattr(e, f"override_{kind}") for e in self.expressions] for kind in ("blink", "look_at", "mouth")
        }
        feelings = {name for name in self.names if name not in (*BLINK, *LOOK, *MOUTH)}
        self._feeling = np.array([name in feelings for name in self.names], dtype=bool)

    @property
    def has_arkit(self) -> bool:
        """Whether brows, eyes and mouth are driven one by one."""
        return bool(self._arkit)

    def weights(
        self, signal: FaceSignal, params: FaceParams, visemes: Floats, leak: FaceLeak | None = None
    ) -> AvatarFaceWeights:
        """signal: what reaches the face; params: (K,) numbers of the painted face at this moment; visemes: (6,).

        leak: a micro-expression of this moment; params have it already, so it only concerns whole expressions.
        """
        weight = np.zeros(len(self.names))
        if self._arkit:
            arkit_weights(self._arkit, params, weight)
        else:
            weight += self._expressed(signal)
            if leak is not None:
                weight += leak.share * (self._emotional(leak.felt) - weight)
        weight = np.where([e.is_binary for e in self.expressions], weight > 0.5, weight).astype(np.float64)
        weight = np.clip(weight, 0.0, 1.0)
        blink, look, mouth = (self._left(weight, kind) for kind in ("blink", "look_at", "mouth"))
        if not self._arkit:
            self._put(weight, "blink", blink * signal.blink, ("blinkLeft", "blinkRight"))
            self._speak(weight, mouth, visemes)
        self._turn_eyes(weight, look, signal)
        return AvatarFaceWeights(np.clip(weight, 0.0, 1.0), look)

    def _expressed(self, signal: FaceSignal) -> Floats:
        """The shown emotion's expressions; a named one of the script where the avatar has it under that name."""
        if signal.expression is not None and signal.expression in self._index:
            weight = np.zeros(len(self.names))
            weight[self._index[signal.expression]] = 1.0
            return weight
        return self._emotional(np.asarray(signal.shown, dtype=np.float64))

    def _emotional(self, shown: Floats) -> Floats:
        """The expressions (E,) that say an emotion (7,)."""
        if self._rated:
            weight = np.zeros(len(self.names))
            strength = float(np.clip(shown[:6].sum(), 0.0, 1.0))
            for name, share in rated_shares(self._rated, self._places, shown).items():
                weight[self._index[name]] = share * strength
            return weight
        total = max(float(shown[:6].sum()), 1.0)
        joy = float(shown[EMOTION_INDEX["joy"]])
        weight = (shown / total) @ self._emotion
        if self._relaxed is not None and joy > 0.0:
            # A little joy is no small laugh but another face.
            rise = np.clip((joy - _CALM_JOY) / (_FULL_JOY - _CALM_JOY), 0.0, 1.0)
            happy = float(rise * rise * (3.0 - 2.0 * rise))
            weight -= (1.0 - happy) * joy / total * self._emotion[EMOTION_INDEX["joy"]]
            weight[self._relaxed] += (1.0 - happy) * joy / total
        return weight

    def _left(self, weight: Floats, kind: str) -> float:
        """What is left of blinking, looking or speaking: block takes all, blend as much as the expression shows."""
        left = 1.0
        for value, rule in zip(weight * self._feeling, self._override[kind], strict=True):
            if rule == "block" and value > 0.0:
                return 0.0
            if rule == "blend":
                left -= float(value)
        return max(left, 0.0)

    def _put(self, weight: Floats, name: str, value: float, halves: tuple[str, ...] = ()) -> None:
        for target in (name,) if name in self._index else halves:
            if target in self._index:
                weight[self._index[target]] = max(weight[self._index[target]], value)

    def _speak(self, weight: Floats, left: float, visemes: Floats) -> None:
        for viseme, value in zip(VISEMES, visemes, strict=True):
            name = _MOUTH_OF.get(viseme)
            if name is not None and name in self._index:
                at = self._index[name]
                # An emotion may hold the mouth open already ("oh" for surprise).
                weight[at] = max(weight[at] * left, left * float(value))

    def _turn_eyes(self, weight: Floats, left: float, signal: FaceSignal) -> None:
        """Look expressions, where the file looks by them; range maps as in VRMC_vrm lookAt."""
        if signal.look is None or self._look_at is None or self._look_at.kind != "expression":
            return
        x, y = (float(v) for v in signal.look)
        for name, value, reach_deg, range_name in (
            ("lookLeft", x, 35.0, "HorizontalOuter"),
            ("lookRight", -x, 35.0, "HorizontalOuter"),
            ("lookUp", y, 24.0, "VerticalUp"),
            ("lookDown", -y, 24.0, "VerticalDown"),
        ):
            if value <= 0.0 or name not in self._index:
                continue
            end, scale = self._look_at.ranges.get(range_name, (90.0, 1.0))
            angle = min(min(value, 1.0) * reach_deg, end)
            self._put(weight, name, left * min(angle / end * scale, 1.0) if end > 0.0 else 0.0)
