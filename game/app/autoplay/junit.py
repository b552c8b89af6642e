"""Results as JUnit XML, which every continuous integration can show."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from game.app.autoplay.coverage import covered
from game.app.autoplay.requirements import Finding
from game.app.autoplay.runs import Run
from game.formats.files import write_bytes

__all__ = ["write_junit"]


def write_junit(path: Path, run: Run, findings: Sequence[Finding]) -> None:
    """One suite per stall: a case for every population that played, every kind of coverage, every requirement.

    A case fails where a requirement is missed; what was not reached stands in the case's output.
    """
    root = ElementTree.Element("testsuites", name="autoplay")
    for stall in run.plan.stalls:
        suite = ElementTree.SubElement(root, "testsuite", name=stall)
        for population in run.plan.populations:
            tally = run.total(stall, population)
            if tally.talks:
                case = ElementTree.SubElement(suite, "testcase", classname=f"{stall}.balance", name=population)
                surplus, deals = tally.surplus_ci, tally.deal_ci
                ElementTree.SubElement(case, "system-out").text = (
                    f"{tally.talks} talks, surplus {surplus.mean:.4f} ± {surplus.half:.4f}, deals {deals.mean:.4f} ± "
                    f"{deals.half:.4f}"
                )
        for kind, reached in covered(run, stall).items():
            case = ElementTree.SubElement(suite, "testcase", classname=f"{stall}.coverage", name=kind)
            rows = [f"{reached.reached} of {reached.total}"] + [f"missing {n} {w}".strip() for n, w in reached.missing]
            ElementTree.SubElement(case, "system-out").text = "\n".join(rows)
        failures = 0
        for finding in findings:
            if finding.stall == stall:
                case = ElementTree.SubElement(suite, "testcase", classname=f"{stall}.required", name=finding.name)
                if finding.good:
                    ElementTree.SubElement(case, "system-out").text = finding.text
                else:
                    failures += 1
                    failure = ElementTree.SubElement(case, "failure", message=finding.text)
                    failure.text = finding.where
        suite.set("tests", str(len(suite.findall("testcase"))))
        suite.set("failures", str(failures))
    ElementTree.indent(root)
    write_bytes(path, ElementTree.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n")
