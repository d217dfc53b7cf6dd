# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts the node of dust_detail between the source of a material's thickness and the baked group, and links a
painted mask to it."""

import math

from ..base import renders
from . import detail_group, dust_detail, dust_litter, rest_coordinates, socket_animation, thickness
from .side_graph import BACK, FRONT

# Property of a material with an overlay: the next bake adds a node of detail (True), or a film's pattern.
WANTED = "lamina_detail"
DUSTED = "lamina_dusted"  # property of a material: what Dust These Objects has added to it


def detail(material):
    """The node of detail before the thickness input, or None."""
    for name in (FRONT, BACK):
        for socket in thickness.group_sockets(material, name):
            if socket.is_linked and detail_group.is_detail(socket.links[0].from_node):
                return socket.links[0].from_node
    return None


def add_detail(material):
    """Put a node of detail between the source of the thickness and the baked group; returns the node, also
    one that is there already. Meshes with the material get rest coordinates. Raises RefusedError without a
    thickness input."""
    renders.stop_previews()
    sockets = thickness.required_sockets(material)
    rest_coordinates.store_for(material)
    node = detail(material)
    if node is not None:
        dust_detail.group()  # drawn anew in files of earlier versions
        return node
    node = new_node(material, "detail", sockets[0].node)
    node.node_tree = dust_detail.group()
    detail_group.set_sizes(node, dust_detail.SIZES)
    for name, share in dust_litter.SHARES.items():
        node.inputs[name].default_value = share if name != "Fibers" or _is_dust(material) else 0.0
    insert(material, node, (FRONT, BACK))
    return node


def add_settled_detail(material):
    """`add_detail` for dust that has settled, which varies by itself: less than the strengths of a layer that
    is even, unless the artist chose others."""
    node = add_detail(material)
    for name, strength in dust_detail.SETTLED.items():
        if math.isclose(node.inputs[name].default_value, dust_detail.UNSETTLED[name], abs_tol=1e-6):
            node.inputs[name].default_value = strength


def new_node(material, mark, beside):
    """A group node for detail, left of `beside`, in front of which there is room."""
    for source in material.node_tree.nodes:
        if thickness.MARK in source:
            source.location.x -= 280.0
    return thickness.marked_node(material.node_tree, "ShaderNodeGroup", mark, beside, 1)


def insert(material, node, names):
    """Link the sources of the inputs `names` of the baked group to `node`, and its outputs to the inputs."""
    tree = material.node_tree
    for name in names:
        for socket in thickness.group_sockets(material, name):
            if socket.is_linked:
                tree.links.new(socket.links[0].from_socket, node.inputs[name])
            elif not node.inputs[name].is_linked:
                _carry_value(socket, node.inputs[name])
                socket_animation.remove(socket)
            tree.links.new(node.outputs[name], socket)


def take_out(material, node, names):
    """Undo `insert`; the node stays."""
    tree = material.node_tree
    for name in names:
        given = node.inputs[name]
        for link in list(node.outputs[name].links):
            target = link.to_socket
            tree.links.remove(link)
            if given.is_linked:
                tree.links.new(given.links[0].from_socket, target)
            else:
                _carry_value(given, target)
        socket_animation.remove(given)


def _carry_value(given, target):
    """Give `target` the value of the unlinked socket `given`, with its animation."""
    target.default_value = given.default_value
    if not socket_animation.is_animated(target):
        socket_animation.copy(given, target)


def _is_dust(material):
    """True if the varying layer is called a dust: fibers lie in no snow or rust."""
    return any(one.varying and "dust" in one.name.lower() for one in material.lamina.layers)


def add_if_wanted(material):
    """After a bake: add the node of detail if the material has WANTED, and remove WANTED."""
    if isinstance(material.get(WANTED), str):
        return
    if material.pop(WANTED, False) and thickness.has_input(material):
        is_new = detail(material) is None
        node = add_detail(material)
        if is_new:
            for name, strength in dust_detail.UNSETTLED.items():
                node.inputs[name].default_value = strength


def remove_detail(material):
    """Link the source of the thickness to the baked group again, without the node of detail and its mask."""
    renders.stop_previews()
    node = detail(material)
    if node is None:
        return
    take_out(material, node, (FRONT, BACK))
    tree = material.node_tree
    tree.nodes.remove(node)
    thickness.remove_nodes(tree)
    dust_detail.remove_unused()


def mask(material):
    """The node of the painted mask, or None."""
    node = detail(material)
    links = node.inputs["Wiped"].links if node is not None else ()
    return links[0].from_node if links else None


def remove_mask(material):
    """Unlink the painted mask, and remove its node unless the artist made it. The painted values stay in the
    file."""
    renders.stop_previews()
    node = mask(material)
    if node is not None:
        _unlink_mask(material)
        thickness.remove_nodes(material.node_tree)


def wipe_by(material, node, output, uv_map=None):
    """Link `output` of a new `node` of the material, which reads a painted mask, to the detail's input Wiped.
    An image is read by the UV map `uv_map`. A mask that was linked before is removed, unless the artist made
    its node."""
    renders.stop_previews()
    to = detail(material)
    tree = material.node_tree
    _unlink_mask(material)
    node[thickness.MARK], node.label, node.select = "wiped", "Wiped places", False
    node.location = (to.location.x - 280.0, to.location.y - 260.0)
    tree.links.new(node.outputs[output], to.inputs["Wiped"])
    if uv_map is not None:
        thickness.read_by(tree, node, to, uv_map)
    thickness.remove_nodes(tree)


def _unlink_mask(material):
    """Unlink the painted mask, and keep its image for the material's next one."""
    for link in list(detail(material).inputs["Wiped"].links):
        if link.from_node.type == "TEX_IMAGE" and link.from_node.image is not None:
            link.from_node.image.use_fake_user = True
            material[thickness.KEPT[thickness.MASK]] = link.from_node.image
        material.node_tree.links.remove(link)
