"""Pictures inside a foreign avatar: PNG and JPEG, measured before they are decoded, never larger than a budget."""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np
import pygame
import pygame.image
import pygame.transform
from numpy.typing import NDArray

from game.core.errors import BadInput, Where
from game.formats import GltfImage, picture_size

__all__ = ["MAX_PIXELS", "MAX_SIDE", "decode_images"]

MAX_SIDE = 8192
MAX_PIXELS = 96_000_000
"""Of all pictures of one avatar together."""
SHOWN_SIDE = 2048
"""Larger ones are made smaller: nobody is nearer."""


def decode_images(
    images: Sequence[GltfImage | None], used: frozenset[int], where: Where
) -> tuple[dict[int, NDArray[np.uint8]], list[str]]:
    """Image index -> (h, w, 4) uint8, first row at the top; and notes about those that could not be shown.

    used: which images to decode. Raises BadInput where together they are too large.
    """
    made: dict[int, NDArray[np.uint8]] = {}
    notes: list[str] = []
    pixels = 0
    for index in sorted(used):
        image = images[index]
        if image is None:
            notes.append(f"picture {index} is missing")
            continue
        size = picture_size(image.data)
        if size is None:
            notes.append(f"picture {index} is neither PNG nor JPEG, left out")
            continue
        width, height = size
        if not (0 < width <= MAX_SIDE and 0 < height <= MAX_SIDE):
            notes.append(f"picture {index} of {width}×{height} pixels left out")
            continue
        pixels += width * height
        if pixels > MAX_PIXELS:
            raise BadInput("pictures", where=where, expected=f"at most {MAX_PIXELS} pixels in all", seen=pixels)
        found = _decode(image.data, size)
        if found is None:
            notes.append(f"picture {index} is broken, left out")
        else:
            made[index] = found
    return made, notes


def _decode(data: bytes, size: tuple[int, int]) -> NDArray[np.uint8] | None:
    try:
        surface = pygame.image.load(io.BytesIO(data), "x.png" if data.startswith(b"\x89PNG") else "x.jpg")
    except (pygame.error, OSError, ValueError, SystemError):
        return None
    if surface.get_size() != size:
        return None
    share = SHOWN_SIDE / max(size)
    if share < 1.0:
        surface = _in_32_bits(surface)
        surface = pygame.transform.smoothscale(
            surface, (max(round(size[0] * share), 1), max(round(size[1] * share), 1))
        )
    width, height = surface.get_size()
    return np.frombuffer(pygame.image.tobytes(surface, "RGBA"), np.uint8).reshape(height, width, 4).copy()


def _in_32_bits(surface: pygame.Surface) -> pygame.Surface:
    data = pygame.image.tobytes(surface, "RGBA")
    return pygame.image.frombytes(data, surface.get_size(), "RGBA")
