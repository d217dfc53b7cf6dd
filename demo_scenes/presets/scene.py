# SPDX-License-Identifier: GPL-3.0-or-later
"""A grid of spheres, one per material, seen straight on; spheres do not shade, light or reflect each other.

Sheets are the front half of a sphere, with light behind it. The light is a sky, a sun, and two soft boxes for
reflections in metals: a large one to the upper left, a narrow one behind to the right. The sky is nearly grey, so
colours in the picture are those of materials.
"""

import math

import bpy
import node_tree
from mathutils import Vector

RADIUS = 0.42  # radius of a sphere in a cell of width 1
SUN = Vector((-0.45, -0.75, 0.65)).normalized()
SUN_IRRADIANCE, SUN_ANGLE = 1.4, math.radians(4.0)
# (towards its middle, cosine of its half angle, radiance): discs in the sky, with soft edges.
BOXES = (
    (Vector((-0.75, -0.75, 0.75)), 0.90, (5.0, 4.9, 4.6)),
    (Vector((0.95, 0.25, 0.30)), 0.95, (3.6, 3.8, 4.2)),
    (Vector((0.05, 1.0, 0.12)), 0.95, (2.6, 2.5, 2.4)),
)
SKY, HORIZON, GROUND = (0.42, 0.42, 0.43), (0.50, 0.50, 0.49), (0.14, 0.135, 0.13)


def build(materials, sheets, columns):
    """A scene of spheres in rows of `columns`, first row on top; `sheets`: True for domes.

    One cell is one unit wide; the camera sees columns x rows of them exactly."""
    scene = bpy.data.scenes.new("presets")
    rows = -(-len(materials) // columns)
    sphere, dome = _sphere(whole=True), _sphere(whole=False)
    for k, material in enumerate(materials):
        body = bpy.data.objects.new(material.name, dome if sheets[k] else sphere)
        scene.collection.objects.link(body)
        body.location = (k % columns + 0.5 - columns / 2, 0.0, rows / 2 - k // columns - 0.5)
        # The mesh is shared, so the material is linked to the object.
        body.material_slots[0].link = "OBJECT"
        body.material_slots[0].material = material
        body.visible_shadow = body.visible_diffuse = body.visible_glossy = body.visible_transmission = False
    _camera(scene, columns, rows)
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.energy, lamp.angle = SUN_IRRADIANCE, SUN_ANGLE
    sun = bpy.data.objects.new("sun", lamp)
    sun.rotation_euler = SUN.to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(sun)
    scene.world = _world()
    return scene


def settle(material, group_node):
    """Put the varying layer on upward surfaces, as dust settles."""
    tree = material.node_tree
    largest = group_node.inputs["Thickness"].default_value
    geometry, split, ramp = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("NewGeometry", "SeparateXYZ", "MapRange"))
    ramp.interpolation_type = "SMOOTHSTEP"
    for name, value in (("From Min", -0.35), ("From Max", 0.9), ("To Min", 0.0), ("To Max", largest)):
        ramp.inputs[name].default_value = value
    tree.links.new(geometry.outputs["Normal"], split.inputs[0])
    tree.links.new(split.outputs["Z"], ramp.inputs["Value"])
    tree.links.new(ramp.outputs["Result"], group_node.inputs["Thickness"])


def _sphere(whole):
    """A sphere as a surface of 64 x 32 smooth faces; only the half towards the camera for a sheet."""
    around, along = 64, 32 if whole else 16
    points, faces = [], []
    for j in range(along + 1):
        theta = math.pi * j / 32
        for i in range(around):
            phi = 2.0 * math.pi * i / around
            points.append((RADIUS * math.sin(theta) * math.cos(phi), -RADIUS * math.cos(theta),
                           RADIUS * math.sin(theta) * math.sin(phi)))
    for j in range(along):
        for i in range(around):
            following = (i + 1) % around
            a, b = j * around, (j + 1) * around
            faces.append((a + i, b + i, b + following, a + following))
    mesh = bpy.data.meshes.new("sphere" if whole else "dome")
    mesh.from_pydata(points, [], faces)
    if Vector(mesh.polygons[len(mesh.polygons) // 2].normal).dot(mesh.polygons[len(mesh.polygons) // 2].center) < 0.0:
        mesh.flip_normals()
    mesh.shade_smooth()
    mesh.materials.append(None)
    return mesh


def _camera(scene, columns, rows):
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", max(columns, rows)
    eye = bpy.data.objects.new("camera", camera)
    eye.location, eye.rotation_euler = (0.0, -10.0, 0.0), (math.pi / 2, 0.0, 0.0)
    scene.collection.objects.link(eye)
    scene.camera = eye


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
