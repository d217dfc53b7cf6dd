# SPDX-License-Identifier: GPL-3.0-or-later
"""Editing the layer list: every operator has the effect of its plain function, and can be undone."""

import importlib

import bpy
import pytest


def names(material):
    return [layer.name for layer in material.lamina.layers]


def twin(addon, count=3):
    """Two materials with the same layers."""
    pair = []
    for name in ("By Function", "By Operator"):
        material = bpy.data.materials.new(name)
        addon.editing.layer_list.add_stack(material)
        while len(material.lamina.layers) < count:
            addon.editing.layer_list.add_layer(material)
        material.lamina.active_index = 1
        pair.append(material)
    return pair


PAIRS = {
    "add": ("add_layer", "layer_add", {}, {}),
    "add interface": ("add_layer", "layer_add", {"kind": "interface"}, {"kind": "interface"}),
    "close sheet": ("close_sheet", "sheet_close", {}, {}),
    "remove": ("remove_layer", "layer_remove", {}, {}),
    "duplicate": ("duplicate_layer", "layer_duplicate", {}, {}),
    "up": ("move_layer", "layer_move", {"direction": "UP"}, {"direction": "UP"}),
    "down": ("move_layer", "layer_move", {"direction": "DOWN"}, {"direction": "DOWN"}),
}


@pytest.mark.parametrize(("function", "operator", "arguments", "properties"), PAIRS.values(), ids=PAIRS)
def test_operator_equals_function(addon, call, function, operator, arguments, properties):
    by_function, by_operator = twin(addon)
    before = names(by_function)
    getattr(addon.editing.layer_list, function)(by_function, **arguments)
    assert call(getattr(bpy.ops.lamina, operator), by_operator, **properties) == {"FINISHED"}
    assert addon.editing.stack_io.to_dict(by_function) == addon.editing.stack_io.to_dict(by_operator)
    assert by_function.lamina.active_index == by_operator.lamina.active_index
    assert names(by_function) != before


def test_add_goes_on_top_of_the_active_layer(addon):
    material, _ = twin(addon)
    active = names(material)[1]
    new = addon.editing.layer_list.add_layer(material).name
    assert names(material)[1:3] == [new, active] and material.lamina.active_index == 1


def test_duplicate_copies_all_but_varying(addon):
    material, _ = twin(addon, 1)
    material.lamina.active_index = 0
    layer = material.lamina.layers[0]
    layer.albedo, layer.tau, layer.g, layer.phase, layer.varying = (0.1, 0.2, 0.3), 7.0, 0.25, "hg", True
    addon.editing.layer_list.duplicate_layer(material)
    first, second = addon.editing.stack_io.to_dict(material)["layers"]
    assert second.pop("name") == "Dust.001" and first.pop("name") == "Dust"
    assert first.pop("varying") and not second.pop("varying")
    assert first == second


def test_duplicate_copies_every_property(addon):
    material, _ = twin(addon, 1)
    material.lamina.active_index = 0
    layer = material.lamina.layers[0]
    for name, value in changed_values(layer):
        setattr(layer, name, value)
    layer.alpha = 0.123456
    before = {name: getattr(layer, name) for name, _ in changed_values(layer)}
    addon.editing.layer_list.duplicate_layer(material)
    copy = material.lamina.layers[1]
    for name, value in before.items():
        value = tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value
        kept = getattr(copy, name)
        kept = tuple(kept) if isinstance(value, tuple) else kept
        assert kept == value or name in ("name", "varying"), name


def changed_values(group):
    """(name, another value) for each property of a layer or base that can be set."""
    for prop in group.bl_rna.properties:
        if prop.is_readonly or prop.identifier in ("name", "roughness"):
            continue
        value = getattr(group, prop.identifier)
        if prop.type == "ENUM" and prop.is_enum_flag:
            yield prop.identifier, value ^ {prop.enum_items[0].identifier}
        elif prop.type == "ENUM":
            yield prop.identifier, next(item.identifier for item in prop.enum_items if item.identifier != value)
        elif prop.type == "BOOLEAN":
            yield prop.identifier, not value
        elif prop.type == "STRING":
            yield prop.identifier, value + "x"
        elif prop.is_array:
            yield prop.identifier, (0.25, 0.5, 0.75)
        else:
            yield prop.identifier, 0.25 if prop.hard_min <= 0.25 else 1.25


@pytest.mark.parametrize("owner", ["layer", "base"])
def test_every_property_tells_of_its_change(addon, monkeypatch, owner):
    material, _ = twin(addon, 1)
    group = material.lamina.layers[0] if owner == "layer" else material.lamina.base
    told = []
    monkeypatch.setattr(addon.base.changes, "listeners", [told.append])
    for name, value in [*changed_values(group), ("roughness", 0.5)]:
        told.clear()
        setattr(group, name, value)
        assert told and all(one == material for one in told), name


def test_an_interface_does_not_vary(addon):
    material, _ = twin(addon, 1)
    layer = material.lamina.layers[0]
    layer.varying = True
    layer.kind = "interface"
    assert not layer.varying


def test_a_sheet_that_ends_inside_a_dielectric(addon):
    material, _ = twin(addon, 1)
    add, open_ior = addon.editing.layer_list.add_layer, addon.editing.layer_list.open_ior
    material.lamina.base.kind = "none"
    assert open_ior(material) is None
    front = add(material, "interface")
    front.ior, front.roughness, front.distribution = 1.4, 0.5, "beckmann"
    assert open_ior(material) == pytest.approx(1.4)
    material.lamina.base.kind = "lambert"
    assert open_ior(material) is None
    material.lamina.base.kind = "none"
    back = addon.editing.layer_list.close_sheet(material)
    assert open_ior(material) is None and material.lamina.layers[-1] == back
    assert (back.ior, back.alpha, back.distribution) == (1.0, 0.25, "beckmann")


def test_moving_beyond_the_ends_does_nothing(addon, call):
    material, _ = twin(addon)
    material.lamina.active_index = 0
    before = names(material)
    assert call(bpy.ops.lamina.layer_move, material, direction="UP") == {"CANCELLED"}
    material.lamina.active_index = 2
    assert not addon.editing.layer_list.move_layer(material, "DOWN")
    assert names(material) == before


def test_removing_the_last_layer_leaves_an_empty_list(addon, call):
    material, _ = twin(addon, 1)
    material.lamina.active_index = 0
    call(bpy.ops.lamina.layer_remove, material)
    assert names(material) == [] and addon.editing.layer_list.active_layer(material) is None
    with pytest.raises(RuntimeError, match="There is no layer"):
        call(bpy.ops.lamina.layer_remove, material)
    call(bpy.ops.lamina.layer_add, material)
    assert len(names(material)) == 1


def test_at_most_one_layer_varies(addon):
    material, _ = twin(addon)
    for layer in material.lamina.layers:
        layer.varying = True
    assert [layer.varying for layer in material.lamina.layers] == [False, False, True]


def test_the_first_stack_takes_the_shown_colour(addon, call):
    material = bpy.data.materials.new("Red")
    principled = addon.nodes.node_tree.of(material).nodes["Principled BSDF"]
    principled.inputs["Base Color"].default_value = (0.9, 0.1, 0.2, 1.0)
    assert call(bpy.ops.lamina.add_stack, material) == {"FINISHED"}
    assert tuple(material.lamina.base.reflectance) == pytest.approx((0.9, 0.1, 0.2))
    assert len(material.lamina.layers) == 1
    with pytest.raises(RuntimeError, match="has Lamina layers already"):
        call(bpy.ops.lamina.add_stack, material)


def test_names_are_unique(addon):
    material, _ = twin(addon, 1)
    made = [addon.editing.layer_list.unique_name(material, "Dust")]
    material.lamina.layers.add().name = made[0]
    made.append(addon.editing.layer_list.unique_name(material, "Dust.001"))
    assert made == ["Dust.001", "Dust.002"]


def test_every_operator_that_changes_data_can_be_undone(addon):
    no_data = {"LAMINA_OT_cancel", "LAMINA_OT_stack_export", "LAMINA_OT_preset_save", "LAMINA_OT_preset_delete"}
    for cls in addon.operators.CLASSES:
        assert ("UNDO" in cls.bl_options) == (cls.__name__ not in no_data), cls.__name__


def test_nothing_can_be_animated(addon):
    properties = addon.properties.material_properties
    for cls in (properties.LaminaLayer, properties.LaminaBase):
        for prop in cls.bl_rna.properties:
            if prop.identifier not in ("rna_type", "name"):
                assert not prop.is_animatable, (cls.__name__, prop.identifier)


@pytest.fixture
def linked(addon, tmp_path):
    """A material with three layers, from another file."""
    material, _ = twin(addon)
    library = tmp_path / "library.blend"
    bpy.data.libraries.write(str(library), {material}, fake_user=True)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(str(library), link=True) as (_source, target):
        target.materials = ["By Function"]
    return bpy.data.materials["By Function"]


def test_linked_materials_are_left_alone(linked, call):
    with pytest.raises(RuntimeError, match="linked from another file"):
        call(bpy.ops.lamina.layer_add, linked)
    assert len(linked.lamina.layers) == 3


def test_library_overrides_are_left_alone(addon, linked, call):
    override = linked.override_create()
    for operator in (bpy.ops.lamina.layer_add, bpy.ops.lamina.bake, bpy.ops.lamina.remove_stack):
        with pytest.raises(RuntimeError, match="a library override, which does not keep changes"):
            call(operator, override)
    assert len(override.lamina.layers) == 3
    local = override.make_local()
    assert call(bpy.ops.lamina.layer_add, local) == {"FINISHED"} and len(local.lamina.layers) == 4


def test_remove_stack(addon, lamina, material, call):
    nodes = {node.name for node in material.node_tree.nodes}
    addon.baking.bake_job.bake_material(material)
    assert call(bpy.ops.lamina.remove_stack, material) == {"FINISHED"}
    assert not material.lamina.enabled and not material.lamina.layers
    assert not bpy.data.node_groups and not bpy.data.images
    assert {node.name for node in material.node_tree.nodes} == nodes


def test_other_layers_are_not_those_of_dust(addon, material):
    """Dust that is removed from objects takes its own layers away, and not those that follow them."""
    dusted = importlib.import_module(f"{addon.__package__}.scene.dusting").MARK
    material[dusted] = "stack"
    addon.editing.stack_io.assign(material, addon.editing.stack_io.to_dict(material))
    assert dusted not in material
    material[dusted] = "stack"
    addon.editing.layer_list.remove_stack(material)
    assert dusted not in material


@pytest.mark.parametrize("index", [-3, 7, 165337089])
def test_an_index_out_of_range_means_the_nearest_layer(addon, material, index):
    """Scripts may give any index."""
    layers = material.lamina.layers
    for change, more in ((addon.editing.layer_list.duplicate_layer, 1), (addon.editing.layer_list.remove_layer, -1)):
        before = len(layers)
        material.lamina.active_index = index
        change(material)
        assert len(layers) == before + more
    material.lamina.active_index = index
    addon.editing.layer_list.move_layer(material, "UP")
    addon.editing.layer_list.add_layer(material)
    assert 0 <= material.lamina.active_index < len(layers)
