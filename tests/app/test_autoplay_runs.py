"""Long runs: the same result however many work on it, whatever dies or is stopped meanwhile."""

from __future__ import annotations

import gzip
import io
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from game.app.autoplay.executors import Crew, workers_of
from game.app.autoplay.jobs import Job, Result, work
from game.app.autoplay.progress import Progress
from game.app.autoplay.runs import Plan, Run, play
from game.app.cli import main
from game.core.errors import BadInput
from game.core.paths import ROOT

PLAN = Plan(("flea",), ("random:1,words:1", "oracle"), 24, 5, log="plain", cover=True, per_job=5)


def quiet(total: int, done: int = 0) -> Progress:
    return Progress(total, done, show=False)


def result_of(run: Run) -> str:
    return json.dumps(run.to_dict(), sort_keys=True)


@pytest.fixture(scope="module")
def straight(tmp_path_factory) -> tuple[bytes, str]:
    """The log and the figures as one process gives them."""
    path = tmp_path_factory.mktemp("straight") / "log.jsonl"
    run = play(PLAN, Crew(), out=path, progress=quiet)
    assert run.whole
    assert run.talks == PLAN.talks == 48
    return path.read_bytes(), result_of(run)


def kill_one_worker() -> None:
    for child in multiprocessing.active_children():
        if child.pid is not None:
            os.kill(child.pid, signal.SIGKILL)
            return
    raise AssertionError("no worker to kill")


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs signals")
def test_two_workers_one_of_them_killed_give_the_very_same(straight, tmp_path: Path) -> None:
    log, figures = straight
    crew, path = Crew(2), tmp_path / "log.jsonl"
    killed = []

    class Watching(Progress):
        def add(self, talks: int) -> None:
            super().add(talks)
            if not killed:
                killed.append(kill_one_worker())

    run = play(PLAN, crew, out=path, progress=lambda total, done: Watching(total, done, show=False))
    assert crew.reborn >= 1
    assert run.whole
    assert path.read_bytes() == log
    assert result_of(run) == figures
    assert not list(tmp_path.glob("*.part*"))


def test_a_job_over_which_every_worker_dies_is_told_in_one_line(monkeypatch) -> None:
    from concurrent.futures import BrokenExecutor, Executor, Future

    class Dying(Executor):
        def submit(self, fn, /, *args, **kwargs):
            future: Future = Future()
            future.set_exception(BrokenExecutor())
            return future

    monkeypatch.setattr("game.app.autoplay.executors._processes", lambda workers: Dying())
    with pytest.raises(BadInput, match="episodes 0 to 4: expected workers that live"):
        play(PLAN, Crew(2), progress=quiet)


class Stopping(Crew):
    """Ctrl-C after some results."""

    def results(self, jobs: Iterator[Job]) -> Iterator[Result]:
        for at, job in enumerate(jobs):
            if at == 4:
                raise KeyboardInterrupt
            yield work(job)


def test_a_stopped_run_keeps_what_is_done_and_goes_on_to_the_same_bytes(straight, tmp_path: Path) -> None:
    log, figures = straight
    path = tmp_path / "log.jsonl"
    stopped = play(PLAN, Stopping(), out=path, progress=quiet)
    assert not stopped.whole
    assert stopped.talks == 20
    assert not path.exists()
    part = path.with_name("log.jsonl.part")
    assert log.startswith(part.read_bytes())
    with part.open("ab") as file:
        file.write(b'{"half a row": ')  # what a power cut leaves
    run = play(PLAN, Crew(), out=path, resume=True, progress=quiet)
    assert run.whole
    assert path.read_bytes() == log
    assert result_of(run) == figures
    assert [p.name for p in tmp_path.iterdir()] == ["log.jsonl"]


def test_an_own_policy_that_was_edited_is_another_run(tmp_path: Path) -> None:
    own, path = tmp_path / "own.py", tmp_path / "log.jsonl"
    source = 'SEES = "table"\ndef move(view, memory, rng):\n    return {"choice": "wait"}\n'
    own.write_text(source)
    plan = Plan(("flea",), (str(own),), 30, 5, log="plain", per_job=5)
    play(plan, Stopping(), out=path, progress=quiet)
    own.write_text(source.replace("wait", "leave"))
    with pytest.raises(BadInput, match="another contents"):
        play(plan, Crew(), out=path, resume=True, progress=quiet)


def test_a_worker_that_stands_elsewhere_and_lives_on_plays_the_files_as_they_are_now(tmp_path: Path) -> None:
    own = tmp_path / "own.py"
    source = 'SEES = "table"\ndef move(view, memory, rng):\n    return {"choice": "wait"}\n'
    moves = set()
    for act in ("wait", "leave"):
        own.write_text(source.replace("wait", act))
        job = next(Plan(("flea",), ("own.py",), 2, 5, log="plain", folder=str(tmp_path)).jobs())
        row = json.loads(work(job).rows.splitlines()[0])
        assert row["policy"] == "own.py"
        moves.add(row["choice"])
    assert moves == {"wait", "leave"}
    own.write_text(source + "# another\n")
    with pytest.raises(BadInput, match="expected the same game but saw 'other contents'"):
        work(replace(job, made=job.made[:-1] + "x"))


def test_only_the_same_run_is_gone_on_with(tmp_path: Path) -> None:
    path = tmp_path / "log.jsonl"
    play(PLAN, Stopping(), out=path, progress=quiet)
    other = Plan(("flea",), ("random:1,words:1", "oracle"), 24, 6, log="plain", cover=True, per_job=5)
    with pytest.raises(BadInput, match="another seed"):
        play(other, Crew(), out=path, resume=True, progress=quiet)
    with pytest.raises(BadInput, match="a stopped run"):
        play(PLAN, Crew(), out=tmp_path / "none.jsonl", resume=True, progress=quiet)


def test_a_compressed_log_says_the_same(straight, tmp_path: Path) -> None:
    path = tmp_path / "log.jsonl.gz"
    words = ["autoplay", "--episodes", "24", "--seed", "5", "--policy", "random:1,words:1", "--policy", "oracle"]
    assert main([*words, "--out", str(path), "--json"]) == 0
    plain = tmp_path / "log.jsonl"
    assert main([*words, "--out", str(plain), "--json"]) == 0
    assert gzip.decompress(path.read_bytes()) == plain.read_bytes() == straight[0]
    assert path.stat().st_size < plain.stat().st_size / 4


@pytest.mark.skipif(os.name == "nt", reason="needs signals")
def test_ctrl_c_stops_cleanly_with_what_is_done(tmp_path: Path) -> None:
    # A suite that runs in a shell's background inherits a deaf ear for Ctrl-C, and would hand it on.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    path = tmp_path / "log.jsonl"
    command = [sys.executable, str(ROOT / "run_game.py"), "autoplay", "--episodes", "100000", "--workers", "2"]
    run = subprocess.Popen(
        [*command, "--out", str(path), "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT
    )
    state = path.with_name("log.jsonl.part.json")
    for _ in range(600):
        if state.exists() or run.poll() is not None:
            break
        time.sleep(0.1)
    run.send_signal(signal.SIGINT)
    out, error = run.communicate(timeout=60)
    assert run.returncode == 130
    assert "stopped after" in error
    assert "Traceback" not in error
    done = json.loads(out)["episodes"]
    rows = path.with_name("log.jsonl.part").read_text(encoding="utf-8").splitlines()
    assert {json.loads(row)["episode"] for row in rows} == set(range(done))
    assert done % 100 == 0


@pytest.mark.skipif(os.name == "nt", reason="needs signals")
def test_ctrl_c_waits_for_no_job(monkeypatch) -> None:
    """Those with bodies take a minute; a second Ctrl-C while they were waited for left everything hanging."""
    before = set(multiprocessing.active_children())

    def interrupted(*args: object, **kwargs: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("game.app.autoplay.executors.wait", interrupted)
    with pytest.raises(KeyboardInterrupt):
        next(Crew(2, task=_sleep_for_an_hour).results(PLAN.jobs()))
    assert not set(multiprocessing.active_children()) - before


def _sleep_for_an_hour(job: Job) -> Result:
    time.sleep(3600.0)
    return Result(job.number)


@pytest.mark.skipif(os.name == "nt", reason="needs signals")
def test_workers_end_with_a_run_that_is_killed_and_play_what_it_plays(tmp_path: Path) -> None:
    """Also from a folder where another ``game`` lies; what was kept is gone on with."""
    (tmp_path / "game").mkdir()
    (tmp_path / "game" / "__init__.py").write_text("")
    state = tmp_path / "log.jsonl.part.json"
    command = [sys.executable, str(ROOT / "run_game.py"), "autoplay", "--episodes", "100000", "--workers", "2"]
    run = subprocess.Popen(
        [*command, "--out", "log.jsonl"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path
    )
    for _ in range(600):
        if state.exists() or run.poll() is not None:
            break
        time.sleep(0.1)
    run.kill()
    # Whoever lives on holds the other end of these pipes.
    run.communicate(timeout=60)
    assert json.loads(state.read_text())["run"]["talks"] >= 100


def test_a_dask_cluster_gives_the_very_same(straight, tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed", reason="the extra cluster is not installed")
    path = tmp_path / "log.jsonl"
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=2, processes=False, dashboard_address=":0")
    try:
        run = play(PLAN, Crew(2, cluster.scheduler_address), out=path, progress=quiet)
    finally:
        cluster.close()
    assert path.read_bytes() == straight[0]
    assert result_of(run) == straight[1]


def test_all_stalls_and_all_policies_are_told_one_by_one(capsys) -> None:
    words = ["autoplay", "--stall", "all", "--policy", "random", "--policy", "oracle:1,fixed:1", "--episodes", "6"]
    assert main([*words, "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    stalls = {row["stall"] for row in rows}
    assert "flea" in stalls
    assert len(rows) == 2 * len(stalls)
    mixed = [row for row in rows if row["policy"] == "oracle:0.5,fixed:0.5"]
    assert all(sum(own["episodes"] for own in row["policies"].values()) == 6 for row in mixed)
    assert main(words) == 0
    assert "surplus" in capsys.readouterr().out


def test_progress_tells_rate_and_what_is_left() -> None:
    now, out = [0.0], io.StringIO()
    bar = Progress(1000, 200, show=True, out=out, clock=lambda: now[0])
    now[0] = 10.0
    bar.add(300)
    assert "50%" in bar.text()
    assert "500/1,000 talks" in bar.text()
    assert "30/s" in bar.text()
    assert "0:17 left" in bar.text()
    bar.end()
    assert out.getvalue().endswith("\n")
    silent = io.StringIO()
    Progress(10, out=silent).add(10)
    assert silent.getvalue() == ""


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--workers", "many"], "auto or a number"),
        (["--resume"], "--out"),
        (["--policy", "oracel"], "oracle"),
        (["--policy", "script:/no/such.yaml"], "a file that exists"),
        (["--policy", "/no/such.py"], "a Python file that exists"),
        (["--require", "/no/such.yaml"], "a file that exists"),
        (["--search", "random"], "fixed | words"),
    ],
)
def test_bad_arguments_give_one_line(capsys, words: list[str], says: str) -> None:
    assert main(["autoplay", "--episodes", "5", *words]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert says in error


@pytest.mark.parametrize("option", ["--out", "--report", "--junit", "--plots", "--record"])
def test_a_place_where_nothing_can_be_written_is_told_before_hours_are_played(tmp_path, capsys, option: str) -> None:
    (tmp_path / "file").write_text("")
    wrong = [tmp_path / "file" / "into"]
    if option not in {"--plots", "--record"}:
        wrong = [tmp_path, tmp_path / "none" / "x"]
    if hasattr(os, "mkfifo"):
        # As root, a file would have taken the place of a pipe or device.
        os.mkfifo(tmp_path / "pipe")
        wrong.append(tmp_path / "pipe")
    for path in wrong:
        assert main(["autoplay", "--episodes", "1000000", option, str(path)]) == 2
        assert "cannot write" in capsys.readouterr().err
    assert {path.name for path in tmp_path.iterdir()} <= {"file", "pipe"}
    assert not (tmp_path / "pipe").is_file()


def test_workers_are_as_many_as_asked() -> None:
    assert workers_of("3") == 3
    assert workers_of("auto") >= 1


def test_conditions_are_counted_however_many_scripts_were_played_in_between(tmp_path) -> None:
    job = Job(0, "flea", "random", 5, 0, 4, cover=True)
    first = work(job).coverage.conditions
    tiny = (Path(__file__).parents[1] / "story" / "tiny.yaml").read_text(encoding="utf-8")
    for number in range(9):
        path = tmp_path / f"tiny{number}.yaml"
        path.write_text(tiny, encoding="utf-8")
        work(Job(0, str(path), "random", 5, 0, 1, cover=True))
    assert any(yes for _, yes in first)
    assert work(job).coverage.conditions == first
