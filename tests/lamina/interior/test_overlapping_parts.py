# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of several closed parts that overlap, as kitbashed models have them: light sees their union."""

import numpy as np
import pytest
from walk_meshes import box, sphere
from z_limit import z_limit

import lamina
from lamina import EndMaterial, Interior, Lamp

MEDIUM = Interior.uniform(EndMaterial((2.0, 4.0, 1.0), (0.1, 0.1, 0.01), 0.3))
SUNS = [Lamp([0.3, 0.2, 0.9]), Lamp([0.3, 0.2, -0.9])]
SAMPLES = 6000


def together(*parts):
    firsts = np.cumsum([0, *(len(one.vertices) for one in parts[:-1])])
    return lamina.Solid(np.vstack([one.vertices for one in parts]),
                        np.vstack([one.triangles + first for one, first in zip(parts, firsts, strict=True)]))


def slab_with_post(sunk):
    return together(box((-2, -2, -1), (2, 2, 0)), box((-0.5, -0.5, -sunk), (0.5, 0.5, 1)))


# Beside the seam, away from it, on the post.
PLACES = ([[0.55, 0.1, 0.0], [0.7, 0.1, 0.0], [1.5, 0.1, 0.0], [0.5, 0.1, 0.05], [0.1, 0.2, 1.0]],
          [[0, 0, 1], [0, 0, 1], [0, 0, 1], [1, 0, 0], [0, 0, 1]])


def estimates(solid, places, surface, seed):
    """(values, standard errors) of exit albedo and light of two lamps at the places."""
    exits = lamina.walk_in_mesh(solid, MEDIUM, *places, surface=surface, samples=SAMPLES, seed=seed)
    light = lamina.light_in_mesh(solid, MEDIUM, SUNS, *places, surface=surface, samples=SAMPLES, seed=seed + 1)
    assert exits.count.lost == 0.0
    return (np.concatenate([np.ravel(exits.albedo.value), np.ravel(light.lamps.value)]),
            np.concatenate([np.ravel(exits.albedo.stderr), np.ravel(light.lamps.stderr)]))


def require_equal(one, other, cases):
    z = (one[0] - other[0]) / np.hypot(one[1], other[1])
    assert np.abs(z).max() < z_limit(z.size * cases), z


@pytest.mark.parametrize(("sunk", "surface"), [(0.1, lamina.Surface()), (0.5, lamina.Surface()),
                                               (0.9, lamina.Surface()), (0.5, lamina.Surface(1.4, 0.3))])
def test_it_does_not_matter_how_deep_a_post_is_sunk(sunk, surface):
    require_equal(estimates(slab_with_post(sunk), PLACES, surface, 3),
                  estimates(slab_with_post(1e-4), PLACES, surface, 13), 4)


def test_two_boxes_whose_sides_coincide_are_one_box():
    whole = box((-1, -1, -1), (1, 1, 1))
    two = together(box((-1, -1, -1), (0.3, 1, 1)), box((-0.2, -1, -1), (1, 1, 1)))
    places = [[-0.25, 0.1, 1.0], [0.35, 0.1, 1.0], [0.9, 0.2, 1.0]], [[0, 0, 1]] * 3
    require_equal(estimates(two, places, lamina.Surface(), 5), estimates(whole, places, lamina.Surface(), 15), 1)


def test_a_sphere_inside_another_changes_nothing():
    outer, inner = sphere(1.0, 3), sphere(0.6, 2)
    places = outer.vertices[:2], outer.vertices[:2]
    require_equal(estimates(together(outer, inner), places, lamina.Surface(), 7),
                  estimates(outer, places, lamina.Surface(), 17), 1)


def test_vertices_inside_another_part_have_no_value():
    solid = slab_with_post(0.5)
    found = lamina.lit_images(solid, MEDIUM, SUNS, samples=64)
    buried = (np.abs(solid.vertices[:, :2]).max(axis=1) < 1.0) & (solid.vertices[:, 2] < 0.0)
    assert buried.sum() == 4 and np.array_equal(found.mask, ~buried)


def test_a_map_of_buried_vertices_alone_is_refused():
    outer, inner = box((-2, -2, -2), (2, 2, 2)), box((-1, -1, -1), (1, 1, 1))
    solid = together(outer, inner)
    uvs = np.zeros((len(solid.triangles), 3, 2))
    uvs[:, :, 0] = -1.0  # left out on purpose
    uvs[12:] = np.array([[0.1, 0.1], [0.9, 0.1], [0.1, 0.9]])
    uvs[13:] = -1.0
    with pytest.raises(lamina.InteriorError, match="all points of the map lie inside other parts"):
        lamina.relightable_images(solid, MEDIUM, uvs=uvs, size=8, samples=16)


def light_of_suns(solid, interior, *places):
    return lamina.light_in_mesh(solid, interior, SUNS, *places)


@pytest.mark.parametrize("call", [lamina.walk_in_mesh, light_of_suns])
def test_normals_that_point_inwards_are_refused(call):
    cube = box((0, 0, 0), (10, 10, 10))
    sides = [[4.0, 5.0, 10.0], [10.0, 5.0, 3.0]], [[0, 0, 1], [-1, 0, 0.2]]
    with pytest.raises(lamina.InteriorError, match=r"normals\[1\] = \(-0.98.*points into the solid"):
        call(cube, MEDIUM, *sides)


@pytest.mark.parametrize("call", [lamina.walk_in_mesh, light_of_suns])
def test_a_face_of_another_part_close_by_turns_no_normal(call):
    """The other face, which points down, lies nearer than the distance within which faces are looked for."""
    cube, lid = box((0, 0, 0), (10, 10, 10)), box((4, 4, 10.0005), (6, 6, 12))
    call(together(cube, lid), MEDIUM, [[5, 5, 10.0]], [[0, 0, 1]])
    with pytest.raises(lamina.InteriorError, match="points into the solid"):
        call(together(cube, lid), MEDIUM, [[5, 3, 10.0]], [[0, 0, -1]])
