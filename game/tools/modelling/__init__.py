"""Characters, stalls and goods as code: signed distance fields and lofts into VRM and glTF files."""

from game.tools.modelling.export import build_character
from game.tools.modelling.stall import build_stall

__all__ = ["build_character", "build_stall"]
