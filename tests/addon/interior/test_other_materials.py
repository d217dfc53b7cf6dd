# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces of other materials on the object of an interior."""

import bpy
import numpy as np
import pytest
from addon_helpers import sun


def make(jobs, obj):
    return jobs.make(bpy.context, obj, obj.active_material)


@pytest.fixture
def capped(addon, ball):
    """The ball with a sun above, and a second material on its upper half: (ball, the material, its Principled)."""
    sun("Sun", (0.0, 0.0, 0.0))
    ball.rotation_euler = (0.0, 0.0, 0.0)
    bpy.context.view_layer.update()
    cap = bpy.data.materials.new("Cap")
    tree = addon.nodes.node_tree.of(cap)
    ball.data.materials.append(cap)
    for face in ball.data.polygons:
        face.material_index = int(face.center.z > 0.0)
    return ball, cap, next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")


def test_faces_of_an_opaque_material_let_no_light_in(jobs, capped, lamina):
    ball, _cap, shader = capped
    settings = ball.active_material.lamina.interior
    settings.output = "LIT"
    dark = make(jobs, ball)
    assert "Faces of Cap count as black" in settings.report and "Lamps shine" not in settings.report
    assert dark.lamps.max() == 0.0 and dark.mask.any()
    shader.inputs["Transmission Weight"].default_value = 1.0
    clear = make(jobs, ball)
    assert "Light passes faces of Cap as if they were of Marble." in settings.report
    assert clear.lamps.max() > 0.0


def test_relightable_tells_that_lamps_shine_through_opaque_faces(jobs, capped):
    ball, _cap, shader = capped
    settings = ball.active_material.lamina.interior
    settings.output = "RELIGHTABLE"
    make(jobs, ball)
    assert "Lamps shine into the body through opaque faces of other materials: choose Lamps Stay" in settings.report
    shader.inputs["Transmission Weight"].default_value = 1.0
    make(jobs, ball)
    assert "Lamps shine" not in settings.report


def test_which_other_materials_light_passes(jobs, capped, addon):
    from bl_ext.user_default.lamina.nodes import other_materials

    ball, cap, shader = capped
    numbers = np.array([0, 1, 1])

    def opaque():
        return other_materials.opaque_faces(numbers, ball, ball.material_slots[0].material)[0].tolist()

    assert opaque() == [False, True, True]
    shader.inputs["Metallic"].default_value = shader.inputs["Subsurface Weight"].default_value = 1.0
    assert opaque() == [False, True, True]
    shader.inputs["Alpha"].default_value = 0.5
    assert opaque() == [False, False, False]
    shader.inputs["Alpha"].default_value = 1.0
    tree = cap.node_tree
    volume = tree.nodes.new("ShaderNodeVolumeScatter")
    tree.links.new(volume.outputs[0], tree.get_output_node("CYCLES").inputs["Volume"])
    assert opaque() == [False, False, False]
    ball.material_slots[1].material = None
    assert opaque() == [False, True, True]
