"""Agreement, live statistics, automatic annotation and the learning curve."""

from __future__ import annotations

import numpy as np
import pytest

from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput
from game.core.paths import ASSETS
from game.embos.clips import TakeClip, load_clips
from game.embos.findings import Findings
from game.embos.repertoire import Behaviour, read_repertoire
from game.embos.units_file import read_units
from game.tools.annotate import edits, files
from game.tools.annotate.agreement import agreement, cohen_kappa
from game.tools.annotate.automatic import Annotator, Example, most_likely, propose, spans_of
from game.tools.annotate.document import Document
from game.tools.annotate.learning_curve import learning_curve, part_of
from game.tools.annotate.statistics import as_take, statistics_of
from game.tools.annotate.trial import score_frames

MOTION = ASSETS / "motion"


@pytest.fixture(scope="module")
def repertoire() -> dict[str, Behaviour]:
    return read_repertoire(MOTION / "behaviours.yaml", Findings())


@pytest.fixture(scope="module")
def documents() -> list[Document]:
    return [files.read_document(MOTION / "takes" / f"{emotion}.yaml") for emotion in EMOTIONS]


def test_kappa_of_a_textbook_table() -> None:
    # Two readers, 50 cases: both yes 20, both no 15, yes/no 5, no/yes 10 -> p_o .7, p_e .5, kappa .4.
    first = np.array(["y"] * 25 + ["n"] * 25)
    second = np.array(["y"] * 20 + ["n"] * 5 + ["y"] * 10 + ["n"] * 15)
    kappa, observed = cohen_kappa(first, second)
    assert observed == pytest.approx(0.7)
    assert kappa == pytest.approx(0.4)


def test_two_annotators_who_differ_are_shown_where(documents: list[Document]) -> None:
    first = documents[0]
    posture = first.of_layer("posture")[1]
    second, _ = edits.changed(first, posture, behaviour="upright")
    tapping = second.of_layer("mannerism")[0]
    second, _ = edits.trimmed(second, tapping, end_s=tapping.end_s - 0.5)
    result = agreement(first, second)
    assert result.kappa["gesture"] == pytest.approx(1.0)
    assert 0.8 < result.kappa["posture"] < 1.0
    assert {(d.layer, d.first, d.second) for d in result.differences} == {
        ("posture", posture.behaviour, "upright"),
        ("mannerism", first.of_layer("mannerism")[0].behaviour, ""),
    }
    with pytest.raises(BadInput, match="the same motion"):
        agreement(first, documents[1])


def test_live_statistics_are_those_of_the_analysis(documents: list[Document], repertoire: dict[str, Behaviour]) -> None:
    shipped, transitions = read_units(MOTION / "units.yaml")
    live = statistics_of(documents, repertoire)
    assert {u.name for u in live.units} == {u.name for u in shipped if not u.is_rest}
    for unit in shipped:
        if not unit.is_rest:
            own = next(u for u in live.units if u.name == unit.name)
            np.testing.assert_allclose(own.intensity, unit.intensity, atol=2e-3)
            np.testing.assert_allclose(own.duration_s, unit.duration_s, atol=2e-3)
            np.testing.assert_allclose(own.waiting_s, unit.waiting_s, atol=2e-2)
    assert {a: dict(b) for a, b in live.transitions.items()} == {a: dict(b) for a, b in transitions.items()}


def test_an_edit_shows_in_the_statistics_and_a_proposal_does_not(
    documents: list[Document], repertoire: dict[str, Behaviour]
) -> None:
    before = statistics_of(documents, repertoire)
    joy = documents[EMOTIONS.index("joy")]
    gap = max(joy.gaps("mannerism"), key=lambda g: g[1] - g[0])
    edited, mark = edits.created(joy, "mannerism", "sigh", *gap)
    after = statistics_of([edited if d is joy else d for d in documents], repertoire)
    profile, old = after.profile("sigh"), before.profile("sigh")
    assert profile is not None
    assert old is not None
    assert profile[EMOTIONS.index("joy")] > old[EMOTIONS.index("joy")] == 0.0
    proposed, _ = edits.changed(edited, mark, confidence=0.6)
    untouched = statistics_of([proposed if d is joy else d for d in documents], repertoire)
    assert untouched.profile("sigh") is not None
    np.testing.assert_array_equal(untouched.profile("sigh"), old)  # type: ignore[arg-type]
    assert untouched.missing[EMOTIONS.index("joy")].proposals == 1


def test_the_likeliest_path_does_not_flicker() -> None:
    probability = np.tile([0.6, 0.4], (40, 1))
    probability[7] = [0.2, 0.8]
    probability[20:] = [0.05, 0.95]
    path = most_likely(probability, 3.0)
    assert path.tolist() == [0] * 20 + [1] * 20


def test_runs_of_labels_become_spans_long_enough_for_their_layer() -> None:
    document = Document(take="t", bvh="t.bvh", fps=30.0, frames=300)
    labels = ["upright"] * 30 + ["lean_back"] * 5 + [""] * 5 + ["upright"] * 60
    marks = spans_of(document, "posture", labels, np.full(100, 0.7))
    assert [(m.behaviour, m.start_s, m.end_s, m.confidence) for m in marks] == [
        ("upright", 0.0, 3.0, 0.7),
        ("upright", 4.0, 10.0, 0.7),
    ]


def test_frames_are_scored_as_precision_and_recall() -> None:
    said = [np.array(["a", "a", "b", "", ""]), np.array(["a", "", "", "", ""])]
    told = [np.array(["a", "b", "b", "b", ""]), np.array(["a", "a", "", "", ""])]
    scores, whole = score_frames(said, told)
    assert (scores["a"].precision, scores["a"].recall, scores["a"].known) == (2 / 3, 2 / 3, 1.0)
    assert (scores["b"].precision, scores["b"].recall, scores["b"].known) == (1 / 3, 1.0, 0.0)
    assert (whole.precision, whole.recall) == (3 / 6, 3 / 4)


def _first_half(document: Document, clip: TakeClip, share: tuple[float, float]) -> tuple[Document, TakeClip]:
    """A stretch of a take as a take of its own."""
    first, last = (round(s * len(clip.rotation)) for s in share)
    cut = TakeClip(clip.rotation[first:last].copy(), clip.root[first:last].copy(), clip.frame_time_s)
    start = first / document.fps
    marks = []
    for mark in document.marks:
        low, high = max(mark.start_s, start) - start, min(mark.end_s, last / document.fps) - start
        if high - low > 1.0:
            marks.append(edits.changed(document, mark, start_s=round(low, 3), end_s=round(high, 3), stroke_s=None)[1])
    part = Document(document.take, document.bvh, document.fps, last - first, document.emotion)
    return part.with_marks(marks), cut


def test_what_was_learnt_from_half_a_take_is_found_in_its_other_half(documents: list[Document]) -> None:
    pytest.importorskip("sklearn", reason="automatic annotation is part of the tools extra")
    clips = load_clips(MOTION / "clips.npz")
    chosen = [d for d in documents if d.emotion == "joy"]
    examples = [Example.of(*_first_half(d, clips[d.take], (0.0, 0.55))) for d in chosen]
    annotator = Annotator(examples)
    right = total = 0
    for document in chosen:
        truth, clip = _first_half(document, clips[document.take], (0.55, 1.0))
        kept = truth.of_layer("posture")[0]
        proposed = propose(annotator, truth.with_marks([kept]), clip)
        assert kept in proposed.marks, "what a person marked stays"
        assert all(0.0 <= m.confidence <= 1.0 for m in proposed.marks if m.confidence is not None)
        found = _labels(proposed)
        wanted = _labels(truth)
        right, total = right + int((found == wanted)[wanted != ""].sum()), total + int((wanted != "").sum())
    assert right / total > 0.6, "postures of the other half, frame by frame (chance is below .3)"


def _labels(document: Document) -> np.ndarray[tuple[int], np.dtype[np.str_]]:
    from game.tools.annotate.agreement import frame_labels

    return frame_labels(document, "posture")


def test_a_part_of_a_take_holds_what_lies_in_it(documents: list[Document], repertoire: dict[str, Behaviour]) -> None:
    take = as_take(documents[0], repertoire)
    part = part_of(take, 30.0, 60.0)
    assert all(30.0 <= s.start_s < s.end_s <= 60.0 for s in part.spans)
    assert all(s.stroke_s is None or s.start_s <= s.stroke_s <= s.end_s for s in part.spans)
    whole = part_of(take, 0.0, 1e6)
    assert whole.spans == take.spans


def test_longer_takes_come_nearer_to_the_whole(
    documents: list[Document], repertoire: dict[str, Behaviour], monkeypatch: pytest.MonkeyPatch
) -> None:
    from game.tools.annotate import learning_curve as lc

    monkeypatch.setattr(lc, "LENGTHS_S", (20.0, 60.0, 150.0))
    monkeypatch.setattr(lc, "WATCH_S", 12.0)
    clips = load_clips(MOTION / "clips.npz")
    takes = [lc.replace(as_take(d, repertoire), clip=clips[d.take]) for d in documents]
    curve = learning_curve(takes, repertoire, draws=2, seed=3)
    for name in lc.MEASURES:
        means = [p.mean[name] for p in curve.points]
        assert means[0] > means[1] > means[2], name
    assert curve == learning_curve(takes, repertoire, draws=2, seed=3)
