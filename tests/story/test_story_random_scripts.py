"""Random valid scripts: whatever a designer may write that the linter lets pass, the engine plays to an end."""

from __future__ import annotations

import json
import random
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from game.core.errors import Where
from game.story import ACTS, Memory, Script, memory_of, restore, save
from game.story.findings import Findings
from game.story.reader import read_script

HEAD = """\
stall: random
title: {en: Random, ja: 乱}
person: mira
start: n0
home: hub
items:
  cup: {list_price: 100, name: {en: cup, ja: 湯のみ}, about: {en: A., ja: B.}}
variables:
  talk: {a: 0, b: false, c: "x"}
  stall: {d: 2}
outcomes: {OUTCOMES}
endings: {over: {en: "Over.", ja: "終わり。"}}
standing:
  - {id: offer, act: offer, once: false, en: "{offer}?", ja: "{offer}?"}
  - {id: leave, act: leave, once: false, en: "Bye.", ja: "では。"}
"""

CONDITIONS = ("a > 1", "b", "c == 'x'", "d / a > 1", "visits.hub < 3", "seen('n0')", "trust >= 0.5 or b")
EFFECTS = ("{a: a + 1}", "{a: a * 1000 - d}", "{b: not b}", "{c: \"'y'\", b: a > 2}", "{d: d / (a - 1)}")
CONDITION = st.sampled_from(CONDITIONS)


@st.composite
def scripts(draw) -> str:
    """Nodes n0 … n9 that lead to later ones, to hubs, back or home; a hub; ends; calls; groups; conditions."""
    count = draw(st.integers(2, 7))
    rows = []
    ids = 0

    def line(indent: str) -> str:
        nonlocal ids
        ids += 1
        parts = [f"id: l{ids}"]
        if draw(st.booleans()):
            parts.append(f'if: "{draw(CONDITION)}"')
        if draw(st.integers(0, 3)) == 0:
            parts.append(f"when: {draw(st.sampled_from(['right', 'wrong', 'neutral', 'veiled']))}")
        if draw(st.integers(0, 5)) == 0:
            parts.append("again: true")
        parts.append('en: "{ask} {item} {a}", ja: "{ask}{item}{a}"')
        return f"{indent}- {{{', '.join(parts)}}}"

    def target(number: int) -> str:
        later = [f"n{i}" for i in range(number + 1, count)]
        return draw(st.sampled_from([*later, "hub", "home", "back", "end"]))

    def ways(number: int, indent: str) -> str:
        if draw(st.booleans()):
            return f"{indent}to: {target(number)}"
        some = [
            f'{indent}  - {{if: "{draw(CONDITION)}", to: {target(number)}}}' for _ in range(draw(st.integers(1, 2)))
        ]
        return "\n".join([f"{indent}to:", *some, *([f"{indent}  - {target(number)}"] if draw(st.booleans()) else [])])

    for number in range(count):
        rows.append(f"  n{number}:")
        if draw(st.booleans()):
            rows.append(f"    set: {draw(st.sampled_from(EFFECTS))}")
        rows.append("    lines:")
        for _ in range(draw(st.integers(1, 3))):
            if draw(st.booleans()):
                rows.append("      - any:")
                rows += [line("          ") for _ in range(draw(st.integers(1, 3)))]
            else:
                rows.append(line("      "))
        kind = draw(st.integers(0, 5))
        if kind == 0:
            rows.append("    choices:")
            for _ in range(draw(st.integers(1, 3))):
                ids += 1
                once = draw(st.sampled_from(["true", "false", "stall"]))
                rows.append(f"      - id: c{ids}\n        act: {draw(st.sampled_from(ACTS))}\n        once: {once}")
                rows.append(f'        en: "c{ids}"\n        ja: "茶{ids}"')
                if draw(st.booleans()):
                    rows.append(f'        if: "{draw(CONDITION)}"')
                if draw(st.booleans()):
                    rows.append(f"        set: {draw(st.sampled_from(EFFECTS))}")
                rows.append(ways(number, "        "))
        elif kind == 1:
            rows.append("    end: over")
        else:
            if draw(st.booleans()) and number + 1 < count:
                rows.append(f"    call: n{draw(st.integers(number + 1, count - 1))}")
            rows.append(ways(number, "    "))
    pool = [
        f'    - {{id: p{i}, act: {draw(st.sampled_from(ACTS))}, en: "p{i}", ja: "話{i}", to: {target(-1)}}}'
        for i in range(draw(st.integers(0, 6)))
    ]
    outcomes = ", ".join(
        f"{kind}: {draw(st.sampled_from([f'n{i}' for i in range(count)] + ['hub', 'end']))}"
        for kind in ("deal", "refused_offer", "insulted", "out_of_patience", "sudden_end", "rounds_out", "walked_away")
    )
    waits = "pool: talk" if pool else "choices: [{id: k, act: praise, en: k, ja: 可}]"
    hub = f"  hub:\n    lines: []\n    {waits}\n"
    return "\n".join(
        [
            HEAD.replace("{OUTCOMES}", "{" + outcomes + "}"),
            *(["pools:", "  talk:", *pool] if pool else []),
            "nodes:",
            *rows,
            hub + "  end:\n    lines: []\n    end: over\n",
        ]
    )


def _read(text: str) -> tuple[Script | None, Findings]:
    findings = Findings()
    return read_script(Path("random.yaml"), findings, text), findings


_RELAXED = [HealthCheck.too_slow, HealthCheck.function_scoped_fixture]


@settings(max_examples=40, deadline=None, suppress_health_check=_RELAXED)
@given(scripts(), st.integers(0, 2**32))
def test_random_scripts_wait_or_end_and_never_break(talk, text, seed):
    script, findings = _read(text)
    # By construction the only errors there can be.
    assert {finding.code for finding in findings.errors} <= {"E_LOOP", "E_RUNS_DRY"}, [str(f) for f in findings.errors]
    if script is None or findings.errors:
        return
    rng = random.Random(seed)
    player = talk(script, seed=seed)
    said: set[str] = set()
    for _ in range(12):
        beat = player.beat
        again = {line.id for line in script.all_lines() if line.again}
        told = [line.id for line in beat.lines if line.id not in again]
        assert len(told) == len(set(told))
        assert not said & set(told)
        said |= set(told)
        assert (beat.ended is None) == bool(beat.choices)
        assert all("{" not in line.en for line in beat.lines)
        assert all(abs(v) <= 1e9 for v in player.state.variables.values() if isinstance(v, float))
        if beat.ended:
            break
        assert any(choice.available for choice in beat.choices)
        assert restore(script, json.loads(json.dumps(save(player.state)))) == player.state
        player.random_move(rng)


@settings(max_examples=25, deadline=None, suppress_health_check=_RELAXED)
@given(scripts(), st.integers(0, 2**32))
def test_saved_and_loaded_anywhere_a_talk_goes_on_as_if_nothing_had_been(player, text, seed):
    """Straight, and through a save at every step: the same beats, the same end, the same memory of the stall. Twice
    over: the second visit begins with what the first one left."""
    script, findings = _read(text)
    if script is None or findings.errors:
        return
    left = []
    for reload in (False, True):
        memory, told = None, []
        for visit in range(2):
            one = player(script, reload, seed=seed + visit, memory=memory)
            rng = random.Random(seed)
            for _ in range(8):
                if one.beat.ended:
                    break
                one.random_move(rng)
            told.append(one.beats)
            memory = memory_of(script, one.state)
            if reload:
                memory = Memory.from_dict(json.loads(json.dumps(memory.to_dict())), Where("memory"))
        left.append((told, memory))
    assert left[0] == left[1]


@settings(max_examples=25, deadline=None)
@given(scripts(), st.data())
def test_damaged_scripts_give_findings_not_crashes(text, data):
    rows = text.split("\n")
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(rows) - 1))
        cut = data.draw(st.integers(0, len(rows[at])))
        scrap = data.draw(st.sampled_from(["", ":", "- ", "{", "}", '"', "#", "~", "[", " x: 1"]))
        rows[at] = rows[at][:cut] + scrap + rows[at][cut + 1 :]
    script, findings = _read("\n".join(rows))
    assert all("\n" not in str(finding) for finding in findings.all)
    assert script is not None or findings.errors
