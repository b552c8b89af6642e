"""Rating a foreign avatar's expressions, and fitting what people saw into the file that the game reads."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from game.app.avatar import open_avatar
from game.app.cli import main
from game.core.emotion_space import EMOTION_INDEX
from game.core.errors import BadInput
from game.face import FaceSignal, load_rated
from game.tools.face.avatar_ratings import expressions_to_rate, look_of
from game.tools.face.ratings_file import Rating, RatingLog
from game.tools.face.sitting import Sitting


@pytest.fixture
def godette(shared_data: Path) -> Path:
    return shared_data / "vrm" / "Godette_vrm_v4.vrm"


def test_a_sitting_with_expressions_resumes_and_refuses_strangers(godette: Path, tmp_path: Path):
    avatar = open_avatar(godette)
    names = expressions_to_rate(avatar)
    assert {"happy", "angry", "sad"} <= set(names)
    assert not {"blink", "aa", "lookLeft"} & set(names)
    path = tmp_path / "ratings.csv"
    sitting = Sitting(RatingLog(path, tuple(avatar.expressions)), names, "yuki", 1)
    first = sitting.face
    sitting.place(0.5, 0.25)
    assert sitting.confirm("2026-01-01T00:00:00Z")
    again = Sitting(RatingLog(path, tuple(avatar.expressions)), names, "yuki", 1)
    assert again.done == 1
    assert again.face != first
    path.write_text(path.read_text(encoding="utf-8").replace(str(first), "smug"), encoding="utf-8")
    with pytest.raises(BadInput, match="smug"):
        RatingLog(path, tuple(avatar.expressions))


def test_an_expression_alone_moves_the_mesh(godette: Path):
    avatar = open_avatar(godette)
    assert np.abs(look_of(avatar, "angry").morph).max() > 0.5
    assert np.abs(look_of(avatar, "neutral").morph).max() == 0.0


def test_ratings_become_gaussians_that_choose(godette: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Raters see joy in "sad" and sadness in "happy": after the fit the game believes them, not the names."""
    avatar = open_avatar(godette)
    path, out = tmp_path / "theirs.csv", tmp_path / "out.faces.yaml"
    log, rng = RatingLog(path, tuple(avatar.expressions)), np.random.default_rng(4)
    seen = {"sad": (0.7, 0.4, "joy"), "happy": (-0.6, -0.4, "sadness"), "angry": (-0.6, 0.7, "anger")}
    for name, (v, a, emotion) in seen.items():
        for i in range(12):
            x, y = np.clip(rng.normal((v, a), 0.1), -1, 1)
            log.append(Rating(f"r{i}", name, float(x), float(y), emotion if i % 3 else ""))
    log.append(Rating("r0", "relaxed", 0.4, -0.3))
    assert main(["face", "fit", str(path), "--avatar", str(godette), "--out-faces", str(out), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert {row["expression"] for row in report["expressions"]} == set(seen)
    assert any(line.startswith("relaxed: 1 ratings") for line in report["lacking"])
    known, _ = load_rated(out)
    np.testing.assert_allclose(known["sad"].mean, (0.7, 0.4), atol=0.1)
    assert known["sad"].affinity[EMOTION_INDEX["joy"]] == 1.0
    face = open_avatar(godette, ratings=out).face
    joy = np.eye(7)[EMOTION_INDEX["joy"]]
    found = face.weights(FaceSignal(joy), np.zeros(60), np.zeros(6)).weight
    assert face.names[int(found.argmax())] == "sad"


def test_too_few_ratings_write_nothing(godette: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / "few.csv"
    RatingLog(path, ("happy", "sad")).append(Rating("r", "happy", 0.1, 0.1))
    assert main(["face", "fit", str(path), "--avatar", str(godette)]) == 2
    assert "1 ratings of 3" in capsys.readouterr().err
    assert list(tmp_path.glob("*.yaml")) == []
