"""Pictures side by side: how far apart they look, and a page that shows it."""

from game.tools.compare.flip import flip
from game.tools.compare.frames import Compared, Limits, compare_frames, cut_strip
from game.tools.compare.page import write_comparison

__all__ = ["Compared", "Limits", "compare_frames", "cut_strip", "flip", "write_comparison"]
