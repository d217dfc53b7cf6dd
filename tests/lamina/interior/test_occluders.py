# SPDX-License-Identifier: GPL-3.0-or-later
"""Opaque things around a solid: shadows, and light that they reflect."""

from dataclasses import replace

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
FIRST = 2**64 - 1 - 2  # the bits of all linkings but 1
SURFACES = [Surface(), Surface(1.3, 0.3), Surface(1.3)]


def square(height, half=50.0, albedo=0.0, **more):
    """A horizontal one about the origin."""
    corners = [[-half, -half, height], [half, -half, height], [half, half, height], [-half, half, height]]
    return Occluders(corners, [[0, 1, 2], [0, 2, 3]], albedo, **more)


def joined(*parts):
    """Occluders in one; the solid is lit as the first ones say."""
    firsts = np.cumsum([0, *(len(one.vertices) for one in parts)])
    triangles = np.concatenate([one.triangles.astype(int) + first for one, first in zip(parts, firsts, strict=False)])
    fields = {name: np.concatenate([getattr(one, name) for one in parts])
              for name in ("vertices", "albedo", "emission", "shadows", "lit", "linking")}
    return Occluders(triangles=triangles, solid_lit=parts[0].solid_lit, **fields)


def shell(radius, **more):
    mesh = sphere(radius, 3)
    return Occluders(mesh.vertices, mesh.triangles, **more)


def linked(lamp, linking=1):
    return replace(lamp, linking=linking)


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


@pytest.mark.parametrize("surface", SURFACES, ids=["matched", "rough", "smooth"])
def test_light_passes_what_does_not_take_its_linking(surface):
    """And meets what does, behind that, as if nothing were there."""
    lamp = PointLamp([0.0, 0.0, 4.0], 0.3)
    lamps = [SUN, linked(SUN), lamp, linked(lamp)]
    alone, among = light(None, surface, lamps), light(square(3.0, shadows=FIRST), surface, lamps)
    assert np.all(among.lamps.value[:, ::2] == 0.0) and np.all(alone.lamps.value > 0.0)
    assert np.array_equal(among.lamps.value[:, 1::2], alone.lamps.value[:, 1::2])
    both = joined(square(3.0, shadows=FIRST), square(3.5))
    assert np.all(light(both, surface, lamps).lamps.value == 0.0)
    twice = joined(square(3.0, shadows=FIRST), square(3.0, shadows=0, lit=0, linking=3))
    assert np.array_equal(light(twice, surface, lamps).lamps.value, among.lamps.value)


def test_what_is_not_lit_reflects_nothing():
    """Two halves of a floor far below, each lit by a sun of its own: as each half alone."""
    halves = [Occluders([[0, -4e5, -400], [side * 4e5, -4e5, -400], [side * 4e5, 4e5, -400], [0, 4e5, -400]],
                        [[0, 1, 2], [0, 2, 3]], 0.7, lit=lit) for side, lit in ((-1, 1 + 2), (1, 1 + 4))]
    sun = Lamp([0.2, 0.1, 1.0])

    def by_floor(lamps, floor, seed):
        lit = Lights(lamps, None, floor, by_occluders=True)
        return estimated(Problem(CUBE, MEDIUM, None, lit, WalkPoints.of(PLACES, NORMALS)), Run(8000, seed=seed)).lamps

    found = by_floor([sun, linked(sun), linked(sun, 2)], joined(*halves), 2)
    np.testing.assert_allclose(found.value[:, 1] + found.value[:, 2], found.value[:, 0], rtol=1e-9)
    for number, half in enumerate(halves):
        alone = by_floor([sun], half, 3)
        z = (found.value[:, 1 + number] - alone.value[:, 0]) / np.hypot(found.stderr[:, 1 + number], alone.stderr[:, 0])
        assert np.abs(z).max() < z_limit(2 * z.size), z
    assert (found.stderr < 0.1 * found.value).all()


@pytest.mark.parametrize("surface", SURFACES, ids=["matched", "rough", "smooth"])
def test_emission_passes_what_does_not_take_its_linking(surface):
    """A shell that shines through a black one is a sky, two that take no light of their own are two skies; behind a
    shell that takes the light they are none."""
    shining = shell(5.0, emission=(2.0, 1.0, 0.5), linking=1, shadows=FIRST)
    outside = light(None, surface, lamps=[], seed=1).sky
    nearer = joined(shining, shell(4.0, emission=(2.0, 1.0, 0.5), linking=1, shadows=FIRST))
    for around, skies in ((joined(shining, shell(4.0, shadows=FIRST)), 1.0), (nearer, 2.0)):
        inside = light(around, surface, lamps=[]).sky
        wanted = skies * np.array([2.0, 1.0, 0.5])
        z = (inside.value / wanted - outside.value) / np.hypot(inside.stderr / wanted, outside.stderr)
        assert np.abs(z).max() < z_limit(6 * z.size), z
    assert np.all(light(joined(shining, shell(4.0)), surface, lamps=[], samples=200).sky.value == 0.0)


@pytest.mark.parametrize("shadows", [FIRST, 2**64 - 1], ids=["passing", "taken"])
def test_emission_lights_what_is_linked(shadows):
    """Light of a shell: that on the solid and that by a floor are the light of both."""
    floor = square(-2.0, 4.0, (0.9, 0.5, 0.2))
    shining = shell(8.0, emission=1.0, linking=1, shadows=shadows)

    def sky(solid_lit, lit, seed):
        around = joined(replace(shining, solid_lit=solid_lit), replace(floor, lit=lit))
        return light(around, lamps=[], samples=20000, seed=seed).sky

    both, direct, by_floor = sky(FIRST + 2, FIRST + 2, 1), sky(FIRST + 2, FIRST, 2), sky(FIRST, FIRST + 2, 3)
    assert np.all(sky(FIRST, FIRST, 4).value == 0.0)
    z = (both.value - direct.value - by_floor.value) / np.sqrt(both.stderr**2 + direct.stderr**2 + by_floor.stderr**2)
    assert np.abs(z).max() < z_limit(2 * z.size), z
    assert np.all(by_floor.value[3] > 0.05 * direct.value[3]), "the floor's light is more than noise"


def test_equal_seeds_give_equal_bytes_for_any_number_of_threads():
    one, other = (light(square(-2.0, albedo=0.7), threads=threads, samples=300) for threads in (1, 3))
    assert one == other
    links = joined(square(-2.0, albedo=0.7, emission=1.0, linking=1, shadows=FIRST), square(3.0, lit=5, shadows=6))
    one, other = (light(links, threads=threads, samples=300, lamps=[linked(SUN)]) for threads in (1, 3))
    assert one == other


def test_links_are_part_of_what_occluders_are():
    floors = [square(-2.0), square(-2.0, shadows=FIRST), square(-2.0, lit=FIRST), square(-2.0, solid_lit=FIRST),
              square(-2.0, shadows=FIRST, linking=1)]
    assert len({floor.hash for floor in floors}) == 5 and floors[0].links is None
    assert square(-2.0, linking=1).hash == floors[0].hash, "all light meets everything"
    parts = [lamina.walk_part(CUBE, MEDIUM, (1, 1), [lamp], PLACES, NORMALS, samples=1) for lamp in (SUN, linked(SUN))]
    assert parts[0].job != parts[1].job and "linking" not in parts[0].job["lamps"][0]


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
    ((np.eye(3), [[0, 1, 2]], 0.1, -1.0), "must be 0 or more"),
    ((np.eye(3), [[0, 1, 2]], 0.1, 0.0, 1.0), "shadows = 1.0: must be whole numbers from 0 to 18446744073709551615"),
    ((np.eye(3), [[0, 1, 2]], 0.1, 0.0, 1, -1), "lit = -1"), ((np.eye(3), [[0, 1, 2]], 0.1, 0.0, [1, 2]), "the shape"),
    ((np.eye(3), [[0, 1, 2]], 0.1, 0.0, 1, 1, 64), "linking = 64: must be whole numbers from 0 to 63"),
    ((np.eye(3), [[0, 1, 2]], 0.1, 0.0, 1, 1, 1, 2**64), "solid_lit")])
def test_bad_occluders(arguments, words):
    with pytest.raises(ArgumentError, match=words):
        Occluders(*arguments)


def test_bad_linkings_of_lamps():
    with pytest.raises(ArgumentError, match="linking = 64: must be a whole number from 0 to 63"):
        linked(SUN, 64)


def test_other_things_are_refused():
    with pytest.raises(ArgumentError, match=r"lamina\.Occluders"):
        light(CUBE)
