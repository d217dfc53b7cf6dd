# SPDX-License-Identifier: GPL-3.0-or-later
"""Texels of a UV map as points, and images with a margin."""

import numpy as np
import pytest
from dust_meshes import plate, sphere
from needs_embree import with_embree

from lamina import dust
from lamina.dust import Settling, dilate, settle, texel_points

pytestmark = with_embree


def planar_uvs(mesh):
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    return ((mesh.vertices - low)[:, :2] / (high - low)[:2])[mesh.triangles]


def test_each_texel_lies_where_its_centre_does():
    mesh = plate(5, 2.0, 0.3)
    points, mask = texel_points(mesh, planar_uvs(mesh), (32, 16))
    assert mask.shape == (16, 32)
    assert mask.all()
    row, column = np.nonzero(mask)
    truth = np.column_stack([2.0 * (column + 0.5) / 32 - 1.0, 2.0 * (row + 0.5) / 16 - 1.0, np.full(len(row), 0.3)])
    np.testing.assert_allclose(points.positions, truth, atol=1e-6)
    np.testing.assert_allclose(points.normals, np.tile([0, 0, 1.0], (len(row), 1)), atol=1e-7)
    np.testing.assert_allclose(points.areas.sum(), 4.0, rtol=1e-9)


def test_dust_on_texels_is_that_on_vertices():
    mesh = sphere(24, 48)
    upper = mesh.triangles[(mesh.vertices[mesh.triangles][:, :, 2] > 0.2).all(axis=1)]
    uvs = (0.5 + 0.5 * mesh.vertices[:, :2])[upper]
    cap = dust.Mesh(mesh.vertices, upper, mesh.vertices)
    points, mask = texel_points(cap, uvs, 64)
    settings = Settling(rays=256, spread=0.6)
    texels = settle(cap, points, settings=settings)
    vertices = settle(cap, settings=settings)
    assert 0.5 < mask.mean() < 0.8
    near = np.argmin(np.linalg.norm(points.positions[:, None] - mesh.vertices[None], axis=2), axis=1)
    # A texel is up to half an edge, .07 rad, from the next vertex.
    assert np.abs(texels.tau - vertices.tau[near]).max() < 0.25
    assert np.abs(texels.tau - vertices.tau[near]).mean() < 0.05
    assert abs(texels.statistics.arrived / vertices.statistics.arrived - 1.0) < 0.03


def test_overlaps_and_what_lies_outside():
    mesh = plate(1)
    uvs = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], float)
    uvs[1] = uvs[0]  # the second triangle lies on the first
    points, mask = texel_points(mesh, uvs, 8)
    assert mask.sum() == 36  # with the diagonal
    assert np.all(points.positions[:, 0] >= points.positions[:, 1] - 1e-6)
    _, outside = texel_points(mesh, uvs + 1.0, 8)
    assert not outside.any()
    _, degenerate = texel_points(mesh, np.zeros((2, 3, 2)), 8)
    assert not degenerate.any()


def test_a_margin_repeats_what_is_next_to_it():
    mask = np.zeros((9, 9), bool)
    mask[4, 4] = True
    image = dilate(np.array([2.0]), mask, margin=2)
    assert np.all(image[2:7, 2:7] == 2.0)
    assert image.sum() == 50.0
    assert dilate(np.zeros(0), np.zeros((3, 3), bool)).sum() == 0.0
    mask[4, 5] = True
    assert dilate(np.array([1.0, 3.0]), mask, margin=1)[3, 4] == 2.0
    with pytest.raises(dust.DustError, match="one number for each texel"):
        dilate(np.zeros(3), mask)
