# SPDX-License-Identifier: GPL-3.0-or-later
"""What a thread of a worker keeps from one part of a run to the next, such as a mesh that is ready for rays."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

_own = threading.local()


def kept(run: Any, make: Callable[[], Any]) -> Any:
    """What `make` made in this thread's last call if `run` is equal to that of the call, otherwise make().

    Most parts of a worker belong to one run, so each thread keeps one thing. Threads have their own: in one that they
    share, they would wait for each other."""
    if getattr(_own, "run", None) != run:
        _own.run = _own.thing = None  # frees the memory first
        _own.thing = make()
        _own.run = run
    return _own.thing
