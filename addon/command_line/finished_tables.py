# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a batch takes its lookup tables from: the folder of finished bakes, other processes, or a bake here.

Each finished bake is written to the folder at once. So a killed batch loses only the bakes that were running,
and the same command continues after the others.
"""

import os
import tempfile
from pathlib import Path
from typing import NamedTuple

from ..baking import bake_job
from ..base import native, package, preferences
from . import waiting
from .exit_codes import UsageError
from .worker_pool import WorkerPool

VARIABLE = "LAMINA_CACHE"  # of the environment: the folder of finished bakes
MOST_BYTES = 1 << 30  # that the default folder keeps; folders of the user's choice are never pruned


class Wanted(NamedTuple):
    """A table: of a lamina.Stack, at a quality, with a basis."""

    stack: object
    quality: str
    basis: str

    @property
    def key(self):
        return self.stack.hash, self.quality, self.basis


class Table(NamedTuple):
    """A lamina.Lut, whether it was finished before, and the seconds of its bake in this batch."""

    lut: object
    is_kept: bool
    seconds: float


class FinishedTables:
    """A context around a batch; leaving it ends the processes. `complain(sentence)` prints a warning. Raises
    UsageError for a folder that cannot be written. With `reads_only`, nothing is written."""

    def __init__(self, arguments, complain, reads_only=False):
        self._force, self._jobs, self._complain = arguments.force, arguments.jobs, complain
        self._threads = arguments.threads
        self._temporary = None
        self._made, self._begun = set(), {}
        self.count = 0
        self._cache = self._open(arguments.cache or os.environ.get(VARIABLE), reads_only)
        self._pool = (
            WorkerPool(self._jobs, self._threads_of_one(), self._cache.folder) if self._jobs > 1 else None
        )

    def _open(self, folder, reads_only):
        is_chosen = bool(folder)
        lut_cache = native.part("baking.table.cache").LutCache
        cache = lut_cache(Path(folder).resolve() if is_chosen else package.user_folder("bakes"))
        if reads_only:
            return cache
        try:
            cache.check_writable()
            cache.remove_forgotten()
            if not is_chosen:
                cache.prune(MOST_BYTES)
        except OSError as error:
            sentence = f"finished bakes cannot be kept in {cache.folder}: {error.strerror}"
            if is_chosen:
                raise UsageError(sentence) from None
            self._complain(f"{sentence}; a kill loses the bakes of the file that is not saved yet")
            self._temporary = tempfile.TemporaryDirectory(prefix="lamina-bakes-")
            cache = lut_cache(self._temporary.name)
        return cache

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._pool is not None:
            self._pool.close()
        if self._temporary is not None:
            self._temporary.cleanup()

    @property
    def folder(self):
        return self._cache.folder

    def has(self, wanted):
        """True if the table is finished."""
        return self._kept(wanted) is not None

    def begin(self, wanted):
        """Have another process bake the table, if there are several, unless it is finished or begun."""
        if self._pool is not None and wanted.key not in self._begun and not self.has(wanted):
            self._begun[wanted.key] = self._pool.submit(wanted)

    def get(self, wanted):
        """The Table. Raises what lamina.bake raises, WorkerError, and KeyboardInterrupt on Ctrl-C."""
        seconds = self._wait(wanted) if wanted.key in self._begun else None
        lut = self._kept(wanted)
        if lut is not None:
            return Table(lut, seconds is None, seconds or 0.0)
        job = bake_job.Job(wanted.stack, wanted.quality, self._threads_of_one(), basis=wanted.basis)
        waiting.for_job(job)
        if job.error is not None:
            raise job.error
        self._keep(job.lut)
        self._made.add(wanted.key)
        return Table(job.lut, False, job.lut.seconds)

    def _wait(self, wanted):
        """The seconds of the bake in another process; None when an earlier material has used its result."""
        future = self._begun.pop(wanted.key)
        seconds = waiting.for_future(future, "Baking in other processes")
        if seconds is not None:
            self._made.add(wanted.key)
            self.count += 1
        return seconds

    def _kept(self, wanted):
        if self._force and wanted.key not in self._made:
            return None
        return self._cache.load(*wanted)

    def _keep(self, lut):
        self.count += 1
        try:
            self._cache.save(lut)
        except OSError as error:
            self._complain(f"a finished bake could not be kept in {self.folder}: {error.strerror}")

    def _threads_of_one(self):
        """Threads of one bake; 0 is all."""
        if self._threads is not None:
            return self._threads
        chosen = preferences.threads()
        return chosen if self._jobs == 1 else max(1, (chosen or os.cpu_count() or 1) // self._jobs)
