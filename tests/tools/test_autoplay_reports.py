"""What a run tells: coverage of everything there is, thresholds, JUnit, a page that needs nothing else."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import pytest

from game.app.autoplay.coverage import covered
from game.app.autoplay.executors import Crew
from game.app.autoplay.progress import Progress
from game.app.autoplay.runs import Plan, Run, play
from game.app.autoplay.tally import Tally, interval_of
from game.app.cli import main
from game.app.content import load_talk_assets, stall_path

PLAN = Plan(("flea",), ("random", "oracle"), 40, 3, cover=True)


@pytest.fixture(scope="module")
def run() -> Run:
    return play(PLAN, Crew(), progress=lambda total, done: Progress(total, done, show=False))


def test_coverage_counts_what_really_happened(run: Run) -> None:
    """Against the log of the same talks, row by row."""
    script = load_talk_assets(stall_path("flea")).script
    reached = covered(run, "flea")
    coverage = run.coverage["flea"]
    assert reached["nodes"].total == len(script.nodes)
    assert reached["nodes"].reached == len(coverage.nodes)
    assert coverage.nodes[script.start] == PLAN.talks
    assert sum(coverage.chosen.values()) == sum(t.moves for t in run.tallies.values())
    assert set(coverage.chosen) <= set(coverage.offered) <= set(script.choices)
    assert set(coverage.lines) <= set(script.lines)
    assert all(where.startswith(str(stall_path("flea"))) for _, where in reached["nodes"].missing)
    conditions = reached["conditions"]
    assert 0 < conditions.reached < conditions.total
    assert conditions.total == 2 * len(coverage.conditions)


def test_listening_to_conditions_changes_nothing(run: Run) -> None:
    plain = play(Plan(("flea",), ("random", "oracle"), 40, 3), Crew(), progress=lambda t, d: Progress(t, d, show=False))
    assert not plain.coverage["flea"].conditions
    for place, tally in plain.tallies.items():
        assert tally.to_dict() == run.tallies[place].to_dict()
    assert plain.coverage["flea"].lines == run.coverage["flea"].lines


def test_a_run_survives_being_written_down(run: Run) -> None:
    again = Run.from_dict(PLAN, json.loads(json.dumps(run.to_dict())))
    assert json.dumps(again.to_dict()) == json.dumps(run.to_dict())


def test_intervals_are_those_of_the_textbook() -> None:
    values = [0.0, 0.5, 1.0, 0.7, 0.2]
    ci = interval_of(5, sum(values), sum(v * v for v in values))
    assert ci.mean == pytest.approx(0.48)
    assert ci.half == pytest.approx(1.96 * 0.3962 / 5**0.5, abs=1e-3)
    assert Tally().surplus_ci.half == 0.0


class Reader(HTMLParser):
    """Headings, links, and whatever a browser would have to fetch."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.fetched: list[str] = []

    def handle_starttag(self, tag: str, attrs) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            if name in {"src", "srcset"} or (name in {"href", "xlink:href"} and not (value or "").startswith("#")):
                self.fetched.append(f"{tag} {name}={value}")


def test_the_page_needs_nothing_else_and_shows_everything(tmp_path: Path, capsys) -> None:
    pytest.importorskip("matplotlib", reason="the extra reports is not installed")
    page, plots, junit = tmp_path / "out.html", tmp_path / "plots", tmp_path / "out.xml"
    wanted = tmp_path / "wanted.yaml"
    wanted.write_text("coverage: {nodes: 0.5, labels: 1}\nbalance: [{policy: oracle, above: random, by: 0.2}]\n")
    words = ["autoplay", "--episodes", "30", "--seed", "3", "--policy", "random", "--policy", "oracle", "--json"]
    code = main([*words, "--report", str(page), "--plots", str(plots), "--junit", str(junit), "--require", str(wanted)])
    assert code == 0
    text = page.read_text(encoding="utf-8")
    reader = Reader()
    reader.feed(text)
    assert not reader.fetched
    assert not re.search(r"@import|url\(\s*['\"]?(?!#)", text)
    assert reader.tags.count("svg") == 4
    assert "Seven Cups" in text
    assert "Everything required is met" in text
    assert "Nodes not passed" in text
    first = json.loads(capsys.readouterr().out)[0]
    assert f"{first['mean_surplus']:.3f}" in text
    assert {p.name for p in plots.iterdir()} == {
        f"flea_{name}.{kind}" for name in ("surplus", "prices", "lengths", "feelings") for kind in ("svg", "png")
    }
    suite = ElementTree.parse(junit).getroot().find("testsuite")
    assert suite is not None
    assert suite.get("name") == "flea"
    assert suite.get("failures") == "0"
    assert int(suite.get("tests") or 0) == len(suite.findall("testcase"))
    names = {(case.get("classname"), case.get("name")) for case in suite}
    assert {("flea.balance", "oracle"), ("flea.coverage", "conditions"), ("flea.required", "nodes")} <= names


def test_missed_requirements_are_the_exit_code(tmp_path: Path, capsys) -> None:
    wanted, junit = tmp_path / "wanted.yaml", tmp_path / "out.xml"
    wanted.write_text(
        "coverage:\n  nodes: 1\nbalance:\n"
        "  - {policy: random, above: oracle, by: 0.1}\n"
        "  - {policy: random, not_above: oracle}\n"
        "  - {policy: oracle, surplus: [0.3, 1.0], moves: [1, 2]}\n"
        "  - {policy: random, stalls: [toys], surplus: [1, 1]}\n"
    )
    words = ["autoplay", "--episodes", "20", "--policy", "random", "--policy", "oracle", "--json"]
    assert main([*words, "--require", str(wanted), "--junit", str(junit)]) == 1
    rows = capsys.readouterr().err.splitlines()
    assert [row.split(": ")[0].rsplit("wanted.yaml", 1)[1] for row in rows] == [":2:10", ":4:5", ":6:5"]
    assert "nodes reached" in rows[0]
    assert "missing" in rows[0]
    assert "above oracle" in rows[1]
    assert "moves" in rows[2]
    failures = ElementTree.parse(junit).getroot().findall(".//failure")
    assert len(failures) == 3
    assert "wanted.yaml:4:5" in (failures[1].text or "")


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("coverage: {noodles: 1}", "wanted.yaml:1:12"),
        ("coverage: {nodes: 2}", "wanted.yaml:1:19"),
        ("balance: [{policy: random}]", "wanted.yaml:1:11"),
        ("balance: [{policy: random, above: oracle}]", "wanted.yaml:1:11"),
        ("balance: [{policy: random, surplus: [1]}]", "wanted.yaml:1:37"),
        ("balance: [{policy: random, above: reader, by: 0.1}]", "wanted.yaml:1:11"),
        ("balance: [{policy: random, stalls: [toyz], surplus: [0, 1]}]", "toys"),
        ("cover: {}", "wanted.yaml:1:1"),
    ],
)
def test_faults_in_the_requirements_are_told_with_their_place(tmp_path: Path, capsys, text: str, place: str) -> None:
    wanted = tmp_path / "wanted.yaml"
    wanted.write_text(text + "\n")
    assert main(["autoplay", "--episodes", "3", "--require", str(wanted), "--json"]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert place in error


def test_a_policy_of_any_name_is_written_in_its_letters(run: Run, tmp_path: Path) -> None:
    """Own policies are files; matplotlib warns of letters that it lacks, and warnings are errors here."""
    pytest.importorskip("matplotlib", reason="the extra reports is not installed")
    from game.render.text import japanese_font
    from game.tools.reports import write_plots, write_report

    if japanese_font() is None:
        pytest.skip("no Japanese font")
    own = Run(Plan(("flea",), ("折り/待つ人.py", "random:0.5,waits.py:0.5"), 40, 3, cover=True), coverage=run.coverage)
    for (stall, _, _), tally in run.tallies.items():
        for population in own.plan.populations:
            own.tallies[stall, population, "random"] = tally
    write_plots(tmp_path / "plots", own)
    write_report(tmp_path / "page.html", own, [])
    assert ">待つ人.py<" in (tmp_path / "page.html").read_text(encoding="utf-8")
