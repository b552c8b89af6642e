"""Pictures of a dialogue: SVG, a page to walk about in, DOT; with visits from autoplay logs."""

from game.tools.graph.dot import dot_of
from game.tools.graph.heat import Heat, read_heat
from game.tools.graph.model import Graph, graph_of
from game.tools.graph.page import page_of
from game.tools.graph.svg import svg_of

__all__ = ["Graph", "Heat", "dot_of", "graph_of", "page_of", "read_heat", "svg_of"]
