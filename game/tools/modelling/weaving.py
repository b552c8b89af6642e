"""Patterns on clothes: where a motif's tiles lie on the cloth, and the tile as a picture for other programs.

Cloth is cut from pieces: front and back, sides, sleeves. Each piece takes its tiles straight on, as a bolt of cloth
would give them; where two pieces meet, vertices are doubled, so that no tile is torn across a seam.
"""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
from PIL import Image

from game.render.weave import ASPECT, tinted, weave_distance
from game.tools.modelling.fields import Floats, Ints
from game.tools.modelling.gltf import srgb
from game.tools.modelling.mesh import Mesh
from game.tools.modelling.parts import Part
from game.tools.modelling.rig import Arm, Rig
from game.tools.modelling.weave_spec import Weave

__all__ = ["cut", "tile_picture"]

_TILE_PX = 96
_ARM_JOINTS = ("UpperArm", "LowerArm", "ForearmTwist", "Hand")


def cut(part: Part, weave: Weave, rig: Rig, arm: Arm) -> tuple[Part, Floats]:
    """The part with vertices doubled along its seams, and (n, 2) where each lies on the cloth in tiles, v downward."""
    assert part.weights is not None
    mesh = part.mesh
    flat, piece = _pieces(mesh, part.weights, rig, arm)
    corner_piece = np.repeat(piece, 3)
    key = mesh.triangle.ravel() * 16 + corner_piece
    unique, renumbered = np.unique(key, return_inverse=True)
    vertex, own = unique // 16, unique % 16
    place = flat[own, vertex]
    angle = np.radians(weave.turn_deg)
    turned = place @ np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    uv = turned * (1.0, -1.0) / (weave.size, weave.size * ASPECT[weave.motif])
    new = Mesh(mesh.position[vertex], mesh.normal[vertex], renumbered.reshape(-1, 3))
    return replace(part, mesh=new, weights=part.weights[vertex]), uv


def _pieces(mesh: Mesh, weights: Floats, rig: Rig, arm: Arm) -> tuple[Floats, Ints]:
    """(pieces, n, 2) the cloth's plane of every piece at every vertex, metres; (m,) the piece of each triangle."""
    p, normal = mesh.position, mesh.normal[mesh.triangle].sum(axis=1)
    planes = [p[:, [0, 1]], p[:, [2, 1]], p[:, [0, 2]]]
    # Front and back reach a little around the body: seams lie at the side.
    piece = (np.abs(normal) * (1.0, 0.75, 1.25))[:, [2, 0, 1]].argmax(axis=1)
    for number, (side, sign) in enumerate((("left", 1.0), ("right", -1.0))):
        q = p * (sign, 1.0, 1.0) - arm.shoulder
        along, up, forward = q @ arm.along, q @ arm.up, q @ arm.forward
        planes += [np.stack([forward, -along], 1), np.stack([up, -along], 1)]
        joints = [rig.index[side + name] for name in _ARM_JOINTS if side + name in rig.index]
        on_arm = weights[:, joints].sum(axis=1)[mesh.triangle].mean(axis=1) > 0.5
        own = normal * (sign, 1.0, 1.0)
        over = np.abs(own @ arm.up) > np.abs(own @ arm.forward)
        piece = np.where(on_arm, 3 + 2 * number + np.where(over, 0, 1), piece)
    return np.stack(planes), piece


def tile_picture(weave: Weave, lit: str) -> bytes:
    """PNG of one tile in the material's lit colour "#rrggbb", for programs that know nothing of weaves."""
    height = round(_TILE_PX * ASPECT[weave.motif])
    inside = weave_distance(weave.motif, _TILE_PX)
    cover = np.clip(inside * _TILE_PX + 0.5, 0.0, 1.0)[..., None]
    ground = np.array(srgb(lit))
    colour = ground * (1.0 - cover) + tinted(ground, weave.strength) * cover
    picture = io.BytesIO()
    tile = Image.fromarray(np.rint(np.clip(colour, 0.0, 1.0) * 255.0).astype(np.uint8))
    tile.resize((_TILE_PX, height), Image.Resampling.BICUBIC).save(picture, "PNG", optimize=True)
    return picture.getvalue()
