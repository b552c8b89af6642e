"""Reports of autoplay runs: plots, and one HTML page."""

from game.tools.reports.page import write_plots, write_report
from game.tools.reports.plots import load_matplotlib

__all__ = ["load_matplotlib", "write_plots", "write_report"]
