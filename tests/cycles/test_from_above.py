# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials seen exactly along the normal: orthographic views from above, and bakes into textures.

There the plane of incidence is undefined, and directions made from it would be zero vectors. Every preset of the
library but the overlays, which have no base, is rendered at 0 and .5 degrees in a white furnace, which does not depend
on the plane of incidence."""

import math

import baked_samples
import bpy
import goniophotometer
import node_tree
import numpy as np
import pytest

import lamina
from lamina import presets

DEGREES = (0.0, 0.5)
VIEWS = baked_samples.Views(np.array(DEGREES) / 90.0 * 63, np.full(2, 0.5))
REPEATS, SAMPLES, BATCH = 8, 32, 12
SIGMAS = 5.0
# Beside noise: weights are linear between columns, preview slices are off by some tenths of a per cent.
SYSTEMATIC = 0.01


@pytest.fixture(scope="module")
def samples(addon):
    shown = filter(addon.editing.presets.can_be_shown, presets.entries())
    found = [_sample(addon, one.id, one.stack) for one in shown if one.category != "Overlays"]
    yield found
    for sample in found:
        bpy.data.materials.remove(sample.material)


def _sample(addon, name, stack):
    """At the largest thickness, where a layer varies: that row and the first are solved."""
    lut = lamina.bake(stack, "preview", row_stride=32 if stack.varying is not None else 1,
                      basis="moving" if stack.is_oriented else "standard")
    material = bpy.data.materials.new(name)
    node_tree.of(material)
    addon.editing.stack_io.assign_stack(material, stack)
    addon.baking.bake_job.apply(material, lut)
    return baked_samples.Sample(name, material, lut, lamina.solve(stack, "preview"), VIEWS)


def _seen(samples, mu_o):
    """(means, their standard errors), each (samples, 3), of patches that lie in the furnace several times."""
    readings = []
    for first in range(0, len(samples), BATCH):
        materials = [sample.material for sample in samples[first : first + BATCH]]
        values = goniophotometer.furnace_many(materials * REPEATS, mu_o, SAMPLES)
        readings.append(values.reshape(REPEATS, len(materials), 3))
    readings = np.concatenate(readings, axis=1)
    return readings.mean(axis=0), readings.std(axis=0, ddof=1) / math.sqrt(REPEATS)


@pytest.mark.parametrize("view", range(len(DEGREES)), ids=[f"{angle:g} degrees" for angle in DEGREES])
def test_every_preset_shows_its_albedo(samples, view, monkeypatch):
    monkeypatch.setattr(goniophotometer, "_READ", slice(1, 7))
    means, sigmas = _seen(samples, math.cos(math.radians(DEGREES[view])))
    wrong = {}
    for sample, mean, sigma in zip(samples, means, sigmas, strict=True):
        exact = sample.albedo_between_columns("top")[view]
        if np.any(np.abs(mean - exact) > SIGMAS * sigma + SYSTEMATIC * exact):
            wrong[sample.name] = (mean / exact).round(4).tolist()
    assert not wrong


def test_both_kinds_of_directions_are_among_the_presets(samples):
    """Tangents and tilted normals, or the test above shows nothing."""
    used = {name for sample in samples for name in sample.lut.closures}
    assert any("_a" in name and name.startswith("ggx") for name in used)
    assert any("tilt" in name for name in used) and any(name.startswith("through") for name in used)


def _convex_body(material):
    """A cube, whose normals are exact in single precision; each face has its own UV square."""
    bpy.ops.mesh.primitive_cube_add()
    body = bpy.context.object
    body.data.materials.clear()
    body.data.materials.append(material)
    layer = body.data.uv_layers.active or body.data.uv_layers.new()
    across = math.ceil(math.sqrt(len(body.data.polygons)))
    for face in body.data.polygons:
        left, low = face.index % across, face.index // across
        corners = ((0.05, 0.05), (0.95, 0.05), (0.95, 0.95), (0.05, 0.95))
        for loop, corner in zip(face.loop_indices, corners, strict=True):
            layer.data[loop].uv = ((left + corner[0]) / across, (low + corner[1]) / across)
    return body, across


@pytest.mark.parametrize("name", ["snow-fresh", "car-paint-red"])
def test_a_texture_bake_from_above_the_surface(addon, name, monkeypatch):
    """Under a white sky a convex body's texels show the albedo for a view along the normal, on every face."""
    sample = _sample(addon, name, presets.load(name))
    scene = bpy.context.scene
    for other in scene.objects:
        monkeypatch.setattr(other, "hide_render", True)
    scene.render.engine, scene.cycles.device = "CYCLES", "CPU"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = 64, False, False
    scene.cycles.max_bounces = 0
    scene.render.bake.view_from = "ABOVE_SURFACE"
    scene.world = goniophotometer._world(1.0)
    body, across = _convex_body(sample.material)
    image = bpy.data.images.new("texture", 8 * across, 8 * across, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    target = sample.material.node_tree.nodes.new("ShaderNodeTexImage")
    target.image = image
    sample.material.node_tree.nodes.active = target
    try:
        bpy.ops.object.bake(type="COMBINED", margin=0, use_clear=True)
        pixels = np.empty(image.size[0] * image.size[1] * 4, np.float32)
        image.pixels.foreach_get(pixels)
    finally:
        bpy.data.objects.remove(body)
        bpy.data.images.remove(image)
        bpy.data.materials.remove(sample.material)
    squares = pixels.reshape(across, 8, across, 8, 4)[:, 2:4, :, 2:4, :3]
    faces = squares.transpose(0, 2, 1, 3, 4).reshape(across * across, -1, 3)[:6].mean(axis=1)
    exact = sample.albedo_between_columns("top")[0]
    assert np.all(faces > 0.5 * exact), "black faces"
    assert faces.mean(axis=0) == pytest.approx(exact, rel=0.03)
