"""Pictures of a fit: part Gaussians as ellipses, weights with intervals, predicted against rated, simulated error.

Needs matplotlib (the `reports` extra), imported only here and only when something is plotted.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from game.core import BadInput, MissingPart, Where
from game.face import REGIONS, FaceModel
from game.tools.face.fitting import FaceFit
from game.tools.face.pad import ellipse
from game.tools.face.simulate import ErrorRow

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["need_matplotlib", "plot_errors", "plot_fit"]

AXES = ("valence", "arousal")
INK, FAINT, BLUE, RED = "#3B1A1C", "#B9A79B", "#34608A", "#D9483A"


def need_matplotlib() -> None:
    """Raises MissingPart, in one line, where matplotlib is not installed."""
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        raise MissingPart("plots need matplotlib: pip install -e '.[reports]'") from None


def _figure(width: float, height: float) -> Figure:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _save(folder: Path, name: str, figure: Figure) -> Path:
    path = folder / name
    try:
        folder.mkdir(parents=True, exist_ok=True)
        figure.savefig(path)
    except OSError as error:
        raise BadInput(
            "plot", where=Where(path), expected="a folder that can be written", seen=error.strerror
        ) from None
    return path


def plot_fit(folder: Path, fit: FaceFit, model: FaceModel) -> list[Path]:
    """Draw what was fitted; returns the files written."""
    need_matplotlib()
    drawn: list[tuple[str, Callable[[FaceFit, FaceModel], Figure | None]]] = [
        ("parts.png", _parts),
        ("weights.png", _weights),
        ("predicted.png", _predicted),
    ]
    files = []
    for name, draw in drawn:
        figure = draw(fit, model)
        if figure is not None:
            files.append(_save(folder, name, figure))
    return files


def _label(fit: FaceFit) -> str:
    return f"{fit.raters} simulated raters" if fit.simulated else f"{fit.raters} raters"


def _square(axes: Any) -> None:
    axes.set(xlim=(-1, 1), ylim=(-1, 1), aspect="equal", xlabel="valence", ylabel="arousal")
    axes.axhline(0, color=FAINT, lw=0.7, zorder=0)
    axes.axvline(0, color=FAINT, lw=0.7, zorder=0)
    circle = ellipse(np.zeros(2), np.eye(2), 1.0, 90)
    axes.plot(circle[:, 0], circle[:, 1], color=FAINT, lw=0.7, zorder=0)


def _parts(fit: FaceFit, model: FaceModel) -> Figure | None:
    """One circumplex per region: every rated part's mean and ellipse of one standard deviation, numbered in a key."""
    if not fit.parts:
        return None
    import matplotlib

    figure = _figure(14.5, 12.5)
    for axes, region in zip(figure.subplots(2, 2).flat, REGIONS, strict=True):
        _square(axes)
        fitted = [p for p in fit.parts if p.region == region]
        colours = matplotlib.colormaps["tab20"](np.linspace(0.0, 1.0, 20))
        for i, part in enumerate(fitted):
            colour = colours[(2 * i) % 20 + (2 * i // 20) % 2]
            digits = "white" if float(colour[:3] @ (0.3, 0.59, 0.11)) < 0.6 else "black"
            outline = ellipse(part.mean, part.covariance)
            axes.fill(outline[:, 0], outline[:, 1], color=colour, alpha=0.10, lw=0)
            axes.plot(outline[:, 0], outline[:, 1], color=colour, lw=1.2, label=f"{i + 1} {part.part} ({part.ratings})")
            axes.annotate(
                f"{i + 1}", part.mean, ha="center", va="center", fontsize=8.5, color=digits, fontweight="bold",
                bbox={"boxstyle": "circle,pad=0.18", "fc": colour, "ec": "none"},
            )  # fmt: skip
        axes.set_title(region, fontsize=13)
        axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=8.5, frameon=False, title="part (ratings)")
    figure.suptitle(f"Part Gaussians, one standard deviation; {_label(fit)}", fontsize=14)
    return figure


def _weights(fit: FaceFit, model: FaceModel) -> Figure | None:
    """Weights with 95 % intervals beside those now in use."""
    if fit.axes is None:
        return None
    figure = _figure(10, 4.4)
    for j, (axes, found, axis) in enumerate(zip(figure.subplots(1, 2, sharey=True), fit.axes, AXES, strict=True)):
        place = np.arange(len(REGIONS))
        margin = np.abs(found.interval.T - found.weight)
        axes.axhline(0, color=FAINT, lw=0.8)
        axes.bar(place, found.weight, 0.55, color=BLUE, alpha=0.75, label="fitted, 95 % interval")
        axes.errorbar(place, found.weight, yerr=margin, fmt="none", ecolor=INK, capsize=5)
        axes.plot(place + 0.38, model.weights.value[:, j], "<", color=RED, ms=8, label="in use (reported or assumed)")
        top = float(np.maximum(found.interval[:, 1], model.weights.value[:, j]).max())
        for i, p in enumerate(found.p_weight):
            text = f"{found.weight[i]:.2f}\np {'< .001' if p < 0.001 else f'= {p:.3f}'}"
            axes.annotate(text, (i, found.interval[i, 1] + 0.03), ha="center", va="bottom", fontsize=9)
        axes.set_xticks(place, REGIONS)
        axes.set(title=f"{axis}: R² = {found.r_squared:.3f} ({found.faces} faces)", ylabel="weight" if j == 0 else "")
        axes.set_ylim(min(0.0, float(found.interval.min()) - 0.05), top + 0.28)
    axes.legend(loc="upper center", fontsize=9)
    figure.suptitle(f"Influence of each region; {_label(fit)}")
    return figure


def _predicted(fit: FaceFit, model: FaceModel) -> Figure | None:
    """Predicted against rated means: faces the weights were fitted on, and those held out."""
    if fit.whole is None or fit.weights is None:
        return None
    figure = _figure(10, 5.2)
    predicted, _ = fit.whole.predict(fit.weights)
    held = fit.held_out
    kept = set(held.faces.faces) if held is not None else set()
    inside = np.array([f not in kept for f in fit.whole.faces])
    for j, (axes, axis) in enumerate(zip(figure.subplots(1, 2), AXES, strict=True)):
        axes.plot([-1.2, 1.2], [-1.2, 1.2], color=FAINT, lw=1)
        axes.plot(predicted[inside, j], fit.whole.mean[inside, j], "o", color=BLUE, alpha=0.6, ms=5, label="fitted on")
        title = axis
        if held is not None:
            axes.plot(held.predicted[:, j], held.faces.mean[:, j], "s", color=RED, alpha=0.85, ms=6, label="held out")
            title += f": held-out R² = {held.r_squared[j]:.3f}, error {held.rmse[j]:.3f}"
        axes.set(
            title=title, xlabel="predicted from the parts", ylabel="rated (mean)", xlim=(-1.15, 1.15),
            ylim=(-1.15, 1.15), aspect="equal",
        )  # fmt: skip
        axes.legend(loc="upper left", fontsize=9)
    figure.suptitle(f"Whole faces, predicted against rated; {_label(fit)}")
    return figure


def plot_errors(folder: Path, rows: Sequence[ErrorRow]) -> Path:
    """Error over all faces against the number of raters, on two logarithmic axes."""
    need_matplotlib()
    figure = _figure(7, 4.6)
    axes = figure.subplots()
    raters = np.array([row.raters for row in rows], dtype=np.float64)
    known = np.array([row.error_known_weights for row in rows])
    axes.loglog(raters, known, "o-", color=BLUE, label="weights known")
    axes.loglog(raters, [row.error_fitted_weights for row in rows], "s-", color=RED, label="weights fitted as well")
    axes.loglog(raters, known[0] / np.sqrt(raters / raters[0]), "--", color=FAINT, label="1 / √raters")
    axes.set_xticks(raters, [str(row.raters) for row in rows])
    axes.set_xticks([], minor=True)
    ticks = [t for t in (0.02, 0.03, 0.05, 0.1, 0.2, 0.3) if known.min() * 0.8 < t < known.max() * 1.3]
    axes.set_yticks(ticks, [f"{t:g}" for t in ticks])
    axes.set_yticks([], minor=True)
    axes.set(xlabel="simulated raters", ylabel="error of the mean (root mean square)")
    axes.set_title(f"{rows[0].predicted_faces} faces predicted from {rows[0].rated_faces} rated ones")
    axes.grid(alpha=0.3)
    axes.legend()
    return _save(folder, "errors.png", figure)
