# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust of several moments: sums of thickness and mass, and refusal of moments on different points."""

import numpy as np
import pytest
from dust_meshes import plate
from needs_embree import with_embree

from lamina import dust

pytestmark = with_embree


def settled(amount, roof=None, **more):
    settings = dust.Settling(amount=amount, spread=0.0, repose=np.pi, rays=16, **more)
    return dust.settle(plate(), occluders=() if roof is None else (roof,), settings=settings, seed=3)


def test_dust_of_two_moments_adds_up():
    """A roof covers one half in the first moment, the other half in the second: both halves get one moment's dust."""
    parts = [settled(0.5, plate(size=1.2, height=0.4, centre=(shift, 0.0))) for shift in (-0.62, 0.62)]
    both = dust.accumulate(parts)
    aside = np.abs(plate().vertices[:, 0]) > 0.1
    assert parts[0].tau[aside].min() == 0.0 and parts[0].tau[aside].max() == pytest.approx(0.5)
    assert both.tau[aside] == pytest.approx(0.5, abs=1e-6)
    assert np.array_equal(both.arrived, (parts[0].arrived.astype(float) + parts[1].arrived).astype(np.float32))
    first, second, total = (one.statistics for one in (*parts, both))
    for name in ("arrived", "deposited", "slid", "wiped", "launched", "fell", "stopped", "missed", "grains", "rays"):
        assert getattr(total, name) == pytest.approx(getattr(first, name) + getattr(second, name)), name
    assert total.fell_stderr == pytest.approx(np.hypot(first.fell_stderr, second.fell_stderr))
    assert total.maximum == both.tau.max()


def test_equal_parts_equal_one_settling_of_the_sum():
    table = plate(size=0.4, height=0.3)
    parts = [settled(0.25, table) for _ in range(4)]
    whole = settled(1.0, table)
    assert dust.accumulate(parts).tau == pytest.approx(whole.tau, rel=1e-6)
    assert dust.accumulate(parts[:1]).tau.tobytes() == parts[0].tau.tobytes()


def test_both_sides_add_up():
    parts = [settled(0.5, two_sided=True) for _ in range(2)]
    assert dust.accumulate(parts).back == pytest.approx(2.0 * parts[0].back)


def test_bad_moments_are_refused():
    with pytest.raises(dust.DustError, match="at least one moment"):
        dust.accumulate([])
    other = dust.settle(plate(cells=4), settings=dust.Settling(rays=4))
    with pytest.raises(dust.DustError, match=r"moments\[1\] lies on other points"):
        dust.accumulate([settled(1.0), other])
    with pytest.raises(dust.DustError, match=r"moments\[1\] lies on other points"):
        dust.accumulate([settled(1.0), settled(1.0, two_sided=True)])
