"""Minutes of play in one process: neither memory nor GL objects grow."""

from __future__ import annotations

from pathlib import Path

import pytest

from game.app.bench_soak import soak


@pytest.mark.gl
def test_minutes_of_play_leave_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MCG_USER_FOLDER", str(tmp_path))
    found = soak(0.6 / 60)
    assert len(found) >= 20
    objects = [count for _, _, count in found]
    assert max(objects[5:]) == min(objects[5:]), "GL objects come and go"
    assert found[-1][1] - found[5][1] < 40.0, "megabytes in half a minute"
    assert list(tmp_path.glob("*.json")) == []
