"""The plots of a report, drawn with matplotlib (extra ``reports``): who wins how much, prices, lengths, feelings."""

from __future__ import annotations

import io
import logging
import re
from collections.abc import Callable, Mapping
from typing import Any

from game.app.autoplay.runs import Run
from game.app.autoplay.tally import MOST_ROUNDS, PRICE_BINS, Tally
from game.core.emotion_space import EMOTIONS
from game.core.errors import BadInput
from game.render.text import japanese_font

__all__ = ["PLOTS", "figure_svg", "load_matplotlib"]

INK, SOFT, LINE, PAPER = "#2c2a3a", "#8a8597", "#d9d2c3", "#fffdf8"
ACCENT, SHADE = "#33508f", "#e9b44c"
EMOTION_INK: Mapping[str, str] = {
    "anger": "#c8452f", "fear": "#7b5ea7", "joy": "#dd9a1a", "sadness": "#3f6fb5", "disgust": "#5f8d3d",
    "surprise": "#1f9e9a", "neutral": "#8a8597",
}  # fmt: skip
_TALLIES = Mapping[str, Tally]


def load_matplotlib() -> Any:
    """pyplot without a window. Raises BadInput where it is missing."""
    try:
        import matplotlib
    except ImportError:
        hint = "pip install 'mental-communication-game[reports]'"
        raise BadInput("reports", expected="the package matplotlib", seen="none", hint=hint) from None
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    # A Japanese font often has one weight: titles take that one, and nobody need be told.
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    plt.rcParams.update(
        {
            "font.family": ["sans-serif", *_japanese()], "font.size": 10, "text.color": INK, "axes.edgecolor": LINE,
            "axes.labelcolor": SOFT, "xtick.color": SOFT, "ytick.color": INK, "axes.spines.top": False,
            "axes.spines.right": False, "figure.facecolor": PAPER, "axes.facecolor": PAPER, "svg.fonttype": "none",
            "svg.hashsalt": "autoplay", "axes.titlesize": 10, "axes.titleweight": "bold", "axes.titlelocation": "left",
        }
    )  # fmt: skip
    return plt


def _japanese() -> list[str]:
    """The name of a font for letters that matplotlib's own lacks (own policies are files, with any names)."""
    from matplotlib import font_manager

    path = japanese_font()
    if path is None:
        return []
    font_manager.fontManager.addfont(path)
    return [str(font_manager.FontProperties(fname=path).get_name())]


def _short(name: str) -> str:
    """A policy's name for a narrow plot: a file without its folder, a mixture on several lines."""
    return "\n".join(part.rpartition("/")[2] for part in name.split(","))


def surplus(plt: Any, tallies: _TALLIES) -> Any:
    """Mean share of the possible gain with its interval; between fixed and oracle the ground that reading covers."""
    names = list(tallies)[::-1]
    figure, axes = plt.subplots(figsize=(7.2, 0.42 * len(names) + 1.1))
    if "fixed" in tallies and "oracle" in tallies:
        low, high = tallies["fixed"].surplus_ci.mean, tallies["oracle"].surplus_ci.mean
        axes.axvspan(low, high, color=SHADE, alpha=0.16, lw=0)
        axes.axvline(low + 0.6 * (high - low), color=SHADE, lw=1.2, ls=(0, (3, 3)))
        axes.text(
            low + 0.6 * (high - low), len(names) - 0.42, " 60 % of the way", color="#a8781c", fontsize=8, va="bottom"
        )
    for at, name in enumerate(names):
        ci = tallies[name].surplus_ci
        axes.plot([ci.low, ci.high], [at, at], color=ACCENT, lw=3, alpha=0.45, solid_capstyle="round")
        axes.plot(ci.mean, at, "o", color=ACCENT, ms=7)
        axes.text(ci.high + 0.012, at, f"{ci.mean:.3f}", va="center", fontsize=9, color=INK)
    axes.set_yticks(range(len(names)), [_short(name) for name in names])
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(-0.6, len(names) - 0.2)
    axes.tick_params(length=0)
    axes.grid(axis="x", color=LINE, lw=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel("share of the possible gain per talk, mean and 95 % interval")
    axes.spines["left"].set_visible(False)
    return figure


def _small(
    plt: Any, tallies: _TALLIES, columns: int, draw: Callable[[Any, Tally], None], below: str, height: float = 1.3
) -> Any:
    """One small plot for each policy, on the same axes."""
    columns = min(columns, len(tallies))
    rows = -(-len(tallies) // columns)
    figure, grid = plt.subplots(
        rows, columns, figsize=(7.2, 1.55 * rows + 0.5), sharex=True, sharey=True, squeeze=False
    )
    for axes in grid.flat[len(tallies) :]:
        axes.set_visible(False)
    for axes, (name, tally) in zip(grid.flat, tallies.items(), strict=False):
        draw(axes, tally)
        axes.set_title(_short(name))
        axes.tick_params(length=0, labelsize=8)
        axes.spines["left"].set_visible(False)
    grid[-1, 0].set_xlabel(below, loc="left", fontsize=9)
    return figure


def prices(plt: Any, tallies: _TALLIES) -> Any:
    """What was paid, as shares of the list price, among the deals."""

    def draw(axes: Any, tally: Tally) -> None:
        share = [count / max(tally.deals, 1) for count in tally.prices]
        axes.bar([(at + 0.5) / PRICE_BINS for at in range(PRICE_BINS)], share, width=0.9 / PRICE_BINS, color=ACCENT)
        axes.set_xlim(0.4, 1.0)
        axes.set_yticks([])

    return _small(plt, tallies, 4, draw, "price paid, share of the list price (deals only)")


def lengths(plt: Any, tallies: _TALLIES) -> Any:
    """How many moves talks took."""

    def draw(axes: Any, tally: Tally) -> None:
        share = [count / max(tally.talks, 1) for count in tally.lengths[1:]]
        axes.bar(range(1, MOST_ROUNDS + 1), share, width=0.8, color=ACCENT)
        axes.axvline(tally.moves_ci.mean, color=SHADE, lw=2)
        axes.set_yticks([])
        axes.set_xlim(0.4, 8.6)
        axes.set_xticks([2, 4, 6, 8])

    return _small(plt, tallies, 4, draw, "moves in a talk; the line is the mean")


def feelings(plt: Any, tallies: _TALLIES) -> Any:
    """What is felt (lines) and shown (dots) on average, round by round."""

    def draw(axes: Any, tally: Tally) -> None:
        # Late rounds that few talks reach tell more of chance than of feelings.
        rounds = [at for at, count in enumerate(tally.at_round) if count >= max(10, 0.02 * tally.talks)]
        for index, name in enumerate(EMOTIONS):
            ink = EMOTION_INK[name]
            axes.plot([at + 1 for at in rounds], [tally.felt[at][index] / tally.at_round[at] for at in rounds],
                      color=ink, lw=1.8, label=name)  # fmt: skip
            axes.plot([at + 1 for at in rounds], [tally.shown[at][index] / tally.at_round[at] for at in rounds],
                      "o", color=ink, ms=2.2)  # fmt: skip
        axes.set_ylim(0.0, 0.75)
        axes.grid(axis="y", color=LINE, lw=0.5)

    figure = _small(plt, tallies, 4, draw, "round; lines: felt, dots: shown on the face", 1.7)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", ncol=7, frameon=False, fontsize=8, handlelength=1.2,
                  bbox_to_anchor=(0.5, 1.06))  # fmt: skip
    return figure


PLOTS: Mapping[str, tuple[str, Callable[[Any, _TALLIES], Any]]] = {
    "surplus": ("Who wins how much", surplus),
    "prices": ("What was paid", prices),
    "lengths": ("How long talks are", lengths),
    "feelings": ("What is felt and shown", feelings),
}


def tallies_of(run: Run, stall: str) -> dict[str, Tally]:
    """By population, in the order in which they were asked for."""
    found = {population: run.total(stall, population) for population in run.plan.populations}
    return {name: tally for name, tally in found.items() if tally.talks}


def figure_svg(plt: Any, figure: Any, title: str) -> str:
    """A figure as an SVG element that scales with the page and says what it is."""
    buffer = io.StringIO()
    figure.tight_layout()
    figure.savefig(buffer, format="svg", bbox_inches="tight", metadata={"Date": None, "Creator": None})
    plt.close(figure)
    svg = buffer.getvalue()[buffer.getvalue().index("<svg") :]
    svg = re.sub(
        r'<svg ([^>]*?)width="[^"]*" height="[^"]*"', rf'<svg role="img" aria-label="{title}" \1', svg, count=1
    )
    return re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
