"""The crawler's page: a thumbnail of every node with what is wrong marked in it, and a sketch of every layout at fault.

One file that needs nothing else, made to be skimmed.
"""

from __future__ import annotations

import html
from base64 import b64encode
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from game.formats.files import write_text
from game.render import encode_picture
from game.tools.crawl.darkroom import Print
from game.tools.crawl.hands import Outside
from game.tools.crawl.paper import Box
from game.tools.crawl.visit import Finding

__all__ = ["ContactSheet", "write_page"]

MAX_SKETCHES = 200

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 0; color: #3b1a1c; background: #fbf4e4 }
header { position: sticky; top: 0; background: #fbf4e4f2; padding: .7rem 1.5rem; border-bottom: 1px solid #d9c7a8;
         z-index: 1; display: flex; gap: 1.6rem; align-items: baseline; flex-wrap: wrap }
main { padding: 1rem 1.5rem } h1 { font-weight: 600; font-size: 1.4rem; margin: 0 } h2 { font-size: 1.1rem }
table { border-collapse: collapse } td, th { padding: .25rem .9rem .25rem 0; text-align: left }
.sheet { display: grid; grid-template-columns: repeat(auto-fill, minmax(21rem, 1fr)); gap: 1rem }
.faults { display: grid; grid-template-columns: repeat(auto-fill, minmax(26rem, 1fr)); gap: 1.2rem }
figure { margin: 0; background: #fff; border: 1px solid #d9c7a8; border-radius: 10px; overflow: hidden }
figure.bad { border: 2px solid #d0211c } figcaption { padding: .5rem .8rem; font-size: .85rem }
.shot { position: relative } .shot img { display: block; width: 100% }
.shot svg { position: absolute; inset: 0; width: 100%; height: 100% }
svg { display: block; width: 100% } .faults svg { background: #e8dcc4 }
b.kind { color: #b3372f } .words, .said { color: #6b5146 } .said { display: block }
body:has(#only:checked) .sheet figure:not(.bad) { display: none }
body:has(#large:checked) .sheet { grid-template-columns: repeat(auto-fill, minmax(40rem, 1fr)) }
"""


class ContactSheet:
    """Collects prints as they come; the pictures themselves are let go."""

    def __init__(self) -> None:
        self.figures: list[str] = []
        self.kinds: Counter[str] = Counter()
        self.bad = 0

    def add(self, taken: Print) -> None:
        """A picture more."""
        self.kinds.update(fault.kind for fault in taken.faults)
        self.bad += bool(taken.faults)
        height, width = (side / taken.scale for side in taken.picture.shape[:2])
        marks = "".join(_mark(fault.box) for fault in taken.faults)
        source = b64encode(encode_picture(taken.picture, "jpg")).decode()
        told = "".join(
            f'<br><b class="kind">{fault.kind}</b> {html.escape(fault.text[:80])}: {html.escape(fault.detail)}'
            for fault in taken.faults
        )
        what = " · ".join(filter(None, (taken.kind, taken.shot, _feeling(taken), taken.units)))
        self.figures.append(
            f'<figure{" class=bad" if taken.faults else ""}><div class="shot">'
            f'<img loading="lazy" alt="{html.escape(taken.node)}" src="data:image/jpeg;base64,{source}">'
            f'<svg viewBox="0 0 {width:.0f} {height:.0f}">{marks}</svg></div>'
            f"<figcaption><b>{html.escape(taken.node)}</b> {html.escape(what)}"
            f'<span class="said">{html.escape(taken.words)}</span>{told}</figcaption></figure>'
        )


def _feeling(taken: Print) -> str:
    if not taken.felt:
        return ""
    told = f"feels {taken.felt}, shows {taken.shown}"
    return told if taken.met else f"{told}; no played talk came here"


def write_page(
    path: Path,
    stall: str,
    findings: Sequence[Finding],
    hands: Sequence[Outside],
    measured: int,
    sheet: ContactSheet | None = None,
) -> None:
    """Write the page, whole or not at all. Raises BadInput where that is impossible."""
    name = html.escape(stall)
    told = f"{measured} layouts measured, {len(findings)} faults; {len(hands)} of hands in motion"
    if sheet is not None:
        kinds = ", ".join(f"{count} {kind}" for kind, count in sheet.kinds.most_common())
        told = f"{len(sheet.figures)} pictures drawn, faults in {sheet.bad} ({kinds or 'none'}); {told}"
    switches = "" if sheet is None else (
        "<label><input type=checkbox id=only> only faults</label><label><input type=checkbox id=large> large</label>"
    )  # fmt: skip
    parts = [
        f"<!doctype html><html lang=en><meta charset=utf-8><title>{name}: crawl</title>",
        f"<style>{STYLE}</style><header><h1>{name}</h1><span>{told}</span>{switches}</header><main>",
    ]
    if hands:
        rows = "".join(f"<tr><td>{h.emotion}<td>{h.hand}<td>{h.share:.1%}<td>{h.far:.2f}</tr>" for h in hands)
        parts.append(f"<table><tr><th>feeling<th>hand<th>out of the picture<th>how far</tr>{rows}</table>")
    if findings:
        parts.append('<h2>Layouts at fault</h2><div class="faults">')
        parts += [_figure(finding) for finding in findings[:MAX_SKETCHES]]
        parts.append("</div>")
    if sheet is not None:
        parts += ['<h2>Every node</h2><div class="sheet">', *sheet.figures, "</div>"]
    parts.append("</main></html>")
    write_text(path, "\n".join(parts))


def _mark(box: Box) -> str:
    return (
        f'<rect x="{box.x:.1f}" y="{box.y:.1f}" width="{box.w:.1f}" height="{box.h:.1f}" fill="none" '
        'stroke="#d0211c" stroke-width="4"/>'
    )


def _figure(finding: Finding) -> str:
    fault, look = finding.fault, finding.look
    panels = "".join(_rect(box, "#fff6de", box.alpha) for box in finding.panels)
    texts = "".join(
        f'<text x="{t.x:.1f}" y="{t.y + 0.75 * t.h:.1f}" font-size="{t.size:.1f}" textLength="{t.w:.1f}" '
        f'lengthAdjust="spacingAndGlyphs">{html.escape(t.text)}</text>'
        for t in finding.texts
    )
    words = f"{finding.node} · {look.language} · {look.scale:.0%}"
    return (
        f'<figure><svg viewBox="0 0 1280 720" font-family="sans-serif" fill="#3b1a1c">{panels}{texts}'
        f"{_mark(fault.box)}</svg>"
        f'<figcaption><b class="kind">{fault.kind}</b> {html.escape(words)}<br>{html.escape(fault.detail)}'
        f'<br><span class="words">{html.escape(fault.text)}</span></figcaption></figure>'
    )


def _rect(box: Box, colour: str, alpha: float) -> str:
    return (
        f'<rect x="{box.x:.1f}" y="{box.y:.1f}" width="{box.w:.1f}" height="{box.h:.1f}" rx="10" fill="{colour}" '
        f'fill-opacity="{min(alpha, 1.0) * 0.8:.2f}" stroke="#5b2a22" stroke-opacity=".4"/>'
    )
