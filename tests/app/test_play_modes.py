"""What a player sees in each of the four modes for comparison, in the game's own window loop over a talk."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pytest

from game.app.input import Action
from game.app.play import Window, open_session
from game.app.screens import TalkScreen
from game.core.humanoid import REFERENCE
from game.embos import LAYERS
from game.render import Device, level_named

pytestmark = pytest.mark.gl

MOODS = np.array([[0.9, 0, 0, 0, 0, 0], [0, 0, 0, 0.9, 0, 0], [0, 0, 0.9, 0, 0, 0]])
MOOD_S = 1.0


@dataclass(frozen=True)
class Seen:
    """Some seconds of a talk, per tick: units that play (t, L), whether the mode holds them at rest (t, L), what the
    face is to show (t, 7), joint rotations (t, 41, 4); of its last picture the mean difference that a face makes."""

    unit: np.ndarray
    at_rest: np.ndarray
    shown: np.ndarray
    rotation: np.ndarray
    face_drawn: float


def watch(device: Device, mode: str) -> Seen:
    """Into the talk over the second thing, then through anger, sadness and joy, looked at in every tick."""
    arguments = argparse.Namespace(language="en", stall="flea", seed=5, mode=mode, overlay=False)
    window = Window(open_session(arguments), device, level=level_named("low"))
    for action in (Action("confirm"), Action("confirm"), Action("key", key="2")):
        window.draw()
        window.handle(action)
        window.advance(1 / 30)
    assert isinstance(window.screen, TalkScreen)
    assert window.session.world.mode == mode
    rows: list[tuple[np.ndarray, ...]] = []
    performer = window.session.assets.performer
    assert performer is not None
    rest = np.asarray(performer.bank.rest)
    for mood in MOODS:
        for _ in range(round(MOOD_S * 30)):
            told = np.append(mood, 0.1)
            window.session.world = replace(window.session.world, felt_target=mood, shown_target=told)
            window.advance(1 / 30)
            body = window.session.world.body
            assert body.performer is not None
            assert body.face_signal is not None
            assert body.pose is not None
            unit = body.performer.unit[0]
            rows.append((unit.copy(), unit == rest, body.face_signal.shown, body.pose.rotation[0].copy()))
    window.draw()
    played = window.renderer.read_pixels().astype(int)
    window.renderer.draw(replace(window.frame(), show_face=False))
    face_drawn = float(np.abs(window.renderer.read_pixels().astype(int) - played).max())
    window.close()
    return Seen(*(np.array(column) for column in zip(*rows, strict=True)), face_drawn=face_drawn)


@pytest.fixture(scope="module")
def seen(tmp_path_factory) -> Iterator[dict[str, Seen]]:
    device, found = Device.headless(320, 180), {}
    for mode in ("full", "gestures", "body", "face"):
        with pytest.MonkeyPatch.context() as patch:
            # Each its own folder: a saved talk would be taken up by the next.
            patch.setenv("MCG_USER_FOLDER", str(tmp_path_factory.mktemp(mode)))
            found[mode] = watch(device, mode)
    yield found
    device.release()


def arms_travel(seen: Seen) -> float:
    """Radians that the arms' joints turn from tick to tick, all together, a second; the first second left out."""
    arms = [i for i, name in enumerate(REFERENCE.names) if name.endswith(("UpperArm", "LowerArm", "Hand"))]
    turn = seen.rotation[30:, arms].astype(float)
    cosine = np.clip(np.abs((turn[1:] * turn[:-1]).sum(axis=-1)), 0.0, 1.0)
    return float(2.0 * np.arccos(cosine).sum() / (len(cosine) / 30))


def test_full_shows_face_posture_mannerism_and_feeling(seen) -> None:
    full = seen["full"]
    assert full.face_drawn > 60
    posture = LAYERS.index("posture")
    assert not full.at_rest[:, posture].all()
    at_end = full.shown[round(MOOD_S * 30) - 1 :: round(MOOD_S * 30), :6]
    np.testing.assert_array_equal(at_end.argmax(axis=1), MOODS.argmax(axis=1))
    assert at_end.max(axis=1).min() > 0.8


def test_body_hides_the_face_and_nothing_else(seen) -> None:
    body, full = seen["body"], seen["full"]
    assert body.face_drawn == 0
    np.testing.assert_array_equal(body.rotation, full.rotation)
    np.testing.assert_array_equal(body.unit, full.unit)


def test_gestures_hold_posture_mannerism_and_face_at_neutral(seen) -> None:
    gestures = seen["gestures"]
    held = [i for i, layer in enumerate(LAYERS) if layer != "gesture"]
    assert gestures.at_rest[:, held].all()
    assert not seen["full"].at_rest[:, held].all()
    assert gestures.face_drawn > 60, "the neutral face is drawn"
    np.testing.assert_allclose(gestures.shown, np.broadcast_to(np.eye(7)[6], gestures.shown.shape), atol=1e-6)


def test_face_holds_the_body_still_and_shows_the_feeling(seen) -> None:
    face, full = seen["face"], seen["full"]
    assert face.at_rest.all()
    assert face.face_drawn > 60
    np.testing.assert_allclose(face.shown, full.shown)
    assert arms_travel(face) < 0.3 * arms_travel(full)
