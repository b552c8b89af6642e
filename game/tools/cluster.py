"""A Dask cluster behind the interface of concurrent.futures (extra ``cluster``)."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from typing import Any

from game.core.errors import BadInput

__all__ = ["dask_executor"]


def dask_executor(address: str, workers: int) -> tuple[Executor, int, Callable[[], None]]:
    """address: of a scheduler, or ``local`` for one of our own with so many workers.

    -> an executor, how many workers it has, and how to leave it. Raises BadInput without the package or an answer.
    """
    try:
        import distributed
    except ImportError:
        hint = "pip install 'mental-communication-game[cluster]'"
        raise BadInput("--dask", expected="the package distributed", seen="none", hint=hint) from None
    dask: Any = distributed
    cluster: Any = None
    try:
        if address == "local":
            # Any free port for its page of figures, which only this machine can reach.
            cluster = dask.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address="127.0.0.1:0")
        client: Any = dask.Client(cluster or address, timeout="20s")
    except (OSError, ValueError, TimeoutError) as error:
        raise BadInput("--dask", expected="a scheduler that answers, or local", seen=f"{address}: {error}") from None

    def close() -> None:
        client.close()
        if cluster is not None:
            cluster.close()

    return client.get_executor(pure=False), max(len(client.scheduler_info()["workers"]), 1), close
