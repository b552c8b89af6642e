"""A shopkeeper from its spec: every part modelled and bound, at any level of detail."""

from __future__ import annotations

from game.tools.modelling.anatomy import Anatomy
from game.tools.modelling.cap import Cap
from game.tools.modelling.hair import Hair
from game.tools.modelling.headband import Headband
from game.tools.modelling.legwear import Legwear
from game.tools.modelling.parts import Detail, Part
from game.tools.modelling.proportions import Figure
from game.tools.modelling.rig import Rig
from game.tools.modelling.spec import CharacterSpec
from game.tools.modelling.spectacles import Spectacles
from game.tools.modelling.surface import Sculpt
from game.tools.modelling.wardrobe import clothes_of
from game.tools.modelling.weights import Binder

__all__ = ["Character"]


class Character:
    """The fields and fine meshes of one shopkeeper; ``parts`` takes any level of detail from them.

    Everything is modelled at the reference humanoid's size (rig, binder); ``figure`` stretches it to the person's.
    """

    def __init__(self, spec: CharacterSpec) -> None:
        self.spec = spec
        self.anatomy = Anatomy.of(spec.head, spec.body, spec.hand)
        self.hair = Hair(spec.hair, spec.springs, self.anatomy.head_centre, self.anatomy.head)
        self.band = Headband(spec.band, spec.springs["bow"], self.hair) if spec.band else None
        self.cap = Cap(spec.cap, self.anatomy.head_centre) if spec.cap else None
        self.spectacles = Spectacles(spec.spectacles, self.anatomy.head_centre) if spec.spectacles else None
        self.clothes = clothes_of(spec.clothes, self.anatomy, spec.springs)
        self.legwear = Legwear(spec.legs, self.anatomy)
        band_chains = self.band.chains.values() if self.band else ()
        chains = (*band_chains, *self.clothes.tails, *self.hair.tuft_chains, *self.hair.chains.values())
        self.rig = Rig.with_chains(chains)
        self.figure = Figure.of(self.rig, spec.proportions)
        self.binder = Binder(self.rig, self.anatomy, self.clothes.sleeve_fit)
        self._head = Sculpt(self.anatomy.head, (-0.21, 0.90, -0.20), (0.21, 1.42, 0.20), 0.0045)
        self._hand = Sculpt(self.anatomy.hand, (0.24, 0.36, -0.075), (0.60, 0.82, 0.115), 0.0025, 2e-3)

    def hand_parts(self, detail: Detail) -> list[Part]:
        """Forearm and hand of both sides."""
        mesh = self._hand.mesh(detail.triangles(5600))
        left = Part("left_hand", "skin", mesh, self.binder.left_hand(mesh.position), 0.9)
        return [left, left.mirrored(self.rig.mirrored_columns())]

    def head_parts(self, detail: Detail) -> list[Part]:
        mesh = self._head.mesh(detail.triangles(8500))
        return [Part("head", "face", mesh, self.binder.head(mesh.position), 0.9)]

    def parts(self, detail: Detail) -> list[Part]:
        """All parts at the reference humanoid's size."""
        parts = self.head_parts(detail) + self.hand_parts(detail)
        parts += self.clothes.parts(self.binder, detail)
        parts += self.legwear.parts(self.binder, detail, with_trousers=not self.spec.clothes.legs)
        parts += self.hair.parts(self.binder, detail)
        for worn in (self.band, self.cap, self.spectacles):
            parts += worn.parts(self.binder, detail) if worn else []
        return parts
