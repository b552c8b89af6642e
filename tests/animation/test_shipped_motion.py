"""The shipped repertoire, driven by its own planner: nothing pops harder than the takes themselves move."""

from __future__ import annotations

import numpy as np
import pytest

from game.animation import GAZE_CUSTOMER, Performer, PerformSignal, joint_accelerations, largest_joint_acceleration
from game.core.emotion_space import EMOTIONS, emotion_vector
from game.core.humanoid import REFERENCE, TABLE_TOP_M
from game.core.paths import ASSETS
from game.embos import Planner, PlannerSignal, UnitLibrary, load_config
from game.embos.scores import linkage
from game.tools.perform import contact

DT = 1.0 / 30.0
UNITS = ASSETS / "motion" / "units.yaml"


@pytest.fixture(scope="module")
def shipped() -> tuple[Planner, Performer]:
    library = UnitLibrary.load(UNITS)
    planner = Planner(library, load_config(ASSETS / "motion" / "planner.yaml"))
    return planner, Performer(library, radius=planner.config.radius)


@pytest.mark.parametrize("emotion", ["anger", "joy", "sadness"])
def test_composed_motion_accelerates_no_harder_than_the_take(shipped: tuple[Planner, Performer], emotion: str) -> None:
    planner, performer = shipped
    library = planner.library
    felt = emotion_vector({emotion: 0.9})[None]
    plan, state = planner.start(1, 3), performer.start(1, 3)
    rng = np.random.default_rng(3)
    words = np.zeros((1, len(library.gestures)))
    rotation, root = [], []
    for tick in range(360):
        if tick % 60 in (30, 36):
            words = np.zeros_like(words)
            words[0, rng.integers(words.shape[1])] = float(tick % 60 == 30)
        plan, decisions = planner.advance(plan, PlannerSignal(felt, words, tick * DT), DT)
        signal = PerformSignal(felt, GAZE_CUSTOMER[None], np.zeros(1))
        state, pose = performer.advance(state, decisions, signal, DT)
        rotation.append(pose.rotation[0])
        root.append(pose.root[0])
    turned = np.stack(rotation).astype(float)
    takes = [library.clips[name].rotation for name in library.clips]
    arms = np.array([not REFERENCE.names[j].endswith(("Leg", "Foot", "Toes")) for j in range(len(REFERENCE))])
    hardest = max(largest_joint_acceleration(take[:, arms]) for take in takes)
    assert largest_joint_acceleration(turned[:, arms]) < 1.25 * hardest
    own = joint_accelerations(library.clips[emotion].rotation[:, arms], 30.0)
    mine = joint_accelerations(turned[:, arms], 30.0)
    assert np.percentile(mine, 99) < 2.0 * np.percentile(own, 99) + 40.0
    shift = np.tile(REFERENCE.rest_translation, (len(turned), 1, 1))
    shift[:, 0] = root
    position, _ = REFERENCE.to_model(turned, shift)
    for side in ("left", "right"):
        wrist = position[:, REFERENCE.index[f"{side}Hand"]]
        over = (wrist[:, 2] > 0.2) & (wrist[:, 2] < 0.7)
        assert wrist[over, 1].min(initial=1.0) > TABLE_TOP_M + 0.005, "no hand goes through the table"


@pytest.mark.parametrize(("emotion", "seed"), [*((name, 79) for name in EMOTIONS), ("fear", 8)])
def test_hands_stay_out_of_body_and_table(shipped: tuple[Planner, Performer], emotion: str, seed: int) -> None:
    """Whatever follows whatever: a brushing touch on the way is all there is, and it is rare."""
    planner, performer = shipped
    felt = emotion_vector({emotion: 0.9 if emotion != "neutral" else 1.0})[None]
    plan, state = planner.start(1, seed), performer.start(1, seed)
    words = np.zeros((1, len(planner.library.gestures)))
    rotation, root = [], []
    for tick in range(900):
        plan, decisions = planner.advance(plan, PlannerSignal(felt, words, tick * DT), DT)
        signal = PerformSignal(felt, GAZE_CUSTOMER[None], np.zeros(1))
        state, pose = performer.advance(state, decisions, signal, DT)
        rotation.append(pose.rotation[0])
        root.append(pose.root[0])
    shift = np.tile(REFERENCE.rest_translation, (len(root), 1, 1))
    shift[:, 0] = root
    position, turned = REFERENCE.to_model(np.stack(rotation).astype(float), shift)
    for side in ("left", "right"):
        points, radii = contact.arm_points(position, turned, side)
        body, table = contact.body_depth(points, radii, position, turned), contact.table_depth(points, radii)
        depth = np.maximum(body, table)[:, : contact.HAND_POINTS].max(axis=1)
        assert depth.max() < 0.02
        assert (depth > 0.012).mean() < 0.01


def test_nothing_takes_the_hands_off_the_table_s_edge_while_ducking(shipped: tuple[Planner, Performer]) -> None:
    library = shipped[0].library
    ducking = library.units[library.index["crouched"]]
    hands = {"left_arm", "right_arm", "left_hand", "right_hand"}
    for unit in library.units:
        if unit.layer != "posture" and unit.uses & hands:
            assert linkage(unit.uses, unit.locks, ducking.uses, ducking.locks) == 0, unit.name
