"""The visual crawler: everything a stall can put on the screen, laid out on paper; every node, drawn and looked at."""

from game.tools.crawl.darkroom import Darkroom, Print, develop
from game.tools.crawl.hands import hands_outside
from game.tools.crawl.moments import Moment, moments_of
from game.tools.crawl.paper import Fault, PaperCanvas, PaperHud
from game.tools.crawl.pixels import Photographs, Seen, judge
from game.tools.crawl.probe import Letters, ProbeHud
from game.tools.crawl.report import ContactSheet, write_page
from game.tools.crawl.visit import Finding, Look, crawl_stall

__all__ = [
    "ContactSheet",
    "Darkroom",
    "Fault",
    "Finding",
    "Letters",
    "Look",
    "Moment",
    "PaperCanvas",
    "PaperHud",
    "Photographs",
    "Print",
    "ProbeHud",
    "Seen",
    "crawl_stall",
    "develop",
    "hands_outside",
    "judge",
    "moments_of",
    "write_page",
]
