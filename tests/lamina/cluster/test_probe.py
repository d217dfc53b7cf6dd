# SPDX-License-Identifier: GPL-3.0-or-later
"""A worker without lamina, or with another version, is named before any work is sent. Each is a process of its own."""

import contextlib
import os
import subprocess
import sys
import time

import pytest

import lamina
from lamina import ArgumentError, Medium, Stack, distributed

dask = pytest.importorskip("distributed", reason="Dask is not installed: there is no cluster to test")
SLAB = Stack([Medium(0.9, 2.0)])
# Files of a folder that comes first on the worker's path, and what the sentence says.
FOREIGN = {
    "none": ({"sitecustomize.py": "import sys; sys.modules['lamina'] = None"}, "no lamina that it can import"),
    "older": ({"lamina/__init__.py": "__version__ = '0.0.1'"}, "lamina 0.0.1"),
    "folder of that name": ({"lamina/__init__.py": ""}, "no lamina that it can import"),
}


@contextlib.contextmanager
def worker(client, folder, files):
    """A worker that finds `files` first."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    before = len(client.nthreads())
    process = subprocess.Popen([sys.executable, "-m", "distributed.cli.dask_worker", client.cluster.scheduler_address,
                                "--nthreads", "1", "--no-dashboard", "--no-nanny"], cwd=folder,
                               env={**os.environ, "PYTHONPATH": str(folder)}, stderr=subprocess.DEVNULL)
    try:
        client.wait_for_workers(before + 1, timeout=60)
        yield
    finally:
        process.terminate()
        process.wait()


@pytest.fixture
def empty():
    """A client of a cluster without workers."""
    with dask.LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address=None) as cluster, \
            dask.Client(cluster) as client:
        yield client


def gives_up(seconds):
    """A `cancel` that ends a call that would wait for ever."""
    until = time.monotonic() + seconds
    return lambda: time.monotonic() > until


@pytest.mark.parametrize("which", FOREIGN)
def test_a_foreign_worker_is_named(empty, tmp_path, which):
    files, words = FOREIGN[which]
    said = []
    with worker(empty, tmp_path, files), pytest.raises(
            ArgumentError, match=rf"^client: its worker tcp://\S+ has {words}: must have lamina {lamina.__version__}, "
                                 "as here$"):
        distributed.estimate(empty, SLAB, 0.5, 0.5, samples=100_000, cancel=gives_up(20),
                             progress=lambda _share, text: said.append(text))
    assert not said  # nothing was sent


def test_without_a_worker_the_first_one_is_waited_for_and_named(empty, tmp_path):
    files, words = FOREIGN["none"]
    with contextlib.ExitStack() as later:
        joined = []

        def progress(_share, text):
            assert text == "waiting for a worker"
            if not joined:
                joined.append(later.enter_context(worker(empty, tmp_path, files)))

        with pytest.raises(ArgumentError, match=f"has {words}: must have"):
            distributed.bakes(empty, [SLAB], "preview", cancel=gives_up(60), progress=progress)
