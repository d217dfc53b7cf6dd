# SPDX-License-Identifier: GPL-3.0-or-later
"""Drops, puddles and fingerprints: their shares of the surface, their normals, and how nodes come and go."""

import bpy
import numpy as np
import pytest
from test_addon_dust_detail import SIDE, plane, shown

KINDS = ("DROPS", "PUDDLES", "PRINTS")
SIZES = {"DROPS": "Drop Size", "PUDDLES": "Puddle Size", "PRINTS": "Print Size"}


@pytest.fixture
def wet(addon, lamina, material):
    """A baked material with a film that varies over its layer of dust."""
    addon.editing.layer_list.add_layer(material, "interface").varying = True
    material.lamina.quality = "preview"
    addon.baking.bake_job.bake_material(material)
    return material


@pytest.fixture
def wiring(addon):
    return addon.nodes.film_wiring


def coverage(material, node, path):
    return shown(material, node.outputs["Coverage"], path / "coverage.exr")


@pytest.mark.parametrize("kind", KINDS)
def test_none_is_none(wet, wiring, tmp_path, kind):
    plane().data.materials.append(wet)
    node = wiring.put(wet, kind)
    node.inputs[SIZES[kind]].default_value = 0.1
    node.inputs["Amount"].default_value = 0.0
    assert not coverage(wet, node, tmp_path).any()
    node.inputs["Amount"].default_value, node.inputs["Coverage"].default_value = 1.0, 0.0
    assert not coverage(wet, node, tmp_path).any()


@pytest.mark.parametrize("share", [0.1, 0.35, 0.7])
@pytest.mark.parametrize("kind", KINDS[:2])
def test_the_amount_is_the_share_of_the_surface(wet, wiring, tmp_path, kind, share):
    """By blocks of 8 x 8 pixels, two cells wide, which are nearly independent; the noise of puddles, whose
    distribution is approximated, and the random points, which are not Poisson's, differ by up to .04."""
    plane().data.materials.append(wet)
    node = wiring.put(wet, kind)
    node.inputs[SIZES[kind]].default_value = 2.0 * 4.0 / SIDE
    node.inputs["Amount"].default_value = share
    found = coverage(wet, node, tmp_path)
    assert found.min() >= 0.0 and found.max() <= 1.0
    assert np.mean((found > 0.0) & (found < 1.0)) < 0.35, "narrow edges"
    blocks = found.reshape(SIDE // 8, 8, SIDE // 8, 8).mean(axis=(1, 3))
    error = blocks.std(ddof=1) / blocks.size**0.5
    assert abs(found.mean() - share) < 3.0 * error + 0.04 and error < 0.04


def test_puddles_lie_on_level_places(wet, wiring, tmp_path):
    square = plane()
    square.data.materials.append(wet)
    node = wiring.put(wet, "PUDDLES")
    node.inputs["Amount"].default_value = 1.0
    assert coverage(wet, node, tmp_path).min() == 1.0
    square.rotation_euler.x = 0.35  # 20 degrees
    assert not coverage(wet, node, tmp_path)[12:36].any()
    node.inputs["Steepest"].default_value = 0.5
    assert coverage(wet, node, tmp_path)[12:36].min() == 1.0


def test_puddles_are_level_and_drops_are_tilted(wet, wiring, tmp_path):
    square = plane()
    square.data.materials.append(wet)
    square.rotation_euler.x = 0.1
    node = wiring.put(wet, "PUDDLES")

    def slope():
        tree = wet.node_tree
        upright = tree.nodes.new("ShaderNodeVectorMath")
        upright.operation, upright.inputs[1].default_value = "DOT_PRODUCT", (0.0, 0.0, 1.0)
        tree.links.new(wiring.node_of(wet).outputs["Normal"], upright.inputs[0])
        return np.arccos(np.clip(shown(wet, upright.outputs["Value"], tmp_path / "slope.exr")[4:-4], -1.0, 1.0))

    node.inputs["Amount"].default_value = 1.0
    assert slope() == pytest.approx(0.0, abs=1e-3)
    node.inputs["Amount"].default_value = 0.0
    assert slope() == pytest.approx(0.1, abs=1e-3)
    square.rotation_euler.x = 0.0
    node = wiring.put(wet, "DROPS")
    node.inputs["Drop Size"].default_value, node.inputs["Amount"].default_value = 0.4, 0.5
    tilts = np.tan(slope())
    assert np.quantile(tilts, 0.98) < 0.75 and tilts.max() > 0.3, "at most twice the height of .35"
    node.inputs["Height"].default_value = 0.0
    assert slope() == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_source_and_normal_stay_linked(addon, wet, wiring, kind):
    thickness, tree = addon.nodes.thickness, wet.node_tree
    group = addon.nodes.node_group.group_nodes(wet)[0]
    bump = tree.nodes.new("ShaderNodeBump")
    tree.links.new(bump.outputs[0], group.inputs["Normal"])
    image = thickness.wire_thickness(wet, "image", to="Coverage").node
    node = wiring.put(wet, kind)
    assert node.inputs["Normal"].links[0].from_node == bump and node.inputs["Coverage"].links[0].from_node == image
    assert thickness.wiring(wet, "Coverage").node == image and wiring.chosen(wet) == kind
    assert wiring.put(wet, kind) == node and len([one for one in tree.nodes if one.type == "GROUP"]) == 2
    wiring.take(wet)
    assert group.inputs["Normal"].links[0].from_node == bump and group.inputs["Coverage"].links[0].from_node == image
    assert wiring.chosen(wet) == "" and not [one for one in bpy.data.node_groups if one.name.startswith("Lamina F")]


def test_a_pattern_leaves_with_its_film_and_comes_back(addon, wet, wiring):
    node, group = wiring.put(wet, "DROPS"), addon.nodes.node_group.group_nodes(wet)[0]
    node.inputs["Amount"].default_value = 0.6
    film = wet.lamina.layers[wet.lamina.active_index]
    film.varying = False
    addon.baking.bake_job.bake_material(wet)
    assert not group.inputs["Normal"].is_linked
    film.varying = True
    addon.baking.bake_job.bake_material(wet)
    assert group.inputs["Normal"].links[0].from_node == node == group.inputs["Coverage"].links[0].from_node
    assert node.inputs["Amount"].default_value == pytest.approx(0.6)
    addon.editing.layer_list.remove_stack(wet)
    assert not [one for one in wet.node_tree.nodes if one.type == "GROUP"]
    assert not [one for one in bpy.data.node_groups if one.name == "Lamina Drops"]


@pytest.mark.parametrize(("preset", "kind"), [("rain-drops", "DROPS"), ("puddles", "PUDDLES"),
                                              ("fingerprints", "PRINTS")])
def test_presets_bring_their_pattern(addon, lamina, wiring, preset, kind):
    material = bpy.data.materials.new("Plastic")
    addon.nodes.node_tree.of(material)
    addon.editing.presets.apply(material, preset)
    material.lamina.quality = "preview"
    addon.baking.bake_job.bake_material(material)
    assert wiring.chosen(material) == kind and addon.nodes.detail_wiring.WANTED not in material
