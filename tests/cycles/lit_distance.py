# SPDX-License-Identifier: GPL-3.0-or-later
"""Exit albedo and mean exit distance of a material, at one point of a wide plane that is seen along its normal.

A point lamp stands above the point, and nodes give the lamp an intensity by direction. Once the plane's irradiance is
the same everywhere, and once it is proportional to the distance from the point. Light that enters at the point, on a
path from the eye, leaves at the distance r with Lambert's closure; so the radiance is the exit albedo in the first
case, and the mean of r times the exit albedo in the second. All pixels see the same point."""

import math

import bpy
import goniophotometer
import lit_edge

PIXELS = (32, 32)
POINT = (0.0, 0.0137)  # off the diagonal of the plane


def exit_albedo_and_distance(material, samples, height):
    """((exit albedo, its standard error), (mean exit distance in Blender units, its standard error)), each of shape
    (3,). `height`: of the lamp, in Blender units; a few mean distances, so that single precision is enough."""
    even, growing = (_render(material, samples, height, power) for power in (0, 1))
    albedo = even.mean(axis=0)
    distance = growing.mean(axis=0) / albedo
    ratio = (growing - distance * even) / albedo  # the linearised error of the ratio
    return (albedo, _standard_error(even)), (height * distance, height * _standard_error(ratio))


def _standard_error(pixels):
    return pixels.std(axis=0, ddof=1) / math.sqrt(len(pixels))


def _render(material, samples, height, power):
    """Pixels (n, 3) where the irradiance over pi is (r / height)^power."""
    scene = bpy.data.scenes.new("lit distance")
    mesh = lit_edge._plane(scene, -lit_edge.HALF, 0.0, material)
    lamp = bpy.data.lights.new("lamp", "POINT")
    lamp.shadow_soft_size = 0.0
    lamp.energy = 4.0 * math.pi**2 * height**2  # a radiant intensity of pi height^2
    _shine(goniophotometer.node_tree.of(lamp), power)
    camera = bpy.data.cameras.new("eye")
    camera.type, camera.sensor_fit, camera.ortho_scale = "ORTHO", "HORIZONTAL", 1e-4 * height
    for name, data, z in (("lamp", lamp, height), ("eye", camera, 1.0)):
        found = bpy.data.objects.new(name, data)
        scene.collection.objects.link(found)
        found.location = (*POINT, z)
    scene.camera = found
    scene.world = goniophotometer._world(0.0)
    goniophotometer._settings(scene, samples, 1)
    scene.cycles.max_bounces = 8
    scene.render.resolution_y, scene.render.resolution_x = PIXELS
    try:
        return goniophotometer._render(scene).reshape(-1, 4)[:, :3]
    finally:
        bpy.data.scenes.remove(scene)
        bpy.data.meshes.remove(mesh)
        bpy.data.cameras.remove(camera)
        bpy.data.lights.remove(lamp)


def _shine(tree, power):
    """Draw the intensity by direction: at the angle theta from the vertical the irradiance of a plane below is
    proportional to intensity cos(theta)^3, and r / height is tan(theta)."""
    tree.nodes.clear()

    def node(kind, operation, *sources):
        made = tree.nodes.new(kind)
        made.operation = operation
        for socket, source in zip(made.inputs, sources, strict=False):
            if isinstance(source, bpy.types.NodeSocket):
                tree.links.new(source, socket)
            else:
                socket.default_value = source
        return made.outputs["Value"]

    towards = tree.nodes.new("ShaderNodeNewGeometry").outputs["Incoming"]
    up = (0.0, 0.0, 1.0)
    cosine = node("ShaderNodeMath", "ABSOLUTE", node("ShaderNodeVectorMath", "DOT_PRODUCT", towards, up))
    across = tree.nodes.new("ShaderNodeVectorMath")
    across.operation, across.inputs[1].default_value = "MULTIPLY", (1.0, 1.0, 0.0)
    tree.links.new(towards, across.inputs[0])
    tangent = node("ShaderNodeMath", "DIVIDE", node("ShaderNodeVectorMath", "LENGTH", across.outputs["Vector"]), cosine)
    shape = node("ShaderNodeMath", "POWER", tangent, float(power))
    strength = node("ShaderNodeMath", "DIVIDE", shape, node("ShaderNodeMath", "POWER", cosine, 3.0))
    emission, output = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputLight")
    tree.links.new(strength, emission.inputs["Strength"])
    tree.links.new(emission.outputs[0], output.inputs[0])
