# SPDX-License-Identifier: GPL-3.0-or-later
"""The grid of distances inside a solid."""

import numpy as np
import pytest

from lamina.settling import embree

pytestmark = pytest.mark.skipif(bool(embree.why_not()), reason=embree.why_not())


def ball(rings=40, around=60):
    """(vertices, triangles, planes) of a sphere of radius 1, stretched to an ellipsoid along x; planes as (normal,
    offset) of each face, for exact distances from inside."""
    turns = 2 * np.pi * np.arange(around) / around
    theta, phi = np.meshgrid(np.pi * np.arange(rings + 1) / rings, turns, indexing="ij")
    vertices = np.stack([2.0 * np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    i, j = np.meshgrid(np.arange(rings), np.arange(around), indexing="ij")
    a, b = i * around + j, i * around + (j + 1) % around
    c, d = a + around, b + around
    triangles = np.vstack([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, c, b), (b, c, d))])
    vertices = vertices.reshape(-1, 3)
    corners = vertices[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    normal, corners = normal[length > 1e-9] / length[length > 1e-9, None], corners[length > 1e-9]
    return vertices, triangles, (normal, np.einsum("ij,ij->i", normal, corners[:, 0]))


def test_clearances_never_exceed_the_distance_and_come_near():
    vertices, triangles, (normal, offset) = ball()
    solid = embree.layer().Solid(vertices.astype(np.float32), triangles.astype(np.uint32), 2, lambda fraction: None)
    rng = np.random.default_rng(1)
    places = rng.uniform(-1.0, 1.0, (4000, 3)) * [2.0, 1.0, 1.0]
    away = (offset - places @ normal.T).min(axis=1)  # of a convex solid: to the nearest plane
    places, away = places[away > 0.0], away[away > 0.0]
    assert len(places) > 1000
    found = np.array([solid.clearance(place) for place in places])
    assert (found <= away + 1e-5).all()
    cell = (4.0 * 2.0 * 2.0 / 2**18) ** (1 / 3)
    # Half a diagonal each for the cell of the surface, twice, and for the place in its own cell, twice.
    assert (found >= away - 2.0 * 3.0**0.5 * cell - 1e-5).all()
    exact = solid.distances(places.astype(np.float32), 10.0)
    np.testing.assert_allclose(exact, away, atol=1e-4)
    assert solid.distances(places.astype(np.float32), 0.05).max() == np.float32(0.05)
    assert solid.clearance((5.0, 0.0, 0.0)) == 0.0


def test_a_build_can_be_stopped():
    vertices, triangles, _ = ball()

    def stop(fraction):
        raise KeyError("enough")

    with pytest.raises(KeyError):
        embree.layer().Solid(vertices.astype(np.float32), triangles.astype(np.uint32), 1, stop)
