# SPDX-License-Identifier: GPL-3.0-or-later
"""Modifiers that make hard edges, or finer meshes: dust has the normals and the levels of the render."""

import bmesh
import bpy
import numpy as np
import pytest
from addon_helpers import pixels
from dusty_objects import NAME, alone, ball, grid, values
from test_addon_dust_edges import cylinder


def block():
    """A smooth cube."""
    return alone("Cube", lambda bm: bmesh.ops.create_cube(bm, size=2.0), smooth=True)


def auto_smooth(obj):
    """What Shade Auto Smooth does: edges of more than 30 degrees become sharp, by nodes."""
    tree = bpy.data.node_groups.new("Smooth by Angle", "GeometryNodeTree")
    for in_out in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Mesh", in_out=in_out, socket_type="NodeSocketGeometry")
    given, made = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    sharp, angle = tree.nodes.new("GeometryNodeSetShadeSmooth"), tree.nodes.new("GeometryNodeInputMeshEdgeAngle")
    below = tree.nodes.new("FunctionNodeCompare")
    below.operation, sharp.domain = "LESS_EQUAL", "EDGE"
    below.inputs["B"].default_value = np.radians(30.0)
    tree.links.new(angle.outputs["Unsigned Angle"], below.inputs["A"])
    tree.links.new(below.outputs[0], sharp.inputs["Shade Smooth"])
    tree.links.new(given.outputs[0], sharp.inputs[0])
    tree.links.new(sharp.outputs[0], made.inputs[0])
    obj.modifiers.new("Smooth by Angle", "NODES").node_group = tree


def edge_split(obj):
    obj.modifiers.new("Split", "EDGE_SPLIT")


def bevel(obj):
    modifier = obj.modifiers.new("Bevel", "BEVEL")
    modifier.width, modifier.segments, modifier.harden_normals = 0.1, 3, True


def weighted(obj):
    bevel(obj)
    obj.modifiers["Bevel"].harden_normals = False
    obj.modifiers.new("Weighted", "WEIGHTED_NORMAL")


HARD = {"auto smooth": auto_smooth, "edge split": edge_split, "bevel": bevel, "weighted": weighted}


def by_corner(obj):
    """The thickness at each face corner of the mesh itself."""
    found = obj.data.attributes[NAME]
    values = np.array([one.value for one in found.data])
    return values if found.domain == "CORNER" else values[[loop.vertex_index for loop in obj.data.loops]]


@pytest.mark.parametrize("shape", [block, lambda: cylinder(smooth=True)], ids=["cube", "cylinder"])
@pytest.mark.parametrize("make", HARD.values(), ids=HARD)
def test_hard_edges_that_modifiers_make(dust, shape, make):
    """As on the same mesh with sharp edges of its own."""
    obj, own = shape(), shape()
    make(obj)
    for edge in own.data.edges:
        edge.use_edge_sharp = True
    if len(own.data.polygons) > 6:
        for edge in own.data.edges:
            edge.use_edge_sharp = edge.use_edge_sharp and abs(own.data.vertices[edge.vertices[0]].co.z
                                                              - own.data.vertices[edge.vertices[1]].co.z) < 1e-6
    for one in (obj, own):
        dust.settle(bpy.context, one)
    assert np.abs(by_corner(obj) - by_corner(own)).max() < 0.01


def subdivided(viewport, render):
    obj = block()
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = viewport, render
    return obj


def test_dust_has_the_levels_of_renders(dust):
    obj = subdivided(0, 3)
    dust.settle(bpy.context, obj)
    assert "has the mesh's 8 vertices for the 386 that" in obj.lamina_dust.told
    settings = obj.lamina_dust
    assert settings.settled != dust.PARTLY
    task = dust.gather(bpy.context, obj, live=True)
    assert len(task.surface.vertices) == 8 and task.settled == dust.PARTLY, "Live reads the viewport"


def test_what_only_renders_show_keeps_dust_off(dust):
    plate, roof = grid(size=0.1), grid("Roof", size=5.0, z=1.0)
    roof.hide_viewport = True
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 0.0, atol=1e-3)
    plate.hide_viewport = True
    roof.hide_render = True
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 1.0, rtol=1e-3)
    plate.hide_viewport, plate.hide_render = False, True
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 1.0, rtol=1e-3), "hidden in renders: as the viewport shows it"


def advised(dust, obj):
    return dust.advice(obj, obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))


def test_a_cage_gets_an_image_in_one_click(dust, addon, call):
    """The eight vertices of the cage lie on steep places of the rendered ball: an attribute would leave its top bare.
    """
    obj, plain = subdivided(0, 2), block()
    assert advised(dust, plain) == ""
    assert "more vertices than the 8 of the mesh" in advised(dust, obj)
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.lamina.dust_image() == {"FINISHED"}
    assert advised(dust, obj) == ""
    settings = obj.lamina_dust
    assert (settings.target, settings.uv_map) == ("image", "Lamina")
    settings.size = 256
    dust.settle(bpy.context, obj)
    assert pixels(settings.image)[..., 0].max() == pytest.approx(1.0, abs=0.02)


def test_a_uv_map_that_overlaps_itself_is_not_used(dust, addon):
    """All faces of the cube have the entire image."""
    obj = block()
    layer = obj.data.uv_layers.new(name="Same")
    for loop, place in enumerate(((0, 0), (1, 0), (1, 1), (0, 1)) * 6):
        layer.uv[loop].vector = place
    assert addon.settling.wiping.store(obj) == "attribute"
    dust.keep_in_image(obj)
    assert obj.lamina_dust.uv_map == "Lamina" and addon.settling.wiping.store(obj) == "attribute"
    plate = grid()
    dust.keep_in_image(plate)
    assert plate.lamina_dust.uv_map == "" and addon.settling.wiping.store(plate) == "image"


def test_a_modifier_that_drops_the_dust_is_named(dust):
    obj = ball()
    obj.lamina_dust.others = False
    obj.modifiers.new("Remesh", "REMESH").mode = "VOXEL"
    dust.settle(bpy.context, obj)
    assert "a modifier drops the attributes of the mesh" in obj.lamina_dust.told


@pytest.mark.parametrize("realized", [False, True])
@pytest.mark.parametrize("joined", [False, True], ids=["alone", "beside the mesh"])
def test_instances_of_geometry_nodes_are_named(dust, addon, realized, joined):
    """A plate on each of the vertices, beside the mesh or in its place."""
    obj, leaf = grid(cells=2), grid("Leaf", size=0.1)
    leaf.hide_render = leaf.hide_viewport = True
    obj.lamina_dust.others = False
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    for in_out in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Mesh", in_out=in_out, socket_type="NodeSocketGeometry")
    names = ("NodeGroupInput", "NodeGroupOutput", "GeometryNodeInstanceOnPoints", "GeometryNodeObjectInfo",
             "GeometryNodeRealizeInstances", "GeometryNodeJoinGeometry")
    given, made, instances, info, realize, join = (tree.nodes.new(name) for name in names)
    info.inputs["Object"].default_value = leaf
    tree.links.new(given.outputs[0], instances.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], instances.inputs["Instance"])
    end = instances.outputs[0]
    if realized:
        tree.links.new(end, realize.inputs[0])
        end = realize.outputs[0]
    tree.links.new(end, join.inputs[0])
    if joined:
        tree.links.new(given.outputs[0], join.inputs[0])
    tree.links.new(join.outputs[0], made.inputs[0])
    obj.modifiers.new("Scatter", "NODES").node_group = tree
    if not realized and not joined:
        with pytest.raises(addon.base.messages.RefusedError, match="no faces.*Realize Instances"):
            dust.settle(bpy.context, obj)
        return
    dust.settle(bpy.context, obj)
    assert ("Realize Instances" in obj.lamina_dust.told) == (not realized)


@pytest.mark.parametrize("kind", ["CURVE", "FONT"])
def test_curves_and_text_are_refused_with_a_remedy(dust, kind):
    obj = bpy.data.objects.new("Sign", bpy.data.curves.new("Sign", kind))
    assert dust.problem(obj) == "Sign is no mesh, and holds no dust: convert it (Object > Convert > Mesh)"
