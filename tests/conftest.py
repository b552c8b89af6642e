"""What every test shares: strict floating point, the neighbours' data, GL without a display."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[1]

# No audio device and no display may be needed by any test.
os.environ.setdefault("SDL_AUDIODRIVER", "dummy")
os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--renew-goldens", action="store_true", default=False, help="draw the golden images anew instead of comparing"
    )
    parser.addoption(
        "--golden-pages", metavar="DIR", default=None, help="a page for every golden: expected, got, difference"
    )


@pytest.fixture(scope="session")
def renew_goldens(request: pytest.FixtureRequest) -> bool:
    """True where the golden images are to be written, not compared."""
    return bool(request.config.getoption("--renew-goldens"))


@pytest.fixture(autouse=True)
def _strict_floats():
    """A NaN or an overflow is an error where it happens, not three stages later."""
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        yield


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Real files that nobody here made; they lie beside the checkout and are never copied into it."""
    folder = ROOT.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("the folder shared/data does not lie beside the checkout")
    return folder
