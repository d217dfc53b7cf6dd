# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates of remaining time in words."""

import pytest

from lamina.common.progress import time_left


@pytest.mark.parametrize(("seconds", "words"), [
    (0.0, "about 1 second left"), (1.6, "about 2 seconds left"), (89.0, "about 89 seconds left"),
    (91.0, "about 2 minutes left"), (3600.0, "about 60 minutes left"), (9000.0, "about 2 hours left"),
])
def test_words(seconds, words):
    assert time_left(seconds) == words
