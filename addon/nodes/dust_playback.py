# SPDX-License-Identifier: GPL-3.0-or-later
"""A modifier that plays dust back which settled at several frames.

The mesh has an attribute for each settling, named by KEY and a number. The modifier's nodes compute the two
numbers next to the scene's frame, blend their attributes linearly, and store the result as the attribute that
materials read. They are nodes of Blender's own, so the file plays and renders without the add-on."""

import bpy

from ..kinds.dust import ATTRIBUTE, BACK_ATTRIBUTE
from .expression import ceil, floor, maximum, minimum
from .graph import Graph

KEY, BACK_KEY = "lamina_dust_key_", "lamina_dust_back_key_"
NAME = "Lamina Dust Playback"
MARK = "lamina_dust_playback"


def is_playback(modifier):
    """True for a modifier made here."""
    return modifier.type == "NODES" and modifier.node_group is not None and MARK in modifier.node_group


def add(obj, frames, domain, two_sided):
    """Play the settlings at `frames`, a range, back on `obj`. `domain`: of the attributes, POINT or CORNER.
    """
    group = bpy.data.node_groups.new(f"{NAME} {obj.name}", "GeometryNodeTree")
    group[MARK] = True
    _draw(group, frames, domain, two_sided)
    modifier = obj.modifiers.new(NAME, "NODES")
    modifier.node_group = group
    modifier.show_expanded = False
    obj.modifiers.move(len(obj.modifiers) - 1, 0)  # the attributes are those of the mesh before its modifiers


def remove(obj):
    """Remove the modifier, and its nodes if nothing else uses them."""
    for modifier in [one for one in obj.modifiers if is_playback(one)]:
        group = modifier.node_group
        obj.modifiers.remove(modifier)
        if group.users == 0:
            bpy.data.node_groups.remove(group)


def _draw(tree, frames, domain, two_sided):
    for in_out in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
    graph = Graph(tree)
    geometry = graph.node("NodeGroupInput").outputs[0]
    now = graph.values(graph.node("GeometryNodeInputSceneTime"))["Frame"]
    # The place in time among the settlings: 0 at the first, and at most the last
    place = maximum((now - float(frames[0])) / float(frames.step), 0.0)
    place = minimum(place, float(len(frames) - 1)).named("place")
    before, after = floor(place).named("before"), ceil(place).named("after")
    share = (place - before).named("share")
    pairs = ((ATTRIBUTE, KEY), (BACK_ATTRIBUTE, BACK_KEY)) if two_sided else ((ATTRIBUTE, KEY),)
    for name, key in pairs:
        early, late = (_key(graph, key, number) for number in (before, after))
        blended = ((late - early) * share + early).named("blended")
        node = graph.node("GeometryNodeStoreNamedAttribute", name)
        node.data_type, node.domain = "FLOAT", domain
        node.inputs["Name"].default_value = name
        graph.link(geometry, node.inputs["Geometry"])
        graph.link(blended, next(one for one in node.inputs if one.name == "Value" and one.enabled))
        geometry = node.outputs["Geometry"]
    graph.link(geometry, graph.node("NodeGroupOutput").inputs[0])
    graph.arrange()


def _key(graph, key, number):
    """The attribute of a settling, given by its number."""
    text = graph.node("FunctionNodeValueToString")
    graph.link(number, next(one for one in text.inputs if one.name == "Value" and one.enabled))
    name = graph.node("FunctionNodeReplaceString")
    name.inputs["String"].default_value, name.inputs["Find"].default_value = f"{key}#", "#"
    graph.link(text.outputs[0], name.inputs["Replace"])
    node = graph.node("GeometryNodeInputNamedAttribute")
    node.data_type = "FLOAT"
    graph.link(name.outputs[0], node.inputs["Name"])
    return graph.value(next(one for one in node.outputs if one.name == "Attribute" and one.enabled))
