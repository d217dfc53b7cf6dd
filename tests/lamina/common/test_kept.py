# SPDX-License-Identifier: GPL-3.0-or-later
"""A thread of a worker makes a thing once per run. Threads share none, and an old one is freed before the next."""

import gc
import threading
import weakref

import pytest

from lamina.common.kept import kept


class Thing:
    pass


def test_a_thing_is_made_once_per_run_and_thread():
    here = [kept({"seed": 1}, Thing) for _ in range(2)]
    assert here[0] is here[1]
    there = []
    thread = threading.Thread(target=lambda: there.append(kept({"seed": 1}, Thing)))
    thread.start()
    thread.join()
    assert there[0] is not here[0] and kept({"seed": 1}, Thing) is here[0]


def test_the_old_thing_is_freed_before_the_next_is_made():
    old, seen = weakref.ref(kept("one run", Thing)), []

    def make():
        gc.collect()
        seen.append(old())
        return Thing()

    kept("another run", make)
    assert seen == [None]


def test_after_an_error_a_thing_is_made_anew():
    def fail():
        raise MemoryError

    for _ in range(2):
        with pytest.raises(MemoryError):
            kept("a run", fail)
    assert isinstance(kept("a run", Thing), Thing)
