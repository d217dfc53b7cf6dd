# SPDX-License-Identifier: GPL-3.0-or-later
"""Photons of lamps in light maps, against walks from the points, which share no estimator of light with them, and
against the light that enters."""

from dataclasses import replace

import numpy as np
import pytest
from walk_meshes import sphere
from z_limit import z_limit

import lamina
from lamina import AreaLamp, EndMaterial, Interior, Lamp, Occluders, PointLamp, SpotLamp, Surface
from lamina.common.progress import silent
from lamina.interior.parts import estimated
from lamina.interior.problem import Lights, Problem, Run, Samples, TexelImage, WalkPoints
from lamina.interior.walk import Walker
from lamina.maps import part_folder
from lamina.maps.places import places_of

PER_SIDE = 2  # texels of a face of a voxel
LAMPS = [Lamp([0.4, -1.0, 0.6], 0.3), PointLamp([1.0, 0.5, 5.0], 0.6),
         SpotLamp([5.0, 5.0, 1.0], [-1.0, -1.0, -0.1], 0.7, 0.4, 0.5),
         AreaLamp([-3.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0])]
# A colored floor, and a wall beside.
AROUND = Occluders([[-9, -9, -0.2], [9, -9, -0.2], [9, 9, -0.2], [-9, 9, -0.2],
                    [-1, -1, 0], [-1, 4, 0], [-1, 4, 0.8], [-1, -1, 0.8]],
                   [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]], [[0.9, 0.5, 0.2]] * 2 + [[0.3, 0.6, 0.8]] * 2)
# The wall takes no light of linking 1, and reflects none of linking 2.
LINKED = replace(AROUND, shadows=[2**64 - 1] * 2 + [1 + 4] * 2, lit=[2**64 - 1] * 2 + [1 + 2] * 2)
LINKED_LAMPS = [replace(lamp, linking=number % 3) for number, lamp in enumerate(LAMPS, 1)]
PLAIN = Interior.uniform(EndMaterial((2.0, 3.0, 1.5), (0.1, 0.02, 0.3), 0.4))
RNG = np.random.default_rng(4)
VEINED = Interior.of_coefficients(RNG.uniform(1.0, 4.0, (4, 4, 4, 3)), RNG.uniform(0.0, 0.5, (4, 4, 4, 3)), (0, 0, 0),
                                  (4, 4, 4), 0.3)


def of_voxels(filled):
    """(a solid of unit cubes, its UV map, the number of faces of the image along each side): each outer face of a cube
    has a square of the image of its own."""
    corners, uvs = [], []
    for cube in sorted(filled):
        for axis in range(3):
            for side in (0, 1):
                away = np.eye(3, dtype=int)[axis] * (2 * side - 1)
                if tuple(np.array(cube) + away) in filled:
                    continue
                first, second = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
                low = np.array(cube, float) + side * np.eye(3)[axis]
                square = np.array([low, low + first, low + first + second, low + second])
                corners.append(square if side else square[::-1])
    across = int(np.ceil(np.sqrt(len(corners))))
    for number in range(len(corners)):
        low = np.array([number % across, number // across]) / across
        uvs.append(low + np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) / across)
    vertices = np.concatenate(corners)
    triangles = (4 * np.arange(len(corners))[:, None, None] + [[0, 1, 2], [0, 2, 3]]).reshape(-1, 3)
    corner_uvs = np.concatenate([[square[[0, 1, 2]], square[[0, 2, 3]]] for square in uvs])
    return lamina.Solid(vertices, triangles), corner_uvs, across


CUP = {(x, y, z) for x in range(3) for y in range(3) for z in range(2)} - {(1, 1, 1)}
STAIRS = {(0, 0, 0), (1, 0, 0), (0, 0, 1), (0, 1, 0)}


def walker_of(solid, uvs, size, interior, surface, lamps, occluders=None):
    places = places_of(solid, uvs, size, None)
    points = WalkPoints.of(places.points.positions, places.points.normals)
    return Walker(Problem(solid, interior, surface, Lights(lamps, None, occluders), points), 0, silent).lit_by_photons(
        TexelImage(uvs, places.mask))


def radiance(walker, samples, seed):
    """(means, standard errors) of photons at the points."""
    sums, squares, counts = walker.photons(Samples(samples, seed), silent)
    sent = samples * len(sums)
    assert counts[:, 1].max() < 1e-4 * sent  # nothing is lost
    return sums / sent, np.sqrt(np.maximum(squares / sent - (sums / sent) ** 2, 0.0) / sent)


# Walks rarely find a small lamp behind a smooth boundary: with few of them, their stated errors are too small.
@pytest.mark.parametrize(("filled", "interior", "surface", "samples", "occluders"), [
    (STAIRS, PLAIN, Surface(1.4), 150, None), (STAIRS, PLAIN, Surface(1.4, 0.3), 20, None),
    (STAIRS, VEINED, Surface(), 20, None), (CUP, PLAIN, Surface(), 20, None),
    (CUP, VEINED, Surface(1.4, 0.3), 20, None), (STAIRS, PLAIN, Surface(1.4, 0.3), 60, AROUND),
    (CUP, PLAIN, Surface(), 60, AROUND), (STAIRS, PLAIN, Surface(1.4, 0.3), 60, LINKED)],
    ids=["smooth", "rough", "veined", "cup", "veined rough cup", "rough among others", "cup among others", "linked"])
def test_photons_and_walks_agree(filled, interior, surface, samples, occluders):
    """The mean over the faces of each side, of light and of its moments: photons by texels, walks from random places.
    Light that meets an occluder first is left to walks in both."""
    solid, uvs, across = of_voxels(filled)
    size = PER_SIDE * across
    lamps = LINKED_LAMPS if occluders is LINKED else LAMPS
    walker = walker_of(solid, uvs, size, interior, surface, lamps, occluders)
    value, stderr = radiance(walker, 300, 1)
    rows, columns = np.nonzero(walker.problem.image.mask)
    face = rows // PER_SIDE * across + columns // PER_SIDE
    squares = solid.vertices.reshape(-1, 4, 3)
    sides = squares[:, 1] - squares[:, 0], squares[:, 3] - squares[:, 0]
    np.testing.assert_allclose(np.bincount(face, walker.texel_areas), np.ones(len(squares)), rtol=1e-5)

    places, rng = 60, np.random.default_rng(2)
    u, v = rng.uniform(0.001, 0.999, (2, len(squares), places, 1))
    spots = squares[:, None, 0] + u * sides[0][:, None] + v * sides[1][:, None]
    normals = np.repeat(np.cross(*sides)[:, None], places, axis=1)
    points = WalkPoints.of(spots.reshape(-1, 3), normals.reshape(-1, 3))

    def by_walks(lights, seed):
        found = estimated(Problem(solid, interior, surface, lights, points), Run(samples, seed=seed))
        light = np.concatenate([found.lamps.value, found.lamp_moments.value], axis=-1)
        return light.reshape(len(squares), places, len(LAMPS), 11)

    found = by_walks(Lights(lamps, None, occluders), 3)
    if occluders is not None:
        found = found - by_walks(Lights(lamps, None, occluders, by_occluders=True), 4)
    walk_errors = found.std(axis=1) / np.sqrt(places - 1)

    def of_sides(values, which):
        """Sums over the faces that look along each axis and against it."""
        side = np.rint(np.cross(*sides) @ [1.0, 2.0, 3.0]).astype(int)[which]
        return np.stack([values[side == one].sum(axis=0) for one in (-3, -2, -1, 1, 2, 3)])

    photons = of_sides(value, face) / PER_SIDE**2
    variance = of_sides(stderr**2, face) / PER_SIDE**4
    walks = of_sides(found.mean(axis=1), slice(None))
    z = (photons - walks) / np.sqrt(variance + of_sides(walk_errors**2, slice(None)))
    assert np.abs(z).max() < z_limit(z.size), z
    light = photons[..., :3]
    assert (np.sqrt(variance[..., :3]) < 0.2 * light).all()
    across = ~np.eye(3, dtype=bool)[[2, 1, 0, 0, 1, 2]]  # components of the first moment along the sides
    ratio = np.abs(photons[..., 3:6]) / light.mean(axis=-1, keepdims=True)
    assert (ratio.swapaxes(0, 1)[:, across] > 0.05).mean() > 0.2  # light changes by view


def test_dark_texels_have_little_noise():
    """Photons are split on their way into a rod that is lit at one end. At the other end there is less than a hundredth
    of the light. Without splitting, its noise relative to the light would grow with the square root; it grows by less
    than half of that, and walks from there find as much light."""
    solid, uvs, across = of_voxels({(x, 0, 0) for x in range(4)})
    material = EndMaterial((2.0, 2.0, 2.0), (0.05, 0.05, 0.05))
    lamp = Lamp([-1.0, 0.0, 0.0])
    walker = walker_of(solid, uvs, PER_SIDE * across, Interior.uniform(material), None, [lamp])
    value, stderr = (found[:, 0, 0] for found in radiance(walker, 400, 5))
    points = walker.problem.points
    bright, dark = points.positions[:, 0] < 1.0, points.normals[:, 0] > 0.5

    def noise(chosen):
        return np.sqrt((stderr[chosen] ** 2).mean()) / value[chosen].mean()

    ratio = value[dark].mean() / value[bright].mean()
    assert ratio < 0.01 and noise(dark) < 0.5 / np.sqrt(ratio) * noise(bright)
    far = points.only(dark)
    found = estimated(Problem(solid, Interior.uniform(material), None, Lights([lamp]), far), Run(30000, seed=6)).lamps
    walks, error = found.value[:, 0].mean(), np.sqrt((found.stderr[:, 0] ** 2).sum(axis=0)).mean() / dark.sum()
    z = (value[dark].mean() - walks) / np.hypot(np.sqrt((stderr[dark] ** 2).sum()) / dark.sum(), error)
    assert error < 0.05 * walks and abs(z) < z_limit(1)


def test_photons_pass_what_does_not_take_their_linking():
    solid, uvs, across = of_voxels(STAIRS)
    lid = Occluders([[-9, -9, 2.5], [9, -9, 2.5], [0, 9, 2.5]], [[0, 1, 2]], shadows=2**64 - 1 - 2)
    lamp = Lamp([0.0, 0.1, 1.0])
    lamps = [lamp, replace(lamp, linking=1)]
    size = PER_SIDE * across
    alone = walker_of(solid, uvs, size, PLAIN, Surface(), lamps).photons(Samples(20, 1), silent)
    among = walker_of(solid, uvs, size, PLAIN, Surface(), lamps, lid).photons(Samples(20, 1), silent)
    assert not among[0][:, 0].any() and alone[0][:, 0].any()
    assert np.array_equal(among[0][:, 1], alone[0][:, 1]) and among[0][:, 1].any()


@pytest.mark.parametrize(("surface", "entering"), [(Surface(), 1.0), (Surface(1.5), 0.96)], ids=["matched", "smooth"])
def test_a_white_body_returns_the_light_that_enters(surface, entering):
    """Two cubes side by side of albedo 1, under light from above; almost none passes without scattering."""
    solid, uvs, across = of_voxels({(0, 0, 0), (1, 0, 0)})
    white = Interior.uniform(EndMaterial((12.0, 14.0, 16.0)))
    walker = walker_of(solid, uvs, (3 * across, 3 * across), white, surface, [Lamp([0.0, 0.0, 1.0], 0.02)])
    sums, squares, _ = walker.photons(Samples(40, 5), silent)
    sent = 40 * len(sums)
    flux = np.pi * (sums[:, 0, :3] * walker.texel_areas[:, None]).sum(axis=0) / sent
    np.testing.assert_allclose(flux, 2.0 * entering, rtol=4.0 / np.sqrt(sent))


def test_a_lamp_close_to_a_large_face_makes_no_more_noise():
    """Patches of a face are drawn in proportion to their light: if whole faces were drawn, the noise of the near lamp
    would be three times that of the far one."""
    solid, uvs, across = of_voxels({(0, 0, 0)})
    noises = []
    for height in (2.0, 0.1):
        lamp = PointLamp([0.5, 0.5, 1.0 + height], 0.01)
        value, stderr = radiance(walker_of(solid, uvs, 8 * across, PLAIN, Surface(1.4, 0.3), [lamp]), 40, 1)
        noises.append(np.sqrt((stderr[..., :3] ** 2).mean()) / value[..., :3].mean())
    assert noises[1] < 1.3 * noises[0]


def test_a_texel_at_a_border_stands_for_its_surroundings():
    """A ball whose triangles lie apart in the image: no surface is counted twice, and little is left out."""
    ball = sphere(1.0, 1)
    across = int(np.ceil(np.sqrt(len(ball.triangles))))
    low = np.stack(np.divmod(np.arange(len(ball.triangles)), across), axis=1)[:, None]
    uvs = (low + 0.1 + 0.8 * np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 1.0]])) / across
    walker = walker_of(ball, uvs, 6 * across, PLAIN, Surface(), LAMPS[:1])
    corners = ball.vertices[ball.triangles]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    assert 0.97 * area < walker.texel_areas.sum() < area * (1.0 + 1e-6) and walker.texel_areas.min() > 0.0


def test_buried_surface_is_left_out():
    """Two cubes that overlap, as one solid: the texels stand for the outside."""
    cube, uvs, across = of_voxels({(0, 0, 0)})
    solid = lamina.Solid(np.vstack([cube.vertices, cube.vertices + [0.5, 0.3, 0.2]]),
                         np.vstack([cube.triangles, cube.triangles + len(cube.vertices)]))
    both = np.vstack([uvs * [0.5, 1.0], uvs * [0.5, 1.0] + [0.5, 0.0]])
    walker = walker_of(solid, both, (40 * across, 20 * across), PLAIN, Surface(), LAMPS[:1])
    inside = 2.0 * (0.5 * 0.7 + 0.5 * 0.8 + 0.7 * 0.8)
    assert walker.texel_areas.sum() == pytest.approx(12.0 - inside, rel=0.005)


@pytest.mark.parametrize("lamp", [PointLamp([0.5, 0.5, 0.5]), Lamp([0.0, 0.0, 1.0])], ids=["inside", "outside"])
def test_lamps_inside_are_found_by_walks(lamp):
    solid, uvs, across = of_voxels(STAIRS)
    found = lamina.lit_images(solid, PLAIN, [lamp], uvs, 2 * across, samples=4)
    assert (found.estimate.count.photons == 0) == isinstance(lamp, PointLamp)
    assert found.lamps.sum() > 0.0 and ("photons of each lamp" in found.report) != isinstance(lamp, PointLamp)
    seen = lamina.lit_images(solid, PLAIN, [lamp], uvs, 2 * across, samples=4, view=(0.0, 0.0, 1.0))
    assert seen.estimate.count.photons == 0 and seen.lamps.sum() > 0.0


def test_threads_and_parts_do_not_change_bytes(tmp_path, monkeypatch):
    monkeypatch.setattr(part_folder, "SAMPLES_PER_PART", 4000)
    solid, uvs, across = of_voxels(STAIRS)
    how = {"uvs": uvs, "size": 2 * across, "samples": 200, "seed": 3, "surface": Surface(1.4, 0.3)}
    one = lamina.lit_images(solid, PLAIN, LAMPS[:2], **how, threads=1)
    told = []
    with pytest.raises(lamina.Cancelled):
        lamina.lit_images(solid, PLAIN, LAMPS[:2], **how, threads=2, folder=tmp_path,
                          cancel=lambda: len(list(tmp_path.glob("part-*.npz"))) > 4)
    again = lamina.lit_images(solid, PLAIN, LAMPS[:2], **how, threads=2, folder=tmp_path,
                              progress=lambda fraction, _: told.append(fraction))
    assert again.lamps.tobytes() == one.lamps.tobytes() and again.sky.tobytes() == one.sky.tobytes()
    assert again.estimate.lamps.stderr.tobytes() == one.estimate.lamps.stderr.tobytes()
    assert told == sorted(told) and len(told) > 5
    assert one.estimate.count.photons == 200 * int(one.mask.sum())
    with pytest.raises(lamina.ShardError, match="different lamps"):
        lamina.lit_images(solid, PLAIN, LAMPS[:1], **how, folder=tmp_path)


def test_the_noise_is_as_wanted():
    """The trial finds the numbers of walks for the sky and of photons for the lamps; the stated errors are right."""
    solid, uvs, across = of_voxels(CUP)
    how = {"uvs": uvs, "size": 3 * across, "surface": Surface(1.4, 0.3)}
    runs = [lamina.lit_images(solid, PLAIN, LAMPS[:1], noise=0.1, seed=seed, **how) for seed in range(4)]
    assert all(0.085 < one.noise < 0.115 for one in runs)
    values = np.stack([one.estimate.lamps.value for one in runs])
    stated = np.sqrt(np.mean([one.estimate.lamps.stderr**2 for one in runs]))
    assert np.sqrt(values.var(axis=0, ddof=1).mean()) == pytest.approx(stated, rel=0.12)
