# SPDX-License-Identifier: GPL-3.0-or-later
"""The stage of a preset: a body on a dark ground with squares, a low warm sun, and a sky with soft boxes.

The sky is nearly grey, so that colours in the picture are those of the material.
"""

import math

import bpy
import extension
import node_tree
import numpy as np
from mathutils import Vector

from . import ball

SUN = Vector((-0.80, -0.42, 0.48)).normalized()
SUN_IRRADIANCE, SUN_ANGLE, SUN_COLOUR = 3.0, math.radians(4.0), (1.0, 0.90, 0.78)
BEHIND_IRRADIANCE = 2.2  # of a second sun behind sheets
FLASH_IRRADIANCE = 0.25  # of a lamp beside the camera, for retroreflectors
EYE, AIM, WIDTH = Vector((0.0, -4.2, 1.75)), Vector((0.0, 0.0, 0.355)), 1.05
# (towards its middle, cosine of its half angle, radiance): discs in the sky, with soft edges.
BOXES = (
    (Vector((-0.75, -0.75, 0.75)), 0.93, (4.5, 4.4, 4.1)),
    (Vector((0.95, 0.25, 0.30)), 0.95, (3.2, 3.4, 3.8)),
    (Vector((0.05, 1.0, 0.35)), 0.94, (2.4, 2.3, 2.2)),
)
SKY, HORIZON, GROUND = (0.20, 0.21, 0.23), (0.26, 0.26, 0.26), (0.06, 0.06, 0.06)
BELOW = {  # overlays: plastic, chrome, wood
    "Base Color": ((0.60, 0.02, 0.015), (0.55, 0.56, 0.57), (0.42, 0.22, 0.09)),
    "Metallic": (0.0, 1.0, 0.0),
    "Roughness": (0.15, 0.1, 0.6),
}
FILM_SCALES = {"DROPS": 12.0, "PUDDLES": 1.0, "PRINTS": 9.0}  # the body is larger than most things with drops on them
SQUARES, SQUARE = (0.035, 0.055), 0.30  # reflectances and size of the squares of the ground


def build():
    """(scene, solid body, sheet): the bodies are hidden until `show`."""
    scene = bpy.data.scenes.new("presets")
    bodies = []
    for mesh in (ball.solid(), ball.sheet()):
        body = bpy.data.objects.new(mesh.name, mesh)
        scene.collection.objects.link(body)
        body.material_slots[0].link = "OBJECT"
        bodies.append(body)
    _camera(scene)
    _sun(scene, "sun", SUN, SUN_IRRADIANCE, SUN_COLOUR)
    _sun(scene, "behind", Vector((0.25, 0.9, 0.55)).normalized(), BEHIND_IRRADIANCE, (1.0, 1.0, 1.0))
    _sun(scene, "flash", (EYE - AIM).normalized(), FLASH_IRRADIANCE, (1.0, 1.0, 1.0))
    scene.collection.objects.link(_floor())
    scene.world = _world()
    scene.view_layers[0].update()
    return scene, *bodies


def show(scene, material, is_sheet):
    """Show `material` on the body for its kind of stack, and in its light."""
    for body in scene.collection.objects:
        if body.name.startswith(("ball", "sheet")):
            body.hide_render = body.name.startswith("sheet") != is_sheet
            if not body.hide_render:
                body.material_slots[0].material = material
        if body.name.startswith("behind"):
            body.hide_render = not is_sheet
        if body.name.startswith("flash"):
            body.hide_render = material.lamina.base.kind != "retroreflector"


def below(name):
    """A new material for overlays to lie over: red plastic on the left, chrome, and dull brown wood on the right."""
    material = bpy.data.materials.new(name)
    tree = node_tree.of(material)
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Object"], split.inputs[0])
    across = _range(tree, split.outputs["X"], -0.5, 0.5)
    for socket, values in BELOW.items():
        ramp = tree.nodes.new("ShaderNodeValToRGB")
        ramp.color_ramp.interpolation = "CONSTANT"
        ramp.color_ramp.elements.new(0.5)
        for element, place, value in zip(ramp.color_ramp.elements, (0.0, 0.39, 0.61), values, strict=True):
            element.position, element.color = place, (*np.broadcast_to(value, 3), 1.0)
        tree.links.new(across, ramp.inputs[0])
        tree.links.new(ramp.outputs[0], tree.nodes["Principled BSDF"].inputs[socket])
    return material


def wire_dust(material):
    """Let the material's varying layer lie on the body as dust that settled in the amount 1, times the baked thickness,
    with grain."""
    thickness = extension.part("nodes.thickness")
    largest = thickness.wiring(material).socket.default_value
    source = thickness.wire_thickness(material, "attribute")
    tree = material.node_tree
    times = tree.nodes.new("ShaderNodeMath")
    times.operation = "MULTIPLY"
    times.inputs[1].default_value = largest
    tree.links.new(source.node.outputs["Fac"], times.inputs[0])
    tree.links.new(times.outputs[0], source.socket)
    detail = extension.part("nodes.detail_wiring").add_detail(material)
    for name, share in (("Cloud Size", 0.4), ("Grain Size", 0.012)):
        detail.inputs[name].default_value = share * ball.PLATE


def scale_film(material):
    """Enlarge the pattern of a film, so that it is seen in a small picture."""
    wiring, patterns = extension.part("nodes.film_wiring"), extension.part("nodes.film_pattern").PATTERNS
    kind = wiring.chosen(material)
    for name in patterns[kind].sizes if kind else ():
        wiring.node_of(material).inputs[name].default_value *= FILM_SCALES[kind]


def _camera(scene):
    camera = bpy.data.cameras.new("camera")
    camera.lens = 85.0
    back = (EYE - AIM).normalized()
    eye = bpy.data.objects.new("camera", camera)
    eye.location = AIM + back * WIDTH * camera.lens / camera.sensor_width
    eye.rotation_euler = back.to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(eye)
    scene.camera = eye


def _sun(scene, name, towards, irradiance, colour):
    lamp = bpy.data.lights.new(name, "SUN")
    lamp.energy, lamp.angle, lamp.color = irradiance, SUN_ANGLE, colour
    sun = bpy.data.objects.new(name, lamp)
    sun.rotation_euler = towards.to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(sun)


def _floor():
    """The ground: a matt plane with squares, which show what is seen through a sheet."""
    mesh = bpy.data.meshes.new("floor")
    mesh.from_pydata([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [], [(0, 1, 2, 3)])
    material = bpy.data.materials.new("floor")
    tree = node_tree.of(material)
    tree.nodes.clear()
    place = tree.nodes.new("ShaderNodeTexCoord").outputs["Object"]
    checks = tree.nodes.new("ShaderNodeTexChecker")
    checks.inputs["Scale"].default_value = 1.0 / SQUARE
    for name, value in zip(("Color1", "Color2"), SQUARES, strict=True):
        checks.inputs[name].default_value = (value, value, value, 1.0)
    # Half a square up: the plane must not lie on the border between cells.
    shift = tree.nodes.new("ShaderNodeVectorMath")
    shift.inputs[1].default_value = (0.0, 0.0, 0.5 * SQUARE)
    tree.links.new(place, shift.inputs[0])
    tree.links.new(shift.outputs[0], checks.inputs["Vector"])
    diffuse, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(checks.outputs["Color"], diffuse.inputs["Color"])
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    mesh.materials.append(material)
    return bpy.data.objects.new("floor", mesh)


def _world():
    world = bpy.data.worlds.new("studio")
    world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", 512
    tree = node_tree.of(world)
    tree.nodes.clear()
    direction = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(direction, split.inputs[0])
    sky = tree.nodes.new("ShaderNodeValToRGB")
    stops = ((0.0, GROUND), (0.47, GROUND), (0.53, HORIZON), (1.0, SKY))
    while len(sky.color_ramp.elements) < len(stops):
        sky.color_ramp.elements.new(0.5)
    for element, (place, colour) in zip(sky.color_ramp.elements, stops, strict=True):
        element.position, element.color = place, (*colour, 1.0)
    tree.links.new(_range(tree, split.outputs["Z"], -1.0, 1.0), sky.inputs[0])
    colour = sky.outputs[0]
    for towards, edge, radiance in BOXES:
        cosine = tree.nodes.new("ShaderNodeVectorMath")
        cosine.operation = "DOT_PRODUCT"
        cosine.inputs[1].default_value = towards.normalized()
        tree.links.new(direction, cosine.inputs[0])
        box = tree.nodes.new("ShaderNodeMix")
        box.data_type = "RGBA"
        tree.links.new(_range(tree, cosine.outputs["Value"], edge - 0.01, edge + 0.01), box.inputs["Factor"])
        tree.links.new(colour, box.inputs[6])
        box.inputs[7].default_value = (*radiance, 1.0)
        colour = box.outputs[2]
    background, output = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(colour, background.inputs["Color"])
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    return world


def _range(tree, value, low, high):
    node = tree.nodes.new("ShaderNodeMapRange")
    node.inputs["From Min"].default_value, node.inputs["From Max"].default_value = low, high
    tree.links.new(value, node.inputs["Value"])
    return node.outputs["Result"]
