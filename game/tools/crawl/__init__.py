"""The visual crawler: everything a stall can put on the screen, measured without drawing the scene."""

from game.tools.crawl.hands import hands_outside
from game.tools.crawl.paper import Fault, PaperCanvas, PaperHud
from game.tools.crawl.report import write_page
from game.tools.crawl.visit import Finding, crawl_stall

__all__ = ["Fault", "Finding", "PaperCanvas", "PaperHud", "crawl_stall", "hands_outside", "write_page"]
