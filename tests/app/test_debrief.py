"""After a talk: what would have happened otherwise agrees with playing it; tells belong to feelings; tokens count."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from game.app.afternoon import Afternoon, Reading, visit_stall
from game.app.bazaar import Lesson, load_bazaar
from game.app.content import load_talk_assets, stall_path
from game.app.loading import load_step_assets
from game.app.saves import SavedGame, load_game, save_game
from game.app.step import new_world, step
from game.app.talk import Choice, choose
from game.app.tells import TellWatch, tell_strength
from game.app.whatif import play_on, turning_point, worth
from game.app.world import Intent, Mark, enter_talk, first_mark, next_mark

BAZAAR = load_bazaar()


@pytest.fixture(scope="module")
def assets():
    return load_talk_assets(stall_path("flea"))


def play(assets, seed: int, guess: str = "") -> tuple[tuple[Mark, ...], object]:
    """A talk of a player who always says the first line with a rising offer."""
    state = visit_stall(assets, Afternoon(seed=seed), "vase")
    marks = [first_mark(assets, state)]
    for i in range(12):
        if state.ended:
            break
        line = next(c for c in state.beat.choices if c.available and c.act != "leave")
        offer = None if line.act == "wait" else min(1600 + 200 * i, round(state.bargain.ask * 320) * 10)
        move = Choice(line.id, offer)
        after = choose(assets, state, move)
        marks.append(next_mark(assets, state, after, move, guess, len(marks)))
        state = after
    return tuple(marks), state


def test_what_would_have_happened_is_what_happens_when_it_is_played(assets) -> None:
    told = 0
    for seed in range(25):
        marks, end = play(assets, seed)
        other = turning_point(assets, marks, end)
        if other is None:
            continue
        told += 1
        at = marks.index(other.mark)
        before = other.mark.before
        again = visit_stall(assets, Afternoon(seed=seed), "vase")
        for mark in marks[1:at]:
            again = choose(assets, again, mark.choice)
        assert again.bargain == before.bargain, "the state at the turning point is the one that was played"
        end_then = play_on(assets, choose(assets, again, other.choice), [m.choice for m in marks[at + 1 :]])
        assert worth(end_then) == worth(other.state)
        assert worth(end_then) > worth(end)
        assert other.gain == pytest.approx(worth(end_then) - worth(end))
        assert other.choice.id != other.mark.choice.id
    assert told >= 15, "a player who reads nothing loses something somewhere"


def test_a_talk_played_with_the_told_word_has_a_smaller_turning_point_left(assets) -> None:
    marks, end = play(assets, 3)
    best = turning_point(assets, marks, end)
    assert best is not None
    for mark in marks[1:]:
        for other in mark.before.beat.choices:
            if not other.available or other.act in ("leave", "offer", "wait"):
                continue
            state = choose(assets, mark.before, Choice(other.id, mark.choice.offer))
            later = [m.choice for m in marks[marks.index(mark) + 1 :]]
            assert worth(play_on(assets, state, later)) <= worth(best.state) + 1e-12


def test_a_save_in_the_middle_keeps_the_curve_the_tokens_and_the_way_back(assets, tmp_path) -> None:
    marks, _ = play(assets, 7, guess="anger")
    state = marks[3].before
    path = tmp_path / "save.json"
    save_game(path, SavedGame(Afternoon(seed=7), "flea", state, marks[:3]))
    # The afternoon's first talk is a lesson; what was played above was not.
    saved = load_game(path, replace(BAZAAR, lessons=()), {"flea": assets})
    assert [m.choice for m in saved.marks] == [m.choice for m in marks[:3]]
    assert [m.guess for m in saved.marks] == ["", "anger", "anger"]
    assert saved.marks == marks[:3]
    assert saved.marks[2].before.bargain == marks[2].before.bargain


def test_a_token_is_right_when_it_names_what_is_felt_and_not_what_is_shown(assets) -> None:
    masked = Lesson(mask=0.95, mood="anger", shows="joy").bend(assets)
    marks, _ = play(masked, 4, guess="anger")
    first = marks[1]
    assert first.label == "anger"
    assert first.face == "joy"
    assert Reading("flea", first.guess, first.label, first.face).right
    assert not Reading("flea", "joy", first.label, first.face).right


def test_lessons_bend_the_mask_the_mood_and_the_leak(assets) -> None:
    plain, masked, habit = BAZAAR.lessons
    open_face = plain.bend(assets)
    assert open_face.person.mask == 0
    state = visit_stall(open_face, Afternoon(seed=3), "vase")
    mark = first_mark(open_face, state)
    np.testing.assert_allclose(mark.felt[:6], mark.shown[:6], atol=1e-9)
    hidden = masked.bend(assets)
    for seed in range(6):
        state = visit_stall(hidden, Afternoon(seed=seed), "vase")
        mark = first_mark(hidden, state)
        assert int(np.argmax(mark.felt[:6])) == 0, "anger behind …"
        assert int(np.argmax(mark.shown[:6])) == 2, "… a smile"
    assert habit.bend(assets).person.habit_rate == 0.2
    assert assets.person.mask == 0.15, "the person stays as written"


def test_the_body_tells_what_is_felt_and_the_clip_drops_the_mask() -> None:
    base = load_step_assets()
    assets = replace(base, talk=Lesson(mask=0.9, leak=1.0, mood="anger", shows="joy").bend(base.talk))
    world = enter_talk(assets, new_world(assets, 5), visit_stall(assets.talk, Afternoon(seed=5), "vase"))
    watch, still = TellWatch(), np.zeros((2, 4, 4), np.float32)
    for i in range(420):
        world = step(assets, world, Intent(proceed=i % 60 == 59))
        watch.tick(assets, world, still)
    watch.finish(assets)
    assert watch.tells
    assert len(watch.tells) <= 3
    library = assets.planner.library
    for tell in watch.tells:
        assert tell.feeling == "anger"
        assert tell.face == "joy"
        assert library.exists[tell.unit, 0], "a unit that belongs to anger"
    assert watch.clip is not None
    clip = watch.clip
    assert clip.tell in watch.tells
    assert len(clip.faces) == len(clip.bare) == len(clip.matrices)
    np.testing.assert_array_equal(clip.bare[clip.drop], clip.faces[clip.drop])
    assert np.abs(clip.bare[-1] - clip.faces[-1]).max() > 0.2, "without the mask the face is another"


def test_rest_and_strangers_units_tell_nothing() -> None:
    assets = load_step_assets(body=False)
    library = assets.planner.library
    angry, smile = np.eye(6)[0] * 0.8, np.eye(6)[2] * 0.6
    rest = int(np.flatnonzero(library.is_rest)[0])
    assert tell_strength(assets, rest, angry, smile) == 0
    not_anger = int(np.flatnonzero(~library.exists[:, 0] & ~library.is_rest)[0])
    assert tell_strength(assets, not_anger, angry, smile) == 0
    own = int(np.flatnonzero(library.exists[:, 0] & ~library.is_rest & (library.exists.sum(axis=1) == 1))[0])
    assert tell_strength(assets, own, angry, smile) > tell_strength(assets, own, angry, angry) > 0
    assert tell_strength(assets, own, angry * 0.2, smile) == 0


def test_a_habit_is_seen_in_the_greeting_and_then_no_more() -> None:
    from game.app.step import HABIT_S, body_emotion

    base = load_step_assets(body=False)
    world = enter_talk(base, new_world(base, 5), visit_stall(base.talk, Afternoon(seed=5), "vase"))
    greeting = replace(world, habit="sadness")
    assert int(np.argmax(body_emotion(base, greeting)[:6])) == 3
    later = replace(greeting, tick=round((HABIT_S + 1) * 30))
    np.testing.assert_allclose(body_emotion(base, later), body_emotion(base, replace(later, habit="")))
    assert enter_talk(base, greeting, world.talk).habit == ""
