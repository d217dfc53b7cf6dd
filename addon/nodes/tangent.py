# SPDX-License-Identifier: GPL-3.0-or-later
"""The source of the tangent of an anisotropic material: the active UV map, which the group reads itself, or a
Tangent node of Cycles about an axis of the object. Links of the artist are kept."""

from ..base import renders
from . import node_group, own_nodes
from .group_sockets import TANGENT


def sockets(material):
    """The tangent inputs of the material's baked group, one for each use of the group."""
    return [node.inputs[TANGENT] for node in node_group.group_nodes(material) if TANGENT in node.inputs]


def follow(material):
    """Link the tangent that the material's property `tangent` names, unless the artist has linked another,
    and remove a node that is no longer used."""
    found, source = sockets(material), material.lamina.tangent
    mine = [node for node in (material.node_tree.nodes if material.node_tree else ())
            if node.type == "TANGENT" and own_nodes.is_marked(node)]
    wanted = source if found else "UV"
    free = [socket for socket in found if not socket.is_linked or socket.links[0].from_node in mine]
    if wanted == "UV" or not free:
        if mine:
            renders.stop_previews()
        for node in mine:
            material.node_tree.nodes.remove(node)
        return
    renders.stop_previews()
    node = mine[0] if mine else _new_node(material, free[0].node)
    node.direction_type, node.axis = "RADIAL", source
    for socket in free:
        material.node_tree.links.new(node.outputs[0], socket)


def _new_node(material, beside):
    node = own_nodes.mark(material.node_tree.nodes.new("ShaderNodeTangent"))
    node.label, node.select = "Direction of brushing", False
    node.location = (beside.location.x - 280.0, beside.location.y - 320.0)
    return node
