"""Expected, got and what lies between them, frame by frame, as one HTML page that needs nothing else."""

from __future__ import annotations

import base64
import html
import struct
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from game.formats.files import write_text
from game.tools.compare.frames import Compared, Limits

__all__ = ["encode_png", "heat", "write_comparison"]

# From dark over violet and orange to pale yellow: lightness rises all the way, so it reads without colour too.
_HEAT = np.array([[0, 0, 4], [59, 15, 112], [140, 41, 129], [222, 73, 104], [254, 159, 109], [252, 253, 191]], float)

_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 88rem; padding: 0 1.5rem; color: #3b1a1c;
       background: #fbf4e4 }
h1 { font-weight: 600; margin-bottom: .2rem } p { margin: .2rem 0 }
section { background: #fff; border: 1px solid #d9c7a8; border-radius: 10px; padding: .9rem 1.1rem; margin-top: 1.2rem }
section.off { border-color: #b3372f; border-width: 2px }
h2 { font-size: 1.05rem; margin: 0 0 .6rem; font-weight: 600 } h2 b { color: #b3372f } h2 i { color: #3d6b45 }
h2 span { font-weight: 400; color: #6b5146; margin-left: .8rem }
.row { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: .8rem }
figure { margin: 0 } figcaption { color: #6b5146; font-size: .85rem; margin-top: .25rem }
img { width: 100%; height: auto; display: block; border-radius: 6px; image-rendering: auto }
.ramp { display: inline-block; width: 12rem; height: .7rem; border-radius: 3px; vertical-align: middle; margin: 0 .5rem;
        background: linear-gradient(90deg, #000004, #3b0f70, #8c2981, #de4968, #fe9f6d, #fcfdbf) }
"""


def heat(difference: NDArray[np.float64]) -> NDArray[np.uint8]:
    """(h, w) in [0, 1] as colours (h, w, 3)."""
    at = np.clip(difference, 0.0, 1.0) * (len(_HEAT) - 1)
    low = np.minimum(at.astype(int), len(_HEAT) - 2)
    share = (at - low)[..., None]
    return np.asarray(np.round(_HEAT[low] * (1.0 - share) + _HEAT[low + 1] * share), np.uint8)


def encode_png(pixels: NDArray[np.uint8]) -> bytes:
    """(h, w, 3) as a PNG file's bytes."""
    height, width = pixels.shape[:2]
    rows = pixels.reshape(height, width * 3)
    above = np.vstack([np.zeros((1, width * 3), np.uint8), rows[:-1]])
    filtered = np.hstack([np.full((height, 1), 2, np.uint8), rows - above])  # filter 2: what differs from above

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    body = zlib.compress(filtered.tobytes(), 6)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) + chunk(b"IEND", b"")


def write_comparison(path: Path, title: str, frames: Sequence[Compared], limits: Limits) -> None:
    """Write the page, whole or not at all: frames that differ first. Raises BadInput where that is impossible."""
    off = [frame for frame in frames if not frame.same]
    parts = [
        f"<!doctype html><html lang=en><meta charset=utf-8><title>{html.escape(title)}</title><style>{_STYLE}</style>",
        f"<h1>{html.escape(title)}</h1><p>{len(off)} of {len(frames)} pictures differ.</p>",
        f"<p>Difference as seen (ꟻLIP): none <span class=ramp></span> as large as can be. Allowed: mean {limits.mean},"
        f" worst tile {limits.tile}.</p>",
    ]
    parts += [_section(frame) for frame in sorted(frames, key=lambda frame: frame.same)]
    write_text(path, "\n".join([*parts, "</html>"]))


def _section(frame: Compared) -> str:
    verdict = "<i>same</i>" if frame.same else "<b>differs</b>"
    pictures = [("expected", frame.expected), ("got", frame.got), ("difference", heat(frame.difference))]
    figures = "".join(
        f'<figure><img alt="{name}" width="{pixels.shape[1]}" height="{pixels.shape[0]}" src="data:image/png;base64,'
        f'{base64.b64encode(encode_png(pixels)).decode()}"><figcaption>{name}</figcaption></figure>'
        for name, pixels in pictures
    )
    return (
        f'<section class="{"same" if frame.same else "off"}"><h2>{html.escape(frame.name)} · {verdict}'
        f"<span>mean {frame.mean:.4f}, worst tile {frame.tile:.3f}</span></h2><div class=row>{figures}</div></section>"
    )
