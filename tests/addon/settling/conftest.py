# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures for the tests of dust on Blender objects."""

import pytest


@pytest.fixture
def dust(addon, lamina):
    """The module that settles dust on objects; it needs Embree."""
    reason = addon.settling.object_dust.unavailable()
    assert not reason, reason
    return addon.settling.object_dust
