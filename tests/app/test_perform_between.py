"""Between two feelings: what is on stage and how the body stands go from one to the other, step by step."""

from __future__ import annotations

import numpy as np

from game.animation import Performer, PerformSignal
from game.app.loading import load_planner
from game.core import EMOTIONS
from game.core import quaternion as quat
from game.core.emotion_space import with_neutral
from game.embos import PlannerSignal

STEPS, EACH, DT_S = 11, 16, 0.2
ALONE_S, SECONDS = 60.0, 150.0  # everyone begins with the same unit: that has to be forgotten first
NOISE = 0.1


def test_from_joy_to_anger_in_ten_steps_shares_and_mean_pose_go_one_way() -> None:
    planner = load_planner()
    library, performer = planner.library, Performer(planner.library, radius=planner.config.radius)
    share = np.linspace(0.0, 1.0, STEPS).repeat(EACH)
    six = np.zeros((len(share), 6))
    six[:, EMOTIONS.index("joy")], six[:, EMOTIONS.index("anger")] = 1.0 - share, share
    emotion, n = with_neutral(six), len(share)
    state, acting = planner.start(n, 4), performer.start(n, 4)
    silent, customer = np.zeros((n, len(library.gestures))), np.tile([0.0, 1.16, 3.0], (n, 1))
    on, pose_sum, count = np.zeros((n, len(library))), np.zeros((n, 41, 3)), 0
    first = round(ALONE_S / DT_S)
    for tick in range(first + round(SECONDS / DT_S)):
        state, decisions = planner.advance(state, PlannerSignal(emotion, silent, tick * DT_S), DT_S)
        if tick < first:
            continue
        on[np.arange(n)[:, None], decisions.unit] += DT_S / SECONDS
        acting, pose = performer.advance(acting, decisions, PerformSignal(emotion, customer, np.zeros(n)), DT_S)
        if tick * DT_S > ALONE_S + 3.0:
            pose_sum += quat.log(pose.rotation.astype(np.float64))
            count += 1
    on = on.reshape(STEPS, EACH, -1).mean(axis=1)
    knows = library.exists
    joy, anger = knows[:, EMOTIONS.index("joy")], knows[:, EMOTIONS.index("anger")]
    posture = np.isin(np.arange(len(library)), library.of_layer("posture"))
    falls, rises = on[:, posture & joy & ~anger].sum(axis=1), on[:, posture & anger & ~joy].sum(axis=1)
    for going in (-falls / falls.max(), rises / rises.max()):
        assert going[-1] - going[0] > 0.8
        assert np.diff(going).min() >= -NOISE
    mean = (pose_sum / count).reshape(STEPS, EACH, -1).mean(axis=1)
    way = mean[-1] - mean[0]
    along = (mean - mean[0]) @ way / (way @ way)
    assert np.diff(along).min() >= -NOISE, along.round(3)
    assert np.corrcoef(along, np.linspace(0.0, 1.0, STEPS))[0, 1] >= 0.9, along
    off = np.linalg.norm(mean - mean[0] - along[:, None] * way, axis=1) / np.linalg.norm(way)
    assert off.max() <= 0.75, "not by way of another pose altogether"
