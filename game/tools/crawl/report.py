"""The crawler's findings as one page: a sketch of every picture in which something is wrong."""

from __future__ import annotations

import html
from collections.abc import Sequence
from pathlib import Path

from game.formats.files import write_text
from game.tools.crawl.hands import Outside
from game.tools.crawl.paper import Box
from game.tools.crawl.visit import Finding

__all__ = ["write_page"]

MAX_SKETCHES = 200

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 88rem; padding: 0 1.5rem; color: #3b1a1c;
       background: #fbf4e4 }
h1 { font-weight: 600 } table { border-collapse: collapse } td, th { padding: .25rem .9rem .25rem 0; text-align: left }
.faults { display: grid; grid-template-columns: repeat(auto-fill, minmax(26rem, 1fr)); gap: 1.2rem; margin-top: 1.5rem }
figure { margin: 0; background: #fff; border: 1px solid #d9c7a8; border-radius: 10px; overflow: hidden }
figcaption { padding: .7rem .9rem } svg { display: block; width: 100%; background: #e8dcc4 }
b.kind { color: #b3372f } .words { color: #6b5146 }
"""


def write_page(path: Path, stall: str, findings: Sequence[Finding], hands: Sequence[Outside], measured: int) -> None:
    """Write the page, whole or not at all. Raises BadInput where that is impossible."""
    parts = [
        f"<!doctype html><html lang=en><meta charset=utf-8><title>{html.escape(stall)}: crawl</title>",
        f"<style>{STYLE}</style><h1>{html.escape(stall)}</h1>",
        f"<p>{measured} pictures measured, {len(findings)} faults of text, {len(hands)} of hands.</p>",
    ]
    if hands:
        rows = "".join(f"<tr><td>{h.emotion}<td>{h.hand}<td>{h.share:.1%}<td>{h.far:.2f}</tr>" for h in hands)
        parts.append(f"<table><tr><th>feeling<th>hand<th>out of the picture<th>how far</tr>{rows}</table>")
    parts.append('<div class="faults">')
    parts += [_figure(finding) for finding in findings[:MAX_SKETCHES]]
    parts.append("</div></html>")
    write_text(path, "\n".join(parts))


def _figure(finding: Finding) -> str:
    fault, look = finding.fault, finding.look
    panels = "".join(_rect(box, "#fff6de", box.alpha) for box in finding.panels)
    texts = "".join(
        f'<text x="{t.x:.1f}" y="{t.y + 0.75 * t.h:.1f}" font-size="{t.size:.1f}" textLength="{t.w:.1f}" '
        f'lengthAdjust="spacingAndGlyphs">{html.escape(t.text)}</text>'
        for t in finding.texts
    )
    box = fault.box
    mark = (
        f'<rect x="{box.x:.1f}" y="{box.y:.1f}" width="{box.w:.1f}" height="{box.h:.1f}" fill="none" '
        'stroke="#d0211c" stroke-width="4"/>'
    )
    words = f"{finding.node} · {look.language} · {look.scale:.0%}"
    return (
        f'<figure><svg viewBox="0 0 1280 720" font-family="sans-serif" fill="#3b1a1c">{panels}{texts}{mark}</svg>'
        f'<figcaption><b class="kind">{fault.kind}</b> {html.escape(words)}<br>{html.escape(fault.detail)}'
        f'<br><span class="words">{html.escape(fault.text)}</span></figcaption></figure>'
    )


def _rect(box: Box, colour: str, alpha: float) -> str:
    return (
        f'<rect x="{box.x:.1f}" y="{box.y:.1f}" width="{box.w:.1f}" height="{box.h:.1f}" rx="10" fill="{colour}" '
        f'fill-opacity="{min(alpha, 1.0) * 0.8:.2f}" stroke="#5b2a22" stroke-opacity=".4"/>'
    )
