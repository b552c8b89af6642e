"""Where jobs run: here, in processes, or on a Dask cluster, all behind the interface of concurrent.futures."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from multiprocessing import connection
from multiprocessing.process import BaseProcess

from game.app.autoplay.jobs import Job, Result, work
from game.core.errors import BadInput

__all__ = ["ATTEMPTS", "Crew", "workers_of"]

ATTEMPTS = 3
"""So often a job is given out before a dying worker counts as the job's fault."""
_AHEAD = 3
"""Jobs given out per worker: enough that none waits, few enough that results never pile up."""
_LOOK_S = 0.25


def workers_of(text: str) -> int:
    """``auto`` or a number. Raises BadInput otherwise."""
    if text == "auto":
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if text.isdigit() and 1 <= int(text) <= 1024:
        return int(text)
    raise BadInput("--workers", expected="auto or a number from 1 to 1024", seen=text)


def _begin_worker() -> None:
    # Ctrl-C is for the one who hands out the work.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    giver = multiprocessing.parent_process()
    if giver is not None:
        threading.Thread(target=_end_with, args=(giver.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    """Whoever hands out the work may be killed: nobody waits for more of it then."""
    connection.wait([sentinel])
    os._exit(1)


def _processes(workers: int) -> Executor:
    # One thread of arithmetic per worker.
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    # Never a plain fork: what this process holds (threads, GL) must not be copied.
    known = multiprocessing.get_all_start_methods()
    context = multiprocessing.get_context("forkserver" if "forkserver" in known else "spawn")
    if "forkserver" in known:
        # Not there on Windows.
        from multiprocessing import forkserver

        # The server must read none of the game: it would look where it stands (python 3.11 keeps our path from it), and
        # find another copy there, or the one that is installed. Workers take the path of this process.
        context.set_forkserver_preload([])
        with _deaf_to_ctrl_c():
            forkserver.ensure_running()
    return ProcessPoolExecutor(workers, context, initializer=_begin_worker)


@contextmanager
def _deaf_to_ctrl_c() -> Iterator[None]:
    """What is started here inherits it; else Ctrl-C would find workers at their imports, and be told at length."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@dataclass
class Crew:
    """Hands out jobs and gives back results as they come, whatever dies meanwhile."""

    workers: int = 1
    dask: str = ""
    task: Callable[[Job], Result] = work
    reborn: int = 0
    _executor: Executor | None = field(default=None, repr=False)
    _close: Callable[[], None] | None = field(default=None, repr=False)
    _others: frozenset[BaseProcess] = field(default=frozenset(), repr=False)

    def results(self, jobs: Iterator[Job]) -> Generator[Result, None, None]:
        """Results in the order in which they are done. The jobs of a worker that died are done again."""
        if not self.dask and self.workers == 1:
            for job in jobs:
                yield self.task(job)
            return
        self._start()
        pending: dict[Future[Result], Job] = {}
        tries: dict[int, int] = {}
        again: list[Job] = []
        more, whole = True, False
        try:
            while more or pending or again:
                while len(pending) < self.workers * _AHEAD and (again or more):
                    given = again.pop(0) if again else next(jobs, None)
                    if given is None:
                        more = False
                        break
                    job = given
                    tries[job.number] = tries.get(job.number, 0) + 1
                    if tries[job.number] > ATTEMPTS:
                        raise BadInput(
                            f"episodes {job.first} to {job.first + job.count - 1}",
                            expected="workers that live", seen=f"{ATTEMPTS} that died over them",
                        )  # fmt: skip
                    pending[self._submit(job)] = job
                done, _ = wait(pending, timeout=_LOOK_S, return_when=FIRST_COMPLETED)
                lost = False
                for future in done:
                    job = pending.pop(future)
                    try:
                        yield future.result()
                        tries.pop(job.number, None)
                    except BrokenExecutor:
                        again.append(job)
                        lost = True
                    except Exception as error:
                        if type(error).__name__ != "KilledWorker":
                            raise
                        again.append(job)
                if lost:
                    # One process gone breaks the pool: all that was given out is given out again.
                    again.extend(pending.values())
                    again.sort(key=lambda job: job.number)
                    pending.clear()
                    self.reborn += 1
                    self._stop()
                    self._start()
            whole = True
        finally:
            for future in pending:
                future.cancel()
            # What still runs (bodies may take a minute) is thrown away: nobody waits for it.
            self._stop(kill=not whole)

    def _submit(self, job: Job) -> Future[Result]:
        assert self._executor is not None
        try:
            return self._executor.submit(self.task, job)
        except BrokenExecutor:
            broken: Future[Result] = Future()
            broken.set_exception(BrokenExecutor())
            return broken

    def _start(self) -> None:
        if self.dask:
            from game.tools.cluster import dask_executor

            self._executor, self.workers, self._close = dask_executor(self.dask, self.workers)
        else:
            self._others = frozenset(multiprocessing.active_children())
            self._executor = _processes(self.workers)

    def _stop(self, *, kill: bool = False) -> None:
        if kill and not self.dask:
            for process in frozenset(multiprocessing.active_children()) - self._others:
                process.kill()
        if self._executor is not None:
            with suppress(Exception):
                self._executor.shutdown(wait=not self.dask, cancel_futures=True)
        if self._close is not None:
            self._close()
        self._executor = self._close = None
