# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies of a few millimetres under a sun or a sky, and counts of data-blocks."""

from typing import NamedTuple

import bpy
from mathutils import Vector

TOWARDS = {"behind": (0.2, 1.0, -0.2), "side": (1.0, 0.0, 0.2)}  # directions to the sun


class Blocks(NamedTuple):
    materials: int
    objects: int
    scenes: int
    images: int
    groups: int


def blocks():
    data = bpy.data
    images = [image for image in data.images if image.type != "RENDER_RESULT"]
    return Blocks(*map(len, (data.materials, data.objects, data.scenes, images, data.node_groups)))


def body(shape, light):
    """The active object, 2 mm wide, with a new material, before a camera. `shape`: "torus" or "plate"; `light`: of
    TOWARDS, or "sky"."""
    scene = bpy.context.scene
    scene.unit_settings.scale_length = 0.001
    if shape == "torus":
        bpy.ops.mesh.primitive_torus_add(major_radius=0.75, minor_radius=0.25, major_segments=96, minor_segments=48)
    else:
        bpy.ops.mesh.primitive_cube_add(size=2.0)
        bpy.context.object.scale.z = 0.15
        bpy.ops.object.transform_apply(scale=True)
    obj = bpy.context.object
    obj.data.polygons.foreach_set("use_smooth", [shape == "torus"] * len(obj.data.polygons))
    eye = Vector((0.0, -6.0, 2.5) if shape == "torus" else (0.0, -3.0, 6.0))
    camera = _linked("Camera", bpy.data.cameras.new("Camera"), eye)
    camera.location, scene.camera = eye, camera
    scene.world = bpy.data.worlds.new("World")
    background = _tree(scene.world).nodes["Background"].inputs
    background["Color"].default_value, background["Strength"].default_value = (1.0,) * 4, float(light == "sky")
    if light != "sky":
        sun = bpy.data.lights.new("Sun", "SUN")
        sun.energy, sun.angle = 3.0, 0.1
        flat_behind = shape == "plate" and light == "behind"
        _linked("Sun", sun, Vector((0.2, 0.3, -1.0) if flat_behind else TOWARDS[light]))
    obj.data.materials.append(bpy.data.materials.new("Body"))
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()
    return obj


def others():
    """A floor below the body and a wall between it and a sun at its side, both diffuse."""
    floor, wall = bpy.data.meshes.new("Floor"), bpy.data.meshes.new("Wall")
    floor.from_pydata([(-15, -15, -1.05), (15, -15, -1.05), (15, 15, -1.05), (-15, 15, -1.05)], [], [(0, 1, 2, 3)])
    wall.from_pydata([(2, -1, -0.6), (2, 0.2, -0.6), (2, 0.2, 1.0), (2, -1, 1.0)], [], [(0, 1, 2, 3)])
    for mesh, color in ((floor, (0.8, 0.4, 0.2)), (wall, (0.1, 0.3, 0.7))):
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(mesh.name, mesh))
        material = bpy.data.materials.new(mesh.name)
        nodes = _tree(material).nodes
        nodes.remove(nodes["Principled BSDF"])
        diffuse = nodes.new("ShaderNodeBsdfDiffuse")
        diffuse.inputs["Color"].default_value = (*color, 1.0)
        material.node_tree.links.new(diffuse.outputs[0], nodes["Material Output"].inputs["Surface"])
        mesh.materials.append(material)
    bpy.context.scene.cycles.diffuse_bounces = 12


def link(source, kind, **states):
    """Lists objects in the light linking ("receiver") or the shadow linking ("blocker") of an object."""
    found = bpy.data.collections.new(kind)
    for number, (name, state) in enumerate(states.items()):
        found.objects.link(bpy.data.objects[name])
        found.collection_objects[number].light_linking.link_state = state
    setattr(bpy.data.objects[source].light_linking, f"{kind}_collection", found)


def _tree(owner):
    from bl_ext.user_default.lamina.nodes import node_tree

    return node_tree.of(owner)


def _linked(name, data, towards):
    """A new object whose +z points to a direction."""
    obj = bpy.data.objects.new(name, data)
    obj.rotation_euler = towards.to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(obj)
    return obj
