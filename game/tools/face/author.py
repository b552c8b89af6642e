"""What an author does, without a window: a wanted point, proposals, locked regions, two faces kept to compare,
undo and redo, saving as a named expression."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.core import EMOTIONS, BadInput
from game.face import FIELDS, INDEX, REGIONS, Face, FaceAsset, NamedExpression, Parts, load_expressions
from game.tools.face.wanted import COHERENCE, Found, Proposer, Wanted
from game.tools.face.yaml_edit import add_expression, add_to_dialogue, check_name

__all__ = ["Author", "Change", "Draft"]

Floats = NDArray[np.float64]
TOP = 12
MAX_UNDO = 500

Change = tuple[tuple[str, float], ...]
"""Numbers of a named expression that differ from those of its parts: (name, value)."""


@dataclass(frozen=True)
class Draft:
    """One state of the work, immutable: what undo goes back to.

    spread: deviation of a wanted Gaussian, 0 for a point; emotion: one of the seven where a name was asked for, which
    tells fear from anger; change: what an opened expression holds beyond its parts; kept: the faces A and B,
    and theirs.
    """

    point: tuple[float, float] = (0.0, 0.0)
    spread: float = 0.0
    emotion: int | None = None
    coherence: float = COHERENCE
    diverse: bool = True
    face: Face = field(default_factory=Face)
    locked: frozenset[str] = frozenset()
    change: Change = ()
    kept: tuple[Face | None, Face | None] = (None, None)
    kept_change: tuple[Change, Change] = ((), ())


class Author:
    """The authoring tool's state and everything that can be done to it."""

    def __init__(self, asset: FaceAsset, save_to: Path, dialogue_faces: Path | None = None) -> None:
        self.asset = asset
        self.save_to = save_to
        self.dialogue_faces = dialogue_faces
        self.draft = Draft()
        self.message = ""
        self.failed = False
        self._proposer = Proposer(asset.search)
        self._past: list[Draft] = []
        self._future: list[Draft] = []
        self._before_drag: Draft | None = None
        self._saved: dict[str, tuple[Face, Change]] = {}
        self._asked: tuple[object, ...] = ()
        self._found: list[Found] = []
        self.names: Mapping[str, NamedExpression] = load_expressions(save_to, self.parts) if save_to.exists() else {}

    @property
    def parts(self) -> Parts:
        return self.asset.model.parts

    @property
    def wanted(self) -> Wanted:
        """What the point, its spread or the name ask for."""
        spread, emotion = self.draft.spread, self.draft.emotion
        values = None if emotion is None else np.eye(len(EMOTIONS))[emotion]
        return Wanted(self.draft.point, np.eye(2) * spread**2 if spread > 0.0 else None, values)

    @property
    def found(self) -> list[Found]:
        """Proposals for the draft, best first. With locked regions only the others differ from the face."""
        draft = self.draft
        base = draft.face if draft.locked else None
        # The free regions of the base do not matter: choosing a proposal must not shuffle the list it stands in.
        key = [getattr(base, region) if base and region in draft.locked else None for region in REGIONS]
        asked = (draft.point, draft.spread, draft.emotion, draft.coherence, draft.diverse, *key)
        if asked != self._asked:
            free = [region for region in REGIONS if region not in draft.locked]
            self._found = self._proposer.find(
                self.wanted, TOP, diverse=draft.diverse, coherence=draft.coherence, locked=base, free=free
            )
            self._asked = asked
        return self._found

    def gaussian(self, face: Face) -> tuple[Floats, Floats]:
        """Mean (2,) and covariance (2, 2) of a face."""
        return self.asset.model.mean_cov(face)

    def density(self, face: Face) -> float:
        """Log-density of the wanted point under a face."""
        return self.asset.model.log_density(self.draft.point, face)

    # -- steps -------------------------------------------------------------------------------------------------------

    def _step(self, draft: Draft) -> None:
        if draft != self.draft:
            self._past = [*self._past[-MAX_UNDO + 1 :], self.draft]
            self._future = []
            self.draft = draft
            self.message = ""

    def drag(self, valence: float, arousal: float) -> None:
        """Move the point while the mouse is held; one drag is one step to undo."""
        if self._before_drag is None:
            self._before_drag = self.draft
        self.draft = replace(self.draft, point=_on_pad(valence, arousal), emotion=None)

    def slide(self, spread: float) -> None:
        """Change the wanted spread while its slider is held; one slide is one step to undo."""
        if self._before_drag is None:
            self._before_drag = self.draft
        self.draft = replace(self.draft, spread=round(float(np.clip(spread, 0.0, 1.0)), 2), emotion=None)

    def drop(self) -> None:
        """The mouse has let go."""
        if self._before_drag is not None:
            draft, self.draft, self._before_drag = self.draft, self._before_drag, None
            self._step(draft)

    def nudge(self, right: int, up: int, fine: bool = False) -> None:
        """Move the point by one step of the keys."""
        step = 0.01 if fine else 0.05
        v, a = self.draft.point
        self._step(replace(self.draft, point=_on_pad(v + right * step, a + up * step), emotion=None))

    def go_to(self, emotion: int) -> None:
        """Ask for one of the seven by name; the point goes where it stands."""
        v, a = self.parts.places[emotion]
        self._step(replace(self.draft, point=_on_pad(float(v), float(a)), spread=0.0, emotion=emotion))

    def choose(self, rank: int) -> None:
        """Take a proposal as the face, 0 the best."""
        if 0 <= rank < len(self.found):
            kept = self._changes_in(self.draft.locked)
            self._step(replace(self.draft, face=self.found[rank].face, change=kept))

    def put(self, region: str, part: str) -> None:
        """Put one part into the face by hand. Raises BadInput for an unknown one."""
        self.parts.regions[REGIONS.index(region)].index(part)
        kept = self._changes_in(frozenset(REGIONS) - {region})
        self._step(replace(self.draft, face=replace(self.draft.face, **{region: part}), change=kept))

    def _changes_in(self, regions: frozenset[str]) -> Change:
        """What the face holds beyond its parts in some regions: another part brings its own numbers."""
        return tuple((name, value) for name, value in self.draft.change if FIELDS[INDEX[name]].region in regions)

    def take(self, face: Face) -> None:
        """Take a whole face of parts."""
        self.parts.numbers(face)
        self._step(replace(self.draft, face=face, change=()))

    def open(self, name: str) -> None:
        """Take a named expression with everything it holds. Raises KeyError for an unknown one."""
        face, change = self.expression(name)
        self._step(replace(self.draft, face=face, change=change))

    def expression(self, name: str) -> tuple[Face, Change]:
        """Parts of a named expression, and what it holds beyond them."""
        if name in self._saved:
            return self._saved[name]
        known = self.names[name]
        of_parts = self.parts.params(self.parts.numbers(known.face))
        differs = np.flatnonzero(np.abs(known.params - of_parts) > 1e-9)
        return known.face, tuple((FIELDS[i].name, float(known.params[i])) for i in differs.tolist())

    def lock(self, region: str) -> None:
        """Lock a region at its present part, or free it. The last free region stays free: nothing could be proposed."""
        locked = self.draft.locked ^ {region}
        if len(locked) < len(REGIONS):
            self._step(replace(self.draft, locked=locked))
        else:
            self.message, self.failed = "One region has to stay free.", True

    def vary(self, diverse: bool) -> None:
        """Whether proposals are to differ from each other."""
        self._step(replace(self.draft, diverse=diverse))

    def keep(self, slot: int) -> None:
        """Keep the face as A (0) or B (1)."""
        draft = self.draft
        kept = (draft.face, draft.kept[1]) if slot == 0 else (draft.kept[0], draft.face)
        change = (draft.change, draft.kept_change[1]) if slot == 0 else (draft.kept_change[0], draft.change)
        self._step(replace(draft, kept=kept, kept_change=change))

    def recall(self, slot: int) -> None:
        """Take A or B as the face."""
        face = self.draft.kept[slot]
        if face is not None:
            self._step(replace(self.draft, face=face, change=self.draft.kept_change[slot]))

    def undo(self) -> None:
        """One step back. A file that was saved stays saved."""
        self.drop()
        if self._past:
            self._future.append(self.draft)
            self.draft = self._past.pop()
            self.message = ""

    def redo(self) -> None:
        """One step forward again."""
        if self._future:
            self._past.append(self.draft)
            self.draft = self._future.pop()
            self.message = ""

    @property
    def can_undo(self) -> bool:
        return bool(self._past) or self._before_drag is not None

    @property
    def can_redo(self) -> bool:
        return bool(self._future)

    def faces_named(self) -> dict[str, Face]:
        """Every named expression of the file, those saved now last."""
        return {name: e.face for name, e in self.names.items()} | {name: row[0] for name, row in self._saved.items()}

    def save(self, name: str, label: str = "") -> bool:
        """Append the face to the file under a name. False, with the reason in ``message``, where it cannot be."""
        try:
            name = check_name(name.strip(), list(self.faces_named()))
            draft, shown = self.draft, label.strip() or name.replace("_", " ")
            add_expression(self.save_to, name, shown, draft.face, self.parts, draft.change)
            self._saved[name] = (draft.face, draft.change)
            if self.dialogue_faces is not None:
                add_to_dialogue(self.dialogue_faces, name)
        except BadInput as error:
            self.message, self.failed = str(error), True
            return False
        self.message, self.failed = f"Saved. In a dialogue: face: {name}", False
        return True


def _on_pad(valence: float, arousal: float) -> tuple[float, float]:
    return (round(float(np.clip(valence, -1.0, 1.0)), 3) + 0.0, round(float(np.clip(arousal, -1.0, 1.0)), 3) + 0.0)
