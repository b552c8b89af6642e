"""Which modeller makes which kind of clothes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from game.tools.modelling.anatomy import Anatomy
from game.tools.modelling.clothes import Clothes
from game.tools.modelling.dungarees import Dungarees
from game.tools.modelling.haori import Haori
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.rig import Chain
from game.tools.modelling.spec import SpringSpec
from game.tools.modelling.spec_wear import ClothesSpec, CoatSpec, DungareesSpec, HaoriSpec
from game.tools.modelling.weights import Binder, SleeveFit

__all__ = ["Garments", "clothes_of"]


class Garments(Protocol):
    """The upper clothes of a person. tails: their spring chains. sleeve_fit: of the outermost sleeve."""

    @property
    def tails(self) -> tuple[Chain, ...]: ...

    @property
    def sleeve_fit(self) -> SleeveFit: ...

    def parts(self, binder: Binder, detail: Detail) -> list[Part]:
        """Meshes of the clothes at a level of detail."""
        ...


def clothes_of(spec: ClothesSpec, anatomy: Anatomy, springs: Mapping[str, SpringSpec]) -> Garments:
    """The clothes of a record, by its kind."""
    if isinstance(spec, CoatSpec):
        return Clothes(spec, anatomy, springs["scarf"])
    if isinstance(spec, HaoriSpec):
        return Haori(spec, anatomy, springs)
    assert isinstance(spec, DungareesSpec)
    return Dungarees(spec, anatomy, springs)
