# SPDX-License-Identifier: GPL-3.0-or-later
"""One strength for the dust of all materials: a node group with a single number, which all nodes of
dust_detail read. The file renders without the add-on, and the number can have key frames."""

import bpy

from .expression import maximum
from .graph import Graph

NAME = "Lamina Dust Strength"
MARK = "lamina_dust_strength"
_VALUE = "Strength"


def group():
    """The node group, made with the strength 1 if the file has none. Groups that came with appended materials
    are replaced by the first one."""
    found, *appended = _found_all() or [None]
    for one in appended:
        one.user_remap(found)
        bpy.data.node_groups.remove(one)
    if found is None:
        found = bpy.data.node_groups.new(NAME, "ShaderNodeTree")
        found.interface.new_socket(_VALUE, in_out="OUTPUT", socket_type="NodeSocketFloat")
        graph = Graph(found)
        value = graph.node("ShaderNodeValue", _VALUE, folded=False)
        value.name, value.outputs[0].default_value = _VALUE, 1.0
        positive = maximum(graph.value(value.outputs[0]), 0.0)
        graph.link(positive.named("not negative"), graph.node("NodeGroupOutput").inputs[_VALUE])
        graph.arrange()
        found[MARK] = 1
    return found


def socket():
    """The output that holds the strength as `default_value`, or None if the file has no such node group."""
    found = _found()
    node = None if found is None else found.nodes.get(_VALUE)
    return None if node is None else node.outputs[0]


def remove_unused():
    """Remove the group if nothing uses it."""
    found = _found()
    if found is not None and not found.users:
        bpy.data.node_groups.remove(found)


def _found():
    return next(iter(_found_all()), None)


def _found_all():
    return [one for one in bpy.data.node_groups if MARK in one and one.is_editable]
