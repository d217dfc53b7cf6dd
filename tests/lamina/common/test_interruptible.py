# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl-C and `cancel` end long solves and searchlights; progress rises to 1."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import lamina
from lamina import _core
from lamina.common.interruptible import interruptible

# Each takes many seconds where nobody stops it.
SHEET = lamina.Stack([lamina.Interface(1.366), lamina.Interface(1.203), lamina.Interface(1.434, 0.04),
                      lamina.Medium(0.9, 2.0, lamina.HenyeyGreenstein(0.9)), lamina.Interface(1.0, 0.04)])
GRADED = lamina.Stack([lamina.Medium(
    thickness=1.0, phase=lamina.HenyeyGreenstein(0.8),
    profile=[lamina.Knot(0.0, sigma_s=1.0, sigma_a=0.01), lamina.Knot(1.0, sigma_s=5.0, sigma_a=0.1)])])
LONG = {"solve": lambda **more: lamina.solve(SHEET, **more),
        "searchlight": lambda **more: lamina.searchlight(GRADED, **more)}
SOON = 5.0  # seconds from the wish to the end: one task of the pool, on a busy machine


@pytest.mark.parametrize("name", LONG)
def test_cancel_is_asked_during_the_work(name):
    asked = []

    def cancel():
        asked.append(time.monotonic())
        return len(asked) == 6

    with pytest.raises(lamina.Cancelled, match=f"the {name} was cancelled"):
        LONG[name](cancel=cancel)
    assert len(asked) == 6 and time.monotonic() - asked[-1] < SOON


@pytest.mark.parametrize("name", LONG)
def test_control_c_ends_the_work(name):
    """In a process of its own, with Python's handler: processes that a shell starts in the background ignore Ctrl-C."""
    code = ("import signal, test_interruptible as t; signal.signal(signal.SIGINT, signal.default_int_handler); "
            f"t.LONG[{name!r}](progress=lambda *_: print('begun', flush=True))")
    with subprocess.Popen([sys.executable, "-c", code], cwd=Path(__file__).parent, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout.readline() == "begun\n"
        process.send_signal(signal.SIGINT)
        sent = time.monotonic()
        _, errors = process.communicate(timeout=60.0)
    assert time.monotonic() - sent < SOON and errors.rstrip().endswith("KeyboardInterrupt"), errors


@pytest.mark.parametrize("alpha", [0.1, 0.02])
def test_progress_of_a_solve_rises_to_1(alpha):
    """Narrow facets are solved in two parts."""
    told = []
    stack = lamina.Stack([lamina.Medium(albedo=[0.3, 0.5, 0.7], tau=1.0)], lamina.Conductor(1.2, 3.0, alpha=alpha))
    lamina.solve(stack, "preview", progress=lambda fraction, text: told.append(fraction))
    assert told == sorted(told) and told[-1] == 1.0


def test_errors_of_the_work_are_passed_on():
    pool = _core.ThreadPool(1)
    for ask in (None, lambda: None):
        with pytest.raises(ZeroDivisionError):
            interruptible(pool, lambda: 1 // 0, ask)
    assert interruptible(pool, lambda: 5, None) == 5
