# SPDX-License-Identifier: GPL-3.0-or-later
"""Waiting for long work in a terminal: progress on the last line, and Ctrl-C."""

import concurrent.futures
import signal
import sys
import threading
import time

WIDTH = 66  # of the line of progress
SELDOM = 30.0  # seconds between lines where there is no terminal

_pressed = []  # Ctrl-C since the start of an Interruptible


def for_job(job):
    """Wait for a base.worker.Worker. On Ctrl-C, the work is cancelled, and KeyboardInterrupt raised."""
    told = time.monotonic()
    try:
        while not job.done:
            check()
            job.wait(0.1)
            _show(f"{job.fraction:4.0%} {job.text}")
            if not sys.stderr.isatty() and time.monotonic() - told > SELDOM:
                told = time.monotonic()
                print(f"lamina: {job.fraction:.0%} {job.text}", file=sys.stderr, flush=True)
    except KeyboardInterrupt:
        job.cancel()
        job.wait()
        raise
    finally:
        _show("")


def for_future(future, text):
    """The result of a concurrent.futures.Future. Raises its exception, or KeyboardInterrupt on Ctrl-C."""
    try:
        while True:
            check()
            try:
                return future.result(timeout=0.1)
            except concurrent.futures.TimeoutError:
                if future.done():  # an exception of the work itself
                    raise
                _show(text)
    finally:
        _show("")


def _show(text):
    if sys.stderr.isatty():
        line = f"{text:<{WIDTH}.{WIDTH}}"
        print(f"\r{line}" if text else f"\r{line}\r", end="", file=sys.stderr, flush=True)


def check():
    """Raises KeyboardInterrupt if Ctrl-C was pressed in an Interruptible."""
    if _pressed:
        raise KeyboardInterrupt


class Interruptible:
    """Ctrl-C is noted in here, and `check` raises KeyboardInterrupt. Blender itself does not pass it on to
    Python, and it drops what is raised in Python code that it calls, such as a render engine."""

    def __enter__(self):
        self._before = None
        self._main = threading.current_thread() is threading.main_thread()
        if self._main:
            self._before = signal.signal(signal.SIGINT, lambda *_: _pressed.append(True))

    def __exit__(self, *_):
        if self._main and self._before is not None:
            signal.signal(signal.SIGINT, self._before)
        _pressed.clear()
