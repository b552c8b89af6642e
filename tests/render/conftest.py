"""One headless device, one person and one stall for all drawing tests."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from game.app.film import sheet
from game.core import ASSETS, MissingPart
from game.formats import read_gltf
from game.render import CharacterModel, Device, StaticMesh, load_character, load_picture, load_stall, save_png
from game.tools.compare import Limits, compare_frames, cut_strip, write_comparison

GOLDENS = Path(__file__).resolve().parents[1] / "goldens" / "render"
Pixels = NDArray[np.uint8]
_ARMS_DEG = {"leftUpperArm": (0, 0, -62), "rightUpperArm": (0, 0, 62), "head": (0, 0, 5)}


@pytest.fixture(scope="module")
def device() -> Iterator[Device]:
    """A headless device of 640×360; tests that resize it set it back."""
    try:
        made = Device.headless(640, 360)
    except MissingPart as error:
        pytest.skip(str(error))
    yield made
    made.release()


@pytest.fixture(scope="session")
def model() -> CharacterModel:
    return load_character(ASSETS / "characters" / "mira.vrm")


@pytest.fixture(scope="session")
def stall() -> StaticMesh:
    return load_stall(ASSETS / "stalls" / "flea.glb")


@pytest.fixture(scope="session")
def backdrop() -> NDArray[np.uint8]:
    return load_picture(ASSETS / "stalls" / "flea_backdrop.png")


@pytest.fixture(scope="session")
def skin_matrices() -> NDArray[np.float32]:
    """(j, 4, 4): arms lowered, head a little tilted."""
    file = read_gltf(ASSETS / "characters" / "mira.vrm")
    local = np.array([node.matrix for node in file.nodes])
    for name, (_, _, degrees) in _ARMS_DEG.items():
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        local[file.node_index[name], :3, :3] = [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    world = file.to_model(local)
    skin = file.skins[0]
    return np.asarray(world[list(skin.joints)] @ skin.inverse_bind, dtype=np.float32)


@pytest.fixture(scope="session")
def golden_pages(request: pytest.FixtureRequest) -> Path | None:
    """Where a page for every golden is wanted, whatever the outcome; None: only where one differs."""
    folder = request.config.getoption("--golden-pages")
    return None if folder is None else Path(folder)


@pytest.fixture
def golden_strip(
    device: Device, renew_goldens: bool, golden_pages: Path | None, tmp_path: Path
) -> Callable[[Sequence[Pixels], str, int], None]:
    """compare(frames, name, columns): assert that the frames look like those of tests/goldens/render/<name>.png.

    Compared on the software rasteriser only, frame by frame; drawn anew with ``pytest tests/render --renew-goldens``.
    Where they differ a page shows expected, got and difference; ``--golden-pages DIR`` writes it in any case.
    """

    def compare(frames: Sequence[Pixels], name: str, columns: int) -> None:
        if not device.software:
            pytest.skip("golden pictures are compared on the software rasteriser only")
        path = GOLDENS / f"{name}.png"
        if renew_goldens:
            GOLDENS.mkdir(parents=True, exist_ok=True)
            save_png(path, sheet(list(frames), columns))
        height, width = frames[0].shape[:2]
        wanted = cut_strip(load_picture(path), (width, height))
        assert len(wanted) >= len(frames), f"{name} has another length; renew it with --renew-goldens"
        compared = compare_frames(
            (f"{name} {i}", old, new) for i, (old, new) in enumerate(zip(wanted, frames, strict=False), start=1)
        )
        off = [frame.told() for frame in compared if not frame.same]
        if off or golden_pages is not None:
            folder = golden_pages or tmp_path
            folder.mkdir(parents=True, exist_ok=True)
            page = folder / f"{name}.html"
            write_comparison(page, name, compared, Limits())
            assert not off, f"{'; '.join(off)}. See {page}; meant so? pytest tests/render --renew-goldens"

    return compare


@pytest.fixture
def golden(golden_strip: Callable[[Sequence[Pixels], str, int], None]) -> Callable[[Pixels, str], None]:
    """compare(pixels, name): one picture, as ``golden_strip``."""
    return lambda pixels, name: golden_strip([pixels], name, 1)
