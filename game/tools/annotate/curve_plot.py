"""The learning curve as a picture. Needs matplotlib (the `reports` extra), imported only when something is plotted."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from game.core.errors import BadInput, Where
from game.tools.annotate.learning_curve import MEASURES, Curve
from game.tools.face.plots import need_matplotlib

__all__ = ["check_plot", "plot_curve"]

_TITLE = {
    "intensity": "intensities (eq. 2): mean difference",
    "times": "duration + waiting (eq. 3): median relative difference",
    "behaviour": "behaviour chosen: share of time spent otherwise",
}
_COLOUR = {"intensity": "#34608A", "times": "#C77A1E", "behaviour": "#B0303F"}


def check_plot(path: Path) -> None:
    """Before minutes of work: raises MissingPart without matplotlib, BadInput for a place that cannot be written."""
    need_matplotlib()
    if path.suffix not in {".png", ".svg", ".pdf"} or not path.parent.is_dir():
        raise BadInput("plot", where=Where(path), expected="NAME.png, .svg or .pdf in a folder that exists")


def plot_curve(curve: Curve, path: Path) -> None:
    """Draw mean and band of each measure over the takes' length. Raises BadInput."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 4.8), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    length = np.array([p.length_s for p in curve.points])
    for name in MEASURES:
        low, high = (np.array([getattr(p, end)[name] for p in curve.points]) for end in ("low", "high"))
        axes.fill_between(length, low, high, color=_COLOUR[name], alpha=0.18, linewidth=0)
        axes.plot(length, [p.mean[name] for p in curve.points], "o-", color=_COLOUR[name], label=_TITLE[name], ms=4)
    axes.axhline(
        curve.dice, color=_COLOUR["behaviour"], linestyle=":", linewidth=1.2, label="the same takes, other dice"
    )
    if curve.enough_s is not None:
        axes.axvline(curve.enough_s, color="#6B5A50", linestyle="--", linewidth=1.0)
        place = (curve.enough_s, 0.96)
        axes.annotate(" enough", place, xycoords=("data", "axes fraction"), color="#6B5A50", va="top")
    axes.set(xlabel="seconds of each of the seven takes", ylabel="distance from the whole takes", ylim=(0.0, 1.0))
    axes.set_xlim(0.0, float(length.max()) * 1.04)
    axes.legend(frameon=False, fontsize=9)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    try:
        figure.savefig(path)
    except OSError as error:
        raise BadInput("plot", where=Where(path), expected="a place that can be written", seen=error.strerror) from None
