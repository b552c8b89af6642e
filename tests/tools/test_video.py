"""Films: what is written can be read back, picture for picture; what cannot is refused in one line."""

from __future__ import annotations

import builtins
from pathlib import Path

import numpy as np
import pytest

from game.app.video import check_film, write_film
from game.core.errors import BadInput, MissingPart


def pictures(count: int, size: tuple[int, int] = (64, 48)) -> list[np.ndarray]:
    """Grey pictures, each a step brighter than the one before."""
    return [np.full((size[1], size[0], 3), 20 + 20 * i, np.uint8) for i in range(count)]


def test_a_film_has_every_picture_at_its_rate(tmp_path: Path) -> None:
    av = pytest.importorskip("av", reason="films need the extra video")
    path = tmp_path / "grey.mp4"
    assert write_film(path, pictures(9, (65, 49)), 24) == 9
    with av.open(str(path)) as film:
        stream = film.streams.video[0]
        seen = [frame.to_ndarray(format="rgb24") for frame in film.decode(stream)]
        assert float(stream.average_rate) == 24.0
    assert [picture.shape for picture in seen] == [(48, 64, 3)] * 9
    assert [round((float(picture.mean()) - 20) / 20) for picture in seen] == list(range(9))
    assert [file.name for file in tmp_path.iterdir()] == ["grey.mp4"]


def test_a_film_that_breaks_leaves_nothing(tmp_path: Path) -> None:
    pytest.importorskip("av", reason="films need the extra video")

    def broken():
        yield from pictures(2)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_film(tmp_path / "x.mp4", broken(), 30)
    assert list(tmp_path.iterdir()) == []


def test_without_pyav_one_line_says_what_to_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def no_av(name: str, *rest: object, **more: object) -> object:
        if name == "av":
            raise ImportError(name)
        return real(name, *rest, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(builtins, "__import__", no_av)
    with pytest.raises(MissingPart, match=r"\[video\].*folder") as caught:
        check_film(tmp_path / "x.mp4")
    assert "\n" not in str(caught.value)
    assert write_film(tmp_path / "frames", pictures(3), 30) == 3
    assert sorted(path.name for path in (tmp_path / "frames").iterdir()) == ["00000.png", "00001.png", "00002.png"]


@pytest.mark.parametrize("name", ["x.gif", "nowhere/x.mp4"])
def test_places_no_film_can_go_to(tmp_path: Path, name: str) -> None:
    with pytest.raises(BadInput):
        check_film(tmp_path / name)
