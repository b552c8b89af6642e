"""Eq. 1 at work: one character and many, durations and waiting, linkage, words, explanations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from game.core import BadInput, with_neutral
from game.embos import (
    LAYERS,
    Course,
    GestureCues,
    MotionUnit,
    Planner,
    PlannerConfig,
    PlannerSignal,
    PlannerState,
    UnitLibrary,
)
from tests.embos import plain_scores

DT = 1.0 / 30.0
JOY = np.eye(7)[2:3]
DECIDED = ("unit", "started", "start_time_s", "duration_s", "emotion_weights", "variant_pick", "stroke_s")


def unit(name: str, layer: str, joy: float = 1.0, *, length: float = 2.0, wait: float = 4.0, **more: Any) -> MotionUnit:
    on = np.eye(7)[2]
    return MotionUnit(name, layer, joy * on, length * on, wait * on, **more)


def small(*extra: MotionUnit, **config: Any) -> Planner:
    units = [unit("upright", "posture", 0.9, length=5, wait=0), unit("g", "gesture"), unit("m", "mannerism")]
    named = {u.name for u in extra}
    config = {"settled": ()} | config
    return Planner(UnitLibrary([u for u in units if u.name not in named] + list(extra)), PlannerConfig(**config))


def play(planner: Planner, seconds: float, *, words: float = 0.0, emotion: np.ndarray = JOY, seed: int = 3) -> Any:
    """(tick, unit names, started) of one character."""
    state = planner.start(1, seed)
    said = np.full((1, len(planner.library.gestures)), words)
    log = []
    for tick in range(round(seconds / DT)):
        state, d = planner.advance(state, PlannerSignal(emotion, said, tick * DT), DT)
        log.append((tick, [planner.library.units[u].name for u in d.unit[0]], d.started[0].copy()))
    return log


def wander(n: int, library: UnitLibrary, ticks: int) -> list[PlannerSignal]:
    rng = np.random.default_rng(4)
    signals, emotion, words = [], with_neutral(rng.random((n, 6)) * 0.4), np.zeros((n, len(library.gestures)))
    for tick in range(ticks):
        if tick % 40 == 0:
            goal = with_neutral(rng.random((n, 6)) ** 3)
        emotion = 0.97 * emotion + 0.03 * goal
        if tick % 3 == 0:
            words = (rng.random(words.shape) > 0.97).astype(np.float64)
        signals.append(PlannerSignal(emotion, words, tick * DT))
    return signals


@pytest.mark.parametrize("look_s", [0.0, 0.1])
def test_alone_and_in_a_crowd_are_the_same_to_the_bit(look_s: float, made_up: Callable[..., Any]) -> None:
    library = made_up(0, with_parts=True).library
    planner, n = Planner(library, PlannerConfig(look_s=look_s)), 150  # more than two pieces of 64
    signals = wander(n, library, 240)
    state, crowd = planner.start(n, 7), []
    for signal in signals:
        state, decisions = planner.advance(state, signal)
        crowd.append(decisions)
    for first, count in ((0, 1), (80, 1), (140, 5)):
        few = slice(first, first + count)
        state = planner.start(count, 7, first=first)
        for signal, together in zip(signals, crowd, strict=True):
            state, alone = planner.advance(state, PlannerSignal(signal.emotion[few], signal.words[few], signal.time_s))
            for name in DECIDED:
                np.testing.assert_array_equal(getattr(alone, name), getattr(together, name)[few])


def test_waiting_for_events_gives_what_judging_every_tick_gives(made_up: Callable[..., Any]) -> None:
    library = made_up(1, with_parts=True).library
    planner = Planner(library)
    lazy = eager = planner.start(6, 2)
    for signal in wander(6, library, 400):
        eager = eager.copied()
        eager.characters.fields["next_s"], eager.characters.fields["calm"] = -np.inf, False
        eager = PlannerState(eager.characters, -np.inf, eager.starting)
        lazy, a = planner.advance(lazy, signal)
        eager, b = planner.advance(eager, signal)
        for name in DECIDED:
            np.testing.assert_array_equal(getattr(a, name), getattr(b, name))


@pytest.mark.parametrize("pace", [1, 7, 24])
def test_clocks_of_their_own_tell_what_ticking_together_shows(pace: int, made_up: Callable[..., Any]) -> None:
    library = made_up(4, with_parts=True).library
    planner, n, ticks = Planner(library), 5, 300
    rng = np.random.default_rng(6)
    gestures = len(library.gestures)
    # Lines: their words' moments; each gesture's window opens earlier by the time it needs to its stroke.
    cues = [
        GestureCues(rng.integers(0, gestures, 12), np.sort(rng.uniform(0.0, ticks * DT, 12)), gestures)
        for _ in range(n)
    ]
    emotion = np.stack([signal.emotion for signal in wander(n, library, ticks)], axis=1)
    state, starts = planner.start(n, 6), []
    for tick in range(ticks):
        lead_s = library.stroke_lead_s(emotion[:, tick])
        words = np.array([cues[i].factors(tick * DT, lead_s[i], planner.config.word_window_s) for i in range(n)])
        signal = PlannerSignal(emotion[:, tick], words, tick * DT)
        before = state
        state, d = planner.advance(state, signal)
        for i in np.flatnonzero(d.started.any(axis=1)):
            reasons = planner.explain_chosen(before, signal, np.array([i]))[0]
            starts.append((i, tick, d.unit[i].tolist(), d.started[i].tolist(), d.numbers[i].tolist(), reasons))
    assert {library.units[row[2][1]].is_rest for row in starts} == {True, False}, "words were heard"
    # The last two characters set out later, and each goes through its ticks in stretches of its own.
    alone, at, told = planner.start(n, 6), np.array([0, 0, 0, -pace, -3 * pace]), []
    while (at < ticks).any():
        rows = np.flatnonzero((at >= 0) & (at < ticks))
        length = np.minimum(np.where(rows == 1, max(pace // 2, 1), pace), ticks - at[rows])
        course = Course(
            np.stack([np.resize(emotion[i, at[i] : at[i] + k], (pace, 7)) for i, k in zip(rows, length, strict=True)]),
            at[rows],
            length,
            np.array([cues[i].gesture for i in rows]),
            np.array([cues[i].time_s for i in rows]),
            np.zeros(len(rows), dtype=bool),
        )
        for piece in planner.follow(alone, rows, course, before=True):
            d, who = piece.decisions, np.arange(len(piece.row))
            reasons = planner.explain_chosen(PlannerState(piece.before, -np.inf, True), piece.signal, who)
            for k, row in enumerate(rows[piece.row]):
                tick = round(float(np.asarray(piece.signal.time_s)[k]) / DT)
                told.append((row, tick, d.unit[k].tolist(), d.started[k].tolist(), d.numbers[k].tolist(), reasons[k]))
        at[rows] += length
        at[at < 0] += pace
    assert sorted(told, key=lambda row: row[:2]) == sorted(starts, key=lambda row: row[:2])


def test_a_first_tick_is_told_and_many_happenings_come_in_pieces(made_up: Callable[..., Any]) -> None:
    library = made_up(4).library
    planner, ticks = Planner(library), 1200
    emotion = np.repeat(np.eye(7)[:2, None], ticks, axis=1)
    course = Course(
        emotion, np.zeros(2, dtype=np.intp), np.full(2, ticks), np.zeros((2, 1), dtype=np.intp),
        np.full((2, 1), np.inf), np.array([True, True]),
    )  # fmt: skip
    state = planner.start(2, 1)
    pieces = list(planner.follow(state, np.arange(2), course))
    assert len(pieces) > 1
    assert state.starts.sum() == sum(int(piece.decisions.started.sum()) for piece in pieces)
    later = replace(course, tick=course.tick + ticks, length=np.full(2, 1))
    ((told,),) = ([piece.row.tolist() for piece in planner.follow(state, np.arange(2), later)],)
    assert told == [0, 1], "though nothing need have started"


def test_a_state_is_never_changed_and_can_be_resumed(made_up: Callable[..., Any]) -> None:
    library = made_up(2).library
    planner = Planner(library)
    signals = wander(3, library, 120)
    state = planner.start(3, 5)
    for signal in signals[:60]:
        state, _ = planner.advance(state, signal)
    before, decided = state.characters.seen.copy(), state.decisions.numbers.copy()
    ends = []
    for _ in range(2):
        onward = state
        for signal in signals[60:]:
            onward, decisions = planner.advance(onward, signal)
        ends.append(decisions)
    np.testing.assert_array_equal(state.characters.seen, before)
    np.testing.assert_array_equal(state.decisions.numbers, decided)
    with pytest.raises(ValueError, match="read-only"):
        state.wait_s[0] = 0.0
    np.testing.assert_array_equal(ends[0].start_time_s, ends[1].start_time_s)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_ten_minutes_hold_the_statistics_of_the_takes(
    seed: int, made_up: Callable[..., Any], on_stage: Callable[..., np.ndarray]
) -> None:
    made = made_up(seed)
    on = on_stage(made.library, PlannerConfig(), 10.0, seed)
    for layer in LAYERS:
        own = [i for i in made.library.of_layer(layer) if not made.library.is_rest[i]]
        r = [np.corrcoef(made.take_share[e, own], on[e, own])[0, 1] for e in range(7)]
        assert np.mean(r) >= 0.95, (layer, r)
        assert np.min(r) >= 0.85, (layer, r)
        assert on[:, own][made.take_share[:, own] == 0.0].sum() == 0.0, "time in units the emotion never showed"


def test_nothing_starts_while_it_waits_and_postures_last_a_second(made_up: Callable[..., Any]) -> None:
    library = made_up(3).library
    planner = Planner(library)
    state = planner.start(7, 9)
    words = np.ones((7, len(library.gestures)))
    since = np.zeros(7)
    for tick in range(6000):
        before = state
        state, d = planner.advance(state, PlannerSignal(np.eye(7), words, tick * DT))
        who, layer = np.nonzero(d.started)
        slot = state.running[who, layer]
        assert np.all(before.wait_s[who, slot] < tick * DT + DT)
        changed = d.started[:, 0] & (before.running[:, 0] != state.running[:, 0])
        if tick:
            assert np.all(tick * DT - since[changed] >= 1.0 - DT)
        since[d.started[:, 0]] = tick * DT


def test_rest_fills_the_waiting_time() -> None:
    log = play(small(), 6.5)
    names = [names[2] for _, names, _ in log]
    assert names[0] == "m"
    assert names[round(2.5 / DT)] == "rest_mannerism"
    assert [names[0] for _, names, _ in log] == ["upright"] * len(log)
    assert [names[1] for _, names, _ in log] == ["rest_gesture"] * len(log), "no word, no gesture"
    starts = [tick * DT for tick, names, started in log if started[2] and names[2] == "m"]
    assert starts == pytest.approx([0.0, 6.0], abs=0.05)


def test_mannerisms_do_not_all_come_at_the_start() -> None:
    planner = small(unit("m", "mannerism", length=2.0, wait=8.0), settled=("mannerism",))
    n = 400
    state, first_s = planner.start(n, 1), np.full(400, np.inf)
    emotion, words = np.repeat(JOY, n, 0), np.zeros((n, 1))
    for tick in range(110):
        state, d = planner.advance(state, PlannerSignal(emotion, words, tick * 0.1), 0.1)
        first_s = np.where(np.isinf(first_s) & (d.duration_s[:, 2] > 0), tick * 0.1, first_s)
    assert first_s.mean() == pytest.approx(5.0, abs=0.4)
    assert first_s.max() <= 10.2


def test_looking_ten_times_a_second_keeps_lengths_and_hears_words_at_once() -> None:
    names = [names[2] for _, names, _ in play(small(look_s=0.1), 6.5)]
    changes = [i * DT for i in range(1, len(names)) if names[i] != names[i - 1]]
    assert changes == pytest.approx([2.0, 6.0], abs=0.07)
    planner = small(look_s=0.1)
    state = planner.start(1, 1)
    for tick in range(12):
        said = np.full((1, 1), float(tick == 11))
        state, d = planner.advance(state, PlannerSignal(JOY, said, tick * DT))
    assert planner.library.units[d.unit[0, 1]].name == "g"


def test_a_gesture_needs_its_word_only_to_begin() -> None:
    planner = small()
    state = planner.start(1, 1)
    seen = []
    for tick in range(90):
        said = np.full((1, 1), 1.0 if 10 <= tick < 13 else 0.0)
        state, d = planner.advance(state, PlannerSignal(JOY, said, tick * DT))
        seen.append(planner.library.units[d.unit[0, 1]].name)
    assert seen[9] == "rest_gesture"
    assert seen[10] == seen[60] == "g"
    assert seen[72] == "rest_gesture"


def test_a_unit_blocked_from_above_gives_way_at_once() -> None:
    sit = unit("upright", "posture", 0.5, length=1.0, wait=0.0)
    crossed = unit("crossed", "posture", 1.0, length=3.0, wait=2.0, uses=frozenset({"right_arm"}))
    scratch = unit("m", "mannerism", length=30.0, wait=0.0, uses=frozenset({"right_arm"}))
    log = play(small(sit, crossed, scratch), 8.0)
    for _, (posture, _, mannerism), _ in log:
        assert mannerism == ("rest_mannerism" if posture == "crossed" else "m")
    assert {names[0] for _, names, _ in log} == {"upright", "crossed"}


def test_locks_and_the_order_of_layers_decide_who_gives_way() -> None:
    gesture = unit("g", "gesture", uses=frozenset({"head"}), length=30.0, wait=0.0)
    mannerism = unit("m", "mannerism", locks=frozenset({"head"}), length=30.0, wait=0.0)
    usual = play(small(gesture, mannerism), 1.0, words=1.0)
    assert usual[-1][1][1:] == ["g", "rest_mannerism"]
    other = play(small(gesture, mannerism, layers=("posture", "mannerism", "gesture")), 1.0, words=1.0)
    assert other[-1][1][1:] == ["m", "rest_gesture"]


def test_equal_scores_go_to_the_first_unit() -> None:
    twins = [unit(f"m{i}", "mannerism", 0.7) for i in range(3)]
    log = play(small(unit("m", "mannerism", 0.1), *twins), 0.1)
    assert log[0][1][2] == "m0"


def test_an_emotion_nothing_was_shown_in_keeps_the_posture() -> None:
    log = play(small(), 3.0, emotion=np.eye(7)[1:2])
    assert len({tuple(names) for _, names, _ in log}) == 1


def test_a_jump_of_emotion_is_followed_at_once_and_a_drift_does_not_flicker(made_up: Callable[..., Any]) -> None:
    made = made_up(5)
    planner = Planner(made.library)
    state = planner.start(7, 1)
    words = np.zeros((7, len(made.library.gestures)))
    switched = np.full(7, np.inf)
    for tick in range(1200):
        emotion = np.eye(7) if tick < 600 else np.roll(np.eye(7), 1, axis=0)
        felt_index = emotion.argmax(axis=1)
        state, d = planner.advance(state, PlannerSignal(emotion, words, tick * DT))
        fits = made.library.exists[d.unit[:, 0], felt_index]
        if tick >= 600:
            switched = np.where(fits & np.isinf(switched), (tick - 600) * DT, switched)
    assert switched.max() <= 2.0
    changes = 0
    for tick in range(1200, 2400):
        share = (tick - 1200) / 1200
        emotion = (1 - share) * np.roll(np.eye(7), 1, axis=0) + share * np.eye(7)
        before = state
        state, _ = planner.advance(state, PlannerSignal(emotion, words, tick * DT))
        changes += int((before.running[:, 0] != state.running[:, 0]).sum())
    assert changes / 7 / 40.0 < 0.4, "posture changes per second"


def test_the_random_factors_have_mean_one_and_the_takes_spread() -> None:
    planner = small(unit("m", "mannerism", length=2.0, wait=1.0, duration_cv=0.3))
    n = 4000
    _, d = planner.advance(planner.start(n, 11), PlannerSignal(np.repeat(JOY, n, 0), np.zeros((n, 1)), 0.0))
    assert d.duration_s[:, 2].mean() == pytest.approx(2.0, rel=0.02)
    assert d.duration_s[:, 2].std() == pytest.approx(0.6, rel=0.05)
    assert np.ptp(d.variant_pick[:, 2]) > 0.99
    assert np.all(d.duration_s[:, 1] == 0.0)
    np.testing.assert_array_equal(d.emotion_weights[0, 2], JOY[0])
    _, other = planner.advance(planner.start(n, 12), PlannerSignal(np.repeat(JOY, n, 0), np.zeros((n, 1)), 0.0))
    assert not np.array_equal(d.duration_s, other.duration_s)


def test_every_start_can_be_explained(made_up: Callable[..., Any]) -> None:
    library = made_up(6, with_parts=True).library
    planner = Planner(library)
    state, reasons = planner.start(2, 8), []
    for signal in wander(2, library, 300):
        before = state
        state, d = planner.advance(state, signal)
        if not d.started.any():
            continue
        for layer, candidates in enumerate(planner.explain(before, signal, 1)):
            assert candidates[0].chosen
            assert candidates[0].unit == d.unit[1, layer]
            assert len(candidates) == len(library.of_layer(LAYERS[layer]))
            for c in candidates:
                assert c.score == pytest.approx(c.continuity * c.linkage * c.time * c.state)
                assert c.reason
            reasons.append(candidates[0].reason)
    for part in ("first choice", "ended; ", "beats rest", "kept: still within its duration", "blocked by"):
        assert any(part in reason for reason in reasons), part


def test_a_signal_of_the_wrong_shape_is_refused() -> None:
    planner = small()
    with pytest.raises(BadInput, match="expected emotion"):
        planner.advance(planner.start(2, 1), PlannerSignal(JOY, np.zeros((1, 1)), 0.0))


def test_a_state_of_another_planner_is_refused() -> None:
    with pytest.raises(BadInput, match="that this planner started"):
        small().advance(small().start(1, 1), PlannerSignal(JOY, np.zeros((1, 1)), 0.0))


def test_the_planners_phi_state_is_the_formula_layer_by_layer(made_up: Callable[..., Any]) -> None:
    library = made_up(7).library
    planner, rng = Planner(library), np.random.default_rng(2)
    emotion = np.concatenate([with_neutral(rng.random((60, 6)) ** 2), with_neutral(np.eye(6)), np.eye(7)[6:]])
    n, words = len(emotion), np.zeros((len(emotion), len(library.gestures)))
    state, _ = planner.advance(planner.start(n, 1), PlannerSignal(emotion[::-1], words, 0.0))
    state, _ = planner.advance(state, PlannerSignal(emotion, words, DT))  # ranked before, in another order
    for layer in LAYERS:
        own = [i for i in library.of_layer(layer) if not library.is_rest[i]]
        slots = [planner.tables.slot_of(i) for i in own]
        for felt, found in zip(emotion, state.phi_state[:, slots], strict=True):
            seen = [plain_scores.presence(felt, shown) for shown in library.exists[own]]
            wanted = np.array(plain_scores.phi_state(felt, library.intensity[own])) * seen
            np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-12)


def test_the_planners_phi_time_is_the_formula(made_up: Callable[..., Any]) -> None:
    library = made_up(8).library
    planner = Planner(library, PlannerConfig(settled=(), minimum=dict.fromkeys(LAYERS, 0.02)))
    state, words = planner.start(7, 3), np.ones((7, len(library.gestures)))
    rows, started = np.arange(7), np.full((7, planner.tables.slots), -np.inf)
    lengths, waits = np.zeros_like(started), np.zeros_like(started)
    phi_time = np.vectorize(plain_scores.phi_time)
    for tick in range(600):
        signal = PlannerSignal(np.eye(7), words, tick * DT)
        now = planner.moment(signal.time_s, DT)
        if tick % 20 == 0 or state.starting:
            time = planner.weigh(state, signal, rows)[2].time.reshape(7, -1)
            used = planner.tables.unit >= 0
            np.testing.assert_array_equal(time[:, used], phi_time(now, started, lengths, waits)[:, used])
        before = state
        state, d = planner.advance(state, signal)
        # Whoever had to give way has had its duration.
        who, layer = np.nonzero((state.running != before.running) & (before.running < planner.tables.slots))
        slot = before.running[who, layer]
        cut = started[who, slot] + lengths[who, slot] >= now
        lengths[who[cut], slot[cut]] = signal.time_s - started[who[cut], slot[cut]]
        who, layer = np.nonzero(d.started & (d.duration_s > 0.0))
        slot = state.running[who, layer]
        started[who, slot], lengths[who, slot] = signal.time_s, d.duration_s[who, layer]
        waits[who, slot] = state.wait_s[who, slot] - signal.time_s - d.duration_s[who, layer]


def test_what_starts_is_mixed_by_eq_5(made_up: Callable[..., Any]) -> None:
    library = made_up(9).library
    planner, rng = Planner(library), np.random.default_rng(3)
    emotion = with_neutral(rng.random((40, 6)) ** 2)
    _, d = planner.advance(planner.start(40, 1), PlannerSignal(emotion, np.ones((40, len(library.gestures))), 0.0))
    mixed = library.mix_weights(emotion[:, None], d.unit)
    np.testing.assert_allclose(d.emotion_weights, mixed, rtol=1e-12, atol=1e-300)
    assert mixed.any(axis=2).mean() > 0.5
