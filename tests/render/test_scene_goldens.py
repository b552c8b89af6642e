"""Whole pictures against their goldens: the other two stalls and faces, evening, passers-by, a foreign avatar.

One renderer goes from stall to stall, as the game's does.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from game.animation import Pose
from game.app.avatar import open_avatar
from game.app.stage import StageAssets, load_stage
from game.core import ASSETS, quaternion
from game.core.humanoid import REFERENCE
from game.face import tessellate
from game.face.params import face_params
from game.render import CLOSEUP, HERO, Camera, FrameView, Renderer
from game.render.crowd import CrowdView, dressed, load_crowd_mesh

pytestmark = pytest.mark.gl

Pixels = NDArray[np.uint8]
AT_EASE_DEG = {"leftUpperArm": (0, 0, -66), "rightUpperArm": (0, 0, 66), "leftLowerArm": (0, -50, 0)} | {
    "rightLowerArm": (0, 30, 0),
    "head": (4, 6, 4),
}
WALKERS = ((-1.15, -2.6, 60.0), (0.95, -3.1, -75.0), (-0.35, -3.6, 90.0))
"""x, z, turn in degrees."""


def at_ease() -> Pose:
    rotation = np.tile(quaternion.IDENTITY, (1, len(REFERENCE), 1)).astype(np.float32)
    for name, degrees in AT_EASE_DEG.items():
        angle = np.radians(np.linalg.norm(degrees)) / 2
        axis = np.array(degrees) / np.linalg.norm(degrees)
        rotation[0, REFERENCE.index[name]] = [*(axis * np.sin(angle)), np.cos(angle)]
    root = REFERENCE.rest_translation[:1].astype(np.float32)
    return Pose(rotation, root, np.zeros((1, 2)), np.zeros(1), np.zeros(1))


def stood(stage: StageAssets) -> NDArray[np.float32]:
    """(J, 4, 4) skin matrices of the person at ease."""
    _, matrices = stage.rig.advance(stage.rig.start(1), at_ease(), 0.0)
    return np.asarray(matrices[0])


@pytest.fixture(scope="module")
def stage() -> Callable[[str, str], StageAssets]:
    return cache(load_stage)


@pytest.fixture(scope="module")
def shot(device) -> Callable[..., Pixels]:
    made: list[Renderer] = []

    def draw(stage: StageAssets, camera: Camera = HERO, **more) -> Pixels:
        if not made:
            made.append(Renderer(device, stage.model, stage.stall, stage.backdrop))
        else:
            made[0].set_stage(stage.model, stage.stall, stage.backdrop)
        face = tessellate(more.pop("params", face_params(mouth_corner=6.0)), stage.face)
        made[0].draw(FrameView(stood(stage), camera=stage.framed(camera), face=face, **more))
        return made[0].read_pixels()

    yield draw
    made[0].release()


@pytest.mark.parametrize(("person", "stall"), [("genzo", "antiques"), ("daimon", "toys")])
def test_each_stall_and_each_face_looks_like_its_golden(person, stall, stage, shot, golden) -> None:
    assets = stage(person, stall)
    golden(shot(assets), f"hero_{stall}")
    cross = face_params(brow_angle=14.0, brow_knit=1.0, mouth_corner=-7.0, mouth_open=8.0)
    golden(shot(assets, CLOSEUP, params=cross), f"closeup_{person}")


def test_the_evening_looks_like_its_golden(stage, shot, golden) -> None:
    golden(shot(stage("mira", "flea"), day_share=1.0), "evening")


def test_passers_by_look_like_their_golden(device, stage, golden) -> None:
    assets = stage("mira", "flea")
    mesh = load_crowd_mesh(ASSETS / "characters" / "mira.vrm")
    standing = stood(assets)
    matrices = []
    for x, z, degrees in WALKERS:
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        place = np.array([[c, 0, s, x], [0, 1, 0, 0], [-s, 0, c, z], [0, 0, 0, 1]], np.float32)
        matrices.append(place @ standing)
    people = CrowdView(matrices, np.array([(x, 0.0, z) for x, z, _ in WALKERS]), np.full(len(WALKERS), 1.4))
    renderer = Renderer(device, None, assets.stall, assets.backdrop)
    try:
        renderer.meet([dressed(mesh, who) for who in range(len(WALKERS))])
        renderer.draw(FrameView(standing, crowd=people))
        pixels = renderer.read_pixels()
    finally:
        renderer.release()
    golden(pixels, "crowd")


def test_somebody_else_s_avatar_behind_the_stall_looks_like_its_golden(shared_data: Path, stage, shot, golden) -> None:
    avatar = open_avatar(shared_data / "vrm" / "Godette_vrm_v4.vrm")
    flea = stage("mira", "flea")
    foreign = replace(flea, model=avatar.model, rig=avatar.rig, lift_m=avatar.lift_m, avatar=avatar)
    golden(shot(foreign, look=avatar.model.still()), "avatar_godette")
