# SPDX-License-Identifier: GPL-3.0-or-later
"""Rubbed edges: dust is thinner at convex edges, and nowhere else."""

import math

import numpy as np
import pytest
from dust_meshes import box, moved, plate, sphere, subdivided
from needs_embree import with_embree

from lamina.dust import Mesh, Points, Settling, settle, settle_image

pytestmark = with_embree

CUBE = box((-1, -1, -1), (1, 1, 1))
EDGE = 0.2
PLAIN = Settling(rays=1024)
RUBBED = Settling(rubbed=0.8, edge=EDGE, rays=1024)


def points(positions, normal=(0.0, 0.0, 1.0)):
    return Points(np.array(positions, float), np.tile(np.array(normal, float), (len(positions), 1)))


def kept(mesh, places, settings=RUBBED, normal=(0.0, 0.0, 1.0), seed=0):
    """Dust on points of a mesh, over that without rubbing."""
    at = points(places, normal)
    return settle(mesh, at, settings=settings, seed=seed, threads=1).tau / settle(
        mesh, at, settings=PLAIN, seed=seed, threads=1).tau


def at_edge(distance):
    """The convexity beside an edge of 90 degrees by quadrature: rays from a plane, by the cosine, leave through the
    other one after distance / sin(theta) / cos(phi)."""
    u, phi = (np.arange(2000) + 0.5) / 2000, 0.5 * np.pi * (np.arange(2000) + 0.5) / 2000
    way = distance / EDGE / (np.sqrt(u)[:, None] * np.cos(phi))
    return min(1.0, 2.0 * np.clip(1.0 - way, 0.0, None).mean() / 2.0)


def test_dust_is_thinner_beside_an_edge_as_by_quadrature():
    distances = np.array([0.002, 0.02, 0.05, 0.1, 0.15])
    found = kept(CUBE, [(1.0 - d, 0.1, 1.0) for d in distances], Settling(rubbed=0.8, edge=EDGE, rays=16384))
    # 4096 rays with at most half of them cut: the pattern's error is below that of independent rays.
    np.testing.assert_allclose(found, [1.0 - 0.8 * at_edge(d) for d in distances], atol=4.0 * 0.8 / math.sqrt(4096))
    assert np.all(np.diff(found) > 0.0) and found[0] < 0.3


def test_middles_concave_corners_and_flat_ground_keep_their_dust():
    stair = Mesh(*_extruded([(0, 0), (3, 0), (3, 1), (1.5, 1), (1.5, 2), (0, 2)]))
    inner = [(2.99, 0.5, 1.0), (1.51, 0.5, 1.0), (0.75, 0.5, 2.0)]
    assert kept(stair, inner)[0] < 0.9, "the outer edge of a step"
    np.testing.assert_array_equal(kept(stair, inner)[1:], 1.0)
    np.testing.assert_array_equal(kept(CUBE, [(0.0, 0.0, 1.0), (0.75, 0.7, 1.0)]), 1.0)
    np.testing.assert_array_equal(kept(plate(), [(0.1, 0.2, 0.0), (0.499, 0.1, 0.0)]), 1.0)


def test_a_thin_plate_is_rubbed_at_its_rim_only():
    slab = box((-1, -1, 0), (1, 1, 0.02))
    found = kept(slab, [(0.0, 0.3, 0.02), (0.999, 0.0, 0.02)])
    assert found[0] == 1.0 and found[1] < 0.6


def test_a_smooth_sphere_keeps_nearly_all():
    """Rays up to `edge` leave a sphere near the tangent: the share (edge / 2 r)^2 of them."""
    ball = sphere(rows=96, columns=192)
    assert kept(ball, [(0.0, 0.0, 1.0)])[0] > 1.0 - 0.8 * 2.0 * (0.5 * EDGE) ** 2


@pytest.mark.parametrize("rubbed", [0.0, 0.5])
def test_the_share_is_linear_and_zero_changes_nothing(rubbed):
    mesh = subdivided(subdivided(subdivided(CUBE)))
    full = settle(mesh, settings=Settling(rubbed=1.0, edge=EDGE), threads=1).tau
    none = settle(mesh, settings=Settling(), threads=1).tau
    found = settle(mesh, settings=Settling(rubbed=rubbed, edge=EDGE), threads=1).tau
    np.testing.assert_allclose(found, (1.0 - rubbed) * none + rubbed * full, rtol=1e-5, atol=1e-7)
    assert full.min() >= 0.0 and np.all(full <= none)
    if rubbed == 0.0:
        assert found.tobytes() == none.tobytes()


def test_the_bytes_do_not_depend_on_threads():
    mesh = subdivided(subdivided(CUBE))
    how = Settling(rubbed=0.7, rays=64)
    one, three = (settle(mesh, settings=how, seed=3, threads=threads) for threads in (1, 3))
    assert one.tau.tobytes() == three.tau.tobytes()
    assert one.statistics.wiped > 0.0
    arrived = one.statistics.deposited + one.statistics.slid + one.statistics.wiped
    assert arrived == pytest.approx(one.statistics.arrived, rel=1e-5)


def test_size_and_place_do_not_matter():
    """The default width is relative to the surface."""
    mesh = subdivided(subdivided(subdivided(subdivided(CUBE))))
    large = moved(mesh, shift=(50.0, -20.0, 7.0), scale=100.0)
    how = Settling(rubbed=0.9, rays=256)
    a, b = (settle(one, settings=how, threads=1).tau for one in (mesh, large))
    assert (a < 0.5).any()
    np.testing.assert_allclose(a, b, atol=0.02)


@pytest.mark.parametrize("up", [1.0, -1.0])
def test_two_sided_dust_is_rubbed_on_the_side_where_it_lies(up):
    """Also with turned normals, where the body lies in front of the face."""
    turned = Mesh(CUBE.vertices, CUBE.triangles[:, ::-1] if up < 0.0 else CUBE.triangles)
    places, sides = [(0.99, 0.1, 1.0), (0.0, 0.0, 1.0)], Settling(two_sided=True, rays=256)
    at = points(places, (0.0, 0.0, up))
    plain = settle(turned, at, settings=sides, threads=1).tau
    found = settle(turned, at, settings=Settling(two_sided=True, rubbed=1.0, edge=EDGE, rays=256), threads=1).tau
    assert found[0] < 0.3 * plain[0] and found[1] == plain[1]


def test_an_image_has_a_soft_shoulder():
    """Across the top of a cube: the amount in the middle, little at the edges, without a step in between."""
    top = Mesh(CUBE.vertices, CUBE.triangles)
    corners = top.vertices[top.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    is_top = normals[:, 2] > 0.99 * np.linalg.norm(normals, axis=1)
    uvs = np.where(is_top[:, None, None], 0.5 * corners[..., :2] + 0.5, -1.0)
    row = settle_image(top, uvs, 64, settings=Settling(rubbed=1.0, edge=EDGE, rays=1024), threads=1).tau[32]
    assert row[32] == pytest.approx(1.0) and row[0] < 0.35
    assert np.abs(np.diff(row)).max() < 0.35 and np.all(np.diff(row[:10]) > -0.03)


def _extruded(outline):
    """(vertices, triangles) of a body along y, closed at its sides, from an outline (x, z) counter-clockwise."""
    count = len(outline)
    vertices = [(x, y, z) for y in (0.0, 1.0) for x, z in outline]
    triangles = []
    for k in range(count):
        after = (k + 1) % count
        triangles += [(k, after, count + after), (k, count + after, count + k)]
    return np.array(vertices, float), np.array(triangles)[:, ::-1]
