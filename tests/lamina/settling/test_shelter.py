# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that cannot keep dust off a surface are left out, and the dust is the same with all of them."""

import numpy as np
import pytest
from needs_embree import with_embree

from lamina import dust
from lamina.settling import sky

BOX = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
TRIANGLES = np.array([t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))], np.uint32)


def box(centre, size, name):
    return dust.Mesh(np.array(centre) + 0.5 * np.array(size) * BOX, TRIANGLES, name=name)


def boxes(seed):
    """60 boxes of many sizes, also below and far above a box at the origin."""
    draw = np.random.default_rng(seed)
    places = draw.uniform(-12.0, 12.0, (60, 3))
    places[np.abs(places).max(axis=1) < 1.5] += 3.0
    return [box(place, draw.uniform(0.1, 1.5, 3), f"box {k}") for k, place in enumerate(places)]


@with_embree
@pytest.mark.parametrize("more", [{}, {"spread": 1.2, "wind": (1.5, -0.5, 0.0)}, {"reach": 4.0, "gravity": (1, 0, -1)}])
def test_the_dust_has_the_same_bytes_with_all_meshes(monkeypatch, more):
    surface, settings = box((0, 0, 0), (1, 1, 1), "surface"), dust.Settling(rays=64, **more)
    kept = []

    def counted(*given):
        kept.append(len(sheltering(*given)))
        return sheltering(*given)

    sheltering = sky.sheltering
    for seed in range(6):
        monkeypatch.setattr(sky, "sheltering", counted)
        found = dust.settle(surface, None, boxes(seed), settings, seed=seed)
        monkeypatch.setattr(sky, "sheltering", lambda _surface, occluders, *_: occluders)
        every = dust.settle(surface, None, boxes(seed), settings, seed=seed)
        assert found.tau.tobytes() == every.tau.tobytes() and found.arrived.tobytes() == every.arrived.tobytes()
        one, other = found.statistics, every.statistics
        assert (one.fell, one.behind, one.keepers, one.notes) == (other.fell, other.behind, other.keepers, other.notes)
        # Grains that miss the surface may meet meshes below it.
        assert one.stopped + one.missed == pytest.approx(other.stopped + other.missed, rel=1e-12)
    assert min(kept) > 0 and max(kept) < 60


@with_embree
def test_a_roof_far_above_counts_and_a_neighbour_far_beside_does_not():
    surface, settings = box((0, 0, 0), (1, 1, 1), "surface"), dust.Settling(rays=64, spread=0.1)
    roof, beside, floor = box((0, 0, 50), (30, 30, 1), "roof"), box((9, 0, 0), (1, 1, 5), "beside"), box(
        (0, 0, -3), (50, 50, 1), "floor")
    names = sky.Sky(surface, [roof, beside, floor], settings, 0).names
    assert names == ["roof"]
    assert dust.settle(surface, None, [roof], settings).tau.max() == 0.0
