# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad interiors and meshes give an error of one sentence; saved interiors load unchanged."""

import math

import numpy as np
import pytest
from walk_meshes import box, sphere

import lamina
from lamina import ArgumentError, EndMaterial, Interior, InteriorError, Lamp, Surface
from lamina.interior.solid import closed

CORNERS = ((0, 0, 0), (1, 1, 1))
WHITE = EndMaterial(1.0)
PALETTE = [WHITE, EndMaterial(2.0, 0.5, 0.3)]
CUBE = box(*CORNERS)
NAN = np.where(np.arange(24).reshape(2, 3, 4) == 17, np.nan, 0.5)


@pytest.mark.parametrize(("make", "words"), [
    (lambda: EndMaterial(-1.0), r"sigma_s = -1: must lie in \[0, 65504\] 1/mm"),
    (lambda: EndMaterial(1.0, (0.1, np.nan, 0.2)), "sigma_a = nan: must lie in"),
    (lambda: EndMaterial((1.0, 2.0)), "sigma_s = .1.0, 2.0.: must be one number, or three"),
    (lambda: EndMaterial(10**400), "sigma_s = 1000.*: must be one number, or three"),
    (lambda: EndMaterial(1.0, 0.0, 1.0), r"g = 1.0: must lie in \[-0.999, 0.999\]"),
    (lambda: Interior.mixed(NAN, PALETTE, *CORNERS), r"coordinate\[1, 1, 1\] = nan: must lie in \[0, 1\]"),
    (lambda: Interior.mixed(np.full((2, 2, 2), 1.5), PALETTE, *CORNERS), r"coordinate\[0, 0, 0\] = 1.5: must lie in"),
    (lambda: Interior.mixed([0.5], PALETTE, *CORNERS), r"coordinate has the shape \(1,\): must be \(nx, ny, nz\)"),
    (lambda: Interior.mixed(np.zeros((2, 2, 2)), [], *CORNERS), "palette = .*: must be a list of 1 to 256"),
    (lambda: Interior.of_coefficients(10**400, NAN, *CORNERS), "sigma_s"),
    (lambda: Interior.of_coefficients(NAN, NAN, *CORNERS), r"sigma_s\[1, 1, 1\] = nan: must lie in"),
    (lambda: Interior.of_coefficients(0 * NAN[:1], -np.ones((1, 3, 4)), *CORNERS),
     r"sigma_a\[0, 0, 0\] = -1.0: must lie in \[0, 65504\] 1/mm"),
    (lambda: Interior.of_coefficients(np.ones((2, 2, 2)), np.ones((2, 2, 3)), *CORNERS), "sigma_a has the shape"),
    (lambda: Interior.of_coefficients(np.ones((2, 2, 2, 2)), np.ones((2, 2, 2)), *CORNERS), "sigma_s has the shape"),
    (lambda: Interior.mixed(np.zeros((2, 2, 2)), PALETTE, (0, 0, 0), (1, 0, 1)), "must be above low = .* along y"),
    (lambda: Interior.mixed(np.zeros((2, 2, 2)), PALETTE, (0, np.inf, 0), (1, 1, 1)), "low holds a value"),
])
def test_bad_interiors(make, words):
    with pytest.raises(InteriorError, match=words):
        make()


def turned(solid, faces):
    triangles = solid.triangles.copy()
    triangles[faces] = triangles[faces, ::-1]
    return lamina.Solid(solid.vertices, triangles)


@pytest.mark.parametrize(("solid", "words"), [
    (lamina.Solid(np.zeros((0, 3)), np.zeros((0, 3), int)), "solid.triangles is empty: must have faces"),
    (turned(CUBE, slice(None)), "solid is inside out, with a volume of -1 mm.3: flip its normals"),
    (turned(CUBE, [3]), "faces that disagree about which side is outside, as along the edge"),
    (lamina.Solid(CUBE.vertices, CUBE.triangles[:-1]),
     r"solid is open along 3 edges, as from \(.*close it .*Fill Holes; in Python: fill_holes=True\)"),
    (lamina.Solid(CUBE.vertices, CUBE.triangles[:-1], name="Dragon"), "Dragon is open"),
    (lamina.Solid(CUBE.vertices * [1, 1, 0], CUBE.triangles), "must enclose a volume"),
    (lamina.Solid([[10**400, 0, 0]], CUBE.triangles), "solid.vertices: must be numbers of shape"),
    (lamina.Solid(CUBE.vertices * np.nan, CUBE.triangles), r"solid.vertices\[0\] has the coordinate nan"),
    (lamina.Solid(CUBE.vertices, CUBE.triangles + 1), "has index 8: must lie in"),
    (lamina.Solid(np.zeros((8, 3)), CUBE.triangles), "0 mm large"),
    (lamina.Solid(CUBE.vertices, CUBE.triangles, opaque=[True]), "solid.opaque = .*must be 12 booleans, one per tri"),
    (lamina.Solid(CUBE.vertices, CUBE.triangles, opaque=np.zeros(12)), "solid.opaque = .*must be 12 booleans"),
    ("dragon", "solid = str: must be a lamina.Solid"),
])
def test_bad_meshes(solid, words):
    with pytest.raises(InteriorError, match=words):
        lamina.walk_in_mesh(solid, Interior.uniform(WHITE), samples=1)


def joined(*shells):
    """Shells in one solid."""
    before = np.cumsum([0, *(len(shell.vertices) for shell in shells)])
    return lamina.Solid(np.vstack([shell.vertices for shell in shells]),
                        np.vstack([shell.triangles + first for shell, first in zip(shells, before, strict=False)]))


def inverted(shell, by=(0, 0, 0)):
    return lamina.Solid(shell.vertices + by, shell.triangles[:, ::-1])


def test_open_meshes_are_told_from_bad_ones():
    flat = lamina.Solid(np.eye(3), [[0, 1, 2]])
    assert CUBE.is_closed() and not flat.is_closed()
    assert not lamina.Solid(CUBE.vertices, CUBE.triangles[:-1]).is_closed()
    with pytest.raises(lamina.InteriorError, match="inside out"):
        turned(CUBE, range(12)).is_closed()
    with pytest.raises(lamina.InteriorError, match="disagree"):
        turned(lamina.Solid(CUBE.vertices, CUBE.triangles[:-1]), [3]).is_closed()


@pytest.mark.parametrize("by", [(3, 0, 0), (0, 0, 3), (0, 0, -3), (0.9, 0.9, 0.9)])
def test_a_shell_that_is_inside_out_beside_another(by):
    """Also above, below, and within the other's box."""
    solid = joined(sphere(1.0, 3), inverted(sphere(0.3, 1), by))
    with pytest.raises(InteriorError, match="a separate part of 80 faces that is inside out and no cavity: flip"):
        lamina.walk_in_mesh(solid, Interior.uniform(WHITE), samples=1)


def test_a_cavity_of_a_cavity_is_inside_out():
    with pytest.raises(InteriorError, match="a separate part of 320 faces"):
        closed(joined(sphere(1.0, 3), inverted(sphere(0.8, 3)), inverted(sphere(0.5, 2))))


@pytest.mark.parametrize("shells", [
    [inverted(sphere(0.3, 2))],
    [inverted(sphere(0.3, 2), (0.5, 0.2, 0.1)), inverted(sphere(0.2, 2), (-0.5, 0.2, 0.1))],
    [inverted(sphere(0.8, 3)), sphere(0.5, 3), inverted(sphere(0.2, 2))],
    [inverted(sphere(0.3, 2), (1.0, 0.0, 0.0))],
    [sphere(0.3, 2)],
    [inverted(inverted(sphere(0.3, 2)), (3.0, 0.0, 0.0))],
], ids=["cavity", "two", "body in a cavity", "cavity that opens", "overlap", "beside"])
def test_shells_that_are_cavities_or_bodies(shells):
    solid = joined(sphere(1.0, 3), *shells)
    assert len(closed(solid).mesh.triangles) == len(solid.triangles)


@pytest.mark.parametrize(("error", "change", "words"), [
    (ArgumentError, {"interior": WHITE}, "interior = .*: must be a lamina.Interior"),
    (ArgumentError, {"surface": 1.5}, "surface = 1.5: must be a lamina.Surface"),
    (ArgumentError, {"samples": 0}, "samples = 0: must be a whole number"),
    (ArgumentError, {"seed": -1}, "seed = -1"),
    (ArgumentError, {"threads": -1}, "threads = -1"),
    (ArgumentError, {"points": [[0, 0, 0]]}, "normals are missing"),
    (ArgumentError, {"normals": [[0, 0, 1]]}, "normals are given without points"),
    (ArgumentError, {"points": [[0, 0, 0]], "normals": [[0, 0, 0]]}, r"normals\[0\] = \(0, 0, 0\): must have a length"),
    (ArgumentError, {"points": [[0, 0, 0]] * 2, "normals": [[0, 0, 1]]}, "normals has 1 rows: must have 2"),
    (ArgumentError, {"directions": [[0, 0, 1]]}, "directions has 1 rows: must have 8"),
    (InteriorError, {"points": [[0.5, 0.5, 0.5]], "normals": [[0, 0, 1]]}, r"points\[0\] = .* lies off the surface"),
    (InteriorError, {"points": [[9e9, 0.5, 0.5]], "normals": [[0, 0, 1]]}, r"points\[0\] = .* lies off the surface"),
])
def test_bad_arguments_of_walks(error, change, words):
    with pytest.raises(error, match=words):
        lamina.walk_in_mesh(**{"solid": CUBE, "interior": Interior.uniform(WHITE), "samples": 1, **change})


def test_bad_surfaces_and_lamps():
    for make, words in ((lambda: Surface(0.5), "ior = 0.5: must lie in"), (lambda: Surface(1.5, 2.0), "alpha = 2.0"),
                        (lambda: Surface(1.5, 0.1, "phong"), "distribution = 'phong'"),
                        (lambda: Lamp((0, 0, 0)), "towards = .*not all 0"),
                        (lambda: Lamp((0, 0, 1), 2.0), "angle = 2")):
        with pytest.raises(ArgumentError, match=words):
            make()
    with pytest.raises(ArgumentError, match=r"lamps\[0\].angle = 0: must be at least 0.0175 behind a smooth boundary"):
        lamina.light_in_mesh(CUBE, Interior.uniform(WHITE), [Lamp((0, 0, 1))], surface=Surface(1.5), samples=1)


def test_repairs():
    """Unshared vertices are welded, a triangle without area is removed, and holes are filled."""
    ball = sphere(1.0, 2)
    corners = ball.vertices[ball.triangles].reshape(-1, 3)
    loose = lamina.Solid(corners, np.arange(len(corners)).reshape(-1, 3))
    degenerate = lamina.Solid(ball.vertices, np.vstack([ball.triangles, [[0, 0, 1]]]))
    holes = lamina.Solid(ball.vertices, np.delete(ball.triangles, [0, 1, 60, 200], axis=0), fill_holes=True)
    white = Interior.uniform(EndMaterial(3.0))
    for solid in (loose, degenerate, holes):
        found = lamina.walk_in_mesh(solid, white, ball.vertices[5:9], ball.vertices[5:9], samples=200)
        assert found.albedo.value == pytest.approx(1.0, rel=1e-9) and found.count.lost == 0.0


def test_only_small_holes_are_filled():
    """Three holes, of one and of two faces: 4 of 320 faces of a sphere."""
    ball = sphere(1.0, 2)
    triangles = np.delete(ball.triangles, [0, 1, 60, 200], axis=0)
    white, where = Interior.uniform(EndMaterial(3.0)), ball.vertices[5:9]

    def albedo(largest):
        solid = lamina.Solid(ball.vertices, triangles, largest)
        return lamina.walk_in_mesh(solid, white, where, where, samples=50).albedo.value

    np.testing.assert_array_equal(albedo(0.02), albedo(True))
    for smaller in (0.005, 0, False):
        with pytest.raises(InteriorError, match="open along 10 edges"):
            albedo(smaller)
    for bad in (-1.0, np.nan, "all", None):
        with pytest.raises(InteriorError, match="fill_holes = .* must be True, False or a share of the area"):
            albedo(bad)


@pytest.mark.parametrize("interior", [
    Interior.uniform(WHITE),
    Interior.mixed(np.linspace(0, 1, 24).reshape(2, 3, 4), PALETTE, (-1, 0, 2), (1, 1, 5), smooth=False),
    Interior.of_coefficients(np.ones((2, 3, 4, 3)), np.full((2, 3, 4), 0.25), *CORNERS, g=0.5),
])
def test_files_come_back_as_they_were(interior, tmp_path):
    path = tmp_path / "inside.npz"
    interior.save(path)
    back = lamina.Interior.load(path)
    assert back.hash == interior.hash and back.palette == interior.palette
    np.testing.assert_array_equal(back.voxels, interior.voxels)


def test_bad_files(tmp_path):
    path = tmp_path / "inside.npz"
    path.write_bytes(b"PK")
    with pytest.raises(InteriorError, match="not a whole interior saved by Lamina"):
        Interior.load(path)
    bad = Interior.of_coefficients(np.ones((2, 2, 2)), np.ones((2, 2, 2)), *CORNERS)
    bad.voxels[1, 0, 1, 3] = -1.0
    bad.save(path)
    with pytest.raises(InteriorError, match=r"inside.npz: voxels\[1, 0, 1, 3\] = -1.0: must lie in"):
        Interior.load(path)
    Interior(bad.voxels, *CORNERS, tuple(PALETTE)).save(path)
    with pytest.raises(InteriorError, match="does not fit the header"):
        Interior.load(path)


def test_a_mixture_takes_two_bytes_a_voxel_and_coefficients_take_twelve():
    """A mixture with 512 voxels per side then takes a quarter of a GiB."""
    shape = (64, 32, 16)
    half = np.broadcast_to(np.float32(0.5), shape)
    assert Interior.mixed(half, PALETTE, *CORNERS).bytes == 2 * math.prod(shape)
    assert Interior.of_coefficients(half, half, *CORNERS).bytes == 12 * math.prod(shape)
