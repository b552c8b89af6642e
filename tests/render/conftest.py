"""One headless device, one person and one stall for all drawing tests."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from game.core import ASSETS, MissingPart
from game.formats import read_gltf
from game.render import CharacterModel, Device, StaticMesh, load_character, load_picture, load_stall, save_png

GOLDENS = Path(__file__).resolve().parents[1] / "goldens" / "render"
MEAN_OFF = 1.5  # of 255, over all pixels and channels
FAR_OFF = 40  # a pixel is wrong when a channel is off by more
FAR_SHARE = 0.01
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


@pytest.fixture
def golden(device: Device, renew_goldens: bool) -> Callable[[NDArray[np.uint8], str], None]:
    """compare(pixels, name): assert that the pixels look like tests/goldens/render/<name>.png.

    Compared on the software rasteriser only; drawn anew with ``pytest tests/render --renew-goldens``.
    """

    def compare(pixels: NDArray[np.uint8], name: str) -> None:
        if not device.software:
            pytest.skip("golden pictures are compared on the software rasteriser only")
        path = GOLDENS / f"{name}.png"
        if renew_goldens:
            GOLDENS.mkdir(parents=True, exist_ok=True)
            save_png(path, pixels)
        wanted = load_picture(path).astype(np.int16)
        assert wanted.shape == pixels.shape, f"{name} has another size; renew it with --renew-goldens"
        off = np.abs(wanted - pixels)
        wrong = (off.max(axis=2) > FAR_OFF).mean()
        assert off.mean() <= MEAN_OFF, f"{name} is off by {off.mean():.2f} on average; renew with --renew-goldens?"
        assert wrong <= FAR_SHARE, f"{name}: {wrong:.2%} of the pixels differ; renew with --renew-goldens?"

    return compare
