# SPDX-License-Identifier: GPL-3.0-or-later
"""The thread pool: any thread count gives the same bytes, and errors come back from its tasks."""

import threading

import numpy as np
import pytest

from lamina import _core

MU = np.array([0.1, 0.5, 1.0])
STACK = _core.Stack([_core.Medium(0.9, 2.0, "hg", 0.75), _core.Medium(0.99, 0.5, "rayleigh")], _core.Base.lambert(0.4))


def values(pool):
    solution = _core.solve(STACK, 1e-3, pool)
    return solution.grid(_core.Side.top, _core.Path.reflect, MU, MU, MU, pool).tobytes()


def test_counts():
    assert [_core.ThreadPool(n).threads for n in (1, 2, 5)] == [1, 2, 5]
    assert _core.ThreadPool(0).threads >= 1


def test_any_number_of_threads_gives_the_same_bytes():
    assert len({values(_core.ThreadPool(n)) for n in (1, 2, 3, 8)}) == 1


@pytest.mark.parametrize("threads", [1, 2, 4])
def test_errors_in_tasks_come_back_and_the_pool_lives_on(threads):
    pool = _core.ThreadPool(threads)
    # An albedo of 3 is no medium: the matrices that the tasks factorise are not positive.
    impossible = _core.Stack([_core.Medium(3.0, 1.0, "hg", 0.9)])
    for _ in range(3):
        with pytest.raises(RuntimeError, match="not positive"):
            _core.solve_at(impossible, 16, 1e-3, pool)
    assert values(pool) == values(_core.ThreadPool(1))


def test_one_pool_serves_several_callers():
    pool, found = _core.ThreadPool(2), []

    def work():
        found.extend(values(pool) for _ in range(5))

    callers = [threading.Thread(target=work) for _ in range(4)]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join(timeout=60)
    assert not any(caller.is_alive() for caller in callers)
    assert len(found) == 20 and set(found) == {values(_core.ThreadPool(1))}


def test_pools_come_and_go():
    for _ in range(200):
        _core.ThreadPool(4)
