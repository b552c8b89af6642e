"""Bodies in one feeling through the game's own step: statistics, waiting times, lines, in-between, jumps, traces."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from game.app.cli import main
from game.app.loading import load_step_assets
from game.app.perform_check import check_means, check_performance
from game.app.performance import Event, Script, fixed_world, line_entropy, line_motions, perform
from game.app.step import StepAssets, step
from game.core import EMOTIONS
from game.embos import Candidate

LINE = "This one here? It is really very big, you know, and I would never sell it for so little!"


@pytest.fixture(scope="module")
def assets() -> StepAssets:
    return load_step_assets(body=False)


def pure(name: str) -> np.ndarray:
    return np.eye(7)[EMOTIONS.index(name)]


@pytest.mark.parametrize("emotion", ["anger", "neutral"])
def test_a_performance_keeps_its_takes_statistics(assets: StepAssets, emotion: str) -> None:
    done = perform(assets, pure(emotion), 600.0, 1, script=Script(every_word=True))
    assert check_performance(assets.planner, done, EMOTIONS.index(emotion)) == []
    assert done.share.sum() == pytest.approx(3.0)  # one unit per layer all the time


def test_each_start_tells_its_factors_its_reason_and_its_span(assets: StepAssets) -> None:
    done = perform(assets, pure("joy"), 60.0, 2, script=Script(LINE))
    assert {e.chosen.layer for e in done.events} == {"posture", "gesture", "mannerism"}
    spans = {
        f"{v.take} {v.start_s:.2f}–{v.end_s:.2f} s": unit.name
        for unit in assets.planner.library.units
        for v in unit.variants
    }
    for event in done.events:
        c = event.chosen
        assert spans[event.source] == c.name
        assert c.score == pytest.approx(c.continuity * c.linkage * c.time * c.state)
        assert c.score == max(other.score for other in event.table)
        assert c.reason
        assert (event.stroke_s is not None) == (c.layer == "gesture")
        json.dumps(event.row(table=True))


def test_the_same_line_does_not_bring_the_same_motion(assets: StepAssets) -> None:
    for emotion in ("anger", "joy"):
        found = line_entropy(line_motions(perform(assets, pure(emotion), 120.0, 3, script=Script(LINE))))
        assert found["lines"] >= 15
        assert found["repeated"] <= 0.1
        assert found["bits"] >= 0.8 * found["most"]


def test_one_seed_one_performance(assets: StepAssets) -> None:
    first, again, other = (
        [e.row() for e in perform(assets, pure("fear"), 20.0, seed, script=Script(LINE)).events] for seed in (5, 5, 6)
    )
    assert first == again
    assert first != other


def test_what_breaks_the_statistics_is_found(assets: StepAssets) -> None:
    done = perform(assets, pure("joy"), 30.0, 1)
    found = check_performance(assets.planner, done, EMOTIONS.index("sadness"))
    assert any("which it never showed" in finding for finding in found)
    assert any("agrees with the take at r" in finding for finding in found)

    def event(time_s: float, unit: int, time: float = 0.5) -> Event:
        layer = assets.planner.library.units[unit].layer
        mine, other = (
            Candidate(layer, u, f"u{u}", 1.0, 1.0, factor, 0.5, 0.5 * factor, u == unit, "", "joy 0.00–2.00 s")
            for u, factor in ((unit, time), (unit + 1, 0.5))
        )
        return Event(time_s, 2.0, mine, (mine, other), "", None)

    waiting = assets.planner.config.minimum["posture"]
    made_up = replace(done, events=(event(0.0, 0), event(0.4, 1), event(3.0, 0, waiting)))
    found = check_performance(assets.planner, made_up, EMOTIONS.index("joy"))
    assert any("u0 held for 0.40 s" in finding for finding in found)
    assert any("u0 at 3.00 s inside its waiting time while u1 was free" in finding for finding in found)
    assert check_means({"joy": {"posture": 0.93}, "fear": {"posture": 0.94}}) == [
        "posture: mean r = 0.935, expected at least 0.95"
    ]


def test_after_a_jump_the_body_follows_within_two_seconds(assets: StepAssets) -> None:
    library = assets.planner.library
    for seed, (before, after) in enumerate((("joy", "anger"), ("neutral", "surprise"), ("anger", "sadness"))):
        world = fixed_world(assets, pure(before), seed)
        for _ in range(300):
            world = step(assets, world)
        world = replace(world, felt_target=pure(after)[:6], shown_target=pure(after))
        for _ in range(60):
            world = step(assets, world)
        posture = int(world.body.decisions.unit[0, 0])
        assert library.exists[posture, EMOTIONS.index(after)], (after, library.units[posture].name)


def test_a_slow_drift_makes_nothing_flicker(assets: StepAssets) -> None:
    world = fixed_world(assets, pure("joy"), 4)
    changes = np.zeros(3)
    for tick in range(1800):
        share = tick / 1800
        felt = (1 - share) * pure("joy") + share * pure("fear")
        before = world.body.decisions.unit[0]
        world = step(assets, replace(world, felt_target=felt[:6], shown_target=felt))
        changes += before != world.body.decisions.unit[0]
    assert changes[0] / 60 < 0.4, "posture changes a second"
    assert changes[2] / 60 < 0.9, "mannerisms and rests a second"


def test_the_command_prints_and_checks(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["perform", "--emotion", "sadness=1", "--minutes", "0.5", "--seed", "1"]
    assert main([*words, "--line", LINE, "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["emotion"] == {"sadness": 1.0}
    assert set(data["events"][0]) >= {"time_s", "layer", "unit", "factors", "reason", "source"}
    assert data["same_line"]["lines"] > 2
    assert sum(u["share"] for u in data["units"].values() if u["layer"] == "posture") == pytest.approx(1.0, abs=1e-3)
    assert main([*words, "--explain", "--every-word", "--language", "ja"]) == 0
    said = capsys.readouterr().out
    assert "φ_state" in said
    assert "agreement with the take: posture r =" in said
    assert main(["perform", "--check", "--minutes", "0.05"]) == 1  # three seconds hold no statistics
    assert "agrees with the take" in capsys.readouterr().out
    assert main(["perform", "--minutes", "0"]) == 2
    assert "above 0" in capsys.readouterr().err
