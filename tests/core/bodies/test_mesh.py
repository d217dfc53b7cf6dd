# SPDX-License-Identifier: GPL-3.0-or-later
"""The ray tracing module, and Lamina without it."""

import importlib.util
import math
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import pytest

import lamina
from lamina.settling import embree

needs_rays = pytest.mark.skipif(bool(embree.why_not()), reason=embree.why_not())
UP = ([0, 0, 1], [1, 0, 0], [0, 1, 0])
FAR = math.inf


def test_this_installation_traces_rays():
    """Fails in a build without Embree, so that a test run cannot pass by skipping dust."""
    assert embree.why_not() == ""


def scene(*meshes, threads=1, go_on=lambda fraction: None):
    parts = [(np.asarray(v, np.float32), np.asarray(t, np.uint32)) for v, t in meshes]
    return embree.layer().Scene(parts, threads, go_on)


def fall(wind=(0.0, 0.0), spread=0.0):
    return embree.layer().Fall(*UP, *wind, math.sin(spread))


def options(count, two_sided=False):
    return embree.layer().Options(count, 0, two_sided, 2.0**-17)


def grid(cells, height):
    line = np.linspace(-1, 1, cells + 1)
    x, y = np.meshgrid(line, line, indexing="ij")
    i, j = np.meshgrid(np.arange(cells), np.arange(cells), indexing="ij")
    a = (i * (cells + 1) + j).ravel()
    b, c, d = a + cells + 1, a + cells + 2, a + 1
    triangles = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return np.column_stack([x.ravel(), y.ravel(), np.full(x.size, height)]), triangles


@needs_rays
def test_rays_do_not_slip_between_triangles():
    """Straight up into every vertex, edge and face of a lattice whose coordinates are no round numbers."""
    roof, triangles = grid(37, 0.3)
    below = roof[triangles].reshape(-1, 3, 3)
    interior = np.abs(below).max(axis=(1, 2)) < 1.0
    corners = below[interior]
    targets = np.vstack([corners[:, 0], 0.5 * (corners[:, 0] + corners[:, 1]), 0.5 * (corners[:, 1] + corners[:, 2]),
                         0.25 * corners[:, 0] + 0.75 * corners[:, 2], corners.mean(axis=1)]).astype(np.float32)
    targets[:, 2] = 0.0
    normals = np.tile(np.float32([0, 0, 1]), (len(targets), 1))
    shares, traced = scene((roof, triangles)).arrivals(fall(), targets, normals, 0, options(8))
    assert traced == len(targets)  # all rays of a fall without spread are one
    assert np.all(shares == 0.0)


@needs_rays
@pytest.mark.parametrize("spread", [0.0, 0.2, 0.9, 1.5])
def test_the_open_share_is_the_mean_over_the_fall(spread):
    """Against brute quadrature of max(0, n.d), cone wholly or partly above the plane, with wind and without."""
    xi, phi = np.meshgrid((np.arange(1000) + 0.5) / 1000, 2.0 * np.pi * (np.arange(360) + 0.5) / 360)
    sine = np.sin(spread) * np.sqrt(xi)
    slope = sine / np.sqrt(1.0 - sine * sine)
    for wind in ((0.0, 0.0), (0.8, -0.3)):
        core = fall(wind, spread)
        for normal in ((0, 0, 1), (0.6, 0, 0.8), (1, 0, 0), (-0.6, 0.64, 0.48), (0.6, 0.0, -0.8), (0, 0, -1)):
            n1, n2, up = normal
            along = up + n1 * (slope * np.cos(phi) - wind[0]) + n2 * (slope * np.sin(phi) - wind[1])
            assert core.open_share(up, n1, n2) == pytest.approx(np.maximum(along, 0.0).mean(), rel=5e-4, abs=1e-4)


@needs_rays
def test_exposure_of_a_corner_is_a_half():
    floor, triangles = grid(1, 0.0)
    wall = [[0, -1, 0], [0, 1, 0], [0, 1, 2], [0, -1, 2]]
    made = scene((100 * floor, triangles), (100 * np.array(wall), [[0, 1, 2], [0, 2, 3]]))
    positions = np.tile(np.float32([1e-3, 0, 0]), (200, 1))
    normals = np.tile(np.float32([0, 0, 1]), (200, 1))
    exposures, traced = made.exposures(positions, normals, 0, options(64), FAR)
    assert traced == 200 * 64
    assert abs(exposures.mean() - 0.5) < 3.5 * exposures.std() / math.sqrt(200) + 1e-3
    within, _ = made.exposures(positions, normals, 0, options(64), 1e-4)
    assert np.all(within == 1.0)


@needs_rays
def test_grains_are_counted_by_what_they_meet():
    plate, triangles = grid(4, 0.0)
    made = scene((plate, triangles[:16]), ([[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], [[0, 1, 2], [0, 2, 3]]))
    front, back, stopped, missed = made.grains(fall(), [-2, -2, 0.1], [4, 0, 0], [0, 4, 0], 40000, 1)
    assert stopped[0] == 0
    assert front + back + stopped[1] + missed == 40000
    # Half of the triangles; the lid shelters a quarter of the plate.
    for count, share in zip((front, back, stopped[1], missed), (0.75 * 2 / 16, 0.0, 1 / 16, 1 - 1 / 16 - 1.5 / 16),
                            strict=True):
        assert abs(count - 40000 * share) < 4.0 * math.sqrt(40000 * share * (1 - share)) + 1e-9
    turned = scene((plate, triangles[:, ::-1])).grains(fall(), [-1, -1, 0.1], [2, 0, 0], [0, 2, 0], 1000, 1)
    assert turned == (0, 1000, [0], 0)


@needs_rays
def test_scenes_are_built_alike_by_any_number_of_threads_and_can_be_stopped():
    rng = np.random.default_rng(1)
    soup = (rng.normal(size=(3000, 3)), np.arange(3000).reshape(-1, 3))
    positions = rng.normal(size=(500, 3)).astype(np.float32)
    normals = np.tile(np.float32([0, 0, 1]), (500, 1))
    runs = [scene(soup, threads=threads).arrivals(fall(spread=1.0), positions, normals, 0, options(16))[0]
            for threads in (1, 2, 4)]
    assert runs[0].tobytes() == runs[1].tobytes() == runs[2].tobytes()

    def stop(fraction):
        raise KeyError("enough")

    big = grid(700, 0.0)
    with pytest.raises(KeyError, match="enough"):
        scene(big, big, threads=1, go_on=stop)


@needs_rays
def test_wrong_arguments_are_refused():
    with pytest.raises(ValueError, match="indices below"):
        scene((np.eye(3), [[0, 1, 3]]))
    made = scene((np.eye(3), [[0, 1, 2]]))
    with pytest.raises(ValueError, match="the same number of rows"):
        made.arrivals(fall(), np.zeros((2, 3), np.float32), np.zeros((1, 3), np.float32), 0, options(1))
    with pytest.raises(ValueError, match="sin_spread"):
        embree.layer().Fall(*UP, 0.0, 0.0, 1.0)


@needs_rays
def test_each_texel_has_one_triangle():
    """A fan around an inner point covers the square once, without a gap along its edges."""
    rim = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    uvs = np.array([[rim[k], rim[(k + 1) % 4], [0.5, 0.5]] for k in range(4)], float)
    triangle, weights = embree.layer().texels(uvs, 64, 64)
    assert np.bincount(triangle.ravel() + 1, minlength=5)[0] == 0
    second, third = weights[..., 0], weights[..., 1]
    corners = uvs[triangle]
    place = ((1 - second - third)[..., None] * corners[:, :, 0] + second[..., None] * corners[:, :, 1]
             + third[..., None] * corners[:, :, 2])
    row, column = np.mgrid[:64, :64]
    np.testing.assert_allclose(place, np.stack([column + 0.5, row + 0.5], axis=-1) / 64, atol=1e-6)


@needs_rays
def test_no_symbol_of_embree_is_left_to_bind():
    """Blender has its own Embree: neither copy may use symbols of the other."""
    tool = shutil.which("nm")
    if tool is None:
        pytest.skip("no nm here")
    listed = subprocess.run([tool, "-D", embree.layer().__file__], check=True, capture_output=True, text=True).stdout
    assert "PyInit__mesh" in listed
    names = [line.split()[-1] for line in listed.splitlines() if "rtc" in line or "embree" in line or "tbb" in line]
    assert names == []


SUFFIX = sysconfig.get_config_var("EXT_SUFFIX")
WITHOUT = {
    "missing": (None, "this build of Lamina was made without"),
    "rubbish": (b"rubbish", "cannot be loaded: "),
    "other Embree": ("raise ImportError('Embree has version 40303, but version 31305 is expected')",
                     "cannot be loaded: Embree has version 40303, but version 31305 is expected"),
}
SCRIPT = """
import numpy as np, lamina
from lamina.dust import Mesh, settle
from lamina.settling import embree
print(lamina.solve(lamina.Stack([lamina.Medium(albedo=.9, tau=2.)])).reflectance(1.).round(3))
print(lamina.dust.available())
try:
    settle(Mesh(np.eye(3), [[0, 1, 2]]))
except lamina.DustUnavailable as error:
    print(error)
"""


@pytest.mark.parametrize("case", WITHOUT)
def test_without_the_layer_all_else_works_and_dust_says_why(case, tmp_path):
    content, words = WITHOUT[case]
    package = Path(importlib.util.find_spec("lamina").origin).parent
    shutil.copytree(package, tmp_path / "lamina", ignore=shutil.ignore_patterns("_mesh*", "__pycache__"))
    if isinstance(content, bytes):
        (tmp_path / f"lamina/_mesh{SUFFIX}").write_bytes(content)
    elif content:
        (tmp_path / "lamina/_mesh.py").write_text(content)
    found = os.pathsep.join([str(tmp_path), str(Path(np.__file__).parents[1])])  # PYTHONPATH may be the way to NumPy
    done = subprocess.run([sys.executable, "-c", SCRIPT], cwd=tmp_path, env={**os.environ, "PYTHONPATH": found},
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    solved, available, said = done.stdout.splitlines()
    assert solved == str(lamina.solve(lamina.Stack([lamina.Medium(albedo=0.9, tau=2.0)])).reflectance(1.0).round(3))
    assert words in said
    assert available == said
    assert said.startswith("dust and walks in meshes need the module lamina._mesh, ")
