# SPDX-License-Identifier: GPL-3.0-or-later
"""The workers of a Dask cluster as an executor.

The scheduler runs a call again if its worker dies."""

from __future__ import annotations

import os
import pkgutil
import time
import warnings
from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any

from .. import _core
from ..common.arguments import check_whole
from ..common.errors import ArgumentError, quoted
from ..common.extras import require
from ..common.parts import POLL, shards_of
from ..common.progress import Progress

PARTS_PER_THREAD = 4  # so that workers of different speed finish at the same time
MOST_PARTS = 4096


def spread(client) -> Executor:
    """The argument `spread` of lamina.relightable_images and lamina.lit_images: the parts of the walks are computed on
    the cluster of `client`, with the bytes of one process. The short trial that finds the number of samples, and the
    work after the walks, stay in this process. Finished parts are kept in `folder`, as without a cluster. An executor
    of concurrent.futures is returned as it is. Raises ExtraMissing without Dask, and ArgumentError."""
    return client if isinstance(client, Executor) else Workers(client)


class Workers(Executor):
    """The executor of a Dask client. The callable of `submit` may hold much data: it is sent once for all successive
    calls, and recomputed from the client's copy if its worker dies."""

    def __init__(self, client: Any):
        distributed = require("distributed", "lamina.distributed")
        if not isinstance(client, distributed.Client) or client.asynchronous:
            raise ArgumentError(f"client = {quoted(client)}: must be a synchronous distributed.Client, or an executor "
                                "of concurrent.futures")
        if client.status == "closed":
            raise ArgumentError(f"client = {quoted(client)}: is closed, or has lost its scheduler")
        self._client, self._executor = client, client.get_executor(pure=False)
        self._sent: tuple[Callable, Any] | None = None

    @property
    def threads(self) -> int:
        return sum(self._client.nthreads().values())

    def submit(self, call: Callable, /, *given, **more) -> Future:  # type: ignore[override]
        if self._sent is None or self._sent[0] is not call:
            with warnings.catch_warnings():
                # From 10 MB on. The ways that Dask advises instead lose the data if its worker dies.
                warnings.filterwarnings("ignore", "Sending large graph")
                self._sent = call, self._client.submit(_same, call, pure=False)
        return self._executor.submit(_apply, self._sent[1], *given, **more)

    def ready(self, step: Progress) -> None:
        """Waits for a worker, and raises ArgumentError unless all workers have this version of Lamina. One without it
        would leave the cluster at its first call, and the call would wait for another worker."""
        self._sent = None
        while not self._client.nthreads():
            step(0.0, "waiting for a worker")
            time.sleep(POLL)
        # A function of Python itself, for the worker may have no other. A worker that dies meanwhile returns an
        # OSError.
        found = self._client.run(pkgutil.resolve_name, "lamina:__version__", on_error="return")
        for worker, version in sorted(found.items()):
            if version == _core.__version__ or isinstance(version, OSError):
                continue
            has = f"lamina {version}" if isinstance(version, str) else "no lamina that it can import"
            raise ArgumentError(f"client: its worker {worker} has {has}: must have lamina {_core.__version__}, as here")


def shards(executor: Executor, parts: int | None, most: int) -> list[tuple[int, int]]:
    """The numbers (i, n) of the parts: `parts`, or some for each thread of the executor, and at most `most`."""
    if parts is None:
        parts = PARTS_PER_THREAD * max(1, getattr(executor, "threads", os.cpu_count() or 1))
    return shards_of(min(check_whole(parts, "parts", 1, MOST_PARTS), max(most, 1)))


def _same(value):
    return value


def _apply(call: Callable, *given, **more):
    return call(*given, **more)
