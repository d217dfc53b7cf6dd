# SPDX-License-Identifier: GPL-3.0-or-later
"""A cube whose top has a black material, against Cycles' own volume in the same mesh.

One Blender unit is a millimetre."""

from importlib import import_module

import bpy
import goniophotometer
import numpy as np
import pytest
from mathutils import Vector
from z_limit import z_limit

HALF = 1.0  # half the cube's side in mm
SCATTERING, ABSORPTION = 6.0, 0.2  # per mm
TO_SUN, TO_EYE = Vector((0.48, 0.36, 0.8)), Vector((0.7, -0.7, -0.2))  # the eye sees a lit side and a dark one
SEEN, PIXELS = 3.6, 24
COVERED = 4.0 * HALF**2 * sum(map(abs, TO_EYE.normalized())) / SEEN**2  # share of the picture


def black():
    material = bpy.data.materials.new("Cap")
    tree = goniophotometer.node_tree.of(material)
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    tree.nodes.remove(shader)
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    tree.links.new(diffuse.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    return material


def volume():
    material = bpy.data.materials.new("Volume")
    tree = goniophotometer.node_tree.of(material)
    tree.nodes.remove(next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"))
    both = tree.nodes.new("ShaderNodeAddShader")
    for place, (kind, density) in enumerate((("Scatter", SCATTERING), ("Absorption", ABSORPTION))):
        shader = tree.nodes.new(f"ShaderNodeVolume{kind}")
        shader.inputs["Density"].default_value = density
        shader.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0) if kind == "Scatter" else (0.0, 0.0, 0.0, 1.0)
        tree.links.new(shader.outputs[0], both.inputs[place])
    tree.links.new(both.outputs[0], tree.get_output_node("CYCLES").inputs["Volume"])
    return material


def cube(scene, material, cap):
    mesh = bpy.data.meshes.new("cube")
    corners = [(x, y, z) for x in (-HALF, HALF) for y in (-HALF, HALF) for z in (-HALF, HALF)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh.from_pydata(corners, [], quads)
    mesh.materials.append(material)
    mesh.materials.append(cap)
    mesh.polygons[5].material_index = int(cap is not None)
    obj = bpy.data.objects.new("cube", mesh)
    scene.collection.objects.link(obj)
    return obj


def scene_of(material, cap, light):
    scene = bpy.data.scenes.new("capped")
    scene.unit_settings.scale_length = 0.001
    camera = bpy.data.cameras.new("eye")
    camera.type, camera.ortho_scale = "ORTHO", SEEN
    scene.camera = bpy.data.objects.new("eye", camera)
    scene.camera.location = 20.0 * TO_EYE.normalized()
    scene.camera.rotation_euler = TO_EYE.to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(scene.camera)
    scene.world = goniophotometer._world(1.0 if light == "sky" else 0.0)
    scene.render.film_transparent = True  # the sky behind the cube is not in the picture
    if light == "sun":
        lamp = bpy.data.lights.new("Sun", "SUN")
        lamp.angle, lamp.energy = 0.0, np.pi
        sun = bpy.data.objects.new("Sun", lamp)
        sun.rotation_euler = TO_SUN.to_track_quat("Z", "Y").to_euler()
        scene.collection.objects.link(sun)
    return scene, cube(scene, material, cap)


def picture(scene, samples, seed=0):
    goniophotometer._settings(scene, samples, 1)
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    scene.cycles.max_bounces = scene.cycles.volume_bounces = 256
    scene.cycles.seed = seed
    return goniophotometer._render(scene)[..., :3].mean(axis=2)


def shown(addon, output, cap, light):
    """(picture of the cube with the nodes of the panel Interior, the images)."""
    jobs = import_module(f"{addon.__name__}.interior.interior_job")
    material = bpy.data.materials.new("body")
    settings = material.lamina.interior
    settings.source, settings.output, settings.map, settings.view = "MARBLE", output, "NEW", "CAMERA"
    settings.ior, settings.size, settings.noise = 1.0, 128, 4.0
    for end in (settings.first, settings.second):
        end.sigma_s, end.sigma_a, end.g = (SCATTERING,) * 3, (ABSORPTION,) * 3, 0.0
    scene, obj = scene_of(material, cap, light)
    with bpy.context.temp_override(scene=scene, view_layer=scene.view_layers[0]):
        scene.view_layers[0].update()
        found = jobs.make(bpy.context, obj, material)
    return picture(scene, 64), found


@pytest.fixture(scope="module")
def truth():
    """{light: two pictures of the volume with independent noise}."""
    cap = black()
    return {light: [picture(scene_of(volume(), cap, light)[0], 1024, seed) for seed in (1, 2)]
            for light in ("sun", "sky")}


def against(truth, found, texels, light):
    """(relative difference of the body's mean radiance from that of the volume, its standard error). `texels`: with a
    value of their own, each with the noise of 4 % that is asked; some three fifths are seen."""
    behind = 1.0 if light == "sky" else 0.0
    body = behind + (np.mean(truth, axis=(1, 2)) - behind) / COVERED
    noise = np.std(truth[0] - truth[1]) / (2.0 * PIXELS * COVERED * body.mean())
    difference = (found.mean() - np.mean(truth)) / (COVERED * body.mean())
    return difference, np.hypot(noise, 0.04 / np.sqrt(0.6 * texels))


@pytest.mark.parametrize("light", ["sun", "sky"])
def test_lit(addon, truth, light):
    """Lit that lets light through the cap is 56 % too bright under the sun."""
    found, images = shown(addon, "LIT", black(), light)
    difference, error = against(truth[light], found, images.mask.sum(), light)
    assert error < 0.006 and abs(difference) < z_limit(3) * error


def test_relightable_under_a_sky(addon, truth):
    """Within the 2 % of docs/limits.md. Under a sun on the cap, Cycles' node is too bright."""
    found, images = shown(addon, "RELIGHTABLE", black(), "sky")
    difference, error = against(truth["sky"], found, images.mask.sum(), "sky")
    assert error < 0.006 and abs(difference) < 0.02 + z_limit(3) * error
