"""Thresholds that a content team sets for its stalls: ``autoplay --require coverage.yaml``.

::

    visits: 4                 # what follows is meant for runs of at least so many visits an episode (default 1)
    coverage:                 # shares of what each stall has, 0 to 1
      nodes: 1
      conditions: 0.9         # both outcomes of each
    balance:
      - {policy: oracle, above: fixed, by: 0.20}
      - {policy: reader, from: fixed, to: oracle, share: 0.6}     # closes so much of the way
      - {policy: face, stalls: [toys], not_above: fixed}
      - {policy: reader, surplus: [0.5, 1.0], deals: [0.7, 1.0], moves: [3, 8]}
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from game.app.autoplay.coverage import KINDS, Reached, covered
from game.app.autoplay.runs import Run
from game.app.autoplay.tally import Interval, Tally
from game.core.errors import BadInput, Where
from game.formats.yaml_source import Node, load_yaml, nearest
from game.story import shipped_stalls

__all__ = ["Finding", "Requirement", "Requirements", "check_played", "judge", "load_requirements"]


@dataclass(frozen=True)
class Finding:
    """One requirement at one stall. where: its place in the file; text: what was measured against what is wanted."""

    stall: str
    name: str
    text: str
    good: bool
    where: str


@dataclass(frozen=True)
class Requirement:
    """One entry under ``balance``. Ranges are (least, most); stalls: empty means all."""

    where: str
    policy: str
    stalls: tuple[str, ...] = ()
    above: str = ""
    by: float = 0.0
    not_above: str = ""
    between: tuple[str, str] = ("", "")
    share: float = 0.0
    ranges: tuple[tuple[str, float, float], ...] = ()

    def others(self) -> Iterator[str]:
        """The policies it compares with."""
        yield from (name for name in (self.above, self.not_above, *self.between) if name)


@dataclass(frozen=True)
class Requirements:
    """coverage: by kind the least share, and where that stands. visits: an episode has at least, and where."""

    coverage: Mapping[str, tuple[float, str]]
    balance: tuple[Requirement, ...]
    visits: tuple[int, str] = (1, "")


def load_requirements(path: Path) -> Requirements:
    """Read thresholds. Raises BadInput with file:line:col."""
    if not path.is_file():
        raise BadInput("--require", where=Where(path), expected="a file that exists", seen="none")
    root = load_yaml(path).only("visits", "coverage", "balance")
    visits, coverage, balance = root.get("visits"), root.get("coverage"), root.get("balance")
    shares = {}
    if coverage is not None:
        for key, value in coverage.only(*KINDS).items():
            shares[key.as_str()] = (value.as_float(0.0, 1.0), str(value.where))
    return Requirements(
        shares,
        () if balance is None else tuple(_requirement(node) for node in balance.as_list()),
        (1, "") if visits is None else (visits.as_int(1, 20), str(visits.where)),
    )


def _requirement(node: Node) -> Requirement:
    node.only("policy", "stalls", "above", "by", "not_above", "from", "to", "share", "surplus", "deals", "moves")

    def word(key: str) -> str:
        found = node.get(key)
        return "" if found is None else found.as_str()

    ranges = []
    for key in ("surplus", "deals", "moves"):
        found = node.get(key)
        if found is not None:
            ends = found.as_list()
            if len(ends) != 2:
                raise found.error(expected="[least, most]")
            ranges.append((key, ends[0].as_float(), ends[1].as_float()))
    for needs, needed in (("above", "by"), ("from", "to"), ("to", "share"), ("share", "from")):
        if node.get(needs) is not None and node.get(needed) is None:
            raise node.error(expected=f"{needed}: beside {needs}:")
    by, share, stalls = node.get("by"), node.get("share"), node.get("stalls")
    made = Requirement(
        str(node.where),
        node["policy"].as_str(),
        () if stalls is None else tuple(item.as_str() for item in stalls.as_list()),
        word("above"),
        0.0 if by is None else by.as_float(-1.0, 1.0),
        word("not_above"),
        (word("from"), word("to")),
        0.0 if share is None else share.as_float(0.0, 1.0),
        tuple(ranges),
    )
    if not (made.above or made.not_above or made.between[0] or made.ranges):
        raise node.error(expected="above, not_above, from and to, surplus, deals or moves")
    return made


def check_played(
    requirements: Requirements, populations: Sequence[str], visits: int = 1, stalls: Sequence[str] = ()
) -> None:
    """Raises BadInput for a policy that is spoken of and will not be played, a stall that is none, or too few visits:
    before any talk. stalls: those that are played; shipped ones may be spoken of as well."""
    least, where = requirements.visits
    if visits < least:
        raise BadInput(where, expected=f"{least} visits an episode", seen=visits, hint=f"play it so: --visits {least}")
    known = tuple(dict.fromkeys((*(path.stem for path in shipped_stalls()), *stalls)))
    for requirement in requirements.balance:
        for name in requirement.stalls:
            if name not in known:
                # Nothing would be asked of it, and nobody told.
                raise BadInput(requirement.where, expected=" | ".join(known), seen=name, hint=nearest(name, known))
        for name in (requirement.policy, *requirement.others()):
            if name not in populations:
                raise BadInput(
                    requirement.where, expected=" | ".join(populations), seen=name, hint=f"play it too: --policy {name}"
                )


def judge(run: Run, requirements: Requirements | None) -> list[Finding]:
    """Every requirement at every stall it speaks of."""
    if requirements is None or not run.talks:
        return []
    found: list[Finding] = []
    for stall in run.plan.stalls:
        reached = covered(run, stall) if requirements.coverage else {}
        found += [_cover(stall, kind, least, where, reached) for kind, (least, where) in requirements.coverage.items()]
        for requirement in requirements.balance:
            if not requirement.stalls or stall in requirement.stalls:
                found += _balance(run, stall, requirement)
    return found


def _cover(stall: str, kind: str, least: float, where: str, reached: Mapping[str, Reached]) -> Finding:
    own = reached.get(kind)
    if own is None:
        return Finding(stall, kind, f"{stall}: no {kind} were counted (bodies were not played: --body)", False, where)
    text = f"{stall}: {own.reached} of {own.total} {kind} reached, {own.share:.1%}, wanted {least:.1%}"
    if own.share < least:
        text += "; missing " + ", ".join(name for name, _ in own.missing[:5]) + (" …" if len(own.missing) > 5 else "")
    return Finding(stall, kind, text, own.share >= least, where)


def _balance(run: Run, stall: str, wanted: Requirement) -> Iterator[Finding]:
    tally = {name: run.total(stall, name) for name in (wanted.policy, *wanted.others())}
    own = tally[wanted.policy].surplus_ci

    def finding(name: str, text: str, good: bool) -> Finding:
        return Finding(stall, f"{wanted.policy} {name}", f"{stall}: {wanted.policy} {text}", good, wanted.where)

    if wanted.above:
        other = tally[wanted.above].surplus_ci
        gap, half = own.mean - other.mean, _both(own, other)
        text = f"is {gap:+.3f} ± {half:.3f} above {wanted.above}, wanted {wanted.by:+.3f}"
        yield finding(f"above {wanted.above}", text, gap >= wanted.by)
    if wanted.not_above:
        other = tally[wanted.not_above].surplus_ci
        gap, half = own.mean - other.mean, _both(own, other)
        text = f"is {gap:+.3f} ± {half:.3f} above {wanted.not_above}, wanted none"
        yield finding(f"not above {wanted.not_above}", text, gap <= half)
    if wanted.between[0]:
        low, high = (tally[name].surplus_ci.mean for name in wanted.between)
        share = (own.mean - low) / (high - low) if high > low else 0.0
        text = (
            f"closes {share:.0%} of the way from {wanted.between[0]} to {wanted.between[1]}, wanted {wanted.share:.0%}"
        )
        yield finding("closes the way", text, share >= wanted.share)
    for name, least, most in wanted.ranges:
        value = _value(tally[wanted.policy], name)
        text = f"{name} {value.mean:.3f} ± {value.half:.3f}, wanted {least:g} to {most:g}"
        yield finding(name, text, least <= value.mean <= most)


def _both(a: Interval, b: Interval) -> float:
    return float((a.half**2 + b.half**2) ** 0.5)


def _value(tally: Tally, name: str) -> Interval:
    return {"surplus": tally.surplus_ci, "deals": tally.deal_ci, "moves": tally.moves_ci}[name]
