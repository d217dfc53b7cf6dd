# SPDX-License-Identifier: GPL-3.0-or-later
"""Opaque faces absorb the light that meets them, from inside and from outside."""

import dataclasses
import math

import numpy as np
import pytest
from walk_meshes import box
from z_limit import z_limit

import lamina
from lamina import EndMaterial, Interior, Lamp, Surface
from lamina.interior.solid import closed

SCATTERING, ABSORPTION = 1.5, 0.05
MEDIUM = Interior.uniform(EndMaterial(SCATTERING, ABSORPTION))
SUN = (0.48, 0.36, 0.8)
CUBE = box((-1, -1, -1), (1, 1, 1))
CAP = (CUBE.vertices[CUBE.triangles][:, :, 2] == 1.0).all(axis=1)
PLACES = np.array([[1.0, 0.2, 0.7], [1.0, -0.3, -0.4], [0.1, 0.2, -1.0]])
NORMALS = np.array([[1.0, 0, 0], [1.0, 0, 0], [0, 0, -1.0]])


def with_cap(solid=CUBE, opaque=CAP):
    return dataclasses.replace(solid, opaque=opaque)


def way_out(places, ways):
    """(distance, whether through the top) to the surface of the cube."""
    with np.errstate(divide="ignore"):
        ends = np.where(ways == 0.0, math.inf, (np.sign(ways) - places) / ways)
    return ends.min(axis=1), (ends.argmin(axis=1) == 2) & (ways[:, 2] > 0.0)


def on_sphere(count, rng):
    z, turn = 2.0 * rng.random(count) - 1.0, 2.0 * math.pi * rng.random(count)
    side = np.sqrt(1.0 - z * z)
    return np.column_stack([side * np.cos(turn), side * np.sin(turn), z])


def photons(place, normal, has_cap, number, rng):
    """(mean, standard error) of the exit albedo and of the light of the sun, of isotropic scattering in the cube."""
    ways = on_sphere(number, rng) - (1.0 - 1e-12) * normal  # cosine-distributed
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    places, alive = np.tile(place - 1e-9 * normal, (number, 1)), np.arange(number)
    exits, light, sun = np.zeros(number), np.zeros(number), np.tile(np.array(SUN), (number, 1))
    extinction, weight = SCATTERING + ABSORPTION, 1.0
    while len(alive):
        flight = rng.exponential(1.0 / extinction, len(alive))
        most, on_top = way_out(places, ways)
        gone = flight >= most
        exits[alive[gone & ~(on_top & has_cap)]] = weight
        places, alive = (places + flight[:, None] * ways)[~gone], alive[~gone]
        weight *= SCATTERING / extinction
        most, on_top = way_out(places, sun[:len(alive)])
        light[alive] += weight / (4.0 * math.pi) * np.exp(-extinction * most) * ~(on_top & has_cap)
        ways = on_sphere(len(alive), rng)
    return [(score.mean(), score.std() / math.sqrt(number)) for score in (exits, light)]


@pytest.mark.parametrize("has_cap", [True, False])
def test_a_cube_agrees_with_a_photon_walk(has_cap):
    """The cube without a cap shows that both walks have the same units."""
    rng = np.random.default_rng(3)
    wanted = np.array([photons(*one, has_cap, 60_000, rng) for one in zip(PLACES, NORMALS, strict=True)])
    solid = with_cap() if has_cap else CUBE
    exits = lamina.walk_in_mesh(solid, MEDIUM, PLACES, NORMALS, samples=20_000, seed=5).albedo
    light = lamina.light_in_mesh(solid, MEDIUM, [Lamp(SUN)], PLACES, NORMALS, samples=20_000, seed=6).lamps
    for place, found in enumerate((exits, light)):
        value, stderr = (one.reshape(3, 3)[:, 0] for one in (found.value, found.stderr))
        z = (value - wanted[:, place, 0]) / np.hypot(stderr, wanted[:, place, 1])
        assert np.abs(z).max() < z_limit(12), z


@pytest.mark.parametrize("surface", [Surface(), Surface(1.4), Surface(1.4, 0.3)])
def test_a_cap_between_body_and_sun_leaves_the_body_dark(surface):
    """The sun shines on the cap alone."""
    sun = [Lamp((0.0, 0.0, 1.0), 0.05)]
    low = box((-1, -1, -1), (1, 1, 1), opaque=CAP)
    places = PLACES[2:], NORMALS[2:]
    found = lamina.light_in_mesh(low, MEDIUM, sun, *places, surface=surface, samples=2000).lamps.value
    clear = lamina.light_in_mesh(CUBE, MEDIUM, sun, *places, surface=surface, samples=2000).lamps.value
    grazing = math.sin(0.05)  # the sun's disk reaches the sides at up to this cosine
    assert clear.min() > 1e-3 and found.max() < grazing * clear.min()


@pytest.mark.parametrize("surface", [Surface(), Surface(1.4), Surface(1.4, 0.3)])
def test_a_body_with_opaque_faces_alone_around_it_gets_no_light(surface):
    """The slab above shades the sun from outside; its lower side is opaque, too."""
    slab = box((-9, -9, 2), (9, 9, 2.5))
    both = lamina.Solid(np.vstack([CUBE.vertices, slab.vertices]), np.vstack([CUBE.triangles, slab.triangles + 8]),
                        opaque=np.repeat([False, True], 12))
    found = lamina.light_in_mesh(both, MEDIUM, [Lamp(SUN, 0.02)], PLACES, NORMALS, surface=surface, samples=500)
    clear = lamina.light_in_mesh(CUBE, MEDIUM, [Lamp(SUN, 0.02)], PLACES, NORMALS, surface=surface, samples=500)
    assert (found.lamps.value == 0.0).all() and clear.lamps.value.min() > 0.0


def test_a_sheet_inside_stops_light():
    """The opaque bottom of a box that is sunk into the cube parts the upper half from the lower half."""
    upper = box((-1, -1, 0), (1, 1, 1))
    opaque = np.concatenate([np.zeros(12, bool), (upper.vertices[upper.triangles][:, :, 2] == 0.0).all(axis=1)])
    both = lamina.Solid(np.vstack([CUBE.vertices, upper.vertices]), np.vstack([CUBE.triangles, upper.triangles + 8]))
    sun, places = [Lamp((0.0, 0.0, 1.0))], ([[0.1, 0.2, -1.0]], [[0, 0, -1]])
    parted = lamina.light_in_mesh(with_cap(both, opaque), MEDIUM, sun, *places, samples=2000).lamps.value
    whole = lamina.light_in_mesh(both, MEDIUM, sun, *places, samples=2000).lamps.value
    assert (parted == 0.0).all() and whole.min() > 0.0


def test_points_on_opaque_faces_have_no_value():
    corners = np.array([[0.1, 0.1], [0.9, 0.1], [0.1, 0.9]])
    uvs = np.array([(corners + (number % 4, number // 4)) / 4.0 for number in range(12)])
    found = lamina.lit_images(with_cap(), MEDIUM, [Lamp(SUN)], uvs=uvs, size=32, samples=16, margin=0)
    clear = lamina.lit_images(CUBE, MEDIUM, [Lamp(SUN)], uvs=uvs, size=32, samples=16, margin=0)
    rows, columns = np.nonzero(clear.mask)
    opaque = CAP[rows // 8 * 4 + columns // 8]
    assert opaque.any() and np.array_equal(found.mask[rows, columns], ~opaque)
    assert found.mask.sum() == (~opaque).sum()
    relightable = lamina.relightable_images(with_cap(), MEDIUM, uvs=uvs, size=32, samples=16, margin=0)
    assert np.array_equal(relightable.mask, found.mask)
    on_cap = lamina.light_in_mesh(with_cap(), MEDIUM, [Lamp(SUN)], [[0.1, 0.2, 1.0]], [[0, 0, 1]], samples=16)
    assert (on_cap.lamps.value == 0.0).all() and (on_cap.sky.value == 0.0).all()


def test_repairs_keep_opaque_faces():
    """A triangle that collapses when vertices are merged comes first, and the last two are missing."""
    apart = np.vstack([CUBE.vertices, CUBE.vertices[0]])
    broken = lamina.Solid(apart, np.vstack([[0, 8, 1], CUBE.triangles[:-2]]), True, opaque=np.arange(11) % 3 == 1)
    found = closed(broken)
    mesh, opaque = found.mesh, found.opaque
    middles = mesh.vertices[mesh.triangles].mean(axis=1)
    wanted = CUBE.vertices[broken.triangles[1:]].mean(axis=1)[broken.opaque[1:]]
    np.testing.assert_allclose(middles[opaque], wanted, atol=1e-12)
    assert len(opaque) == len(mesh.triangles) == 14


def test_parts_of_runs_with_other_opaque_faces_do_not_mix(tmp_path):
    runs = [lamina.walk_part(solid, MEDIUM, (number, 2), points=PLACES, normals=NORMALS, samples=4)
            for number, solid in ((1, CUBE), (2, with_cap()))]
    with pytest.raises(lamina.ShardError, match="solid"):
        lamina.merge_walks(runs)
