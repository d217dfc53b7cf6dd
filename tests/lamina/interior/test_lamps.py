# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps and surroundings of a solid: far lamps against the solver, near lamps against the flux that enters, and discs
against their image in the surroundings."""

import numpy as np
import pytest
from walk_meshes import slab, sphere, view
from z_limit import z_limit

import lamina
from lamina import AreaLamp, ArgumentError, EndMaterial, Interior, Lamp, PointLamp, SpotLamp, Surface, Surroundings

SIGMA_S, SIGMA_A, G, THICKNESS = (0.9, 1.6, 0.4), (0.1, 0.05, 0.3), 0.6, 2.0
UNIFORM = Interior.uniform(EndMaterial(SIGMA_S, SIGMA_A, G))
FAR = 1e6  # mm
MU = 0.8  # cosine at the slab of the light from far lamps


def require_within_error(difference, stderr):
    z = np.ravel(difference) / np.ravel(stderr)
    assert np.abs(z).max() < z_limit(z.size), z


def far_lamps():
    """(lamp, irradiance on a plane perpendicular to the light) by name, all in the direction view(MU)."""
    towards = np.array(view(MU))
    place, metres = FAR * towards, FAR / 1000.0
    aside = np.cross(towards, [0.0, 1.0, 0.0])
    across = aside / np.linalg.norm(aside)
    up = np.cross(-towards, across)  # across x up points back to the slab
    # Half-way through the blend of the spot's edge the smooth step is at 1/2.
    cosine = np.cos(0.3)
    axis = -towards * (cosine + 0.25 * (1.0 - cosine)) + across * np.sqrt(1.0 - (cosine + 0.25 * (1.0 - cosine)) ** 2)
    return {"point": (PointLamp(place), 1.0 / metres**2), "ball": (PointLamp(place, 0.3 * FAR), 1.0 / metres**2),
            "spot": (SpotLamp(place, axis, 0.6, 0.5), 0.5 / metres**2),
            "area": (AreaLamp(place, 300.0 * across, 200.0 * up), 4.0 * 300.0 * 200.0 / FAR**2),
            "ellipse": (AreaLamp(place, 300.0 * across, 200.0 * up, True), np.pi * 300.0 * 200.0 / FAR**2),
            "away": (AreaLamp(place, 200.0 * up, 300.0 * across), 0.0)}


@pytest.mark.parametrize("surface", [Surface(), Surface(1.4, 0.3)], ids=["matched", "rough"])
def test_far_lamps_light_a_slab_as_the_solver_says(surface):
    lamps = {name: pair for name, pair in far_lamps().items() if name != "ball"}
    solid, points, normals = slab(THICKNESS)
    out = [-0.6, 0.0, 0.8]
    found = lamina.light_in_mesh(solid, UNIFORM, [lamp for lamp, _ in lamps.values()], points, normals, out, surface,
                                 8000, seed=3).lamps
    medium = lamina.Medium(sigma_s=SIGMA_S, sigma_a=SIGMA_A, thickness=THICKNESS, phase=lamina.HenyeyGreenstein(G))
    black = lamina.Medium(sigma_s=0.0, sigma_a=1e4, thickness=THICKNESS)
    faces = [lamina.Interface(ior=ior, alpha=surface.alpha) for ior in (surface.ior, 1.0)]
    azimuth = np.pi - np.arctan2(-0.0, -1.0)
    brdf = lamina.solve(lamina.Stack([medium] if surface.ior == 1.0 else [faces[0], medium, faces[1]])).brdf(
        out[2], MU, azimuth)
    if surface.alpha:  # without the reflection by the facets on top
        brdf = brdf - lamina.solve(lamina.Stack([faces[0], black, faces[1]])).brdf(out[2], MU, azimuth)
    irradiance = np.array([light for _, light in lamps.values()])
    expected = np.ravel(brdf) * MU * irradiance[:, None]
    lit = irradiance > 0.0
    assert not found.value[0, ~lit].any()
    require_within_error(found.value[0, lit] - expected[lit], found.stderr[0, lit])


def test_a_far_ball_behind_a_smooth_boundary_is_a_disc():
    lamp, irradiance = far_lamps()["ball"]
    disc = Lamp(view(MU), np.arcsin(0.3))
    solid, points, normals = slab(THICKNESS)
    found = lamina.light_in_mesh(solid, UNIFORM, [lamp, disc], points, normals, view(0.9), Surface(1.4), 16000,
                                 seed=3).lamps
    balls, discs = found.value[0] / [[irradiance], [1.0]]
    require_within_error(balls - discs, np.hypot(*(found.stderr[0] / [[irradiance], [1.0]])))
    assert (found.stderr[0, 1] < 0.05 * discs).all()


def solid_angle(corners):
    """The solid angle of triangles seen from the origin, positive if their front is seen (van Oosterom, Strackee)."""
    a, b, c = (corners[:, k] for k in range(3))
    la, lb, lc = (np.linalg.norm(one, axis=1) for one in (a, b, c))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = (la * lb * lc + np.einsum("ij,ij->i", a, b) * lc + np.einsum("ij,ij->i", b, c) * la
             + np.einsum("ij,ij->i", c, a) * lb)
    return -2.0 * np.arctan2(volume, below)


def test_near_lamps_lose_no_light():
    """An optically thick ball of albedo 1 returns the flux that enters from a lamp near by. The radiance of a matched
    boundary does not count light that was never scattered; almost none passes."""
    solid = sphere(1.0, 2)
    corners = solid.vertices[solid.triangles]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    place = np.array([0.3, 1.2, 1.5])
    seen = solid_angle(corners - place)
    entering = seen[seen > 0.0].sum() * 1000.0**2  # irradiance 1 at 1 m is a flux of 1 in each steradian
    rng = np.random.default_rng(5)
    count = 1500
    chosen = rng.choice(len(area), count, p=area / area.sum())
    points = np.einsum("nk,nkc->nc", rng.dirichlet([1.0, 1.0, 1.0], count), corners[chosen])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[chosen]
    white = Interior.uniform(EndMaterial((6.0, 7.0, 8.0)))
    lamps = [PointLamp(place), PointLamp(place, 0.2), SpotLamp(place, -place, np.pi, 0.0)]
    found = lamina.light_in_mesh(solid, white, lamps, points, normals, samples=12, seed=6).lamps.value
    flux = np.pi * area.sum() * found
    z = (flux.mean(axis=0) - entering) / (flux.std(axis=0) / np.sqrt(count))
    assert np.abs(z).max() < z_limit(z.size), z
    assert (flux.std(axis=0) / np.sqrt(count) < 0.06 * entering).all()


@pytest.mark.parametrize("surface", [Surface(1.4, 0.3), Surface(1.4, 0.15), Surface(1.4)],
                         ids=["rough", "narrow", "smooth"])
def test_a_disc_is_the_same_in_the_surroundings(surface):
    """The surroundings count where paths escape, lamps by rays towards them: a disc of 54 degrees about +z, on a ball
    and a smaller one in its shadow, with coefficients that vary."""
    rng = np.random.default_rng(4)
    ball, small = sphere(1.0, 2), sphere(0.5, 2)
    solid = lamina.Solid(np.vstack([ball.vertices, small.vertices + [0.3, 0.0, -1.8]]),
                         np.vstack([ball.triangles, small.triangles + len(ball.vertices)]))
    sigma_s = rng.uniform(0.5, 3.0, (3, 3, 3, 3)) * [1.0, 1.5, 2.0]
    interior = Interior.of_coefficients(sigma_s, 0.1 * sigma_s[::-1], (-1, -1, -2.5), (1, 1, 1), 0.3)
    table = np.zeros((10, 4, 3))  # rows of 18 degrees
    table[-3:] = 1.0 / (np.pi * np.sin(0.3 * np.pi) ** 2)
    chosen = rng.choice(len(solid.triangles), 24)
    corners = solid.vertices[solid.triangles[chosen]]
    found = lamina.light_in_mesh(
        solid, interior, [Lamp([0, 0, 1], 0.3 * np.pi)], corners.mean(axis=1),
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), surface=surface, samples=6000, seed=8,
        surroundings=Surroundings(table))
    lamp, sky = found.lamps.value[:, 0].mean(axis=0), found.sky.value.mean(axis=0)
    errors = np.sqrt((found.lamps.stderr[:, 0] ** 2 + found.sky.stderr**2).sum(axis=0)) / len(chosen)
    require_within_error(lamp - sky, errors)
    assert (errors < 0.03 * sky).all()


def test_surroundings_have_their_colour_and_their_sides():
    """Uniform surroundings are the sky times a colour; light from +y lights the side at +y."""
    ball = sphere(1.0, 2)
    ends = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    places = [int(np.argmax(ball.vertices @ end)) for end in ends]
    how = {"points": ball.vertices[places], "normals": ball.vertices[places], "samples": 600, "seed": 2}
    dense = Interior.uniform(EndMaterial(20.0, 0.5))
    colour = np.array([0.5, 1.0, 2.0])
    white = lamina.light_in_mesh(ball, dense, **how).sky.value
    tinted = lamina.light_in_mesh(ball, dense, surroundings=Surroundings(np.ones((2, 3, 1)) * colour), **how).sky.value
    np.testing.assert_allclose(tinted, white * colour, rtol=1e-6)
    table = np.zeros((8, 8, 3))
    table[:4, 2] = 1.0  # azimuths from 90 down to 45 degrees, below the horizon
    light = lamina.light_in_mesh(ball, dense, surroundings=Surroundings(table), **how).sky.value.mean(axis=1)
    assert light[0] > 5.0 * light[1] and light[0] > 1.3 * light[2] > 0.0 and light[4] > 5.0 * light[3]


def test_a_sun_on_honed_stone_has_little_noise():
    """Rays in the refracted direction of the sun: before, a sample's standard deviation was 20 times its mean."""
    ball = sphere(30.0, 3)
    marble = Interior.uniform(EndMaterial((2.19, 2.62, 3.0), (0.0021, 0.0041, 0.0071)))
    places = ball.vertices[ball.vertices @ [0.3, 0.3, 0.9] > 15.0][::20]
    found = lamina.light_in_mesh(ball, marble, [Lamp([0.3, 0.3, 0.9], 0.005)], places, places,
                                 surface=Surface(1.5, 0.09), samples=64, seed=1).lamps
    assert np.sqrt((found.stderr**2).mean() * 64) < 3.0 * found.value.mean()


def bumpy_ball():
    """A ball of radius 10 mm with bumps of 6 %, and its normals at the vertices."""
    ball = sphere(1.0, 5)
    x, y, z = ball.vertices.T
    vertices = 10.0 * ball.vertices * (1.0 + 0.06 * np.sin(9 * x + 1) * np.sin(8 * y) * np.sin(10 * z + 2))[:, None]
    corners = vertices[ball.triangles]
    normals = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(normals, ball.triangles[:, k], np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    return lamina.Solid(vertices, ball.triangles), normals / np.linalg.norm(normals, axis=1)[:, None]


def test_stated_errors_of_a_sun_on_bumpy_polished_stone():
    """Rays go towards the sun through all faces that may refract it. With rays through one face alone, deviations are
    1.5 to 2.3 times the stated errors (seeds 1 to 3), because light through other faces is met by chance."""
    solid, normals = bumpy_ball()
    sun = Lamp([0.3, 0.3, 0.9], 0.005)
    chosen, repeated = np.flatnonzero(normals @ sun.towards > 0.4)[::300][:10], 40
    places = np.repeat(chosen, repeated)  # equal places with walks of their own
    marble = Interior.uniform(EndMaterial((2.19, 2.62, 3.0), (0.0021, 0.0041, 0.0071)))
    found = lamina.light_in_mesh(solid, marble, [sun], solid.vertices[places], normals[places],
                                 surface=Surface(1.5, 0.01), samples=64, seed=1).lamps
    value, stderr = (one[:, 0].reshape(len(chosen), repeated, 3) for one in (found.value, found.stderr))
    z = (value - value.mean(axis=1, keepdims=True)) / stderr * np.sqrt(repeated / (repeated - 1))
    assert np.sqrt((z**2).mean()) < 1.35


def test_noise_is_common_to_the_channels():
    """Walks of red, green and blue use the same random numbers, so that noise changes brightness more than colour."""
    ball = sphere(30.0, 3)
    veins = lamina.marble((-30, -30, -30), (30, 30, 30), 64)
    places = np.repeat(ball.vertices[:2], 80, axis=0)  # equal places with walks of their own
    found = lamina.walk_in_mesh(ball, veins, places, places, surface=Surface(1.5, 0.09), samples=8, seed=3).albedo.value
    noise = (found.reshape(2, 80, 3) - found.reshape(2, 80, 3).mean(axis=1, keepdims=True)).reshape(-1, 3)
    correlation = np.corrcoef(noise.T)
    assert correlation[0, 1] > 0.7 and correlation[0, 2] > 0.7


@pytest.mark.parametrize(("make", "words"), [
    (lambda: PointLamp([0, 0]), r"position = \[0, 0\]: must be three numbers"),
    (lambda: PointLamp([0, 0, 0], -1.0), r"radius = -1.0: must lie in \[0, 1e12\] mm"),
    (lambda: SpotLamp([0, 0, 0], [0, 0, 0], 1.0), "direction = .*not all 0"),
    (lambda: SpotLamp([0, 0, 0], [0, 0, 1], 4.0), "cone = 4.0: must lie in"),
    (lambda: AreaLamp([0, 0, 0], [1, 0, 0], [1, 1, 0]), "second = .*: must be perpendicular to first"),
    (lambda: Surroundings(np.zeros((4, 4))), r"radiance has the shape \(4, 4\): must be \(rows, columns, 3\)"),
    (lambda: Surroundings(np.full((2, 2, 3), -1.0)), "radiance = -1: must be 0 or more"),
    (lambda: lamina.light_in_mesh(sphere(1.0, 1), UNIFORM, [PointLamp([0, 0, 5])], surface=Surface(1.5), samples=1),
     r"lamps\[0\].radius = 0: must be above 0 behind a smooth boundary"),
    (lambda: lamina.light_in_mesh(sphere(1.0, 1), UNIFORM, surroundings=3, samples=1),
     "surroundings = 3: must be a lamina.Surroundings"),
])
def test_bad_lamps(make, words):
    with pytest.raises(ArgumentError, match=words):
        make()


def test_a_sun_of_two_degrees_in_single_precision_is_large_enough():
    angle = 0.5 * float(np.float32(np.radians(2.0)))
    assert angle < np.radians(1.0) and lamina.Lamp((0.0, 0.0, 1.0), angle).too_small == ""
    assert lamina.Lamp((0.0, 0.0, 1.0), 0.999 * angle).too_small
