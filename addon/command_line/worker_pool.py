# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that bake stacks for a batch: each is a Blender of its own; with bpy as a module, a Python."""

import concurrent.futures
import contextlib
import json
import os
import subprocess
import sys
import threading
from collections import deque
from pathlib import Path

import bpy

from ..base import native
from ..base.messages import RefusedError
from . import stack_worker

ATTEMPTS = 2  # a process that was killed is replaced once for each bake
PATIENCE = 10.0  # seconds for a process to end by itself
KEPT_LINES = 5  # of what a process said last


class WorkerError(RefusedError):
    """A process ended before it answered."""


class WorkerPool:
    """Up to `count` processes; each bakes with this number of threads and writes tables to `folder`."""

    def __init__(self, count, threads, folder):
        self._request = {"threads": threads, "folder": str(folder)}
        self._executor = concurrent.futures.ThreadPoolExecutor(count, "lamina batch")
        self._lock, self._all, self._idle = threading.Lock(), [], []
        self._is_closed = False

    def submit(self, wanted):
        """A concurrent.futures.Future of the seconds that the bake takes; None if the process could not write
        the table. Raises what lamina.bake raises, and WorkerError."""
        request = {
            **self._request,
            "stack": wanted.stack.to_json(),
            "quality": wanted.quality,
            "basis": wanted.basis,
        }
        return self._executor.submit(self._run, json.dumps(request))

    def close(self):
        """End the processes; running bakes are cancelled."""
        with self._lock:
            self._is_closed = True
            processes = list(self._all)
        self._executor.shutdown(wait=False, cancel_futures=True)
        for one in processes:
            one.close_input()
        for one in processes:
            one.end()
        self._executor.shutdown(wait=True)

    def _run(self, request):
        for _ in range(ATTEMPTS):
            process = self._take()
            answer = process.ask(request)
            if answer is not None:
                with self._lock:
                    self._idle.append(process)
                return _seconds(answer)
            process.end()
        raise WorkerError(process.last_words())

    def _take(self):
        with self._lock:
            if self._is_closed:
                raise WorkerError("the batch has ended")
            if self._idle:
                return self._idle.pop()
            process = _Process()
            self._all.append(process)
            return process


def _seconds(answer):
    if "error" not in answer:
        return answer["seconds"]
    kind = getattr(native.require(), answer["kind"], None)
    if isinstance(kind, type) and issubclass(kind, Exception):
        raise kind(answer["error"])
    raise WorkerError(f"{answer['kind']}: {answer['error']}")


class _Process:
    def __init__(self):
        self._said = deque(maxlen=KEPT_LINES)
        # A group of its own, so that Ctrl-C in the terminal reaches the batch alone.
        group = (
            {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
            if os.name == "nt"
            else {"process_group": 0}
        )
        self._process = subprocess.Popen(
            _command(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            encoding="utf-8",
            errors="replace",
            **group,
        )

    def ask(self, request):
        """The answer, or None if the process ended before."""
        try:
            self._process.stdin.write(request + "\n")
            self._process.stdin.flush()
        except OSError:
            return None
        for line in self._process.stdout:
            if line.startswith(stack_worker.MARK):
                return json.loads(line.removeprefix(stack_worker.MARK))
            self._said.append(line.strip())
        return None

    def close_input(self):
        with contextlib.suppress(OSError):
            self._process.stdin.close()

    def end(self):
        """Wait for the end of the process, and kill it if it takes long."""
        self.close_input()
        try:
            self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def last_words(self):
        """How the process ended, as a sentence."""
        said = next((line for line in reversed(self._said) if line), "")
        code = self._process.returncode
        how = f"was ended by signal {-code}" if code is not None and code < 0 else f"ended with code {code}"
        return f"the process that baked it {how}" + (f": {said}" if said else "")


def _command():
    script = str(Path(stack_worker.__file__).resolve())
    package_folder = str(Path(native.require().__file__).resolve().parents[1])
    if bpy.app.binary_path:
        program = [
            bpy.app.binary_path,
            "--background",
            "--factory-startup",
            "--python-exit-code",
            "1",
            "--python",
            script,
            "--",
        ]
    else:
        program = [sys.executable, "-P", script]  # without the script's folder in the module search path
    return [*program, package_folder]
