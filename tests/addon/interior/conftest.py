# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the tests of interiors."""

import pytest


@pytest.fixture
def jobs(addon, lamina):
    from bl_ext.user_default.lamina.interior import interior_job

    yield interior_job
    interior_job.stop()
