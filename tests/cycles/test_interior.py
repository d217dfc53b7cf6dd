# SPDX-License-Identifier: GPL-3.0-or-later
"""Interiors in Cycles: a homogeneous slab against the solver, and a veined slab against Cycles' own volume."""

import bmesh
import bpy
import numpy as np
import pytest
import veined_slab
from z_limit import z_limit

import lamina


@pytest.fixture
def jobs(addon):
    from importlib import import_module

    return import_module(f"{addon.__name__}.interior.interior_job")


def shown(jobs, light, output, noise, change=None):
    """(scene, images) of a slab with the nodes of its interior."""
    scene = veined_slab.scene_with(light)
    material = bpy.data.materials.new("interior")
    veined_slab.interior(material, output, noise)
    obj = veined_slab.slab(scene, material)
    if change is not None:
        change(material)
    with bpy.context.temp_override(scene=scene, view_layer=scene.view_layers[0]):
        scene.view_layers[0].update()
        found = jobs.make(bpy.context, obj, material)
    return scene, found


@pytest.mark.parametrize("output", ["RELIGHTABLE", "LIT"])
def test_homogeneous_slab_under_a_sky(jobs, addon, output):
    """The 1D answer, from the panel's properties to the pixels."""
    sigma_s, sigma_a = veined_slab.VEIN

    def uniform(material):
        for end in (material.lamina.interior.first, material.lamina.interior.second):
            end.sigma_s, end.sigma_a = sigma_s, sigma_a

    scene, found = shown(jobs, "sky", output, 4.0, uniform)
    medium = lamina.Medium(sigma_s=list(sigma_s), sigma_a=list(sigma_a), thickness=veined_slab.THICKNESS)
    solved = lamina.solve(lamina.Stack([medium]))
    # The camera looks along the normal. Light from the sides of the slab does not reach the middle of the picture.
    expected = solved.reflectance(1.0) + solved.transmittance(1.0)
    side = veined_slab.PIXELS // 4
    pixels = veined_slab.picture(scene, 64)[side:-side, side:-side].reshape(-1, 3)
    # Neighbouring pixels share texels, so the noise of the mean is up to twice that of independent pixels. The images
    # are smoothed, which does not lower the noise of their mean: that of the walks is added.
    texels = np.arange(found.mask.size).reshape(found.mask.shape)
    middle = texels[10:-10, 10:-10].ravel()
    measured = found.estimate.sky if output == "LIT" else found.estimate.albedo
    walks = np.sqrt((measured.stderr[middle] ** 2).mean(axis=0) / len(middle))
    error = np.hypot(2.0 * pixels.std(axis=0, ddof=1) / np.sqrt(len(pixels)), walks)
    # Relightable: the walks in uniform media that correct for thin parts have a noise of their own, .3 %.
    allowed = 0.01 * expected if output == "RELIGHTABLE" else 0.0
    assert np.all(np.abs(pixels.mean(axis=0) - expected) < allowed + z_limit(3) * error)
    if output == "LIT":
        z = (measured.value[middle] - expected) / measured.stderr[middle]
        assert np.abs(z).max() < z_limit(z.size)


def white_ball(scene, material, radius):
    mesh, shape = bpy.data.meshes.new("ball"), bmesh.new()
    bmesh.ops.create_icosphere(shape, subdivisions=3, radius=radius)
    shape.to_mesh(mesh)
    shape.free()
    mesh.materials.append(material)
    obj = bpy.data.objects.new("ball", mesh)
    scene.collection.objects.link(obj)
    return obj


@pytest.mark.parametrize("sigma_s", [4.0, 12.0])
def test_white_ball_under_a_white_sky(jobs, addon, sigma_s):
    """A body that absorbs nothing disappears. Cycles' limit of flights loses no light at the lower density, and some
    4 % at the higher one, half of what it loses in a half-space."""
    scene = veined_slab.scene_with("sky")
    material = bpy.data.materials.new("white")
    settings = material.lamina.interior
    settings.output, settings.ior, settings.size, settings.noise = "RELIGHTABLE", 1.0, 20, 4.0
    for end in (settings.first, settings.second):
        end.sigma_s, end.sigma_a, end.g = (sigma_s,) * 3, (0.0,) * 3, 0.0
    radius = 3.0
    obj = white_ball(scene, material, radius)
    with bpy.context.temp_override(scene=scene, view_layer=scene.view_layers[0]):
        scene.view_layers[0].update()
        jobs.make(bpy.context, obj, material)
    picture = veined_slab.picture(scene, 96)[..., 0] - 1.0
    # Over the whole ball, because the lost light depends on the view and is replaced in its mean.
    covered = np.pi * (radius / veined_slab.SEEN) ** 2
    mean, error = picture.mean() / covered, picture.std(ddof=1) / np.sqrt(picture.size) / covered
    assert error < 0.003
    # Cycles itself loses .2 % in the ball of lower density.
    assert abs(mean) < 0.004 + z_limit(2) * error


@pytest.fixture(scope="module")
def truth():
    """Two pictures of the volume with independent noise."""
    scene = veined_slab.scene_with("sky")
    material = bpy.data.materials.new("volume")
    veined_slab.volume(material)
    veined_slab.slab(scene, material)
    return [veined_slab.picture(scene, 48, step=0.05, seed=seed) for seed in (1, 2)]


def mean_square(found, truth):
    """(mean square difference over the squared mean, without the noise of the truth; its standard error), of blocks of
    3 x 3 pixels. The two pictures of the truth are independent. Channels of a block are not."""
    side = veined_slab.PIXELS // 3
    first, second = ((found - one).reshape(side, 3, side, 3, 3).mean(axis=(1, 3)) for one in truth)
    products = (first * second).mean(axis=2).ravel() / np.mean(truth) ** 2
    return products.mean(), products.std(ddof=1) / np.sqrt(products.size)


@pytest.mark.parametrize(("output", "noise", "limit"), [("RELIGHTABLE", 4.0, 0.06), ("LIT", 2.2, 0.02)])
def test_veined_slab_against_the_volume(jobs, truth, output, noise, limit):
    """Relightable: far less than half the difference of each texel's own material (25 %). Lit: at most 2 %."""
    scene, _ = shown(jobs, "sky", output, noise)
    found = veined_slab.picture(scene, 64)
    square, error = mean_square(found, truth)
    assert error < limit**2  # the statement is worth something
    assert square < limit**2 + z_limit(2) * error
    assert abs(found.mean() / np.mean(truth) - 1.0) < 0.015
