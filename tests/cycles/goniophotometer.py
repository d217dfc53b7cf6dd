# SPDX-License-Identifier: GPL-3.0-or-later
"""A virtual goniophotometer: the reflection of a flat patch of any Cycles material, by direction.

Patches lie side by side in the plane z = 0, along y; an orthographic camera looks at them from
(sin theta_o, 0, cos theta_o), and a sun of angle 0 shines from (-sin theta_i cos dphi,
-sin theta_i sin dphi, +-cos theta_i): dphi = 0 is forward, the light keeps its azimuth.  One render reads
every patch, since coplanar patches cannot shade each other.  Readings are f * |cos theta_i| in 1/sr, RGB.

A render of at most `_BATCH` patches takes about a tenth of a second.
"""
from __future__ import annotations

import math
import os
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "demo_scenes"))

import node_tree

# Square pixels per patch along y, and those that are read: off the seams between patches, and off the
# diagonal of the quad (at the middle), where Cycles loses samples when the sun is below.
_COLUMNS, _READ, _ROWS = 8, slice(5, 7), 4
_BATCH = 100


def measure(material, mu_o, mu_i, dphi, samples=64, below=False, backface=False):
    """f * |cos theta_i| of one material for one pair of directions, shape (3,); see `measure_many`."""
    return measure_many([material], mu_o, mu_i, dphi, samples, below, backface)[0]


def measure_many(materials, mu_o, mu_i, dphi, samples=64, below=False, backface=False):
    """Readings of several materials, shape (n, 3).

    `below` puts the light on the far side of the patches (transmission); `backface` turns the patches
    over, so that the camera sees their back faces.
    """
    sin_i, height = math.sqrt(max(0.0, 1.0 - mu_i * mu_i)), -mu_i if below else mu_i
    towards_light = Vector((-sin_i * math.cos(dphi), -sin_i * math.sin(dphi), height))
    return _read_all(materials, mu_o, samples, backface, towards_light)


def furnace(material, mu_o, samples=1024, backface=False):
    """Radiance of one material under a constant environment of radiance 1, shape (3,)."""
    return furnace_many([material], mu_o, samples, backface)[0]


def furnace_many(materials, mu_o, samples=1024, backface=False):
    """White furnace readings of several materials, shape (n, 3)."""
    return _read_all(materials, mu_o, samples, backface, None)


def material_from_recipe(lobe, weight=(1.0, 1.0, 1.0)):
    """A new material that holds exactly one lobe (of `lamina.lobes`), with an RGB weight."""
    recipe = lobe.node
    material = bpy.data.materials.new(lobe.id)
    material.cycles.use_bump_map_correction = False
    tree = node_tree.of(material)
    tree.nodes.clear()
    closure = tree.nodes.new(recipe.type)
    for name, value in recipe.enums.items():
        setattr(closure, name, value)
    for name, value in recipe.inputs.items():
        if name in closure.inputs:
            closure.inputs[name].default_value = value
    closure.inputs[recipe.weight_input].default_value = (*weight, 1.0)
    for name, direction in {recipe.normal_input: recipe.normal, **recipe.vectors}.items():
        socket = direction_socket(tree, direction)
        if socket is not None and name:
            tree.links.new(socket, closure.inputs[name])
    for name, multiple in recipe.view_angles.items():
        tree.links.new(_view_angle(tree, multiple), closure.inputs[name])
    for name, parameters in recipe.of_cosine.items():
        tree.links.new(_of_cosine(tree, *parameters), closure.inputs[name])
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(closure.outputs[0], output.inputs["Surface"])
    return material


def direction_socket(tree, direction):
    """A socket that carries the named direction of a recipe; None for the plain normal."""
    if direction == "N":
        return None
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    normal, incoming = geometry.outputs["Normal"], geometry.outputs["Incoming"]
    if direction == "I":
        return incoming
    if direction == "N+I":
        return _vector(tree, "NORMALIZE", _vector(tree, "ADD", normal, incoming))
    cosine = _vector(tree, "DOT_PRODUCT", normal, incoming)
    aside = tree.nodes.new("ShaderNodeVectorMath")
    aside.operation = "CROSS_PRODUCT"
    tree.links.new(incoming, aside.inputs[0])
    aside.inputs[1].default_value = (3e-6, 5e-6, 8e-6)
    if direction == "I aside":
        return _vector(tree, "NORMALIZE", _vector(tree, "ADD", incoming, aside.outputs["Vector"]))
    if direction == "T":
        across = _vector(tree, "SUBTRACT", normal, _vector(tree, "SCALE", incoming, scale=cosine))
        return _vector(tree, "NORMALIZE", _vector(tree, "ADD", across, aside.outputs["Vector"]))
    along = _vector(tree, "SCALE", normal, scale=cosine)
    if direction[0] == "lean":
        mirrored = _vector(tree, "SUBTRACT", _vector(tree, "ADD", along, along), incoming)
        lean = _vector(tree, "SCALE", normal, scale=float(direction[1]))
        return _vector(tree, "NORMALIZE", _vector(tree, "ADD", mirrored, lean))
    angle = math.radians(direction[1])
    sideways = _vector(tree, "NORMALIZE", _vector(tree, "SUBTRACT", incoming, along))
    turned = _vector(
        tree, "ADD",
        _vector(tree, "SCALE", normal, scale=math.cos(angle)),
        _vector(tree, "SCALE", sideways, scale=math.sin(angle)),
    )
    return _vector(tree, "NORMALIZE", turned)


def _view_angle(tree, multiple):
    """A socket that carries a multiple of the angle between viewer and normal."""
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    cosine = _vector(tree, "DOT_PRODUCT", geometry.outputs["Normal"], geometry.outputs["Incoming"])
    angle, scaled = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeMath")
    angle.operation, scaled.operation = "ARCCOSINE", "MULTIPLY"
    tree.links.new(cosine, angle.inputs[0])
    tree.links.new(angle.outputs[0], scaled.inputs[0])
    scaled.inputs[1].default_value = multiple
    return scaled.outputs[0]


def _of_cosine(tree, offset, factor, power):
    """A socket that carries offset + factor * cosine ** power, clamped, for the cosine of viewer and normal."""
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    raised, scaled = tree.nodes.new("ShaderNodeMath"), tree.nodes.new("ShaderNodeMath")
    raised.operation, scaled.operation, scaled.use_clamp = "POWER", "MULTIPLY_ADD", True
    tree.links.new(_vector(tree, "DOT_PRODUCT", geometry.outputs["Normal"], geometry.outputs["Incoming"]),
                   raised.inputs[0])
    raised.inputs[1].default_value = power
    tree.links.new(raised.outputs[0], scaled.inputs[0])
    scaled.inputs[1].default_value, scaled.inputs[2].default_value = factor, offset
    return scaled.outputs[0]


def _vector(tree, operation, a, b=None, scale=None):
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = operation
    tree.links.new(a, node.inputs[0])
    if b is not None:
        tree.links.new(b, node.inputs[1])
    if isinstance(scale, float):
        node.inputs["Scale"].default_value = scale
    elif scale is not None:
        tree.links.new(scale, node.inputs["Scale"])
    return node.outputs["Value" if operation == "DOT_PRODUCT" else "Vector"]


# --- The instrument -----------------------------------------------------------------------------


def _read_all(materials, mu_o, samples, backface, towards_light):
    readings = [
        _read(materials[i : i + _BATCH], mu_o, samples, backface, towards_light)
        for i in range(0, len(materials), _BATCH)
    ]
    return np.concatenate(readings)


def _read(materials, mu_o, samples, backface, towards_light):
    count = len(materials)
    scene = bpy.data.scenes.new("goniophotometer")
    meshes = [_patch(scene, k, material, backface) for k, material in enumerate(materials)]
    camera = _camera(scene, mu_o, count)
    lamp = _sun(scene, towards_light) if towards_light is not None else None
    scene.world = _world(0.0 if lamp else 1.0)
    _settings(scene, samples, count)
    try:
        pixels = _render(scene)
    finally:
        bpy.data.scenes.remove(scene)
        for mesh in meshes:
            bpy.data.meshes.remove(mesh)
        bpy.data.cameras.remove(camera)
        if lamp:
            bpy.data.lights.remove(lamp)
    return pixels.reshape(_ROWS, count, _COLUMNS, -1)[:, :, _READ, :3].mean(axis=(0, 2))


def _patch(scene, k, material, backface):
    """A long strip of unit width, y from k to k + 1."""
    far = 200.0
    corners = [(-far, k, 0.0), (far, k, 0.0), (far, k + 1.0, 0.0), (-far, k + 1.0, 0.0)]
    mesh = bpy.data.meshes.new("patch")
    mesh.from_pydata(corners, [], [(3, 2, 1, 0) if backface else (0, 1, 2, 3)])
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("patch", mesh))
    return mesh


def _camera(scene, mu_o, count):
    camera = bpy.data.cameras.new("eye")
    camera.type = "ORTHO"
    camera.sensor_fit = "HORIZONTAL"
    camera.ortho_scale = count
    camera.clip_end = 1000.0
    eye = bpy.data.objects.new("eye", camera)
    scene.collection.objects.link(eye)
    scene.camera = eye
    towards_eye = Vector((math.sqrt(max(0.0, 1.0 - mu_o * mu_o)), 0.0, mu_o))
    right = Vector((0.0, 1.0, 0.0))
    eye.matrix_world = _frame(right, towards_eye, 10.0 * towards_eye + 0.5 * count * right)
    return camera


def _sun(scene, towards_light):
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.angle, lamp.energy = 0.0, 1.0
    sun = bpy.data.objects.new("sun", lamp)
    scene.collection.objects.link(sun)
    sun.matrix_world = _frame(towards_light.orthogonal().normalized(), towards_light, Vector())
    return lamp


def _frame(x, z, origin):
    y = z.cross(x)
    return Matrix.Translation(origin) @ Matrix((x, y, z)).transposed().to_4x4()


def _world(strength):
    """A world of constant radiance, shared by all readings of that radiance."""
    name = f"goniophotometer {strength}"
    world = bpy.data.worlds.get(name)
    if world is None:
        world = bpy.data.worlds.new(name)
        background = next(node for node in node_tree.of(world).nodes if node.type == "BACKGROUND")
        background.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
        background.inputs["Strength"].default_value = strength
    return world


def _settings(scene, samples, count):
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = _COLUMNS * count, _ROWS
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = False
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.exr_codec = "NONE"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.max_bounces = 0
    cycles.transparent_max_bounces = 8
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = 0.0
    cycles.blur_glossy = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.film_exposure = 1.0
    cycles.pixel_filter_type = "BOX"


def _render(scene):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "reading.exr")
        scene.render.filepath = path
        bpy.ops.render.render(write_still=True, scene=scene.name)
        image = bpy.data.images.load(path)
        image.colorspace_settings.name = "Non-Color"
        width, height = image.size
        pixels = np.empty(width * height * image.channels, np.float32)
        image.pixels.foreach_get(pixels)
        channels = image.channels
        bpy.data.images.remove(image)
    return pixels.reshape(height, width, channels).astype(float)
