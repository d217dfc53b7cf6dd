# SPDX-License-Identifier: GPL-3.0-or-later
"""What the node groups of detail share: each is kept once in a file, drawn anew by a newer add-on, and goes
with its last user."""

import bpy

from . import group_sockets

# Properties of the groups, with their versions.
MARKS = ("lamina_dust_detail", "lamina_drops", "lamina_puddles", "lamina_prints")


def of(mark, version, name, draw):
    """The group with this one of MARKS. draw(tree): adds the missing sockets and all nodes."""
    found = next((one for one in bpy.data.node_groups if mark in one and one.is_editable), None)
    if found is not None and found[mark] == version:
        return found
    made = found or bpy.data.node_groups.new(name, "ShaderNodeTree")
    made.nodes.clear()
    draw(made)
    made[mark] = version
    return made


def is_detail(node):
    """True if a node uses such a group."""
    return node.type == "GROUP" and node.node_tree is not None and any(one in node.node_tree for one in MARKS)


def set_sizes(node, sizes):
    """Set the inputs `sizes`, {name: metres}, in units of the scene."""
    unit = bpy.context.scene.unit_settings.scale_length
    for name, size in sizes.items():
        node.inputs[name].default_value = size / unit


def add_input(tree, name, kind, description="", **values):
    """Add an input of this kind with the property `values`, unless the tree has one of that name."""
    if name not in group_sockets.named(tree, "INPUT"):
        socket = tree.interface.new_socket(name, in_out="INPUT", socket_type=kind, description=description)
        for key, value in values.items():
            setattr(socket, key, value)


def add_output(tree, name, kind):
    """Add an output of this kind, unless the tree has one of that name."""
    if name not in group_sockets.named(tree, "OUTPUT"):
        tree.interface.new_socket(name, in_out="OUTPUT", socket_type=kind)


def add_settings(tree, settings):
    """Add the missing inputs of (name, subtype, default, least, most, description)."""
    for name, subtype, default, least, most, description in settings:
        add_input(tree, name, "NodeSocketFloat", description, subtype=subtype, default_value=default,
                  min_value=least, max_value=most)


def remove_unused():
    """Remove the groups that nothing uses."""
    for group in [one for one in bpy.data.node_groups if one.is_editable and not one.users]:
        if any(mark in group for mark in MARKS):
            bpy.data.node_groups.remove(group)
