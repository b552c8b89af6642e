"""Colours through the whole pipeline: a known base comes out as the bytes that the tables of the art direction say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.formats import ToonMaterial
from game.formats.avatar_geometry import AvatarGeometry
from game.formats.srgb import linear_light
from game.formats.toon_material import ToonTexture
from game.render import Camera, CharacterModel, FontSet, FrameView, Renderer, level_named
from game.render.avatar_model import build_avatar
from game.render.grading import grade
from game.render.hud import rgba
from game.render.lighting import Lights
from game.render.model import Material, Part, ShadowMesh, merge_character, merge_static

pytestmark = pytest.mark.gl

AHEAD = Camera((0.0, 1.0, 3.0), (0.0, 1.0, 0.0), 20.0)
SUN = tuple(Lights.market().sun)
SHADED = (0.0, -0.8, 0.6)  # turned from the sun, no rim
BELOW = (0.0, -1.0, 0.0)  # turned from it so far that the darkest tone shows
BASES = ("#FFDABF", "#34608A", "#F7BC4B", "#E9543F", "#2A7B78", "#808080", "#101820", "#F7EFE3")
EYE = np.eye(4, dtype=np.float32)[None]


def srgb(colour: str) -> np.ndarray:
    return np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0


def squares(bases: tuple[str, ...], normal: tuple[float, float, float], kind: str, skinned: bool) -> list[Part]:
    """A row of squares that fills the picture's middle."""
    parts = []
    for k, base in enumerate(bases):
        x = 0.12 * (k - len(bases) / 2)
        place = np.array([(x, 0.9, 0), (x + 0.1, 0.9, 0), (x + 0.1, 1.1, 0), (x, 1.1, 0)], np.float32)
        colour = tuple(srgb(base))
        parts.append(
            Part(
                "table" if not skinned else "body",
                Material(f"m{k}", kind, colour, tuple(0.7 * srgb(base)), tuple(0.5 * srgb(base))),
                place,
                np.tile(np.array(normal, np.float32), (4, 1)),
                np.zeros(4, np.float32),
                np.array([[0, 1, 2], [0, 2, 3]], np.uint32),
                np.zeros((4, 4), np.uint8) if skinned else None,
                np.tile(np.array([255, 0, 0, 0], np.uint8), (4, 1)) if skinned else None,
            )
        )
    return parts


def person(bases: tuple[str, ...], normal: tuple[float, float, float], kind: str = "cloth") -> CharacterModel:
    far = np.array([(0, -9, 0), (0.001, -9, 0), (0, -9, 0.001)], np.float32)
    shadow = ShadowMesh(
        far,
        np.zeros((3, 4), np.uint8),
        np.tile(np.array([255, 0, 0, 0], np.uint8), (3, 1)),
        np.zeros(3, np.float32),
        np.array([[0, 1, 2]], np.int32),
        1,
    )
    parts = squares(bases, normal, kind, True)
    unseen = replace(parts[0], position=parts[0].position - np.float32(9.0), outline=np.ones(4, np.float32))
    mesh = merge_character([*parts, unseen], 1)
    return CharacterModel("squares", {40_000: mesh}, shadow, 1)


def middles(pixels: np.ndarray, count: int) -> np.ndarray:
    """(count, 3) the colour in the middle of every square."""
    height, width = pixels.shape[:2]
    per_m = height / (2.0 * 3.0 * np.tan(np.radians(10.0)))
    columns = (width / 2 + per_m * (0.12 * (np.arange(count) - count / 2) + 0.05)).astype(int)
    return pixels[height // 2, columns].astype(int)


def drawn(device, model, view: FrameView, stall=None, level: str = "default", fonts=None) -> np.ndarray:
    renderer = Renderer(device, model, stall, level=level_named(level), fonts=fonts)
    try:
        renderer.draw(view)
        return renderer.read_pixels()
    finally:
        renderer.release()


@pytest.mark.parametrize("level", ["default", "ultra"])
@pytest.mark.parametrize(
    ("normal", "share", "gain"),
    [(SUN, 1.0, (1.03, 1.02, 1.0)), (SHADED, 0.7, (0.9417, 0.9319, 1.0008)), (BELOW, 0.5, (1.0, 1.0, 1.0))],
    ids=["lit", "shade", "deep"],
)
def test_a_person_s_palette_comes_out_as_it_stands_in_the_yaml(device, normal, share, gain, level) -> None:
    """Lit, shade and deep of a base: the grading curve, then the tone's own small factors, and nothing else."""
    view = FrameView(EYE, camera=AHEAD, show_stall=False)
    found = middles(drawn(device, person(BASES, normal), view, level=level), len(BASES))
    palette = np.rint(grade(share * np.array([srgb(base) for base in BASES])) * 255.0)
    wanted = np.minimum(palette * gain, 255.0)
    assert np.abs(found - wanted).max() <= 1.5, np.c_[found, wanted.round()]


def test_a_stall_s_palette_comes_out_the_same(device) -> None:
    """The baked scene is graded as a whole, after shading; bright things bloom, so the darker bases are looked at."""
    bases = tuple(base for base in BASES if srgb(base).max() < 0.7)
    stall = merge_static(squares(bases, SUN, "flat", False), {})
    found = middles(drawn(device, None, FrameView(EYE, camera=AHEAD, near=False), stall), len(bases))
    wanted = grade(np.array([srgb(base) for base in bases]) * (1.03, 1.02, 1.0)) * 255.0
    assert np.abs(found - wanted).max() <= 2.0, np.c_[found, wanted.round()]


def test_an_avatar_s_pictures_are_decoded_and_mixed_in_linear_light(device, monkeypatch) -> None:
    """Unlit: picture times factor in linear light, encoded as sRGB; lit MToon: the same where it faces the sun."""
    factor, texel = (0.5, 0.2, 0.05), (200, 128, 64)
    picture = np.tile(np.array([*texel, 255], np.uint8), (4, 4, 1))
    monkeypatch.setattr("game.render.avatar_model.decode_images", lambda *_: ({0: picture}, []))
    place = np.array([(-0.1, 0.9, 0), (0.1, 0.9, 0), (0.1, 1.1, 0), (-0.1, 1.1, 0)], np.float32)
    geometry = AvatarGeometry(
        (0,),
        np.eye(4)[None],
        place,
        np.tile(np.array(SUN, np.float32), (4, 1)),
        np.zeros((4, 2), np.float32),
        np.full((4, 4), 255, np.uint8),
        np.zeros((4, 4), np.uint8),
        np.tile(np.array([255, 0, 0, 0], np.uint8), (4, 1)),
        np.array([[0, 1, 2], [0, 2, 3]], np.int32),
        ((0, 0, 6),),
        {},
        (),
    )
    light = np.array(linear_light([v / 255.0 for v in texel])) * factor
    encoded = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    wanted = grade(encoded) * 255.0
    for kind in ("unlit", "mtoon"):
        material = ToonMaterial("m", kind, lit=(*factor, 1.0), lit_texture=ToonTexture(0), shade=(0.0, 0.0, 0.0))
        file = type("File", (), {"images": [None], "path": "x.vrm"})
        model = build_avatar("square", file, geometry, (material,), 1.0)
        view = FrameView(EYE, camera=AHEAD, look=model.still(), show_stall=False)
        found = drawn(device, model, view)[180, 320].astype(int)
        assert np.abs(found - wanted).max() <= 1.5, (kind, found, wanted)


def test_the_interface_shows_its_colours_as_they_are(device, model, skin_matrices) -> None:
    """Opaque fills are exact; half cover is the mean of the two; white over white has no grey edge."""

    def paint(hud) -> None:  # 720 units are 360 pixels
        hud.rect(80, 80, 120, 120, fill=rgba("#34608A"))
        hud.rect(280, 80, 120, 120, fill=rgba("#FFFFFF"))
        hud.rect(300, 100, 80, 80, fill=rgba("#FFFFFF"), radius=30.0)
        hud.rect(480, 80, 120, 120, fill=rgba("#000000"))
        hud.rect(480, 80, 120, 120, fill=rgba("#FFFFFF", 0.5))
        hud.text("I", 700, 80, size=90.0, colour=rgba("#C83264"))

    view = replace(FrameView(skin_matrices), show_stall=False, hud=paint)
    pixels = drawn(device, None, view, fonts=FontSet.for_language("en")).astype(int)
    np.testing.assert_array_equal(pixels[70, 70], [0x34, 0x60, 0x8A])
    assert pixels[42:98, 142:198].min() == 255
    assert np.abs(pixels[70, 270] - 128).max() <= 1
    stem = pixels[:, 350:380].reshape(-1, 3)
    assert (stem == [0xC8, 0x32, 0x64]).all(axis=1).any(), "text is as dark as its colour, no darker"


@pytest.mark.parametrize("level", ["default", "ultra"])
def test_edges_lie_between_what_they_part(device, level) -> None:
    """Neither samples nor feathers leave a dark or bright fringe around a surface without an outline."""
    view = FrameView(EYE, camera=AHEAD, show_stall=False)
    pixels = drawn(device, person(("#808080",), SUN), view, level=level).astype(int)
    inside, row = pixels[180, 320], pixels[180, 200:440]
    low = np.minimum(inside, row[0]).min() - 3
    assert (row >= low).all()
    assert (row.max(axis=0) <= np.maximum(inside, row[[0, -1]].max(axis=0)) + 3).all()
