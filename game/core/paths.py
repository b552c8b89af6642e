"""Where the checkout keeps its data. The game runs from a checkout (``pip install -e .``)."""

from __future__ import annotations

from pathlib import Path

__all__ = ["ASSETS", "DIALOGUE", "ROOT"]

ROOT = Path(__file__).resolve().parents[2]
ASSETS = ROOT / "assets"
DIALOGUE = ROOT / "dialogue"
