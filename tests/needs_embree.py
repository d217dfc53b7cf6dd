# SPDX-License-Identifier: GPL-3.0-or-later
"""The mark of tests that trace rays."""

import pytest

from lamina import dust

with_embree = pytest.mark.skipif(bool(dust.available()), reason=dust.available())
