# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel Depth: when it is there, what each choice sets, and what the nodes show."""

import bpy
import pytest
from addon_helpers import icosphere


@pytest.fixture
def deep(addon, lamina, material):
    """A material with a medium per millimetre."""
    layer = material.lamina.layers[0]
    layer.mode, layer.sigma_s, layer.sigma_a = "coefficients", (2.0, 2.0, 2.0), (0.1, 0.1, 0.1)
    layer.infinite = True
    return material


def choose(material, call, depth):
    assert call(bpy.ops.lamina.depth, material, depth=depth) == {"FINISHED"}
    return material.lamina.interior


def test_only_layers_with_lengths_have_a_depth(addon, deep):
    panel = addon.ui.depth_panel
    assert addon.editing.depth.has_lengths(deep) and panel.LAMINA_PT_depth.wanted(deep)
    deep.lamina.layers[0].mode = "optical"
    assert not panel.LAMINA_PT_depth.wanted(deep)
    deep.lamina.base.kind, deep.lamina.base.half_space_form = "half-space", "coefficients"
    assert panel.LAMINA_PT_depth.wanted(deep)
    deep.lamina.base.kind = "lambert"
    assert not panel.LAMINA_PT_depth.wanted(deep)
    assert panel.LAMINA_PT_depth.wanted(bpy.data.materials.new("Plain")), "veins need no layers"


def test_each_choice(deep, call):
    interior = choose(deep, call, "EXACT")
    assert (deep.lamina.depth, interior.source, interior.output) == ("EXACT", "LAYERS", "LIT")
    interior.output = "RELIGHTABLE"
    assert choose(deep, call, "VEINS").source == "MARBLE"
    assert interior.output == "RELIGHTABLE", "the artist's choice stays"
    interior.source = "NODES"
    assert choose(deep, call, "VEINS").source == "NODES"
    assert choose(deep, call, "EXACT").source == "LAYERS"


def test_exact_below_lamps_that_move(addon, deep, call):
    """Maps that lamps may move over, in place of light maps."""
    body = bpy.data.objects.new("Body", icosphere("Body", 1.0))
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    for one in (body, sun):
        bpy.context.scene.collection.objects.link(one)
    sun.keyframe_insert("rotation_euler", frame=1)
    with bpy.context.temp_override(object=body):
        assert choose(deep, call, "EXACT").output == "RELIGHTABLE"


def test_an_output_that_was_computed_stays(deep, call):
    """Files of earlier versions do not store the output that was the first of the list."""
    deep.lamina.interior.report = "Relightable: 3 lamps"
    assert choose(deep, call, "VEINS").output == "RELIGHTABLE"


def test_soft_and_back_to_the_surface(addon, deep, call):
    addon.baking.bake_job.bake_material(deep)
    shown = addon.nodes.node_group.shows_lateral
    choose(deep, call, "SOFT")
    assert not shown(deep) and addon.editing.depth.chosen(deep) == "SOFT"
    deep.lamina.depth = "SURFACE"
    addon.baking.lateral_job.make(deep, bpy.context.scene)
    assert shown(deep) and addon.editing.depth.chosen(deep) == "SOFT", "a file of an earlier version"
    choose(deep, call, "SURFACE")
    assert not shown(deep) and addon.editing.depth.chosen(deep) == "SURFACE"
