# SPDX-License-Identifier: GPL-3.0-or-later
"""Long calls of the core that Ctrl-C and `cancel` can stop."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TypeVar

from .. import _core

Result = TypeVar("Result")
PAUSE = 0.05  # seconds between two calls of `ask`


def interruptible(pool: _core.ThreadPool, call: Callable[[], Result], ask: Callable[[], object] | None) -> Result:
    """The result of `call`, which works on `pool`. Meanwhile calls `ask` from time to time. If `ask` raises, or after
    Ctrl-C, the pool is stopped for good and the exception is passed on.

    Python handles Ctrl-C in its main thread alone, so a call elsewhere without `ask` is made directly."""
    if ask is None and threading.current_thread() is not threading.main_thread():
        return call()
    outcome: list[Result] = []
    failure: list[BaseException] = []
    # An event, since in Python 3.11 a join that Ctrl-C interrupts marks a running thread as ended.
    ended = threading.Event()

    def work() -> None:
        try:
            outcome.append(call())
        except BaseException as error:
            failure.append(error)
        ended.set()

    threading.Thread(target=work, name="lamina", daemon=True).start()
    try:
        while not ended.wait(PAUSE):
            if ask is not None:
                ask()
    except BaseException:
        pool.stop()
        ended.wait()
        raise
    if failure:
        raise failure[0]
    return outcome[0]
