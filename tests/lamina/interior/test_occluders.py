# SPDX-License-Identifier: GPL-3.0-or-later
"""Opaque things around a solid: shadows, and light that they reflect."""

import numpy as np
import pytest
from walk_meshes import box, sphere
from z_limit import z_limit

import lamina
from lamina import ArgumentError, EndMaterial, Interior, Lamp, Occluders, PointLamp, Surface
from lamina.interior.parts import estimated
from lamina.interior.problem import Lights, Problem, Run, WalkPoints

MEDIUM = Interior.uniform(EndMaterial((2.0, 3.0, 1.5), (0.1, 0.02, 0.3), 0.4))
CUBE = box((-1, -1, -1), (1, 1, 1))
PLACES = np.array([[1.0, 0.2, 0.7], [1.0, -0.3, -0.4], [0.1, 0.2, 1.0], [0.3, -0.4, -1.0]])
NORMALS = np.array([[1.0, 0, 0], [1.0, 0, 0], [0, 0, 1.0], [0, 0, -1.0]])
SUN = Lamp([0.2, 0.1, 1.0], 0.1)
SURFACES = [Surface(), Surface(1.3, 0.3), Surface(1.3)]


def square(height, half=50.0, albedo=0.0):
    """A horizontal one about the origin."""
    corners = [[-half, -half, height], [half, -half, height], [half, half, height], [-half, half, height]]
    return Occluders(corners, [[0, 1, 2], [0, 2, 3]], albedo)


def light(occluders, surface=None, lamps=(SUN,), samples=2000, **more):
    return lamina.light_in_mesh(CUBE, MEDIUM, list(lamps), PLACES, NORMALS, surface=surface, samples=samples,
                                occluders=occluders, **more)


@pytest.mark.parametrize("surface", SURFACES, ids=["matched", "rough", "smooth"])
def test_a_black_ceiling_takes_all_light_of_the_sun(surface):
    found = light(square(3.0), surface)
    assert np.all(found.lamps.value == 0.0) and np.all(found.sky.value > 0.0)


def test_what_is_behind_the_lamp_or_inside_has_no_effect():
    lamp = PointLamp([0.0, 0.0, 4.0], 0.3)
    alone = light(None, lamps=[lamp])
    assert np.array_equal(light(square(6.0, 1.0), lamps=[lamp]).lamps.value, alone.lamps.value)
    assert np.array_equal(light(square(0.0, 0.9), lamps=[lamp]).lamps.value, alone.lamps.value)


def test_a_shell_takes_all_light_of_the_sky():
    shell = sphere(5.0, 3)
    found = light(Occluders(shell.vertices, shell.triangles, 0.5), lamps=[], samples=200)
    assert np.all(found.sky.value == 0.0)


@pytest.mark.parametrize("surface", SURFACES[:2], ids=["matched", "rough"])
def test_a_large_floor_under_a_sun_is_a_lower_sky(surface):
    """A floor of albedo a under a sun of irradiance E has the radiance a E cos / pi. The body's shadow on a floor far
    below is small."""
    albedo, height = np.array([0.9, 0.5, 0.2]), 400.0
    floor = square(-height, 400000.0, albedo)
    lit = Lights([SUN], None, floor, by_occluders=True)
    by_floor = estimated(Problem(CUBE, MEDIUM, surface, lit, WalkPoints.of(PLACES, NORMALS)), Run(20000)).lamps
    radiance = np.ones((2, 1, 3), np.float32)
    radiance[0] = 0.0  # rows from the bottom or the top: one half of the sphere
    halves = [light(None, surface, lamps=[], samples=20000, seed=2 + number,
                    surroundings=lamina.Surroundings(radiance[::1 - 2 * number].copy())).sky for number in (0, 1)]
    below = min(halves, key=lambda one: one.value[2].sum())  # the top face sees less of it
    cosine = SUN.towards[2] / np.linalg.norm(SUN.towards)
    wanted = below.value * albedo * cosine / np.pi
    found = by_floor.value[:, 0]
    error = np.sqrt(by_floor.stderr[:, 0] ** 2 + (below.stderr * albedo * cosine / np.pi) ** 2)
    z = (found - wanted) / error
    assert np.abs(z).max() < z_limit(z.size), z
    assert np.all(error < 0.03 * wanted)


@pytest.mark.parametrize("surface", SURFACES, ids=["matched", "rough", "smooth"])
def test_a_shell_that_shines_is_a_sky(surface):
    shell = sphere(5.0, 3)
    shining = Occluders(shell.vertices, shell.triangles, 0.0, (2.0, 1.0, 0.5))
    inside, outside = light(shining, surface, lamps=[]).sky, light(None, surface, lamps=[], seed=1).sky
    z = (inside.value / [2.0, 1.0, 0.5] - outside.value) / np.hypot(inside.stderr / [2.0, 1.0, 0.5], outside.stderr)
    assert np.abs(z).max() < z_limit(3 * z.size)


def test_equal_seeds_give_equal_bytes_for_any_number_of_threads():
    one, other = (light(square(-2.0, albedo=0.7), threads=threads, samples=300) for threads in (1, 3))
    assert one == other


def test_merged_parts_are_one_run():
    floor = square(-2.0, albedo=0.7)
    more = {"surface": None, "samples": 64, "occluders": floor}
    parts = [lamina.walk_part(CUBE, MEDIUM, (i, 2), [SUN], PLACES, NORMALS, **more) for i in (1, 2)]
    assert lamina.merge_walks(parts) == light(floor, samples=64)
    assert parts[0].job["occluders"] != lamina.walk_part(CUBE, MEDIUM, (1, 2), [SUN], PLACES, NORMALS, **more | {
        "occluders": square(-2.0, albedo=0.6)}).job["occluders"]


@pytest.mark.parametrize(("arguments", "words"), [
    (([[0, 0, 0]], np.zeros((0, 3), int)), "is empty"), (([[0, 0, np.nan]] * 3, [[0, 1, 2]]), "nan"),
    ((np.eye(3), [[0, 1, 3]]), "triangles"), ((np.eye(3), [[0, 1, 2]], 1.5), "must be 0 to 1"),
    ((np.eye(3), [[0, 1, 2]], [0.1, 0.2]), "has the shape"),
    ((np.eye(3), [[0, 1, 2]], 0.1, -1.0), "must be 0 or more")])
def test_bad_occluders(arguments, words):
    with pytest.raises(ArgumentError, match=words):
        Occluders(*arguments)


def test_other_things_are_refused():
    with pytest.raises(ArgumentError, match=r"lamina\.Occluders"):
        light(CUBE)
