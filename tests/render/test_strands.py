"""Strands of hair: what tells one from the next, and that levels of detail agree on it."""

from __future__ import annotations

import numpy as np
import pytest

from game.core.paths import ASSETS
from game.render.assets import load_character
from game.render.model import KINDS, CharacterMesh
from game.render.strands import strand_terms


def strip(at: tuple[float, float, float], rows: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """A strand: a band of two columns, every second vertex there twice as at a seam."""
    place = [(x, -0.02 * row, 0.0) for row in range(rows) for x in (0.0, 0.015, 0.015)]
    corner = [(3 * r, 3 * r + 1 + r % 2, 3 * r + 3) for r in range(rows - 1)]
    corner += [(3 * r + 1, 3 * r + 4, 3 * r + 3) for r in range(rows - 1)]
    return np.array(place, np.float32) + np.array(at, np.float32), np.array(corner, np.uint32)


def test_a_strand_has_one_tone_across_its_seams_and_its_neighbour_another() -> None:
    (left, corner), (right, _) = strip((0.10, 1.2, 0.1)), strip((0.14, 1.2, 0.1))
    both = np.vstack([left, right])
    triangle = np.vstack([corner, corner + len(left)]).astype(np.uint32)
    azimuth = np.zeros(len(both))
    terms = strand_terms(both, triangle, np.stack([azimuth, np.full(len(both), 0.4)], axis=1))
    one, other = terms[: len(left)], terms[len(left) :]
    assert np.ptp(one[:, 0]) == 0.0
    assert np.ptp(other, axis=0).max() == 0.0
    assert abs(one[0, 0] - other[0, 0]) > 0.01
    assert abs(one[0, 1] - other[0, 1]) > 0.002


def test_a_whole_head_of_curls_keeps_its_palette_wherever_it_is() -> None:
    ball = np.random.default_rng(5).normal(size=(400, 3))
    head = (0.2 * ball / np.linalg.norm(ball, axis=1, keepdims=True)).astype(np.float32)
    fan = np.stack([np.zeros(398), np.arange(1, 399), np.arange(2, 400)], axis=1).astype(np.uint32)
    hair = np.zeros((400, 2))
    terms = [strand_terms(head + np.float32(up), fan, hair) for up in (1.00, 1.03, 1.31)]
    assert all((each[:, 0] == 0.0).all() for each in terms)
    np.testing.assert_array_equal(terms[0], terms[1])
    np.testing.assert_array_equal(terms[0], terms[2])
    lock = strand_terms(head * np.float32(0.3), fan, hair)
    assert np.abs(lock[:, 0]).max() > 0.0


def hair_tones(mesh: CharacterMesh) -> tuple[np.ndarray, np.ndarray]:
    """Places and tones of the vertices of hair."""
    runs = [run for run in mesh.runs if KINDS.index(run.kind) == 0]
    used = np.unique(np.concatenate([mesh.triangle.reshape(-1)[r.first : r.first + r.count] for r in runs]))
    return mesh.position[used], mesh.extra[used, 0]


@pytest.mark.parametrize("person", ["mira", "genzo"])
def test_every_level_of_detail_has_the_same_strands(person: str) -> None:
    model = load_character(ASSETS / "characters" / f"{person}.vrm")
    (fine, tone), (coarse, other) = hair_tones(model.mesh(40_000)), hair_tones(model.mesh(15_000))
    assert np.unique(tone.round(3)).size >= 12
    some = np.random.default_rng(2).choice(len(coarse), 200, replace=False)
    near = np.linalg.norm(fine[None] - coarse[some, None], axis=2).argmin(axis=1)
    # Where strands touch, the nearest vertex may be the neighbour's.
    assert np.mean(np.abs(tone[near] - other[some]) < 0.03) > 0.5
    assert np.mean(np.abs(tone[np.roll(near, 7)] - other[some]) < 0.03) < 0.4, "else anything would do"
