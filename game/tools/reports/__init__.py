"""Reports of autoplay runs: plots, and one HTML page."""

from game.tools.reports.page import write_plots, write_report

__all__ = ["write_plots", "write_report"]
