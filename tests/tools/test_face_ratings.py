"""Ratings on disk and a rater's sitting: nothing is lost, nothing is asked twice, everything can be taken back."""

from __future__ import annotations

import numpy as np
import pygame
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from game.core import ASSETS, BadInput
from game.face import Face, load_parts
from game.tools.face.rate_window import RateScreen
from game.tools.face.ratings_file import Rating, RatingLog, face_code, parse_face, read_ratings
from game.tools.face.sitting import Sitting, single_part_faces, whole_faces

HEAD = "rater,face,valence,arousal,name,time\n"


@pytest.fixture(scope="module")
def parts():
    return load_parts(ASSETS / "face" / "parts.yaml")


@pytest.fixture
def path(tmp_path):
    return tmp_path / "ratings.csv"


def sit(path, parts, rater="yuki", faces=None):
    return Sitting(RatingLog(path, parts), faces or single_part_faces(parts), rater, 1)


def test_every_single_part_once(parts):
    faces = single_part_faces(parts)
    assert len(faces) == len(set(faces)) == 1 + sum(n - 1 for n in parts.counts)
    assert all(sum(p != "standard" for p in face.parts) <= 1 for face in faces)


def test_whole_faces_are_the_same_for_all_raters(parts):
    faces = whole_faces(parts, 81, seed=4)
    assert faces == whole_faces(parts, 81, seed=4)
    assert faces != whole_faces(parts, 81, seed=5)
    assert len(set(faces)) == 81
    assert all(sum(p != "standard" for p in face.parts) >= 2 for face in faces)
    with pytest.raises(BadInput, match="1 to 2000"):
        whole_faces(parts, 0, seed=1)


def test_order_differs_by_rater_and_holds_after_a_break(path, parts, tmp_path):
    a, b = sit(path, parts), sit(tmp_path / "b.csv", parts, "ken")
    seen = []
    for _ in range(5):
        seen.append(a.face)
        a.place(0.1, 0.2)
        assert a.confirm("t")
    again = sit(path, parts)
    assert again.done == 5
    assert again.face == a.face
    assert again.face not in seen
    assert [b.face] != seen[:1] or b.face != seen[0]


def test_a_rating_is_on_the_disk_before_the_next_face(path, parts):
    sitting = sit(path, parts)
    face = sitting.face
    sitting.place(-0.25, 1.7)
    sitting.call(1)
    assert sitting.confirm("2026-01-01T00:00:00Z")
    # The log is still open: another reader already sees the row.
    assert path.read_text() == HEAD + f"yuki,{face_code(face)},-0.2500,1.0000,fear,2026-01-01T00:00:00Z\n"
    assert sitting.face != face
    assert sitting.point is None
    assert sitting.name == ""


def test_no_point_no_rating(path, parts):
    sitting = sit(path, parts)
    assert not sitting.confirm("t")
    assert sitting.message
    assert path.read_text() == HEAD


def test_undo_brings_face_point_and_name_back(path, parts):
    sitting = sit(path, parts)
    first = sitting.face
    sitting.nudge(1, 0)
    sitting.nudge(0, 1, fine=True)
    sitting.call(3)
    sitting.confirm("t")
    assert sitting.undo()
    assert (sitting.face, sitting.name) == (first, "sadness")
    assert sitting.point == pytest.approx((0.05, 0.01))
    assert path.read_text() == HEAD
    assert not sitting.undo()


def test_undo_never_takes_another_raters_row(path, parts):
    sitting = sit(path, parts)
    sitting.place(0, 0)
    sitting.confirm("t")
    with path.open("a") as other:
        other.write("ken,standard+standard+standard+standard,0.1,0.1,,t\n")
    assert not sitting.undo()
    assert len(read_ratings(path, parts)) == 2


def test_a_row_cut_off_by_a_power_loss_is_dropped_and_the_rest_kept(path, parts):
    row = "yuki,standard+standard+standard+standard,0.1000,0.2000,,t\n"
    path.write_text(HEAD + row + "yuki,fierce+stand")
    log = RatingLog(path, parts)
    assert [r.valence for r in log.ratings] == [0.1]
    assert path.read_text() == HEAD + row


def test_two_raters_share_a_file_and_the_later_rating_counts(path, parts):
    sit(path, parts).log.append(Rating("yuki", Face(), 0.5, 0.5))
    log = RatingLog(path, parts)
    log.append(Rating("ken, jr", Face(), -0.5, 0.0))
    log.append(Rating("yuki", Face(), 0.25, 0.0))
    found = {r.rater: r.valence for r in read_ratings(path, parts)}
    assert found == {"yuki": 0.25, "ken, jr": -0.5}


@pytest.mark.parametrize(
    ("row", "message"),
    [
        (
            "yuki,standard+standard+standard+standard,1.2,0,,t",
            r"ratings\.csv:3: valence: expected a number from -1 to 1",
        ),
        ("yuki,standard+standard+standard+standard,0,nan,,t", r"ratings\.csv:3: arousal"),
        ("yuki,standard+standard+standard+standard,0,,,t", r"ratings\.csv:3: arousal"),
        ("yuki,fierc+standard+standard+standard,0,0,,t", "did you mean 'fierce'"),
        ("yuki,fierce,0,0,,t", r"expected eyes\+eyebrows\+mouth\+skin"),
        ("yuki,standard+standard+standard+standard,0,0,angry,t", "anger | fear"),
        (",standard+standard+standard+standard,0,0,,t", "rater"),
        ("yuki,standard+standard+standard+standard,0,0", "6 columns"),
        ('yuki,"standard', r"ratings\.csv:3"),
    ],
)
def test_bad_rows_name_file_and_line_and_change_nothing(path, parts, row, message):
    text = HEAD + "yuki,standard+standard+standard+standard,0,0,,t\n" + row + "\n"
    path.write_text(text)
    for read in (read_ratings, RatingLog):
        with pytest.raises(BadInput, match=message):
            read(path, parts)
    assert path.read_text() == text


def test_files_that_are_no_ratings(path, parts, tmp_path):
    path.write_text("a,b\n1,2\n")
    with pytest.raises(BadInput, match=r"ratings\.csv:1: heading"):
        RatingLog(path, parts)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BadInput, match="UTF-8"):
        read_ratings(path, parts)
    path.write_text("")
    with pytest.raises(BadInput, match="empty file"):
        read_ratings(path, parts)
    for place in (tmp_path, tmp_path / "no" / "r.csv"):
        with pytest.raises(BadInput, match="folder that exists"):
            RatingLog(place, parts)


def test_codes_go_there_and_back(parts):
    face = Face("fierce", "knitted", "grit", "vein")
    assert parse_face(face_code(face), parts) == face


LINES = st.lists(
    st.lists(
        st.one_of(
            st.sampled_from(["yuki", "standard+standard+standard+standard", "fierce", "0.5", "1e999", "-1", "", "joy"]),
            st.text(max_size=12),
        ),
        max_size=8,
    ),
    max_size=5,
)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(LINES, st.sampled_from([",", '",', "\n", ";"]), st.booleans())
def test_any_text_is_ratings_or_one_clear_line(path, parts, lines, between, headed):
    path.write_bytes(
        ((HEAD if headed else "") + "\n".join(between.join(row) for row in lines)).encode("utf-8", "replace")
    )
    said, found = "ratings.csv", []
    try:
        found = read_ratings(path, parts)
    except BadInput as error:
        said = str(error)
    assert "ratings.csv" in said
    assert "\n" not in said
    assert all(abs(r.valence) <= 1 and abs(r.arousal) <= 1 for r in found)


# -- the window's input, without a window ---------------------------------------------------------------------------


def send(screen, kind, **fields):
    return screen.handle(pygame.event.Event(kind, **fields), lambda at: (float(at[0]), float(at[1])))


def key(screen, code, mod=0):
    return send(screen, pygame.KEYDOWN, key=code, mod=mod)


@pytest.fixture
def screen(path, parts):
    return RateScreen(sit(path, parts), lambda: "now")


def test_click_drag_and_release_set_the_point(screen):
    pad = screen.pad
    send(screen, pygame.MOUSEBUTTONDOWN, button=1, pos=pad.to_screen(0.0, 0.0))
    assert screen.sitting.point == pytest.approx((0.0, 0.0))
    send(screen, pygame.MOUSEMOTION, pos=pad.to_screen(0.3, -0.4))
    assert screen.sitting.point == pytest.approx((0.3, -0.4))
    send(screen, pygame.MOUSEBUTTONUP, button=1, pos=(5000, -5000))
    assert screen.sitting.point == (1.0, 1.0)
    send(screen, pygame.MOUSEMOTION, pos=pad.to_screen(0.0, 0.0))
    assert screen.sitting.point == (1.0, 1.0)


def test_keys_alone_are_enough(screen, path):
    for code in (pygame.K_RIGHT, pygame.K_RIGHT, pygame.K_UP, pygame.K_LEFT, pygame.K_3):
        key(screen, code)
    assert screen.sitting.point == pytest.approx((0.05, 0.05))
    assert key(screen, pygame.K_RETURN), "another face is due: what comes behind waits for it"
    assert path.read_text().endswith(",0.0500,0.0500,joy,now\n")
    assert key(screen, pygame.K_z, pygame.KMOD_CTRL)
    assert path.read_text() == HEAD


def test_a_point_that_was_set_survives_closing(screen, path):
    send(screen, pygame.MOUSEBUTTONDOWN, button=1, pos=screen.pad.to_screen(0.5, 0.5))
    send(screen, pygame.QUIT)
    assert not screen.running
    assert "0.5000,0.5000,,now" in path.read_text()


def test_a_rating_that_cannot_be_written_stays_and_is_told(screen, path):
    screen.sitting.place(0.5, 0.5)
    face = screen.sitting.face
    path.unlink()
    path.mkdir()
    assert not key(screen, pygame.K_RETURN)
    assert "Not saved" in screen.sitting.message
    assert (screen.sitting.face, screen.sitting.point) == (face, (0.5, 0.5))
    send(screen, pygame.QUIT)
    assert screen.running, "the first try to close only warns"
    path.rmdir()
    send(screen, pygame.QUIT)
    assert not screen.running
    assert "0.5000,0.5000" in path.read_text()


def test_any_storm_of_input_keeps_file_and_count_in_step(screen, path, parts):
    rng = np.random.default_rng(3)
    codes = [pygame.K_RETURN, pygame.K_BACKSPACE, pygame.K_LEFT, pygame.K_UP, pygame.K_1, pygame.K_7, pygame.K_SPACE]
    for _ in range(300):
        if rng.random() < 0.5:
            key(screen, codes[rng.integers(len(codes))])
        else:
            kind = (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP)[rng.integers(2)]
            send(screen, kind, button=1, pos=tuple(rng.integers(-50, 1400, 2)))
    assert len(read_ratings(path, parts)) == screen.sitting.done
