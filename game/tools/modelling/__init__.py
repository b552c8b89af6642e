"""Characters, stalls and goods as code: signed distance fields and lofts into VRM and glTF files."""

from game.tools.modelling.character import build_character

__all__ = ["build_character"]
