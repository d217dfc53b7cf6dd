# SPDX-License-Identifier: GPL-3.0-or-later
"""Eevee shows thin sheets as sheets: the Thickness of the material's output is 0 for them, and only for them."""


def output_of(material):
    return material.node_tree.get_output_node("EEVEE")


def baked(addon, material, base):
    material.lamina.base.kind = base
    addon.baking.bake_job.bake_material(material)
    return addon.nodes.node_group.group_nodes(material)[0]


def test_a_sheet_is_thin(addon, material):
    node = baked(addon, material, "none")
    (link,) = output_of(material).inputs["Thickness"].links
    assert link.from_node == node
    (group_output,) = [one for one in node.node_tree.nodes if one.type == "GROUP_OUTPUT"]
    (source,) = group_output.inputs[link.from_socket.name].links
    assert source.from_node.type == "VALUE" and source.from_socket.default_value == 0.0


def test_a_body_is_not(addon, material):
    assert len(baked(addon, material, "lambert").outputs) == 1
    assert not output_of(material).inputs["Thickness"].is_linked


def test_another_base_changes_it(addon, material):
    baked(addon, material, "none")
    baked(addon, material, "lambert")
    assert not output_of(material).inputs["Thickness"].is_linked
    node = baked(addon, material, "none")
    assert output_of(material).inputs["Thickness"].links[0].from_node == node


def test_the_artists_own_thickness_stays(addon, material):
    tree = addon.nodes.node_tree.of(material)
    own = tree.nodes.new("ShaderNodeValue")
    tree.links.new(own.outputs[0], output_of(material).inputs["Thickness"])
    baked(addon, material, "none")
    assert output_of(material).inputs["Thickness"].links[0].from_node == own


def test_a_group_that_is_no_longer_shown(addon, material):
    """Another shader at the output is a body again as soon as Lamina's node is connected or removed."""
    node = baked(addon, material, "none")
    addon.nodes.node_group.remove(material)
    assert not output_of(material).inputs["Thickness"].is_linked
    node = baked(addon, material, "none")
    other = material.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    material.node_tree.links.new(other.outputs[0], output_of(material).inputs["Surface"])
    addon.nodes.thin_sheet.connect(material, node)
    assert not output_of(material).inputs["Thickness"].is_linked
    addon.nodes.node_group.connect(material)
    assert output_of(material).inputs["Thickness"].links[0].from_node == node
