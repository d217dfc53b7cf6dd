# SPDX-License-Identifier: GPL-3.0-or-later
"""Hard edges: a vertex has dust for each of its normals; smooth surfaces are unchanged."""

import math

import numpy as np
import pytest
from dust_meshes import box, moved, plate, sphere, subdivided, torus
from needs_embree import with_embree
from z_limit import z_limit

from lamina import dust
from lamina.dust import Mesh, Settling, settle, texel_points
from lamina.settling import corners
from lamina.settling.corners import corners_of
from lamina.settling.mesh import checked_mesh, vertex_points

pytestmark = with_embree

CUBE = box((-1, -1, -1), (1, 1, 1))


def cylinder(sides=24, radius=1.0, height=2.0):
    """Closed, with a vertex in the middle of either cap."""
    phi = 2.0 * np.pi * np.arange(sides) / sides
    ring = radius * np.column_stack([np.cos(phi), np.sin(phi)])
    vertices = np.vstack([np.column_stack([ring, np.zeros(sides)]), np.column_stack([ring, np.full(sides, height)]),
                          [[0, 0, 0], [0, 0, height]]])
    k = np.arange(sides)
    after = (k + 1) % sides
    return Mesh(vertices, np.vstack([np.column_stack(t) for t in (
        (k, after, after + sides), (k, after + sides, k + sides),
        (k + sides, after + sides, np.full(sides, 2 * sides + 1)),
        (after, k, np.full(sides, 2 * sides)))]))


def groove(slope, length=50.0, width=1.0):
    """A valley along y, whose bottom line has vertices at its ends and in the middle."""
    height = width * math.tan(math.radians(slope))
    rows = np.array([[x, y, abs(x) / width * height] for y in (-length, 0, length) for x in (-width, 0, width)], float)
    return Mesh(rows, [[r + k, r + k + 1, r + k + 4] for r in (0, 3) for k in (0, 1)]
                + [[r + k, r + k + 4, r + k + 3] for r in (0, 3) for k in (0, 1)])


def face_normals(mesh):
    corners = mesh.vertices[mesh.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return cross / np.linalg.norm(cross, axis=1)[:, None]


@pytest.mark.parametrize("mesh", [CUBE, box((-3, -1, 0), (3, 1, 0.02)), cylinder(), subdivided(subdivided(CUBE))],
                         ids=["cube", "table", "cylinder", "fine cube"])
@pytest.mark.parametrize("by_corner", [False, True], ids=["by angle", "given"])
def test_an_open_top_has_the_amount(mesh, by_corner):
    if by_corner:
        mesh = Mesh(mesh.vertices, mesh.triangles, np.repeat(face_normals(mesh)[:, None], 3, axis=1))
    found = settle(mesh, settings=Settling(amount=2.0, rays=64), threads=1)
    up = face_normals(mesh)[:, 2]
    np.testing.assert_allclose(found.tau[found.corners][up > 0.99], 2.0, rtol=1e-5)
    assert np.all(found.tau[found.corners][up < -0.99] == 0.0)
    np.testing.assert_array_equal(found.vertices[found.corners], mesh.triangles)
    np.testing.assert_array_equal(found.vertices[:len(mesh.vertices)], np.arange(len(mesh.vertices)))


def test_the_dust_of_a_cube_is_what_falls_on_it():
    """The points' sum against grains from above: 70 % too little before, when its corners had one normal."""
    for mesh in (CUBE, cylinder(), moved(CUBE, np.array([[1, 0, 0], [0, 0.6, -0.8], [0, 0.8, 0.6]]))):
        statistics = settle(mesh, settings=Settling(rays=1024, spread=0.8), threads=1).statistics
        assert abs(statistics.arrived - statistics.fell) < z_limit(3) * statistics.fell_stderr + 2e-3 * statistics.fell
        assert statistics.notes == ()


@pytest.mark.parametrize("slope", [20.0, 50.0, 60.0])
def test_the_bottom_of_a_groove_has_each_walls_own(slope):
    """cos(slope) arrives, less the part of the cone that the other wall stops. A share of it by the slope does not
    slide. Of the rest, concavity keeps one half of what the other wall hides, (1 + cos(interior angle)) / 2 of the
    cosine-weighted hemisphere.
    """
    mesh = groove(slope)
    settings = Settling(rays=8192)
    found = settle(mesh, settings=settings, threads=1)
    angle = math.radians(slope)
    arrives = _arrives(angle, settings.spread)
    x = np.clip((slope - 45.0) / 20.0 + 0.5, 0.0, 1.0)
    lies = 1.0 - x * x * (3.0 - 2.0 * x)
    hidden = 0.5 * (1.0 + math.cos(math.pi - 2.0 * angle))
    truth = arrives * (lies + (1.0 - lies) * settings.concavity * hidden)
    bottom = found.tau[found.vertices == 4]
    assert len(bottom) == 2
    np.testing.assert_allclose(bottom, truth, atol=0.006)
    if slope == 50.0:
        assert truth == pytest.approx(0.26, abs=0.002)
        # At the ends of the line there is only a part of the other wall.
        truth = arrives * (lies + (1.0 - lies) * settings.concavity * _hidden_at_the_end(angle))
        np.testing.assert_allclose(found.tau[np.isin(found.vertices, (1, 7))], truth, atol=0.006)


def _hidden_at_the_end(slope):
    """Share of the cosine-weighted hemisphere over a wall, just off the end of the bottom line, half way between the
    line and the wall's own end, that the other wall hides; by brute quadrature."""
    square, phi = np.meshgrid((np.arange(1000) + 0.5) / 1000, 2.0 * np.pi * (np.arange(2000) + 0.5) / 2000)
    up_wall, along_line = np.sqrt(square) * np.cos(phi), np.sqrt(square) * np.sin(phi)
    off_wall = np.sqrt(1.0 - square)
    # The other wall through the line, at the interior angle: n = (-sin, cos) in (up the wall, off the wall) is behind.
    sine, cosine = math.sin(math.pi - 2.0 * slope), math.cos(math.pi - 2.0 * slope)
    towards = -(up_wall * sine - off_wall * cosine)  # per length, to the plane at distance sine of the point (1, 0)
    with np.errstate(divide="ignore"):
        length = np.where(towards > 0.0, sine / towards, np.inf)
    up_the_other = (1.0 + length * up_wall) * cosine + length * off_wall * sine
    hit = np.isfinite(length) & (1.0 + length * along_line > 0.0)
    assert np.all(up_the_other[hit] > -1e-9)
    return hit.mean()


def _arrives(slope, spread):
    """The mean of n.d over the cone, for directions that neither wall of the groove hides, by brute quadrature."""
    xi, phi = np.meshgrid((np.arange(2000) + 0.5) / 2000, 2.0 * np.pi * (np.arange(720) + 0.5) / 720)
    sine = np.sin(spread) * np.sqrt(xi)
    across = sine / np.sqrt(1.0 - sine * sine) * np.cos(phi)
    weight = math.cos(slope) + math.sin(slope) * across
    return np.where(np.abs(across) < 1.0 / math.tan(slope), np.maximum(weight, 0.0), 0.0).mean()


def test_points_move_off_edges_alike_in_blocks(monkeypatch):
    mesh = checked_mesh(subdivided(subdivided(CUBE)), "mesh")
    found = corners_of(mesh)
    points = vertex_points(mesh, corners=found)
    whole = corners.moved_off_edges(mesh, points, found, 1e-3)
    assert (np.linalg.norm(whole.positions - points.positions, axis=1) > 0).sum() > 24
    monkeypatch.setattr(corners, "BLOCK", 5)
    assert corners.moved_off_edges(mesh, points, found, 1e-3).positions.tobytes() == whole.positions.tobytes()


def test_the_angle_limit():
    faces = cylinder(12)  # 30 degrees between its sides
    for degrees, points in ((29.9, 12 * 6 + 2), (30.0, 12 * 4 + 2), (89.9, 12 * 4 + 2), (90.0, 26), (180.0, 26)):
        mesh = Mesh(faces.vertices, faces.triangles, sharp_angle=math.radians(degrees))
        assert len(settle(mesh, settings=Settling(rays=4)).tau) == points, degrees


def test_smooth_surfaces_stay_as_they_are():
    """Equal point by point to the result with one normal per vertex."""
    for mesh in (torus(60, 30), sphere(24, 48), plate(6)):
        smooth = Mesh(mesh.vertices, mesh.triangles, sharp_angle=math.pi)
        one, other = (settle(surface, settings=Settling(rays=64), threads=1) for surface in (mesh, smooth))
        assert one.tau.tobytes() == other.tau.tobytes()
        np.testing.assert_array_equal(one.corners, mesh.triangles)


def test_corners_by_edges_are_those_by_a_walk():
    """Groups of corners against a plain search over shared edges, on a soup with edges of many faces."""
    rng = np.random.default_rng(5)
    mesh = checked_mesh(Mesh(rng.normal(size=(30, 3)), rng.integers(0, 30, (120, 3)), sharp_angle=1.2), "soup")
    corners = corners_of(mesh)
    with np.errstate(invalid="ignore"):
        normals = face_normals(mesh)
    whole = np.array([len(set(t)) == 3 for t in mesh.triangles.tolist()])
    for v in range(30):
        owners = [t for t in range(120) if whole[t] and v in mesh.triangles[t]]
        group = {t: t for t in owners}
        for _ in owners:
            for a in owners:
                for b in owners:
                    shared = set(mesh.triangles[a].tolist()) & set(mesh.triangles[b].tolist())
                    if len(shared) > 1 and normals[a] @ normals[b] >= math.cos(1.2) - 1e-5:
                        group[a] = group[b] = min(group[a], group[b])
        point = {t: corners.point[t, mesh.triangles[t].tolist().index(v)] for t in owners}
        for a in owners:
            for b in owners:
                assert (point[a] == point[b]) == (group[a] == group[b])
    np.testing.assert_array_equal(corners.vertex[corners.point], mesh.triangles)


def test_given_normals_of_one_direction_are_one_point():
    fan = 400  # more normals at the tip than are compared with one another
    phi = 2.0 * np.pi * np.arange(fan) / fan
    cone = Mesh(np.vstack([[[0, 0, 1]], np.column_stack([np.cos(phi), np.sin(phi), np.zeros(fan)])]),
                np.column_stack([np.zeros(fan, int), 1 + np.arange(fan), 1 + (np.arange(fan) + 1) % fan]))
    flat = Mesh(cone.vertices, cone.triangles, np.repeat(face_normals(cone)[:, None], 3, axis=1))
    found = settle(flat, settings=Settling(rays=16, spread=0.2, repose=math.pi))
    np.testing.assert_allclose(found.tau[found.corners], math.sqrt(0.5), rtol=1e-4)
    one = Mesh(cone.vertices, cone.triangles, np.tile([0.0, 0.0, 2.0], (fan, 3, 1)))
    assert len(settle(one, settings=Settling(rays=4)).tau) == len(cone.vertices)


def test_texels_have_the_normals_of_their_triangle():
    uvs = np.array([[[0.5 * k, 0], [0.5 * k + 0.5, 0], [0.5 * k, 1]] for k in (0, 1)], float)
    two = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2], [0, 2, 3]])
    points, mask = texel_points(two, uvs, 32)
    left = np.nonzero(mask)[1] < 16
    np.testing.assert_allclose(points.normals[left], np.tile([0, 0, 1.0], (left.sum(), 1)), atol=1e-12)
    np.testing.assert_allclose(points.normals[~left], np.tile([1.0, 0, 0], ((~left).sum(), 1)), atol=1e-12)


def test_normals_by_corner_are_checked():
    with pytest.raises(dust.DustError, match=r"normals has shape \(2, 3, 3\): must be \(12, 3, 3\), or \(8, 3\)"):
        settle(Mesh(CUBE.vertices, CUBE.triangles, np.zeros((2, 3, 3))))
    with pytest.raises(dust.DustError, match=r"normals: must be numbers of shape"):
        settle(Mesh(CUBE.vertices, CUBE.triangles, [[[0, 0], [1]]]))
    for angle in (-0.1, 3.2, float("nan"), "flat", None):
        with pytest.raises(dust.DustError, match=r"sharp_angle = .*: must lie in \[0, 3.14159\]"):
            settle(Mesh(CUBE.vertices, CUBE.triangles, sharp_angle=angle))
    odd = np.zeros((12, 3, 3))
    assert np.all(settle(Mesh(CUBE.vertices, CUBE.triangles, odd), settings=Settling(rays=4)).tau == 0.0)


def test_areas_are_those_of_the_faces():
    points = vertex_points(checked_mesh(CUBE, "cube"), corners=corners_of(checked_mesh(CUBE, "cube")))
    assert len(points.areas) == 24
    assert points.areas.sum() == pytest.approx(24.0)
    np.testing.assert_allclose(np.abs(points.normals).max(axis=1), np.linalg.norm(points.normals, axis=1))
