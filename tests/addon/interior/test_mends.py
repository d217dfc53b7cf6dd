# SPDX-License-Identifier: GPL-3.0-or-later
"""Buttons that mend what refuses the interior of an object."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from addon_helpers import drawn, pixels


@pytest.fixture
def texts(addon, ball):
    """What the panel says."""
    def said(obj):
        context = SimpleNamespace(
            object=obj, material=obj.active_material, scene=bpy.context.scene, region=SimpleNamespace(width=600),
            preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)), view_layer=bpy.context.view_layer,
            evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get)
        return drawn(lambda layout: addon.ui.interior_fields.draw(context, layout))
    return said


def images(obj):
    nodes = obj.active_material.lamina.lateral_group.nodes
    return {node.label: pixels(node.image) for node in nodes if node.type == "TEX_IMAGE"}


def test_objects_that_share_a_mesh_get_materials_of_their_own(jobs, ball, call, texts):
    shared = ball.active_material
    twin = bpy.data.objects.new("Twin", ball.data)
    bpy.context.scene.collection.objects.link(twin)
    twin.scale, twin.location = (0.03, 0.01, 0.01), (3.0, 0.0, 0.0)
    assert "Own Copy of the Material" in texts(ball)
    with pytest.raises(ValueError, match="Marble is also on Twin"):
        jobs.make(bpy.context, ball, shared)
    assert call(bpy.ops.lamina.interior_copy, shared) == {"FINISHED"}
    assert ball.data == twin.data and twin.active_material == shared != ball.active_material
    assert "Own Copy of the Material" not in texts(ball)
    jobs.make(bpy.context, ball, ball.active_material)
    first = images(ball)
    jobs.make(bpy.context, twin, shared)
    assert not np.array_equal(first["color"], images(twin)["color"])
    assert all(np.array_equal(first[name], again) for name, again in images(ball).items())


def test_a_modifier_that_copies_faces_is_applied(jobs, ball, texts):
    array = ball.modifiers.new("Row", "ARRAY")
    array.relative_offset_displace = (1.5, 0.0, 0.0)
    with pytest.raises(ValueError, match="Ball: the modifier Row makes faces .* in the UV map: apply it"):
        jobs.make(bpy.context, ball, ball.active_material)
    assert "Apply Row" in texts(ball)
    with bpy.context.temp_override(object=ball, active_object=ball):
        assert bpy.ops.object.modifier_apply(modifier="Row", single_user=True) == {"FINISHED"}
    assert "Apply Row" not in texts(ball)
    jobs.make(bpy.context, ball, ball.active_material)
    assert images(ball)


@pytest.mark.parametrize("kind", ["CURVE", "FONT"])
def test_curves_and_text_are_converted(jobs, ball, texts, kind):
    if kind == "FONT":
        data = bpy.data.curves.new("Letters", "FONT")
        data.body, data.extrude, data.bevel_depth = "L", 0.1, 0.02
    else:
        data = bpy.data.curves.new("Letters", "CURVE")
        data.dimensions, data.bevel_depth, data.use_fill_caps = "3D", 0.1, True
        data.splines.new("POLY").points.add(2)
        for number, point in enumerate(data.splines[0].points):
            point.co = (number, 0.3 * number**2, 0.0, 1.0)
    data.materials.append(ball.active_material)
    bpy.data.objects.remove(ball)
    obj = bpy.data.objects.new("Letters", data)
    obj.scale = (0.01,) * 3
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    assert {"Letters has no mesh of its own: convert it", "Convert to Mesh"} <= set(texts(obj))
    assert bpy.ops.object.convert(target="MESH") == {"FINISHED"}
    obj.active_material.lamina.interior.map = "NEW"
    assert "Convert to Mesh" not in texts(obj)
    found = jobs.make(bpy.context, obj, obj.active_material)
    assert found.mask.sum() > 40
