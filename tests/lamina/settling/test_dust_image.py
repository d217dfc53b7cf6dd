# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust as an image, a band of rows at a time; faults of UV maps; far, closed and broken occluders."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from dust_meshes import box, plate, sphere, torus
from needs_embree import with_embree
from z_limit import z_limit

from lamina import dust
from lamina.dust import Mesh, Points, Settling, dilate, settle, settle_image, texel_points
from lamina.settling import texels

pytestmark = with_embree


def planar_uvs(mesh):
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    return ((mesh.vertices - low)[:, :2] / (high - low)[:2])[mesh.triangles]


@pytest.mark.parametrize("two_sided", [False, True])
def test_bands_are_the_whole(monkeypatch, two_sided):
    mesh, roof = torus(40, 20), box((-0.3, -0.3, 0.5), (0.3, 0.3, 0.6))
    upper = Mesh(mesh.vertices, mesh.triangles[face_up(mesh)])
    uvs = planar_uvs(mesh)[face_up(mesh)]
    settings = Settling(rays=32, spread=0.9, coverage=0.6, two_sided=two_sided)
    points, mask = texel_points(upper, uvs, (60, 90))
    whole = settle(upper, points, [roof], settings, seed=3, threads=1)
    monkeypatch.setattr(texels, "BAND", 60 * 7)
    banded = settle_image(upper, uvs, (60, 90), [roof], settings, seed=3, threads=1, margin=3)
    assert banded.tau.tobytes() == dilate(whole.tau, mask, 3).tobytes()
    np.testing.assert_array_equal(banded.arrived[mask], whole.arrived)
    assert not banded.arrived[~mask].any()
    assert (banded.back is None) == (not two_sided)
    assert banded.statistics.arrived == pytest.approx(whole.statistics.arrived, rel=1e-9)
    assert banded.statistics.points == mask.sum()


def face_up(mesh):
    corners = mesh.vertices[mesh.triangles]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0.0


MEMORY = """
import resource, sys
import numpy as np
sys.path.insert(0, sys.argv[1])
from dust_meshes import plate
from lamina.dust import Settling, settle_image
mesh = plate(4)
uvs = (mesh.vertices[:, :2] + 0.5)[mesh.triangles]
def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
settle_image(mesh, uvs, 64, settings=Settling(rays=1, spread=0.0))
before = peak()
found = settle_image(mesh, uvs, int(sys.argv[2]), settings=Settling(rays=1, spread=0.0), threads=1)
assert np.all(found.tau == 1.0)
print(peak() - before)
"""


def test_a_large_image_needs_little_more_than_itself():
    """Bytes per texel: 4 each for thickness, arrived dust and the image with its margin, 1 for the mask; and at most
    300 MiB for a band. All texels as points took more than 200 bytes each."""
    words = [sys.executable, "-c", MEMORY, str(Path(__file__).parents[1]), "2048"]
    done = subprocess.run(words, check=True, capture_output=True, text=True)
    assert float(done.stdout) < 13.0 * 2048**2 + 300.0 * 2**20


UV_FAULTS = {
    "next tile": (lambda uvs: uvs + [1.0, 0.0], "Plate: the UV map lies outside the image, with u from 1 to 2 and v "
                  "from 0 to 1: u and v must lie in [0, 1]"),
    "no area": (lambda uvs: 0.0 * uvs + 0.5, "Plate: the UV map has no area"),
    "lines": (lambda uvs: uvs * [1.0, 0.0], "Plate: the UV map has no area"),
    "too small": (lambda uvs: 1e-4 * uvs + 0.001, "Plate: no texel's centre of 16 x 16 lies on the UV map"),
}


@pytest.mark.parametrize("name", UV_FAULTS)
def test_a_uv_map_without_texels_is_refused(name):
    change, words = UV_FAULTS[name]
    mesh = Mesh(plate(4).vertices, plate(4).triangles, name="Plate")
    with pytest.raises(dust.DustError) as caught:
        settle_image(mesh, change(planar_uvs(mesh)), 16, settings=Settling(rays=4))
    assert str(caught.value).startswith(words)
    assert "\n" not in str(caught.value)


UV_LOSSES = {
    "tiles": (lambda uvs: 4.0 * uvs, "is unwrapped beyond the image (u from 0 to 4, v from 0 to 4)"),
    "some flat": (lambda uvs: np.where(np.arange(len(uvs))[:, None, None] % 4 == 0, 0.5, uvs),
                  "25 % of the surface has no area"),
    "overlaps": (lambda uvs: np.abs(uvs - 0.5), "texels stand for 25 % of the surface only"),
}


@pytest.mark.parametrize("name", UV_LOSSES)
def test_what_a_uv_map_leaves_out_is_told(name):
    change, words = UV_LOSSES[name]
    mesh = plate(4)
    found = settle_image(mesh, change(planar_uvs(mesh)), 64, settings=Settling(rays=4))
    assert any(words in note for note in found.statistics.notes), found.statistics.notes
    assert settle_image(mesh, planar_uvs(mesh), 64, settings=Settling(rays=4)).statistics.notes == ()


def test_an_occluder_far_away_leaves_the_grains_as_they_are():
    surface = sphere(24, 48)
    alone = settle(surface, settings=Settling(rays=16), threads=1).statistics
    for distance in (1e3, 1e6, 1e9):
        far = box((-1, -1, distance), (1, 1, distance + 1.0))
        far = Mesh(far.vertices + [distance, 0, 0], far.triangles)
        found = settle(surface, None, [far], Settling(rays=16), threads=1).statistics
        assert found.fell == pytest.approx(alone.fell, abs=z_limit(3) * alone.fell_stderr)
        assert found.behind == 0.0
        assert found.fell + found.stopped + found.missed == pytest.approx(found.launched)


def test_a_dome_is_named():
    dome = sphere(16, 32, 50.0)
    dome = Mesh(dome.vertices, dome.triangles, name="Sky")
    post = box((2, 2, 0), (2.1, 2.1, 1))
    found = settle(plate(), None, [post, dome], Settling(rays=16), threads=1)
    assert np.all(found.tau == 0.0)
    assert found.statistics.keepers == ("Sky",)
    assert "Sky keeps nearly all dust off" in found.statistics.notes[0]
    unnamed = settle(plate(), None, [Mesh(dome.vertices, dome.triangles)], Settling(rays=16), threads=1)
    assert unnamed.statistics.keepers == ("occluders[0]",)
    roof = settle(plate(), None, [plate(1, 0.5, 0.3), post], Settling(rays=16), threads=1)
    assert roof.statistics.keepers == ()


def test_a_broken_occluder_is_named():
    broken = Mesh([[0, 0, 0], [1, 0, float("nan")], [0, 1, 0]], [[0, 1, 2]], name="Broken")
    with pytest.raises(dust.DustError, match=r"^Broken.vertices\[1\] has the coordinate nan"):
        settle(plate(), None, [plate(), broken])


def test_the_back_is_told_apart():
    down = Mesh(plate(4).vertices, plate(4).triangles[:, ::-1])
    found = settle(down, settings=Settling(rays=16, two_sided=True), threads=1)
    np.testing.assert_allclose(found.back, 1.0, rtol=1e-6)
    np.testing.assert_array_equal(found.tau, found.back)
    above = settle(plate(4), settings=Settling(rays=16, two_sided=True), threads=1)
    assert np.all(above.back == 0.0)
    assert settle(plate(4), settings=Settling(rays=16), threads=1).back is None


@pytest.mark.parametrize("tilt", [40.0, 70.0])
def test_a_single_ray_is_unbiased(tilt):
    """A slope with the half of the sky hidden that it faces: the mean over many points, one ray each, against 4096."""
    angle = math.radians(tilt)
    wall = Mesh([[1e-3, -50, -50], [1e-3, 50, -50], [1e-3, 50, 50], [1e-3, -50, 50]], [[0, 1, 2], [0, 2, 3]])

    def mean(points, rays):
        at = Points(np.zeros((points, 3)), np.tile([math.sin(angle), 0.0, math.cos(angle)], (points, 1)))
        settings = Settling(rays=rays, repose=math.pi, concavity=0.0)
        tau = settle(plate(2), at, [wall], settings, seed=1, threads=1).tau.astype(float)
        return tau.mean(), tau.std(ddof=1) / math.sqrt(points)

    (truth, error), (single, noise) = mean(200, 4096), mean(100000, 1)
    assert abs(single - truth) < z_limit(2) * math.hypot(error, noise)
    assert noise < 0.01 * truth
