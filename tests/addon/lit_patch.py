# SPDX-License-Identifier: GPL-3.0-or-later
"""A white patch at the origin under one lamp, and its light in Cycles."""

import bpy
import numpy as np
from mathutils import Vector

SOURCES = {
    "SUN": {"energy": 2.0, "angle": 0.1},
    "POINT": {"energy": 900.0, "shadow_soft_size": 0.3},
    "SPOT": {"energy": 1500.0, "shadow_soft_size": 0.1, "spot_size": 0.5, "spot_blend": 0.4},
    "AREA": {"energy": 700.0, "shape": "RECTANGLE", "size": 0.8, "size_y": 0.4},
    "DISK": {"energy": 700.0, "shape": "DISK", "size": 0.8},
}
PLACE = Vector((3.0, -4.0, 9.0))


def lit_scene(name, **more):
    """The scene with one lamp that shines at the origin; a spot shines a little beside the origin. `more`: properties
    of the lamp."""
    scene, numbers = bpy.context.scene, {**SOURCES[name], **more}
    kind = "AREA" if name == "DISK" else name
    obj = bpy.data.objects.new(name, bpy.data.lights.new(name, kind))
    for field, value in numbers.items():
        setattr(obj.data, field, value)
    turn = (PLACE - Vector((0.0, 0.0, 2.0 if name == "SPOT" else 0.0))).to_track_quat("Z", "Y")
    obj.location, obj.rotation_euler = PLACE, turn.to_euler()
    scene.collection.objects.link(obj)
    scene.world = bpy.data.worlds.new("Dark")
    scene.world.color = (0.0, 0.0, 0.0)
    # From Blender 5.0 on, a new world has nodes, with a grey background.
    for node in scene.world.node_tree.nodes if scene.world.node_tree is not None else ():
        if node.type == "BACKGROUND":
            node.inputs["Strength"].default_value = 0.0
    bpy.context.view_layer.update()
    return scene


def irradiance_in_cycles(float_render, scene, change=lambda: None):
    """At the origin, on a plane perpendicular to the light: pi times the radiance of a white diffuse patch. `change`:
    called before the render."""
    from bl_ext.user_default.lamina.nodes import node_tree

    mesh = bpy.data.meshes.new("Patch")
    mesh.from_pydata([(-0.01, -0.01, 0), (0.01, -0.01, 0), (0.01, 0.01, 0), (-0.01, 0.01, 0)], [], [(0, 1, 2, 3)])
    patch = bpy.data.objects.new("Patch", mesh)
    material = bpy.data.materials.new("White")
    node_tree.of(material).nodes.clear()
    shader = material.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    output = material.node_tree.nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
    mesh.materials.append(material)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 0.01
    turn = PLACE.to_track_quat("Z", "Y")
    patch.rotation_euler = camera.rotation_euler = turn.to_euler()
    camera.location = 0.5 * PLACE.normalized() + turn @ Vector((0.001, 0.002, 0.0))
    for obj in (patch, camera):
        scene.collection.objects.link(obj)
    scene.camera = camera
    float_render.prepare(scene, 4, 4)
    scene.cycles.samples = 1024
    change()
    return np.pi * float_render.picture(scene)[..., 0].mean()
