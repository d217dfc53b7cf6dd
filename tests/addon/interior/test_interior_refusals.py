# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects, lamps and settings that the panel Interior refuses."""

import bmesh
import bpy
import numpy as np
import pytest
from addon_helpers import sun


def sheared(obj):
    stand = bpy.data.objects.new("Stand", None)
    bpy.context.scene.collection.objects.link(stand)
    obj.parent, stand.scale = stand, (2.0, 1.0, 1.0)


def shared(obj):
    other = bpy.data.objects.new("Twin", obj.data)
    bpy.context.scene.collection.objects.link(other)


def opened(obj):
    made = bmesh.new()
    made.from_mesh(obj.data)
    right = [face for face in made.faces if face.calc_center_median().x > 0.0]
    bmesh.ops.delete(made, geom=right, context="FACES")
    made.to_mesh(obj.data)
    made.free()


def flipped(obj):
    obj.data.flip_normals()


def emptied(obj):
    obj.data.clear_geometry()


def overlapping(obj):
    layer = obj.data.uv_layers.new(name="Own")
    layer.uv.foreach_set("vector", np.tile([0.1, 0.1, 0.9, 0.1, 0.1, 0.9], len(obj.data.polygons)))


def lit_by(obj, kind):
    """A new lamp of the scene, named Bulb."""
    obj.active_material.lamina.interior.output = "LIT"
    made = bpy.data.objects.new("Bulb", bpy.data.lights.new("Bulb", kind))
    bpy.context.scene.collection.objects.link(made)
    return made


def lamp_with_nodes(obj):
    from bl_ext.user_default.lamina.nodes import node_tree

    lamp = lit_by(obj, "POINT").data
    falloff = node_tree.of(lamp).nodes.new("ShaderNodeLightFalloff")
    emission = next(node for node in lamp.node_tree.nodes if node.type == "EMISSION")
    lamp.node_tree.links.new(falloff.outputs["Linear"], emission.inputs["Strength"])


def focused_area(obj):
    lit_by(obj, "AREA").data.spread = np.radians(60.0)


def world_by_ray(obj):
    from bl_ext.user_default.lamina.nodes import node_tree

    obj.active_material.lamina.interior.output = "LIT"
    world = bpy.context.scene.world = bpy.data.worlds.new("Sky")
    path = node_tree.of(world).nodes.new("ShaderNodeLightPath")
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    world.node_tree.links.new(path.outputs[0], background.inputs["Color"])


def narrow_sun(obj):
    settings = obj.active_material.lamina.interior
    settings.output, settings.roughness = "LIT", 0.0
    sun("Sun", (0, 0, 0)).data.angle = 0.0


def small_bulb(obj):
    lit_by(obj, "POINT").data.shadow_soft_size = 0.0
    obj.active_material.lamina.interior.roughness = 0.0


def no_texture(obj):
    obj.active_material.lamina.interior.source = "NODES"


def layers_without_lengths(obj):
    from bl_ext.user_default.lamina.editing import layer_list

    layer_list.add_stack(obj.active_material)
    obj.active_material.lamina.interior.source = "LAYERS"


def missing_map(obj):
    obj.data.uv_layers.new(name="Own")
    obj.active_material.lamina.interior.uv_map = "Other"


@pytest.mark.parametrize(("change", "words"), [
    (sheared, r"Ball is sheared by its parent Stand: apply the scale"),
    (shared, "Marble is also on Twin: its images fit one object"),
    (opened, r"Ball is open along \d+ edges"),
    (flipped, "Ball is inside out"),
    (emptied, "Ball has no faces"),
    (overlapping, "Ball: .* texels lie on two parts of the surface"),
    (lamp_with_nodes, "Bulb has nodes of its own: remove them for Lamps Stay, or hide it in renders"),
    (focused_area, "Bulb has a Spread of 60 degrees: must be 180 for Lamps Stay"),
    (world_by_ray, "Sky has a Light Path node, with light that depends on the ray"),
    (narrow_sun, "Sun has the Angle 0 degrees: behind a smooth boundary it must be at least 2 degrees, or give"),
    (small_bulb, "Bulb has the Radius 0: behind a smooth boundary it must be above 0, or give the boundary a R"),
    (no_texture, "Marble has no texture linked to a color or density"),
    (layers_without_lengths, "has no lengths"),
    (missing_map, "Ball has no UV map named .Other.: unwrap it, or let Lamina unwrap it"),
])  # fmt: skip
def test_refusals(jobs, ball, call, change, words):
    """One sentence, and the material is unchanged."""
    change(ball)
    bpy.context.view_layer.update()
    material = ball.active_material or bpy.data.materials["Marble"]
    before = [node.name for node in material.node_tree.nodes]
    with pytest.raises(ValueError, match=words) as raised:
        jobs.make(bpy.context, ball, material)
    assert "\n" not in str(raised.value)
    assert [node.name for node in material.node_tree.nodes] == before and material.lamina.lateral_group is None
