# SPDX-License-Identifier: GPL-3.0-or-later
"""Calls on the workers of a Dask cluster, with progress and cancellation, and the results in the order of the calls.

The scheduler runs a call again if its worker dies. A call is a pure function of its arguments, so the results do not
depend on the workers."""

from __future__ import annotations

import pkgutil
import time
import warnings
from collections.abc import Callable, Sequence
from typing import Any

from .. import _core
from ..common.arguments import check_whole
from ..common.errors import ArgumentError, quoted
from ..common.extras import require
from ..common.progress import Progress, stepper

PARTS_PER_THREAD = 4  # so that workers of different speed finish at the same time
MOST_PARTS = 4096
POLL = 0.2  # seconds between two calls of `cancel`


def gather(client, call: Callable, arguments: Sequence[tuple], shared: tuple, work: str, progress: Progress | None,
           cancel: Callable[[], bool] | None, keep: Callable[[Any], None] | None = None) -> list:
    """[call(*shared, *each) for each in arguments], on the workers of `client`. `shared` is sent once, and recomputed
    from the client's copy if its worker dies. `keep` is called with each result as soon as it is there. Raises what a
    call raises, Cancelled, KilledWorker of Dask if a call has killed several workers, and ArgumentError for a worker
    without this version of Lamina."""
    distributed = checked(client)
    step = stepper(work, progress, cancel)
    _probe(client, step)
    step(0.0, f"0 of {len(arguments)} parts")
    with warnings.catch_warnings():
        # From 10 MB on. The ways that Dask advises instead lose the data if its worker dies.
        warnings.filterwarnings("ignore", "Sending large graph")
        held = client.submit(_same, shared, pure=False)
    futures = [client.submit(_apply, call, held, each, pure=False) for each in arguments]
    waiting, done = set(futures), 0
    try:
        while waiting:
            try:
                finished = distributed.wait(waiting, timeout=POLL, return_when="FIRST_COMPLETED").done
            except TimeoutError:
                finished = set()
            for future in finished:
                if future.status in ("error", "lost", "cancelled"):
                    future.result()  # raises
                if keep is not None:
                    keep(future.result())
            waiting -= finished
            done += len(finished)
            step(done / len(futures), f"{done} of {len(futures)} parts")
        return client.gather(futures)
    finally:
        client.cancel([held, *(future for future in futures if not future.done())])


def _probe(client, step: Progress) -> None:
    """Waits for a worker, and raises ArgumentError unless all workers have this version of Lamina. One without it would
    leave the cluster at its first call, and the call would wait for another worker."""
    while not client.nthreads():
        step(0.0, "waiting for a worker")
        time.sleep(POLL)
    # A function of Python itself, for the worker may have no other. A worker that dies meanwhile returns an OSError.
    found = client.run(pkgutil.resolve_name, "lamina:__version__", on_error="return")
    for worker, version in sorted(found.items()):
        if version == _core.__version__ or isinstance(version, OSError):
            continue
        has = f"lamina {version}" if isinstance(version, str) else "no lamina that it can import"
        raise ArgumentError(f"client: its worker {worker} has {has}: must have lamina {_core.__version__}, as here")


def checked(client):
    """The module `distributed`. Raises ExtraMissing, and ArgumentError unless `client` is a client of it."""
    distributed = require("distributed", "lamina.distributed")
    if not isinstance(client, distributed.Client) or client.asynchronous:
        raise ArgumentError(f"client = {quoted(client)}: must be a synchronous distributed.Client")
    return distributed


def shards(client, parts: int | None, most: int) -> list[tuple[int, int]]:
    """The numbers (i, n) of the parts: `parts`, or some for each thread of the cluster, and at most `most`."""
    checked(client)
    if parts is None:
        parts = PARTS_PER_THREAD * max(1, sum(client.nthreads().values()))
    count = min(check_whole(parts, "parts", 1, MOST_PARTS), max(most, 1))
    return [(number, count) for number in range(1, count + 1)]


def _same(value):
    return value


def _apply(call: Callable, shared: tuple, each: tuple):
    return call(*shared, *each)
