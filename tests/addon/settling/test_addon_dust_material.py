# SPDX-License-Identifier: GPL-3.0-or-later
"""Settled dust and the material: the thickness that the material reads, grain and clouds, and the panels."""

from types import SimpleNamespace

import bpy
import pytest
from addon_helpers import drawn, pixels
from dusty_objects import NAME, grid


def plate_with_image(dust, addon, material):
    """A plate with this material, and dust in an image."""
    material.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(material)
    plate = grid(material=material)
    plate.lamina_dust.target, plate.lamina_dust.size = "image", 32
    dust.settle(bpy.context, plate)
    return plate


def test_the_material_reads_the_dust(dust, addon, material):
    layer = material.lamina.layers[0]
    layer.varying, layer.tau = True, 2.0
    addon.baking.bake_job.bake_material(material)
    plate = grid(material=material)
    assert addon.nodes.thickness.wiring(material).source == "value"
    dust.settle(bpy.context, plate)
    found = addon.nodes.thickness.wiring(material)
    assert (found.source, found.name) == ("attribute", NAME)
    assert addon.ui.settled_fields.mismatch(material, plate.lamina_dust) == ""
    plate.lamina_dust.amount = 3.0
    dust.settle(bpy.context, plate)
    assert "above thickness 2 nothing changes" in addon.ui.settled_fields.mismatch(material, plate.lamina_dust)
    plate.lamina_dust.target = "image"
    assert "does not read it" in addon.ui.settled_fields.mismatch(material, plate.lamina_dust)
    dust.settle(bpy.context, plate)
    assert addon.nodes.thickness.wiring(material).source == "image"


def test_the_first_dust_of_a_material_gets_grain_and_clouds(dust, addon, material):
    material.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(material)
    plate = grid(size=3.0, material=material)
    dust.settle(bpy.context, plate)
    node = addon.nodes.detail_wiring.detail(material)
    assert node.inputs["Cloud Size"].default_value == pytest.approx(0.05)
    small = grid("Small", size=0.01, material=material)
    dust.settle(bpy.context, small)
    assert node.inputs["Cloud Size"].default_value == pytest.approx(0.05), "objects with one material have one size"
    assert all("lamina_rest" in one.data.attributes for one in (plate, small))
    addon.nodes.detail_wiring.remove_detail(material)
    dust.settle(bpy.context, plate)
    assert addon.nodes.detail_wiring.detail(material) is None
    assert addon.nodes.thickness.wiring(material).source == "attribute"


def test_remove_leaves_no_dust(dust, addon, material, call):
    """Dust that another material shows stays."""
    other = bpy.data.materials.new("Other")
    addon.editing.layer_list.add_stack(other)
    material.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(material)
    alone, shared = grid("Alone", material=material), grid("Shared", material=material)
    shared.data.materials.append(other)
    for obj in (alone, shared):
        dust.settle(bpy.context, obj)
    assert any(group.name.startswith("Lamina Dust Detail") for group in bpy.data.node_groups)
    assert call(bpy.ops.lamina.remove_stack, material) == {"FINISHED"}
    assert not any(one.name.startswith("lamina") for one in alone.data.attributes) and not alone.lamina_dust.told
    assert NAME in shared.data.attributes and shared.lamina_dust.told
    assert not bpy.data.node_groups and not material.node_tree.nodes.get("Lamina")


def test_a_duplicate_leaves_the_image_of_the_original_alone(dust, addon, material):
    plate = plate_with_image(dust, addon, material)
    image, look = plate.lamina_dust.image, pixels(plate.lamina_dust.image)
    twin, of_twin = plate.copy(), material.copy()
    twin.data = plate.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    twin.data.materials[0] = of_twin
    twin.lamina_dust.amount = 0.3
    dust.settle(bpy.context, twin)
    own = twin.lamina_dust.image
    assert own != image and addon.nodes.thickness.wiring(of_twin).node.image == own
    assert plate.lamina_dust.image == image == addon.nodes.thickness.wiring(material).node.image
    twin.lamina_dust.image = image  # as before it settled
    dust.clear(twin)
    assert plate.lamina_dust.image == image and (pixels(image) == look).all()


def test_after_clear_the_material_reads_no_dust(dust, addon, material):
    """It reads the missing attribute: a texture without an image is magenta in Cycles, and so thick dust."""
    plate = plate_with_image(dust, addon, material)
    dust.clear(plate)
    assert addon.nodes.thickness.wiring(material).source == "attribute"
    assert not addon.nodes.thickness.images_read(material.node_tree)
    assert not any(node.type == "TEX_IMAGE" for node in material.node_tree.nodes)


def test_a_painted_image_stays_unless_the_artist_chooses_settled(dust, addon, material):
    material.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(material)
    painted = addon.nodes.thickness.wire_thickness(material, "image").node.image
    plate = grid(material=material)
    dust.settle(bpy.context, plate)
    assert addon.nodes.thickness.wiring(material).node.image == painted
    assert f"the thickness of Bronze stays that of the image {painted.name}: choose" in plate.lamina_dust.told
    bpy.context.view_layer.objects.active = plate
    said = addon.scene.place.put(bpy.context, material, "SETTLED")
    assert addon.nodes.thickness.wiring(material).source == "attribute" and "stays" not in said
    assert painted.users, "the material keeps the image"


def test_an_artists_own_node_stays(dust, addon, material):
    material.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(material)
    socket = addon.nodes.node_group.group_nodes(material)[0].inputs["Thickness"]
    mine = material.node_tree.nodes.new("ShaderNodeValue")
    material.node_tree.links.new(mine.outputs[0], socket)
    dust.settle(bpy.context, grid(material=material))
    assert socket.links[0].from_node == mine


def test_the_panels_of_dust_and_of_its_detail(dust, addon, material):
    layer = material.lamina.layers[0]
    layer.varying, layer.tau = True, 2.0
    addon.baking.bake_job.bake_material(material)
    plate = grid(material=material)
    context = SimpleNamespace(
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)), region=SimpleNamespace(width=600),
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get, mode="OBJECT", object=plate, material=material,
        scene=bpy.context.scene,
    )  # fmt: skip

    def lines(panel=addon.ui.where_panel.LAMINA_PT_where):
        return drawn(lambda layout: panel.draw(SimpleNamespace(layout=layout), context))

    addon.nodes.thickness.wire_thickness(material, "attribute")
    before = lines()
    assert [line for line in before if line in ("How Much", "Where From", "Where It Stays", "Where To")] == [
        "How Much", "Where From", "Where It Stays", "Where To"]
    assert "Settle Dust" in before and "Add Grain and Clouds" in before
    addon.nodes.thickness.wire_thickness(material, "value")
    dust.settle(bpy.context, plate)
    after = lines()
    assert "Settle Again" in after
    assert "Cloud Size" in after and "Remove Grain and Clouds" in after and "Wipe by Hand" in after
