# SPDX-License-Identifier: GPL-3.0-or-later
"""Lit towards the camera next to silhouettes and to the edges of islands.

Without absorption and below a sky of radiance 1, each sample is 1 at any point and in any direction. So the picture is
1 wherever the eye sees the surface, without noise."""

import numpy as np
import pytest
from walk_meshes import box, sphere

import lamina
from lamina import EndMaterial, Interior

WHITE = Interior.uniform(EndMaterial(1.0, 0.0))
VIEW = np.array([0.6, -0.5, 0.4])
SIZE = (24, 16)


def box_with_uvs():
    """A box whose six faces fill the image without gaps: those that the eye sees lie beside those that it does not."""
    solid = box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    corners = solid.vertices[solid.triangles]
    face = np.arange(len(corners)) // 2
    order = np.array([0, 4, 2, 1, 3, 5])[face]  # -x, +x, -y, +y, -z, +z
    cells = np.column_stack([order % 3, order // 3])
    axes = [[k for k in range(3) if np.ptp(corners[t, :, k]) > 0.0] for t in range(len(corners))]
    within = np.array([corners[t][:, axes[t]] for t in range(len(corners))]) * 0.5 + 0.5
    return solid, (within + cells[:, None]) / (3.0, 2.0)


def sphere_with_uvs():
    """A sphere with longitude and latitude."""
    solid = sphere(1.0, 3)
    corners = solid.vertices[solid.triangles]
    longitude = np.arctan2(corners[..., 1], corners[..., 0]) / (2.0 * np.pi) + 0.5
    longitude -= np.rint(longitude - longitude[:, :1])  # triangles do not wrap around the image
    return solid, np.stack([longitude, np.arcsin(corners[..., 2]) / np.pi + 0.5], axis=-1)


def seen_from(solid, uvs, eye):
    """Positions in the image, in texels, of points on the faces that the eye sees."""
    corners = solid.vertices[solid.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    shares = np.random.default_rng(1).dirichlet((1.0,) * 3, (len(corners), 20))
    inside = (uvs >= 0.0).all(axis=(1, 2)) & (uvs <= 1.0).all(axis=(1, 2))
    chosen = inside & (np.einsum("ij,ij->i", normals, eye - corners[:, 0]) > 0.0)
    return (np.einsum("tpk,tkc->tpc", shares, uvs)[chosen] * SIZE).reshape(-1, 2)


def interpolated(image, places):
    """Values between texels as Cycles interpolates them."""
    limit = np.array(SIZE) - 1
    first = np.floor(places - 0.5)
    share = places - 0.5 - first
    found = 0.0
    for corner in np.ndindex(2, 2):
        column, row = np.clip(first + corner, 0, limit).astype(int).T
        weight = np.where(corner, share, 1.0 - share).prod(axis=1)
        found = found + weight[:, None] * image[row, column]
    return found


@pytest.mark.parametrize("made", [box_with_uvs, sphere_with_uvs])
@pytest.mark.parametrize("from_afar", [True, False])
def test_nothing_that_the_eye_sees_is_darkened(made, from_afar):
    solid, uvs = made()
    eye = VIEW * (1e6 if from_afar else 6.0)
    where = {"view": VIEW} if from_afar else {"eye": eye}
    found = lamina.lit_images(solid, WHITE, (), uvs, SIZE, samples=2, **where)
    pixels = interpolated(found.sky, seen_from(solid, uvs, eye))
    assert len(pixels) > 50
    np.testing.assert_allclose(pixels, 1.0, atol=1e-5)


def test_vertices_next_to_a_silhouette():
    solid = sphere(1.0, 2)
    found = lamina.lit_images(solid, WHITE, (), samples=2, view=VIEW)
    corners = solid.vertices[solid.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    np.testing.assert_allclose(found.sky[solid.triangles[normals @ VIEW > 0.0]], 1.0, atol=1e-5)
    assert not found.mask.all() and len(found.estimate.sky.value) == found.mask.sum()


def test_the_noise_is_that_of_the_places_that_the_eye_sees():
    """Walks from both sides of a box, with equal light: half of the places must not look like half of the light."""
    solid, uvs = box_with_uvs()
    grey = Interior.uniform(EndMaterial(1.0, 0.5))
    mean = lamina.lit_images(solid, grey, (), uvs, SIZE, samples=64, seed=1)
    found = lamina.lit_images(solid, grey, (), uvs, SIZE, samples=64, seed=1, view=VIEW)
    assert found.noise < 1.2 * mean.noise


def test_a_map_that_the_eye_does_not_see_is_refused():
    solid, uvs = box_with_uvs()
    corners = solid.vertices[solid.triangles]
    uvs = np.where((corners[:, :, 2] == 1.0).all(axis=1)[:, None, None], uvs, 0.0)
    with pytest.raises(lamina.InteriorError, match="no point of the map faces the eye"):
        lamina.lit_images(solid, WHITE, (), uvs, SIZE, samples=2, view=(0.0, 0.0, -1.0))
