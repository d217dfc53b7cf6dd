# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers over a material: the operator, presets, the panel and the command line."""

from types import SimpleNamespace

import bpy
import pytest
from addon_helpers import Layout, surface_source


@pytest.fixture
def glossy(addon):
    """A material with a red Glossy BSDF."""
    material = bpy.data.materials.new("Red")
    tree = addon.nodes.node_tree.of(material)
    tree.nodes.remove(tree.nodes["Principled BSDF"])
    shader = tree.nodes.new("ShaderNodeBsdfAnisotropic")
    shader.inputs["Color"].default_value = (0.8, 0.1, 0.1, 1.0)
    tree.links.new(shader.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    return material


def layer_names(material):
    return [layer.name for layer in material.lamina.layers]


def test_the_operator_bakes_and_remove_restores(addon, lamina, glossy, call):
    shader = surface_source(glossy)
    assert call(bpy.ops.lamina.add_over, glossy) == {"FINISHED"}
    result, node = glossy.lamina.result, surface_source(glossy)
    assert node.node_tree == glossy.lamina.node_group and result.quality == "preview"
    assert node.inputs["Base"].links[0].from_node == shader
    assert tuple(node.inputs["Base Reflectance"].default_value) == pytest.approx((0.8, 0.1, 0.1, 1.0))
    assert addon.baking.bake_job.state(glossy) == "fresh"
    assert glossy.lamina.layers[0].tau == pytest.approx(0.3), "the material stays visible"
    assert 0.0 <= result.base_matte < 0.05 and 0.0 <= result.base_metal < 0.05
    lines = dict(addon.ui.panel.below_lines(result))
    assert lines["If Matte"].endswith("%") and lines["If Rough Metal"].endswith("%")
    assert call(bpy.ops.lamina.remove_stack, glossy) == {"FINISHED"}
    assert surface_source(glossy) == shader


def test_the_operator_refuses_a_second_time_and_an_empty_output(addon, lamina, glossy, call):
    assert call(bpy.ops.lamina.add_over.poll, glossy)
    tree = glossy.node_tree
    tree.links.remove(tree.get_output_node("CYCLES").inputs["Surface"].links[0])
    assert not call(bpy.ops.lamina.add_over.poll, glossy)


def test_a_preset_keeps_the_base(addon, lamina, glossy):
    addon.editing.over_material.add(glossy)
    addon.editing.presets.apply(glossy, "dusty-bronze")
    assert addon.editing.stack_io.to_dict(glossy)["base"] == {"kind": "shader", "reflectance": [0.8, 0.1, 0.1]}
    before = layer_names(glossy)
    assert before and before != ["Dust"]
    with pytest.raises(addon.base.messages.RefusedError, match="has no layers that could lie over this material"):
        addon.editing.presets.apply(glossy, "gold")
    assert layer_names(glossy) == before


def test_new_reflectance_and_another_base(addon, lamina, glossy):
    addon.editing.over_material.add(glossy)
    addon.baking.bake_job.bake_material(glossy, "preview")
    node = surface_source(glossy)
    shader = node.inputs["Base"].links[0].from_node
    glossy.lamina.base.shader_reflectance = (0.3, 0.3, 0.3)
    addon.baking.bake_job.bake_material(glossy, "preview")
    assert tuple(node.inputs["Base Reflectance"].default_value) == pytest.approx((0.3, 0.3, 0.3, 1.0))
    glossy.lamina.base.kind = "lambert"
    addon.baking.bake_job.bake_material(glossy, "preview")
    assert "Base" not in node.inputs and "Base Reflectance" not in node.inputs
    assert glossy.lamina.result.base_matte < 0.0
    glossy.lamina.base.kind = "shader"
    addon.baking.bake_job.bake_material(glossy, "preview")
    assert node.inputs["Base"].links[0].from_node == shader, "a new input is linked again"


@pytest.fixture
def painted(addon):
    """A glowing material with a texture of the color."""
    material = bpy.data.materials.new("Painted")
    tree = addon.nodes.node_tree.of(material)
    node, checker = tree.nodes["Principled BSDF"], tree.nodes.new("ShaderNodeTexChecker")
    tree.links.new(checker.outputs["Color"], node.inputs["Base Color"])
    node.inputs["Emission Strength"].default_value = 2.0
    return material


def test_varnish_over_textures_and_dust_again(addon, lamina, painted):
    over, bake = addon.editing.over_material, addon.baking.bake_job.bake_material
    checker = next(node for node in painted.node_tree.nodes if node.type == "TEX_CHECKER")
    over.add(painted)
    bake(painted, "preview")
    end = surface_source(painted)
    assert end.type == "ADD_SHADER", "the emission behind the layers"
    layers = end.inputs[0].links[0].from_node
    assert layers.inputs["Base Color"].links[0].from_node == checker
    over.assign_layers(painted, lamina.Stack([lamina.Interface(1.5)], lamina.Black()))
    bake(painted, "preview")
    assert painted.lamina.base.kind == "shader" and surface_source(painted) == layers
    assert layers.inputs["Base"].links[0].from_node.type == "BSDF_PRINCIPLED"
    assert not any(node.type == "EMISSION" for node in painted.node_tree.nodes)
    over.assign_layers(painted, lamina.Stack([lamina.Medium(albedo=0.9, tau=0.2)], lamina.Black()))
    bake(painted, "preview")
    assert painted.lamina.base.kind == "principled" and surface_source(painted).type == "ADD_SHADER"
    assert layers.inputs["Base Color"].links[0].from_node == checker
    addon.editing.layer_list.remove_stack(painted)
    assert surface_source(painted).type == "BSDF_PRINCIPLED"
    assert {node.type for node in painted.node_tree.nodes} == {"BSDF_PRINCIPLED", "OUTPUT_MATERIAL", "TEX_CHECKER"}


def drawn(addon, material):
    """What the main panel draws."""
    layout = Layout()
    panel = SimpleNamespace(layout=layout)
    region = SimpleNamespace(width=500)
    preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0))
    context = SimpleNamespace(material=material, region=region, preferences=preferences,
                              window_manager=bpy.context.window_manager)
    addon.ui.panel.LAMINA_PT_main.draw(panel, context)
    return layout.lines[: layout.lines.index("Presets by Picture")]


def test_the_panel_offers_one_choice_and_names_what_is_lost(addon, lamina, glossy):
    lines = drawn(addon, glossy)
    assert lines[0] == "Add Layers Over This Material" and lines[1].startswith("Approximate")
    plain = bpy.data.materials.new("Plain")
    tree = addon.nodes.node_tree.of(plain)
    assert drawn(addon, plain) == ["Add Layers Over This Material", "New Layers Instead", "Presets"]
    tree.nodes["Principled BSDF"].inputs["Sheen Weight"].default_value = 0.5
    assert drawn(addon, plain)[1:3] == ["Not carried over:", "sheen"]
    tree.nodes.clear()
    assert drawn(addon, plain) == ["Add Lamina Layers", "Presets"]
    addon.editing.over_material.add(glossy)
    assert drawn(addon, glossy) == ["Presets"]


def test_the_command_line(addon, lamina, glossy, tmp_path, capsys):
    stack = tmp_path / "varnish.json"
    lamina.Stack([lamina.Interface(1.5)], lamina.Black()).save(stack)
    main, shader = addon.command_line.command.main, surface_source(glossy)
    assert main(["bake", "--over"]) == 2
    assert "need names or patterns" in capsys.readouterr().err
    assert main(["bake", "Red", "--over", "--stack", str(stack)]) == 0
    assert layer_names(glossy) == ["Interface"] and glossy.lamina.base.kind == "shader"
    assert surface_source(glossy).inputs["Base"].links[0].from_node == shader
    assert main(["bake", "Red", "--over"]) == 0, "layers that are there already are baked again"
    empty = bpy.data.materials.new("Empty")
    addon.nodes.node_tree.of(empty).nodes.clear()
    assert main(["bake", "Empty", "--over"]) == 1
    assert "No shader is linked to the Surface" in capsys.readouterr().out and not empty.lamina.enabled
