"""Dask on this machine alone (extra ``cluster``)."""

from __future__ import annotations

import ipaddress
import os

import pytest

from game.tools.cluster import dask_executor

pytest.importorskip("distributed", reason="needs the cluster extra")


def test_a_local_cluster_cannot_be_reached_from_elsewhere():
    psutil = pytest.importorskip("psutil", reason="comes with the cluster extra")
    executor, workers, close = dask_executor("local", 1)
    try:
        assert (workers, executor.submit(abs, -3).result(20)) == (1, 3)
        this = psutil.Process(os.getpid())
        open_to = [
            place.laddr.ip
            for process in (this, *this.children(recursive=True))
            for place in process.net_connections(kind="inet")
            if place.status == "LISTEN"
        ]
        assert open_to
        assert all(ipaddress.ip_address(ip).is_loopback for ip in open_to)
    finally:
        close()
