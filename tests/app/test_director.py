"""The camera: the right shot for each moment, glides without jumps, faces and hands where they can be seen."""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
import pytest

from game.app.arguments import parse_day_share
from game.app.director import Direction, Moment, direct, start_direction
from game.app.shots import ESTABLISHING, SHOTS, camera_of, numbers_of, stand

TICK_S = 1 / 30
STRONG_JOY = {"burst_s": 5.3, "strength": 0.8, "talk": 7}


def settled(scene: str = "talk", place: str = "flea", **more) -> Direction:
    """A camera that has rested in a scene since long ago; time 5 s."""
    state = start_direction(place)
    return after(state, Moment(scene, 0.0, place, **more), 5.0)


def after(state: Direction, moment: Moment, seconds: float, reduced: bool = False) -> Direction:
    for tick in range(round(seconds / TICK_S) + 1):
        state = direct(state, replace(moment, time_s=moment.time_s + tick * TICK_S), reduced_motion=reduced)
    return state


def seen(state: Direction) -> str:
    camera = state.camera(state.time_s)
    return next((name for name, shot in SHOTS.items() if shot == camera), "moving")


def pixel(camera, point) -> np.ndarray:
    """Where a point lies in a 1280 × 720 picture."""
    x, y, _, w = camera.view_projection(16 / 9) @ np.append(point, 1.0)
    return np.array([(x / w + 1) * 640, (1 - y / w) * 360])


@pytest.mark.parametrize(
    ("moment", "shot"),
    [
        (Moment("title", 5.0, "flea"), "home"),
        (Moment("table", 5.0, "flea"), "talk"),
        (Moment("talk", 5.0, "flea"), "talk"),
        (Moment("outcome", 5.0, "flea"), "side"),
        (Moment("talk", 5.0, "flea", waiting=True, offering=True), "offer"),
        (Moment("talk", 5.0, "flea", **STRONG_JOY), "close"),
        (Moment("talk", 5.0, "flea", **STRONG_JOY | {"strength": 0.4}), "talk"),
        (Moment("talk", 5.0, "flea", **STRONG_JOY, gap=0.5, first_visit=True), "glance"),
        (Moment("talk", 5.0, "flea", **STRONG_JOY, gap=0.5), "close"),
    ],
    ids=["title", "table", "talk", "outcome", "offer", "strong face", "weak face", "mask, first visit", "mask, later"],
)
def test_each_moment_gets_its_shot(moment: Moment, shot: str) -> None:
    assert seen(after(settled(moment.scene), moment, 1.5)) == shot


def test_a_closeup_ends_by_itself_and_at_the_players_turn() -> None:
    close = after(settled(), Moment("talk", 5.0, "flea", **STRONG_JOY), 1.5)
    assert seen(after(close, Moment("talk", 6.6, "flea", **STRONG_JOY), 4.0)) == "talk"
    assert seen(after(close, Moment("talk", 6.6, "flea", waiting=True, **STRONG_JOY), 1.2)) == "talk"


def test_the_camera_glances_down_once_in_a_talk() -> None:
    first = Moment("talk", 5.0, "flea", burst_s=5.3, gap=0.6, talk=7, first_visit=True)
    state = after(settled(), first, 4.0)
    assert seen(state) == "talk"
    assert seen(after(state, replace(first, time_s=9.1, burst_s=9.4), 1.2)) == "talk"


def test_a_reaction_long_past_brings_no_closeup() -> None:
    assert seen(after(settled(), Moment("talk", 5.0, "flea", burst_s=2.0, strength=0.9), 1.0)) == "talk"


def test_what_is_felt_but_not_shown_moves_no_camera() -> None:
    """A close-up on what the face hides would read the person for the player."""
    hidden = Moment("talk", 5.0, "flea", burst_s=5.3, strength=0.2, gap=0.9, talk=7)
    assert seen(after(settled(), hidden, 1.5)) == "talk"


def test_an_arrival_is_established_and_ends_at_the_table() -> None:
    state = direct(settled("title"), Moment("table", 5.0, "antiques"))
    assert state.camera(5.0) == ESTABLISHING
    assert state.camera(5.4) == ESTABLISHING
    assert seen(after(state, Moment("table", 5.0, "antiques"), 3.2)) == "talk"


def wander() -> list[Moment]:
    """A restless talk: shots are called off half way, again and again."""
    rng = np.random.default_rng(3)
    moments, time_s, burst_s = [], 0.0, -10.0
    while time_s < 60.0:
        scene = str(rng.choice(["title", "table", "talk", "talk", "talk", "outcome"]))
        waiting, offering, strength = rng.random() < 0.4, rng.random() < 0.5, float(rng.random())
        burst_s = time_s + 0.2 if rng.random() < 0.5 else burst_s
        for _ in range(rng.integers(3, 40)):
            moments.append(
                Moment(scene, time_s, "flea", bool(waiting), bool(offering and waiting), burst_s, strength, talk=1)
            )
            time_s += TICK_S
    return moments


def path(rate_hz: int) -> np.ndarray:
    """(frames, 7) numbers of the camera, ticks at 30 a second, frames at the rate."""
    state, frames, per_tick = start_direction("flea"), [], rate_hz // 30
    for moment in wander():
        state = direct(state, moment)
        frames += [numbers_of(state.camera(moment.time_s + k / rate_hz)) for k in range(per_tick)]
    return np.array(frames)


def test_no_frame_jumps_even_when_shots_are_called_off_half_way() -> None:
    frames = path(60)
    step = np.abs(np.diff(frames, axis=0))
    assert step.max() > 0.005, "the camera did move"
    assert np.linalg.norm(step[:, :3], axis=1).max() < 0.06, "metres per frame"
    assert step[:, 6].max() < 0.2, "degrees per frame"
    # Nor does the speed: a sixtieth of a second changes it by little.
    assert np.abs(np.diff(frames, n=2, axis=0))[:, :6].max() < 0.006


def test_every_frame_rate_sees_the_same_path() -> None:
    np.testing.assert_allclose(path(120)[::4], path(30), atol=1e-12)


def test_a_glide_ends_exactly_so_that_the_still_picture_can_rest() -> None:
    glide = stand(SHOTS["home"]).toward(SHOTS["offer"], 1.0, 0.9)
    assert glide.at(1.0) == camera_of(numbers_of(SHOTS["home"]))
    assert glide.at(1.9) is SHOTS["offer"]
    assert glide.at(100.0) is SHOTS["offer"]


def test_reduced_motion_cuts_between_scenes_and_never_glides() -> None:
    shots = {numbers_of(SHOTS[name]).tobytes() for name in ("home", "talk", "side")}
    state = start_direction("flea")
    for moment in wander():
        state = direct(state, moment, reduced_motion=True)
        assert numbers_of(state.camera(moment.time_s)).tobytes() in shots


def test_reduced_motion_switched_on_half_way_stands_at_once() -> None:
    moving = direct(settled("title"), Moment("talk", 5.1, "flea"))
    assert seen(after(moving, Moment("talk", 5.2, "flea"), 0.1)) == "moving"
    assert seen(after(moving, Moment("talk", 5.2, "flea"), 0.1, reduced=True)) == "talk"


def test_another_world_starts_another_direction() -> None:
    old = after(settled(), Moment("talk", 5.0, "flea", **STRONG_JOY), 1.0)
    assert seen(after(old, Moment("title", 0.0, "flea"), 0.1)) == "home"


@pytest.mark.parametrize("shot", ["talk", "close", "glance", "offer"])
def test_the_face_stands_clear_of_every_panel(shot: str) -> None:
    corners = [(x, y, 0.1) for x in (-0.2, 0.2) for y in (1.02, 1.40)]
    for place in (pixel(SHOTS[shot], corner) for corner in corners):
        assert 20 < place[0] < 880, "the choices begin at 888"
        assert 10 < place[1] < 565, "the speaker's name begins at 565"


@pytest.mark.parametrize("shot", ["talk", "glance", "offer"])
def test_resting_hands_stand_clear_of_the_panels_while_the_player_chooses(shot: str) -> None:
    for x in (-0.3, 0.3):
        left, top = pixel(SHOTS[shot], (x, 0.61, 0.36))
        assert 20 < left < 880
        assert top < 582, "the subtitles begin at 582"


@pytest.mark.parametrize(("text", "share"), [("13:00", 0.0), ("16:30", 0.7), ("18:00", 1.0)])
def test_a_time_of_day_is_a_share_of_the_afternoon(text: str, share: float) -> None:
    assert parse_day_share(text) == pytest.approx(share)


@pytest.mark.parametrize("text", ["12:59", "18:01", "4 pm", "16:75", ""])
def test_times_outside_the_market_are_refused(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match="13:00 to 18:00"):
        parse_day_share(text)
