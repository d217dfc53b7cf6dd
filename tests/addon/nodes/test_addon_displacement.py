# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement by the layer: true heights in Cycles, the artist's own displacement, and exact restoration."""

import bpy
import numpy as np
import pytest
from test_addon_dust_detail import plane, shown


@pytest.fixture
def dusty(addon, lamina, material):
    """A baked material whose layer varies up to 2, of the thickness 1.5."""
    layer = material.lamina.layers[0]
    layer.varying, layer.tau = True, 2.0
    addon.baking.bake_job.bake_material(material)
    addon.nodes.thickness.wiring(material).socket.default_value = 1.5
    plane(cells=8).data.materials.append(material)
    return material


@pytest.fixture
def displace(addon):
    def displace(material, height):
        made = addon.nodes.displacement.add(material, height)
        node = addon.nodes.detail_wiring.detail(material)
        for name in ("Clouds", "Grain"):
            node.inputs[name].default_value = 0.0
        return made

    return displace


def heights(path):
    """float (height, width): z of the surface, rendered from above."""
    material = bpy.context.scene.objects["Square"].active_material
    tree = material.node_tree
    place, parts = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(place.outputs["Position"], parts.inputs[0])
    found = shown(material, parts.outputs["Z"], path)
    for node in (place, parts):
        tree.nodes.remove(node)
    return found


def state(material):
    tree = material.node_tree
    return (sorted(node.name for node in tree.nodes), material.displacement_method, sorted(
        (link.from_node.name, link.from_socket.name, link.to_node.name, link.to_socket.name) for link in tree.links))


@pytest.mark.parametrize("unit", [1.0, 0.01])
def test_the_surface_rises_by_millimetres(addon, dusty, displace, tmp_path, unit):
    bpy.context.scene.unit_settings.scale_length = unit
    assert heights(tmp_path / "flat.exr") == pytest.approx(0.0, abs=1e-6)
    made = displace(dusty, 0.004 * unit)
    found = heights(tmp_path / "raised.exr")
    assert found == pytest.approx(0.006, abs=2e-6)
    node = addon.nodes.detail_wiring.detail(dusty)
    node.inputs["Wiped"].default_value = 0.5
    assert displace(dusty, 0.020 * unit) == made
    assert heights(tmp_path / "wiped.exr") == pytest.approx(0.015, abs=5e-6)
    addon.nodes.displacement.remove(dusty)
    assert heights(tmp_path / "again.exr") == pytest.approx(0.0, abs=1e-6)


def test_scaled_objects_rise_as_much(dusty, displace, tmp_path):
    thing = bpy.context.scene.objects["Square"]
    thing.scale = (3.0, 3.0, 3.0)
    displace(dusty, 0.004)
    assert heights(tmp_path / "raised.exr") == pytest.approx(0.006, abs=2e-6)


def test_the_artists_own_displacement_is_added_to_and_restored(addon, dusty, displace, tmp_path):
    addon.nodes.detail_wiring.add_detail(dusty)
    tree = dusty.node_tree
    own = tree.nodes.new("ShaderNodeDisplacement")
    own.inputs["Height"].default_value, own.inputs["Midlevel"].default_value = 0.1, 0.0
    own.inputs["Scale"].default_value = 1.0
    tree.links.new(own.outputs[0], tree.get_output_node("CYCLES").inputs["Displacement"])
    before = state(dusty)
    with pytest.raises(addon.base.messages.RefusedError, match="as bump"):
        displace(dusty, 0.004)
    assert state(dusty) == before
    dusty.displacement_method = "BOTH"
    before = state(dusty)
    displace(dusty, 0.004)
    assert heights(tmp_path / "both.exr") == pytest.approx(0.106, abs=1e-5)
    addon.nodes.displacement.remove(dusty)
    assert state(dusty) == before
    assert heights(tmp_path / "own.exr") == pytest.approx(0.1, abs=1e-5)


def test_it_goes_with_the_detail_the_varying_layer_and_the_stack(addon, dusty, displace, call):
    tree, displacement = dusty.node_tree, addon.nodes.displacement
    before = state(dusty)
    assert call(bpy.ops.lamina.displace, dusty, height=3.0) == {"FINISHED"}
    assert displacement.node(dusty).inputs["Scale"].default_value == pytest.approx(0.003)
    assert dusty.displacement_method == "DISPLACEMENT"
    assert call(bpy.ops.lamina.dust_detail, dusty, remove=True) == {"FINISHED"}
    assert state(dusty) == before
    assert call(bpy.ops.lamina.displace, dusty) == {"FINISHED"}
    assert call(bpy.ops.lamina.displace, dusty, remove=True) == {"FINISHED"}
    assert displacement.node(dusty) is None and addon.nodes.detail_wiring.detail(dusty) is not None
    displace(dusty, 0.01)
    for source in ("attribute", "image", "value"):
        addon.nodes.thickness.wire_thickness(dusty, source)
        assert displacement.node(dusty).inputs["Height"].is_linked
    dusty.lamina.layers[0].varying = False
    addon.baking.bake_job.bake_material(dusty)
    assert displacement.node(dusty) is None and dusty.displacement_method == before[1]
    dusty.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(dusty)
    displace(dusty, 0.01)
    addon.editing.layer_list.remove_stack(dusty)
    assert dusty.displacement_method == before[1]
    assert not tree.get_output_node("CYCLES").inputs["Displacement"].is_linked
    assert not any(addon.nodes.thickness.MARK in node for node in tree.nodes)


def test_grain_and_litter_do_not_rise_and_clouds_do(addon, dusty, displace, tmp_path):
    displace(dusty, 0.004)
    node = addon.nodes.detail_wiring.detail(dusty)
    for name in ("Grain", "Fibers", "Specks"):
        node.inputs[name].default_value = 1.0
    node.inputs["Fiber Length"].default_value = node.inputs["Speck Size"].default_value = 0.5
    assert np.ptp(heights(tmp_path / "raised.exr")) < 1e-6
    node.inputs["Clouds"].default_value, node.inputs["Cloud Size"].default_value = 1.0, 1.0
    assert np.ptp(heights(tmp_path / "clouds.exr")) > 0.002


def test_a_material_without_thickness_is_refused(addon, lamina, material, call):
    addon.baking.bake_job.bake_material(material)
    with pytest.raises(addon.base.messages.RefusedError, match="no thickness input"):
        addon.nodes.displacement.add(material)
    assert material.displacement_method == "BUMP"
