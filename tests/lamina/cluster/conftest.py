# SPDX-License-Identifier: GPL-3.0-or-later
"""A cluster of two worker processes on this machine, and workers that are killed in the middle of their work."""

import contextlib
import os
import signal

import pytest


@pytest.fixture(scope="package")
def client():
    distributed, config = pytest.importorskip("distributed"), pytest.importorskip("dask.config")
    # 15 seconds after a worker is lost, Dask gives it up for good where no worker of its name runs: also where that
    # one had come back in time and a later test has just killed it again.
    with (config.set({"distributed.deploy.lost-worker-timeout": "1 hour"}),
          distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, host="127.0.0.1",
                                   dashboard_address=None) as cluster, distributed.Client(cluster) as client):
        yield client


@pytest.fixture
def a_worker_killed(client):
    """`with a_worker_killed(when) as progress`: `progress` kills a worker once, when `when(share, text)` is true. The
    end of the block waits until the cluster has started another worker."""

    @contextlib.contextmanager
    def killing(when):
        workers, killed = set(client.run(os.getpid).values()), []

        def progress(share, text):
            if when(share, text) and not killed:
                killed.append(min(workers))
                os.kill(killed[0], signal.SIGKILL)

        yield progress
        assert killed, "the work was over before a worker was killed"
        client.wait_for_workers(2, timeout=60)
        assert killed[0] not in client.run(os.getpid).values()

    return killing
