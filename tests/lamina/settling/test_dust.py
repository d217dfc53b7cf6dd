# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust that settles, in cases with closed forms or symmetries; Monte Carlo by Z-scores with fixed seeds."""

import math

import numpy as np
import pytest
from dust_meshes import box, moved, plate, sphere, subdivided, torus
from needs_embree import with_embree
from z_limit import z_limit

from lamina import dust
from lamina.dust import Mesh, Points, Settling, settle
from lamina.settling.mesh import vertex_points

pytestmark = with_embree

STILL = {"repose": math.pi, "concavity": 0.0}  # all arriving dust stays


def disc(inner):
    """A disc above the origin, which hides the directions up to the angle `inner`."""
    corners = 512
    phi = 2.0 * math.pi * np.arange(corners) / corners
    # A polygon of the disc's area.
    radius = math.tan(inner) * math.sqrt(2.0 * math.pi / corners / math.sin(2.0 * math.pi / corners))
    rim = np.column_stack([radius * np.cos(phi), radius * np.sin(phi), np.ones(corners)])
    k = np.arange(corners)
    return Mesh(np.vstack([rim, [[0, 0, 1]]]), np.column_stack([np.full(corners, corners), k, (k + 1) % corners]))


def rotation(axis, angle):
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * k + (1.0 - math.cos(angle)) * k @ k


TURNED = rotation((1.0, 2.0, 0.5), 1.1)


@pytest.mark.parametrize("spread", [0.0, 0.3, 1.5])
@pytest.mark.parametrize("wind", [(0.0, 0.0, 0.0), (3.0, -1.0, 0.0)])
def test_an_open_plate_gets_the_amount(spread, wind):
    found = settle(plate(), settings=Settling(amount=2.5, spread=spread, wind=wind, rays=64), threads=1)
    np.testing.assert_allclose(found.tau, 2.5, rtol=1e-6)
    np.testing.assert_array_equal(found.tau, found.arrived)


def test_gravity_and_wind_may_point_anywhere():
    wind = TURNED @ [0.7, 0.2, 5.0]  # the last along gravity, which counts for nothing
    turned = settle(moved(plate(), TURNED), threads=1,
                    settings=Settling(amount=2.0, gravity=TURNED @ [0, 0, -3.0], wind=wind, rays=64))
    np.testing.assert_allclose(turned.tau, 2.0, rtol=1e-5)


@pytest.mark.parametrize("tilt", [0.2, 0.9, 1.3])
def test_an_open_slope_gets_its_shadow_in_the_fall(tilt):
    """n.(up - wind) while all of the cone is above its plane: for a fall along one direction its cosine rule."""
    surface = moved(plate(2), rotation((0, 1, 0), tilt))
    normal = np.array([math.sin(tilt), 0.0, math.cos(tilt)])
    wind = np.array([-0.4, 0.3, 0.0])
    found = settle(surface, settings=Settling(amount=1.0, spread=0.2, wind=wind, rays=64, **STILL), threads=1)
    np.testing.assert_allclose(found.tau, normal[2] - normal @ wind, rtol=1e-5)


def test_nothing_falls_under_a_roof_wider_than_the_spread():
    spread, height = math.radians(50.0), 0.25
    reach = 0.5 + height * math.tan(spread)
    # Vertices right below the roof's vertices and edges: rays straight up meet those.
    roof = plate(16, 2.0 * reach + 1e-3, height)
    found = settle(plate(16), occluders=[roof], settings=Settling(spread=spread, rays=512), threads=1)
    assert np.all(found.tau == 0.0)
    assert found.statistics.fell == 0.0
    assert found.statistics.stopped > 0.0


def test_a_mesh_under_another_that_touches_it_is_told():
    for height in (1e-6, 1e-4):
        found = settle(plate(1), occluders=[plate(1, 1.0, height)], settings=Settling(spread=0.5, rays=64), threads=1)
        assert found.statistics.fell < 1e-3 and found.tau.max() > 0.5
        assert found.statistics.notes[1].startswith("nearly no dust that falls meets the mesh, though its points see")


def test_the_shadow_of_a_disc_has_its_closed_form():
    """Below the centre of a disc of half-angle a in a cone of half-angle s, the share sin^2 a / sin^2 s is
    sheltered."""
    spread, inner = math.radians(60.0), math.radians(35.0)
    count = 400
    points = Points(np.zeros((count, 3)), np.tile([0.0, 0.0, 1.0], (count, 1)))
    found = settle(plate(), points, [disc(inner)], Settling(spread=spread, rays=64, **STILL), seed=3, threads=1)
    truth = 1.0 - math.sin(inner) ** 2 / math.sin(spread) ** 2
    z = (found.tau.mean() - truth) / (found.tau.std(ddof=1) / math.sqrt(count))
    assert abs(z) < z_limit(1)
    assert found.tau.std() < 0.02  # points of low discrepancy: sixty-four independent ones would have .06


@pytest.mark.parametrize("hidden", [0.001, 0.004, 0.999])
def test_rays_that_a_point_saves_keep_the_mean(hidden):
    """Most points do not see a small disc, or a small gap, in the first quarter of their rays."""
    spread, count = 0.5, 6000
    points = Points(np.zeros((count, 3)), np.tile([0.0, 0.0, 1.0], (count, 1)))
    above = disc(math.asin(math.sin(spread) * math.sqrt(hidden)))
    found = settle(plate(), points, [above], Settling(spread=spread, rays=256, **STILL), seed=5)
    error = found.tau.std(ddof=1) / math.sqrt(count)
    assert abs(found.tau.mean() - (1.0 - hidden)) < z_limit(3) * error and error < 0.001
    assert found.statistics.rays - found.statistics.grains < 0.7 * 256 * count


def test_wind_moves_the_shadow():
    found = settle(plate(40, 4.0), occluders=[plate(1, 1.0, 0.5)], threads=1,
                   settings=Settling(spread=0.0, wind=(2.0, 0.0, 0.0), rays=4))
    x, y = plate(40, 4.0).vertices[:, :2].T
    inside = (np.abs(x - 1.0) < 0.49) & (np.abs(y) < 0.49)
    outside = (np.abs(x - 1.0) > 0.51) | (np.abs(y) > 0.51)
    assert np.all(found.tau[inside] == 0.0)
    np.testing.assert_allclose(found.tau[outside], 1.0, rtol=1e-6)


def test_a_wall_takes_half_of_the_sky_from_the_floor_at_its_foot():
    wall = box((-1, -50, 0), (0, 50, 50))
    count = 400
    for distance in (0.0, 1e-3):  # on the edge itself, and just off it
        points = Points(np.tile([distance, 0.0, 0.0], (count, 1)), np.tile([0.0, 0.0, 1.0], (count, 1)))
        found = settle(plate(4, 10.0), points, [wall], Settling(spread=1.2, rays=64, **STILL), threads=1)
        error = found.tau.std(ddof=1) / math.sqrt(count)
        assert abs(found.tau.mean() - 0.5) < z_limit(2) * error + 2e-4


def test_a_mirrored_scene_has_mirrored_dust():
    surface, pillars = sphere(12, 24), [box((-1.6, -0.3, -1), (-1.2, 0.3, 2)), box((1.2, -0.3, -1), (1.6, 0.3, 2))]
    mirrored = surface.vertices * [-1.0, 1.0, 1.0]
    partner = np.argmin(np.linalg.norm(mirrored[:, None] - surface.vertices[None], axis=2), axis=1)
    assert np.allclose(surface.vertices[partner], mirrored)
    seeds = 24
    runs = np.array([settle(surface, None, pillars, Settling(rays=64, spread=1.0), seed=seed, threads=1).tau
                     for seed in range(seeds)], float)
    difference = runs - runs[:, partner]
    mean, error = difference.mean(axis=0), difference.std(axis=0, ddof=1) / math.sqrt(seeds)
    noisy = error > 1e-6
    assert noisy.sum() > 50
    assert np.all(np.abs(mean[~noisy]) < 1e-5)
    # Student's t with 23 degrees of freedom, 1 % over some 200 points: 4.9.
    assert np.abs(mean[noisy] / error[noisy]).max() < 4.9


def test_a_finer_mesh_has_the_same_dust():
    coarse = torus(48, 24)
    fine = subdivided(subdivided(coarse))
    settings = Settling(rays=2048, spread=0.9)
    old = len(coarse.vertices)
    finer = vertex_points(fine)
    before = settle(coarse, settings=settings, seed=1)
    after = settle(fine, Points(finer.positions[:old], finer.normals[:old]), settings=settings, seed=2)
    assert 0.1 < np.mean(before.arrived < 0.5) < 0.9
    assert np.abs(after.arrived - before.arrived).max() < 0.02
    assert np.abs(after.tau - before.tau).max() < 0.02


def test_mass_is_kept():
    settings = Settling(amount=2.0, spread=0.8, wind=(0.3, 0.0, 0.0), coverage=0.6, rays=64)
    found = settle(sphere(64, 128), occluders=[plate(1, 1.0, 1.5)], settings=settings, threads=0)
    s = found.statistics
    assert math.isclose(s.arrived, s.deposited + s.slid + s.wiped, rel_tol=1e-9)
    assert math.isclose(s.launched, s.fell + s.behind + s.stopped + s.missed, rel_tol=1e-9)
    assert min(s.slid, s.wiped, s.stopped, s.missed) > 0.0
    # Rays from the points and grains from above: two ways that share nothing; half a per cent is the mesh's.
    assert abs(s.arrived - s.fell) < z_limit(1) * s.fell_stderr + 0.005 * s.fell
    assert s.behind == 0.0


@pytest.mark.parametrize("spread", [0.0, 0.7, 1.3])
def test_a_sphere_catches_its_shadow(spread):
    """pi r^2 over the cosine of the fall, on average over the flux: 2 (1 - cos s) / sin^2 s."""
    found = settle(sphere(96, 192, radius=0.5), settings=Settling(spread=spread, rays=64, **STILL), threads=0)
    factor = 2.0 * (1.0 - math.cos(spread)) / math.sin(spread) ** 2 if spread else 1.0
    truth = math.pi * 0.25 * factor
    s = found.statistics
    assert abs(s.fell - truth) < z_limit(3) * s.fell_stderr + 1e-3 * truth
    assert abs(s.arrived - truth) < 2e-3 * truth


def test_grains_slide_off_beyond_the_angle_of_repose():
    settings = Settling(spread=0.3, repose=0.7, repose_width=0.2, concavity=0.0, rays=16)

    def stays(tilt, **changes):
        found = settle(moved(plate(1), rotation((1, 0, 0), tilt)), threads=1,
                       settings=Settling(**{**vars(settings), **changes}))
        return float((found.tau / found.arrived).mean())

    assert stays(0.59) == 1.0
    assert math.isclose(stays(0.7), 0.5, abs_tol=1e-5)
    assert stays(0.81) == 0.0
    assert stays(0.69, repose_width=0.0) == 1.0
    assert stays(0.71, repose_width=0.0) == 0.0
    assert stays(1.5, repose=math.pi) == 1.0


def test_what_slides_holds_in_concavities():
    # A ridge and a groove of the same slopes, 60 degrees.
    up = math.tan(math.radians(60.0))
    ridge = Mesh(np.array([[-1, -5, -up], [0, -5, 0], [1, -5, -up], [-1, 5, -up], [0, 5, 0], [1, 5, -up]]),
                 [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])
    groove = Mesh(ridge.vertices * [1, 1, -1], ridge.triangles)
    at = Points([[0.02, 0.0, -0.02 * up]], [[math.sin(math.radians(60.0)), 0.0, 0.5]])
    below = Points([[0.02, 0.0, 0.02 * up]], [[-math.sin(math.radians(60.0)), 0.0, 0.5]])
    settings = Settling(spread=0.3, repose=0.7, repose_width=0.1, concavity=1.0, reach=1.0, rays=1024)
    assert settle(ridge, at, settings=settings, threads=1).tau[0] == 0.0
    held = settle(groove, below, settings=settings, threads=1)
    # The other wall, at 60 degrees to this one, hides (1 + cos 60)/2 of the cosine-weighted hemisphere.
    assert abs(held.tau[0] / held.arrived[0] - 0.75) < 0.05
    none = settle(groove, below, settings=Settling(**{**vars(settings), "concavity": 0.0}), threads=1)
    assert none.tau[0] == 0.0


def test_coverage_is_the_share_that_is_left():
    surface = plate(100)
    shares = []
    for seed in range(6):
        found = settle(surface, settings=Settling(coverage=0.3, patch=0.05, rays=1), seed=seed, threads=1)
        shares.append(found.tau.mean())
        assert set(np.round(np.unique(found.tau)[[0, -1]], 6)) == {0.0, 1.0}
    assert abs(np.mean(shares) - 0.3) < 0.03
    assert np.all(settle(surface, settings=Settling(coverage=0.0, rays=1), threads=1).tau == 0.0)
    assert np.all(settle(surface, settings=Settling(coverage=1.0, rays=1), threads=1).tau == 1.0)


def test_mass_makes_thickness():
    by_mass = settle(plate(1), settings=Settling(grams=2.0, extinction="dust-mars-like-1.7um", time=3.0, rays=4))
    np.testing.assert_allclose(by_mass.tau, 2.0 * 0.494 * 3.0, rtol=1e-6)
    np.testing.assert_allclose(by_mass.grams, 6.0, rtol=1e-6)
    np.testing.assert_allclose(settle(plate(1), settings=Settling(grams=2.0, extinction=0.25, rays=4)).tau, 0.5)


def test_a_plain_number_of_time_multiplies_the_amount():
    one = settle(sphere(8, 16), settings=Settling(amount=0.5, rays=32), seed=7, threads=1)
    four = settle(sphere(8, 16), settings=Settling(amount=0.5, time=4.0, rays=32), seed=7, threads=1)
    np.testing.assert_allclose(four.tau, 4.0 * one.tau, rtol=1e-6)


def test_the_same_seed_gives_the_same_bytes_for_any_thread_count():
    scene = (torus(60, 30, ripple=0.2), None, [box((-0.3, -0.3, 0.5), (0.3, 0.3, 0.6))], Settling(rays=64, spread=1.0))
    runs = [settle(*scene, seed=5, threads=threads) for threads in (1, 2, 5)]
    for other in runs[1:]:
        assert runs[0].tau.tobytes() == other.tau.tobytes()
        assert runs[0].statistics.fell == other.statistics.fell
        assert runs[0].statistics.rays == other.statistics.rays
    assert settle(*scene, seed=6, threads=1).tau.tobytes() != runs[0].tau.tobytes()


@pytest.mark.parametrize(("scale", "shift"), [(1e-4, 0.0), (1e6, 0.0), (1.0, 1e7), (1e5, -1e9)])
def test_size_and_place_do_not_matter(scale, shift):
    here, occluder = torus(40, 20), box((-0.3, -0.3, 0.5), (0.3, 0.3, 0.6))
    settings = Settling(rays=64, spread=0.9)
    near = settle(here, None, [occluder], settings, threads=1).tau
    place = {"shift": (shift, -shift, shift), "scale": scale}
    far = settle(moved(here, **place), None, [moved(occluder, **place)], settings, threads=1).tau
    # Rays that graze an edge may fall on its other side.
    assert np.abs(far - near).max() < 0.05
    assert np.mean(np.abs(far - near) > 1e-4) < 0.05


def test_a_large_ground_does_not_coarsen_what_stands_on_it():
    small = torus(40, 20, radius=0.1, tube=0.04)
    alone = settle(small, settings=Settling(rays=64), threads=1).tau
    on_ground = settle(small, None, [plate(1, 1e4, -0.05)], Settling(rays=64), threads=1).tau
    np.testing.assert_array_equal(alone, on_ground)


def test_thin_shells_do_not_leak():
    lower, upper = plate(20, height=0.0), plate(20, height=1e-3)
    shell = Mesh(np.vstack([lower.vertices, upper.vertices]),
                 np.vstack([lower.triangles, upper.triangles + len(lower.vertices)]))
    tau = settle(shell, settings=Settling(spread=0.5, rays=64), threads=1).tau
    inner = np.abs(lower.vertices[:, :2]).max(axis=1) < 0.49
    assert np.all(tau[:len(inner)][inner] == 0.0)
    np.testing.assert_allclose(tau[len(inner):], 1.0, rtol=1e-6)


def test_a_sheet_seen_from_below_needs_two_sides_and_says_so():
    turned = Mesh(plate(4).vertices, plate(4).triangles[:, ::-1])
    one = settle(turned, settings=Settling(rays=16), threads=1)
    assert np.all(one.tau == 0.0)
    assert "back of faces" in one.statistics.notes[0]
    two = settle(turned, settings=Settling(rays=16, two_sided=True), threads=1)
    np.testing.assert_allclose(two.tau, 1.0, rtol=1e-6)
    assert two.statistics.notes == ()


def test_two_sides_of_a_closed_body_are_one():
    settings = {"rays": 64, "spread": 0.8}
    one = settle(sphere(24, 48), settings=Settling(**settings), threads=1)
    two = settle(sphere(24, 48), settings=Settling(two_sided=True, **settings), threads=1)
    np.testing.assert_allclose(two.arrived, one.arrived, atol=0.02)


def test_odd_meshes_are_taken():
    base = plate(4)
    extra = len(base.vertices)
    odd = Mesh(np.vstack([base.vertices, [[9, 9, 9], [0, 0, 0], [0.1, 0.1, 2.0]]]),
               np.vstack([base.triangles, base.triangles[:1],  # twice the same
                          [[0, 0, 1], [3, 3, 3]],  # without area
                          [[0, 1, extra + 2], [1, 0, extra + 2]]]))  # three faces and more on an edge
    tau = settle(odd, settings=Settling(rays=64, spread=0.2), threads=1).tau
    assert np.isfinite(tau).all()
    assert tau[extra] == 0.0  # a stray vertex
    assert tau[extra - 1] == pytest.approx(1.0)


def test_points_without_normal_and_no_points():
    nothing = settle(plate(1), Points(np.zeros((0, 3)), np.zeros((0, 3))), settings=Settling(rays=4))
    assert nothing.tau.shape == (0,)
    assert nothing.statistics.mean == 0.0
    flat = settle(plate(1), ([[0, 0, 0]], [[0, 0, 0]]), settings=Settling(rays=4))
    assert flat.tau.tolist() == [0.0]


NAN = float("nan")
WRONG = {
    "NaN": (lambda: settle(Mesh([[0, 0, 0], [1, NAN, 0], [0, 1, 0]], [[0, 1, 2]])), r"vertices\[1\] .* nan"),
    "far": (lambda: settle(Mesh([[0, 0, 0], [1, 0, 0], [0, 1e13, 0]], [[0, 1, 2]])), r"vertices\[2\]"),
    "index": (lambda: settle(Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]])), r"triangles\[0\] has index 3"),
    "negative": (lambda: settle(Mesh(np.eye(3), [[0, 1, 2], [0, -1, 2]])), r"triangles\[1\] has index -1"),
    "floats": (lambda: settle(Mesh(np.eye(3), [[0.0, 1.0, 2.0]])), "whole numbers"),
    "flat": (lambda: settle(Mesh([0, 1, 2], [[0, 1, 2]])), r"must be \(n, 3\)"),
    "words": (lambda: settle(Mesh([["a", "b", "c"]], [[0, 0, 0]])), "must be numbers"),
    "empty": (lambda: settle(Mesh(np.zeros((0, 3)), [])), "at least one face"),
    "faceless": (lambda: settle(Mesh(np.eye(3), np.zeros((0, 3), int))), "at least one face"),
    "point": (lambda: settle(Mesh(np.zeros((3, 3)), [[0, 1, 2]])), "must have an extent"),
    "normals": (lambda: settle(Mesh(np.eye(3), [[0, 1, 2]], np.eye(3)[:2])), "normals has 2 rows"),
    "occluder": (lambda: settle(plate(), occluders=[plate(), Mesh(np.eye(3), [[0, 1, 9]])]), r"occluders\[1\]"),
    "no mesh": (lambda: settle(plate().vertices), "must be a lamina.dust.Mesh"),
    "one occluder": (lambda: settle(plate(), occluders=plate()), "occluders = Mesh: must be a list of lamina"),
    "settings": (lambda: settle(plate(), settings={}), "settings = {}: must be a lamina.dust.Settling or None"),
    "moments": (lambda: dust.accumulate(plate()), "moments = Mesh.*: must be a list of what lamina.dust.settle"),
    "moment": (lambda: dust.accumulate([plate()]), "must be a list of what lamina.dust.settle returned"),
    "margin": (lambda: dust.settle_image(plate(1), np.zeros((2, 3, 2)), 8, margin=-1), "margin = -1: must be a whole"),
    "margin of an image": (lambda: dust.dilate(np.ones(1), np.ones((1, 1), bool), 2.5), "margin = 2.5: must be a"),
    "points": (lambda: settle(plate(), (np.eye(3), np.eye(3)[:1])), "points.normals has 1 rows"),
    "areas": (lambda: settle(plate(), Points(np.eye(3), np.eye(3), [1.0, NAN, 1.0])), "points.areas"),
    "seed": (lambda: settle(plate(), seed=-1), "seed = -1"),
    "threads": (lambda: settle(plate(), threads=-1), "threads = -1"),
    "amount": (lambda: Settling(amount=-1.0), r"settling.amount = -1.0: must lie in \[0, 1000\]"),
    "both": (lambda: Settling(amount=1.0, grams=1.0), "both amount and grams"),
    "spread": (lambda: Settling(spread=1.6), "settling.spread"),
    "spread NaN": (lambda: Settling(spread=NAN), "settling.spread = nan"),
    "gravity": (lambda: Settling(gravity=(0, 0, 0)), "must not be zero"),
    "wind": (lambda: Settling(wind=(0, 21, 0)), "at most 20"),
    "wind word": (lambda: Settling(wind="north"), "must be three numbers"),
    "rays": (lambda: Settling(rays=0), "settling.rays = 0"),
    "true": (lambda: Settling(coverage=True), "settling.coverage = True"),
    "dust": (lambda: Settling(extinction="icing sugar"), "settling.extinction = 'icing sugar'"),
    "size": (lambda: dust.texel_points(plate(1), np.zeros((2, 3, 2)), 0), "size = 0"),
    "uvs": (lambda: dust.texel_points(plate(1), np.zeros((3, 3, 2)), 8), "uvs_per_corner has shape"),
}


@pytest.mark.parametrize("name", WRONG)
def test_bad_input_gets_one_sentence(name):
    work, words = WRONG[name]
    with pytest.raises(ValueError, match=words) as caught:
        work()
    assert "\n" not in str(caught.value)


def test_progress_rises_and_a_cancelled_run_ends():
    from lamina import Cancelled

    seen = []
    settle(sphere(32, 64), settings=Settling(rays=4096), progress=lambda fraction, text: seen.append(fraction))
    assert seen == sorted(seen)
    assert len(seen) > 4
    assert (seen[0], seen[-1]) == (0.0, 1.0)
    for last in range(len(seen)):
        calls = iter(range(1000))
        with pytest.raises(Cancelled, match="settling of dust"):
            settle(sphere(32, 64), settings=Settling(rays=4096), cancel=lambda calls=calls, last=last:
                   next(calls) >= last)


def test_statistics_read_well():
    found = settle(plate(), settings=Settling(rays=16))
    assert found.statistics.points == 81
    assert found.statistics.rays == 81 * 16 + found.statistics.grains
    assert str(found.statistics).startswith("optical thickness 1 on average, 1 at most, 100 % covered; 81 points")
