"""A run as one HTML file that needs nothing else: figures, plots, coverage with what is missing, requirements."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from game.app.autoplay.comparisons import compared
from game.app.autoplay.coverage import Reached, covered
from game.app.autoplay.requirements import Finding
from game.app.autoplay.runs import Run
from game.app.autoplay.tally import Tally
from game.app.content import load_talk_assets, stall_path
from game.core.errors import BadInput
from game.core.paths import ASSETS
from game.formats.files import write_bytes, write_text
from game.tools.reports.plots import PLOTS, figure_svg, load_matplotlib, tallies_of

__all__ = ["write_plots", "write_report"]

_MOST_MISSING = 200
_KINDS: Mapping[str, tuple[str, str]] = {
    "nodes": ("Nodes", "passed"),
    "choices": ("Choices", "taken"),
    "offered": ("Choices", "offered"),
    "lines": ("Lines", "spoken"),
    "conditions": ("Conditions", "both outcomes"),
    "labels": ("Feelings", "met"),
    "units": ("Motion units", "seen"),
    "parts": ("Face parts", "drawn"),
}


def write_report(path: Path, run: Run, findings: Sequence[Finding]) -> None:
    """One self-contained HTML file. Raises BadInput without matplotlib, or where it cannot be written."""
    plt = load_matplotlib()
    plan = run.plan
    body = [
        "<h1>Autoplay</h1>",
        f'<p class="soft">{run.talks:,} talks: {len(plan.populations)} '
        f"{'policies' if len(plan.populations) > 1 else 'policy'} at {len(plan.stalls)} "
        f"{'stalls' if len(plan.stalls) > 1 else 'stall'}, {plan.episodes:,} each, seed {plan.seed}."
        f"{'' if run.whole else ' The run was stopped before its end.'}</p>",
    ]
    if len(plan.stalls) > 1:
        links = [f'<a href="#{escape(stall)}">{escape(_title(stall))}</a>' for stall in plan.stalls]
        body.append(f"<nav>{''.join(links)}</nav>")
    if findings:
        body.append(_required(findings))
    for stall in plan.stalls:
        body += _stall(plt, run, stall)
    style = (ASSETS / "autoplay" / "report.css").read_text("utf-8")
    page = (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1"><title>Autoplay report</title>'
        f"<style>{style}</style></head><body><main>{''.join(body)}</main></body></html>\n"
    )
    write_text(path, page)


def write_plots(folder: Path, run: Run) -> None:
    """Every plot of every stall as SVG and PNG. Raises BadInput where the folder cannot be made."""
    plt = load_matplotlib()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInput("--plots", expected="a folder", seen=f"{folder}: {error.strerror}") from None
    for stall in run.plan.stalls:
        tallies = tallies_of(run, stall)
        for name, (_, draw) in PLOTS.items() if tallies else ():
            figure = draw(plt, tallies)
            figure.tight_layout()
            for kind in ("svg", "png"):
                metadata = {"Date": None, "Creator": None} if kind == "svg" else {}
                place = folder / f"{stall_path(stall).stem}_{name}.{kind}"
                drawn = io.BytesIO()
                figure.savefig(drawn, format=kind, dpi=150, bbox_inches="tight", metadata=metadata)
                write_bytes(place, drawn.getvalue())
            plt.close(figure)


def _title(stall: str) -> str:
    return load_talk_assets(stall_path(stall)).script.title.en


def _required(findings: Sequence[Finding]) -> str:
    missed = sum(not finding.good for finding in findings)
    head = "Everything required is met" if not missed else f"{missed} of {len(findings)} requirements are missed"
    rows = "".join(
        f'<li><span class="mark {"good" if f.good else "bad"}">{"✓ met" if f.good else "✗ missed"}</span> '
        f"{escape(f.text)} <code>{escape(f.where)}</code></li>"
        for f in sorted(findings, key=lambda f: f.good)
    )
    return f'<h3>{head}</h3><div class="card"><ul class="plain">{rows}</ul></div>'


def _stall(plt: object, run: Run, stall: str) -> list[str]:
    assets, tallies = load_talk_assets(stall_path(stall)), tallies_of(run, stall)
    if not tallies:
        return []
    person = assets.script.person
    out = [
        f'<h2 id="{escape(stall)}">{escape(assets.script.title.en)}</h2>',
        f'<p class="soft">{escape(person.name.en)}, {escape(assets.person.id)}: '
        f"mask {assets.person.mask:g}, leak {assets.person.leak:g}</p>",
        _balance(run, stall, tallies),
    ]
    for title, draw in PLOTS.values():
        out.append(f'<h3>{title}</h3><div class="card">{figure_svg(plt, draw(plt, tallies), title)}</div>')
    out.append(f"<h3>How talks end</h3>{_endings(tallies)}")
    out.append(f"<h3>What was reached</h3>{_coverage(covered(run, stall))}")
    return out


def _balance(run: Run, stall: str, tallies: Mapping[str, Tally]) -> str:
    head = "<tr><th>Policy</th><th>Surplus</th><th>Deals</th><th>Moves</th><th>Right</th><th>Wrong</th></tr>"
    rows = []
    for name, tally in tallies.items():
        rows.append(_balance_row(name, tally))
        own = run.policies(stall, name)
        rows += [_balance_row(f"· {who}", part) for who, part in own.items() if len(own) > 1]
    mask = load_talk_assets(stall_path(stall)).person.mask
    against = "".join(
        f"<tr><td>{escape(c.name)}</td><td>{escape(c.figure)}</td><td>{escape(c.wanted)}</td>"
        f'<td><span class="mark {"good" if c.good else "bad"}">{"✓ as wanted" if c.good else "✗ not"}</span></td></tr>'
        for c in compared(tallies, mask)
    )
    table = f'<div class="card"><table>{head}{"".join(rows)}</table></div>'
    return table + (f'<div class="card"><table>{against}</table></div>' if against else "")


def _balance_row(name: str, tally: Tally) -> str:
    surplus, deals, moves = tally.surplus_ci, tally.deal_ci, tally.moves_ci
    made = max(sum(tally.qualities.values()), 1)

    def cell(text: str, half: str) -> str:
        return f'<td>{text} <span class="pm">± {half}</span></td>'

    return (
        f"<tr><td>{escape(name)}</td>{cell(f'{surplus.mean:.3f}', f'{surplus.half:.3f}')}"
        f"{cell(f'{deals.mean:.1%}', f'{deals.half:.1%}')}{cell(f'{moves.mean:.2f}', f'{moves.half:.2f}')}"
        f"<td>{tally.qualities['right'] / made:.0%}</td><td>{tally.qualities['wrong'] / made:.0%}</td></tr>"
    )


def _endings(tallies: Mapping[str, Tally]) -> str:
    names = sorted({ending for tally in tallies.values() for ending in tally.endings})
    head = "".join(f"<th>{escape(name)}</th>" for name in tallies)
    rows = "".join(
        f"<tr><td>{escape(ending)}</td>"
        + "".join(f"<td>{tally.endings[ending] / tally.talks:.1%}</td>" for tally in tallies.values())
        + "</tr>"
        for ending in names
    )
    return f'<div class="card"><table><tr><th>Ending</th>{head}</tr>{rows}</table></div>'


def _coverage(reached: Mapping[str, Reached]) -> str:
    tiles, missing = [], []
    for kind, own in reached.items():
        title, how = _KINDS[kind]
        whole = " whole" if own.share == 1.0 else ""
        tiles.append(
            f'<div class="tile"><b>{own.share:.1%}</b>{title} {how}<br>'
            f'<span class="soft">{own.reached} of {own.total}</span>'
            f'<div class="bar{whole}"><i style="width:{own.share:.1%}"></i></div></div>'
        )
        if own.missing:
            rows = "".join(
                f"<li>{escape(name)} <code>{escape(where)}</code></li>" for name, where in own.missing[:_MOST_MISSING]
            )
            more = len(own.missing) - _MOST_MISSING
            rows += f"<li>… and {more} more</li>" if more > 0 else ""
            missing.append(
                f"<details><summary>{title} not {how}: {len(own.missing)}</summary><ul>{rows}</ul></details>"
            )
    return f'<div class="grid">{"".join(tiles)}</div>{"".join(missing)}'
