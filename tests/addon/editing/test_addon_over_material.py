# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers over a material: the operator, presets, the panel and the command line."""

from types import SimpleNamespace

import bpy
import pytest
from addon_helpers import Layout, surface_source

from lamina import presets


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
    assert node.node_tree == glossy.lamina.node_group and result.quality == glossy.lamina.quality
    assert node.inputs["Base"].links[0].from_node == shader
    assert tuple(node.inputs["Base Reflectance"].default_value) == pytest.approx((0.8, 0.1, 0.1, 1.0))
    assert addon.baking.bake_job.state(glossy) == "fresh"
    assert glossy.lamina.layers[0].tau == pytest.approx(0.3), "the material stays visible"
    errors = result.report["base_error"]
    assert 0.0 <= errors["lambert"] < 0.05 and 0.0 <= errors["metal"] < 0.05
    lines = dict(addon.ui.numbers.below_lines(result))
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


OVERLAYS = [entry.id for entry in presets.entries() if entry.category == "Overlays"]


@pytest.mark.usefixtures("equal_bakes_once")
@pytest.mark.parametrize("preset", OVERLAYS)
def test_an_overlay_lies_over_a_principled_material(addon, lamina, preset):
    """One step for a material without layers, with breakup; removing it leaves nothing behind."""
    material = bpy.data.materials.new("Plastic")
    tree = addon.nodes.node_tree.of(material)
    shader = tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0.6, 0.02, 0.015, 1.0)
    addon.editing.presets.apply(material, preset)
    stack = addon.editing.stack_io.to_dict(material)
    assert [layer["name"] for layer in stack["layers"]] == [layer.name for layer in presets.load(preset).layers]
    assert stack["base"]["kind"] == "principled" and stack["base"]["color"] == pytest.approx([0.6, 0.02, 0.015])
    addon.baking.bake_job.bake_material(material, "preview")
    assert surface_source(material).node_tree == material.lamina.node_group
    varies = presets.load(preset).varying is not None
    assert ("Thickness" in surface_source(material).inputs) == varies
    detail = addon.nodes.detail_wiring.detail
    assert (detail(material) is not None) == varies, "an even layer would look like clay"
    if varies:
        assert detail(material).inputs["Clouds"].default_value == pytest.approx(0.9), "more than of settled dust"
        assert (detail(material).inputs["Fibers"].default_value > 0.0) == preset.endswith("-dust"), "only in dust"
        addon.nodes.detail_wiring.remove_detail(material)
        addon.baking.bake_job.bake_material(material, "preview")
        assert detail(material) is None, "the artist has removed it"
    addon.editing.layer_list.remove_stack(material)
    assert surface_source(material) == shader and len(tree.nodes) == 2


def test_an_overlay_keeps_any_base_and_needs_something_below(addon, lamina, glossy, call):
    own = bpy.data.materials.new("Own")
    addon.editing.presets.apply(own, "lacquered-copper")
    base = addon.editing.stack_io.to_dict(own)["base"]
    assert call(bpy.ops.lamina.preset_apply, own, preset="varnish") == {"FINISHED"}
    assert layer_names(own) == ["varnish surface", "varnish"]
    assert addon.editing.stack_io.to_dict(own)["base"] == base
    addon.editing.presets.apply(glossy, "soot")
    assert glossy.lamina.base.kind == "shader"
    addon.editing.layer_list.remove_stack(glossy)  # before a bake
    assert addon.nodes.detail_wiring.WANTED not in glossy
    addon.editing.presets.apply(glossy, "soot")
    addon.editing.stack_io.assign_stack(glossy, presets.load("dusty-bronze"))  # as from a file, before a bake
    assert addon.nodes.detail_wiring.WANTED not in glossy
    empty = bpy.data.materials.new("Empty")
    addon.nodes.node_tree.of(empty).nodes.clear()
    with pytest.raises(RuntimeError, match="No shader is linked to the Surface"):
        call(bpy.ops.lamina.preset_apply, empty, preset="soot")
    assert not empty.lamina.enabled


def test_layers_of_a_preset_over_a_material_without_layers(addon, lamina):
    material = bpy.data.materials.new("Plastic")
    addon.nodes.node_tree.of(material)
    with pytest.raises(ValueError, match="has no layers that could lie over this material"):
        addon.editing.presets.apply(material, "gold", over=True)
    assert not material.lamina.enabled
    addon.editing.presets.apply(material, "lacquered-copper", over=True)
    assert material.lamina.base.kind == "principled" and len(layer_names(material)) == 2
    addon.editing.presets.apply(material, "lacquered-copper", over=False)
    assert material.lamina.base.kind == "conductor"


def test_presets_that_cannot_lie_over_a_material_are_grey(addon, lamina, glossy, material):
    """Their tooltips say why. Overlays come first."""
    operator = addon.operators.presets.LAMINA_OT_preset_apply

    def grey(of):
        return {entry.id for entry in presets.entries() if addon.editing.presets.problem(of, entry)}

    newer = {entry.id for entry in presets.entries() if entry.stack.is_oriented and bpy.app.version < (5, 0)}
    assert grey(glossy) == newer == grey(material) and not grey(None)
    assert next(iter(addon.editing.presets.by_category())) == "Overlays"
    addon.editing.over_material.add(glossy)
    alone = {entry.id for entry in presets.entries()
             if not entry.stack.layers or entry.stack.layers[-1].kind == "film"}  # of its own metal
    assert grey(glossy) == newer | alone
    for preset, reason in (("gold", "has no layers that could lie over this material"),
                           ("heat-tinted-steel-blue", "has a thin film on its own metal"), ("dusty-bronze", None)):
        properties = SimpleNamespace(preset=preset, user=False, over="AUTO")
        told = operator.description(SimpleNamespace(material=glossy), properties)
        assert reason in told if reason else "cannot" not in told
    drawn = GreyLayout()
    addon.ui.menus.LAMINA_MT_presets.draw(SimpleNamespace(layout=drawn), SimpleNamespace(material=glossy))
    assert "Gold, satin" in drawn.grey and "Dusty bronze" not in drawn.grey and "House dust" in drawn.lines
    assert len(drawn.grey) == len(grey(glossy))


class GreyLayout(Layout):
    """Also records the texts of operators that are drawn grey."""

    def __init__(self):
        super().__init__()
        self.__dict__.update(grey=[], enabled=True)

    def _inside(self, *_args, **_options):
        inside = GreyLayout()
        inside.__dict__.update(lines=self.lines, grey=self.grey)
        return inside

    row = column = _inside

    def operator(self, name, text=None, icon="NONE", **options):
        if not self.enabled:
            self.grey.append(text)
        return super().operator(name, text, icon, **options)


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
    assert "base_error" not in glossy.lamina.result.report
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
    for stack in (lamina.Stack([lamina.Interface(1.5)], lamina.Black()),
                  lamina.Stack([lamina.Medium(albedo=0.9, tau=0.2)], lamina.Black())):
        over.assign_layers(painted, stack)
        bake(painted, "preview")
        assert painted.lamina.base.kind == "principled" and surface_source(painted) == end
        assert layers.inputs["Base Color"].links[0].from_node == checker and "Base" not in layers.inputs
    addon.editing.layer_list.remove_stack(painted)
    assert surface_source(painted).type == "BSDF_PRINCIPLED"
    assert {node.type for node in painted.node_tree.nodes} == {"BSDF_PRINCIPLED", "OUTPUT_MATERIAL", "TEX_CHECKER"}


def drawn(addon, material):
    """What the main panel draws."""
    layout = Layout()
    panel = SimpleNamespace(layout=layout)
    region = SimpleNamespace(width=500)
    theme = SimpleNamespace(user_interface=SimpleNamespace(wcol_regular=SimpleNamespace(text=(0.9, 0.9, 0.9))))
    preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0), themes=[theme])
    context = SimpleNamespace(material=material, region=region, preferences=preferences, engine="CYCLES",
                              window_manager=bpy.context.window_manager)
    addon.ui.panel.LAMINA_PT_main.draw(panel, context)
    return layout.lines[: layout.lines.index("Presets by Picture")]


def test_the_panel_offers_one_choice_and_names_what_is_lost(addon, lamina, glossy):
    lines = drawn(addon, glossy)
    assert lines[:2] == ["Dust These Objects", "Add Layers Over This Material"] and lines[2].startswith("Approximate")
    plain = bpy.data.materials.new("Plain")
    tree = addon.nodes.node_tree.of(plain)
    dust = "Dust These Objects"
    assert drawn(addon, plain) == [dust, "Add Layers Over This Material", "New Layers Instead", "Presets"]
    tree.nodes["Principled BSDF"].inputs["Sheen Weight"].default_value = 0.5
    assert drawn(addon, plain)[2].startswith("Approximate, because the shader stays in use")
    tree.nodes["Principled BSDF"].inputs["Sheen Weight"].default_value = 0.0
    tree.nodes["Principled BSDF"].inputs["Anisotropic"].default_value = 0.5
    assert drawn(addon, plain)[2] == "Not carried over:"
    assert drawn(addon, plain)[3].startswith("anisotropic highlights for light")
    tree.nodes.clear()
    assert drawn(addon, plain) == [dust, "Add Lamina Layers", "Presets"]
    addon.editing.over_material.add(glossy)
    assert drawn(addon, glossy) == ["Not shown yet; the full one follows", "Presets"]


@pytest.mark.skipif(bpy.app.version >= (5, 0, 0), reason="the nodes of a material cannot be switched off")
def test_use_nodes_is_off(addon, lamina, glossy, call):
    """The panel says so before, and afterwards, when the layers are not seen."""
    node_tree = addon.nodes.node_tree
    node_tree.switch_off(glossy)
    assert addon.editing.over_material.problem(glossy).startswith("Use Nodes is off")
    node_tree.of(glossy)
    addon.editing.over_material.add(glossy)
    addon.baking.bake_job.bake_material(glossy, "preview")
    connected = addon.nodes.node_group.is_connected
    assert connected(glossy)
    node_tree.switch_off(glossy)
    assert not connected(glossy)
    assert call(bpy.ops.lamina.connect, glossy) == {"FINISHED"}
    assert node_tree.is_on(glossy) and connected(glossy)


PARTS = {"Transmission Weight": 1.0, "Subsurface Weight": 0.3, "Sheen Weight": 0.5}


@pytest.mark.parametrize("part", PARTS)
def test_a_shader_with_more_than_the_base_has_stays_in_use(addon, lamina, call, part):
    """Glass would become plastic. The choice holds for presets, in either way."""
    over, kinds = addon.editing.over_material, []
    for keep in (None, True, False):
        material = bpy.data.materials.new("Glass")
        shader = addon.nodes.node_tree.of(material).nodes["Principled BSDF"]
        assert not over.keeps_shader(material)
        shader.inputs[part].default_value = PARTS[part]
        assert over.keeps_shader(material)
        assert bool(over.not_carried(material, keep)) == (keep is False)
        chosen = {} if keep is None else {"keep_shader": keep}
        assert call(bpy.ops.lamina.add_over, material, **chosen) == {"FINISHED"}
        kinds.append(material.lamina.base.kind)
        assert ("Base" in surface_source(material).inputs) == (keep is not False)
        for preset in ("dusty-bronze", "dusty-lacquer"):
            addon.editing.presets.apply(material, preset)
            assert material.lamina.base.kind == kinds[-1]
        if keep is not False:
            reflectance = tuple(material.lamina.base.shader_reflectance)
            assert reflectance == pytest.approx((0.08 if part == "Transmission Weight" else 0.8,) * 3)
    assert kinds == ["shader", "shader", "principled"]


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


def told_by_base_panel(addon, material):
    """Texts and operators that the panel Base draws."""
    layout = Layout()
    preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0))
    context = SimpleNamespace(material=material, preferences=preferences, region=SimpleNamespace(width=400.0))
    addon.ui.panel.LAMINA_PT_base.draw(SimpleNamespace(layout=layout), context)
    return " ".join(layout.lines)


def icon_of_base(addon, material):
    """The icon in the header of the panel Base, which is there while the panel is folded."""
    drawn = []
    layout = SimpleNamespace(label=lambda text, icon="NONE": drawn.append(icon))
    addon.ui.panel.LAMINA_PT_base.draw_header_preset(SimpleNamespace(layout=layout), SimpleNamespace(material=material))
    return drawn


def test_edits_of_the_replaced_shader_are_told_and_read_again(addon, lamina, call):
    material = bpy.data.materials.new("Painted")
    tree = addon.nodes.node_tree.of(material)
    shader, rgb = tree.nodes["Principled BSDF"], tree.nodes.new("ShaderNodeRGB")
    tree.links.new(rgb.outputs[0], shader.inputs["Base Color"])
    another = tree.nodes.new("ShaderNodeRGB")
    assert call(bpy.ops.lamina.add_over, material) == {"FINISHED"}
    node = addon.nodes.node_group.group_nodes(material)[0]
    assert node.inputs["Base Color"].links and surface_source(material) == node
    assert not addon.editing.over_material.has_changed(material)
    assert "Before Lamina" not in told_by_base_panel(addon, material) and icon_of_base(addon, material) == ["NONE"]
    shader.inputs["Emission Color"].default_value = (0.2, 0.4, 0.6, 1.0)
    shader.inputs["Sheen Weight"].default_value = 0.3  # the layers do not read this
    assert not addon.editing.over_material.has_changed(material), "the emission has no strength"
    tree.links.new(another.outputs[0], shader.inputs["Base Color"])
    assert addon.editing.over_material.has_changed(material)
    addon.editing.over_material.read_again(material)
    assert node.inputs["Base Color"].links[0].from_node == another
    edits = (
        lambda: setattr(shader.inputs["IOR"], "default_value", 1.7),
        lambda: setattr(shader.inputs["Emission Strength"], "default_value", 3.0),
        lambda: tree.links.remove(shader.inputs["Base Color"].links[0]),
    )
    for edit in edits:
        edit()
        assert addon.editing.over_material.has_changed(material)
        assert "Before Lamina" in told_by_base_panel(addon, material) and icon_of_base(addon, material) == ["INFO"]
        assert call(bpy.ops.lamina.read_again, material) == {"FINISHED"}
        assert not addon.editing.over_material.has_changed(material)
        assert addon.baking.bake_job.state(material) == "fresh"
    base = addon.editing.stack_io.to_dict(material)["base"]
    assert base["ior"] == pytest.approx(1.7) and not base.get("inputs")
    emission = surface_source(material).inputs[1].links[0].from_node
    assert emission.type == "EMISSION" and emission.inputs["Strength"].default_value == pytest.approx(3.0)
    assert tuple(emission.inputs["Color"].default_value) == pytest.approx((0.2, 0.4, 0.6, 1.0))
    assert not any(socket.links for socket in node.inputs)
    assert call(bpy.ops.lamina.remove_stack, material) == {"FINISHED"}
    assert surface_source(material) == shader
    assert not any("Lamina" in one.label for one in tree.nodes)


def test_read_again_below_layers_that_cannot_be_baked_is_one_sentence(addon, lamina, call):
    material = bpy.data.materials.new("Painted")
    shader = addon.nodes.node_tree.of(material).nodes["Principled BSDF"]
    assert call(bpy.ops.lamina.add_over, material) == {"FINISHED"}
    call(bpy.ops.lamina.layer_add, material, kind="film")
    shader.inputs["IOR"].default_value = 1.7
    with pytest.raises(RuntimeError, match="^Error: Layer 1 “Thin Film”, kind") as refused:
        call(bpy.ops.lamina.read_again, material)
    assert "Traceback" not in str(refused.value)
    assert addon.editing.stack_io.to_dict(material)["base"]["ior"] == pytest.approx(1.7)
    assert addon.baking.bake_job.failure(material)
