"""What can be laid over the picture while a talk runs: feelings, active nodes, the three networks."""

from game.app.overlays.feelings import draw_feelings
from game.app.overlays.networks import draw_networks
from game.app.overlays.units import draw_units
from game.app.session import Session
from game.app.ui import Canvas

__all__ = ["OVERLAYS", "draw_overlays"]

OVERLAYS = {"feelings": draw_feelings, "units": draw_units, "networks": draw_networks}


def draw_overlays(session: Session, canvas: Canvas) -> None:
    """Draw those that are switched on; the networks need the room of the others and name the active nodes too."""
    names = ["networks"] if "networks" in session.overlays else ["feelings", "units"]
    for name in names:
        if name in session.overlays:
            OVERLAYS[name](session, canvas)
