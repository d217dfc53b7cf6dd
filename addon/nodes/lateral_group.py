# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group for lateral light transport: one per material, in addition to the node group of the bake."""

import bpy

from ..base import image_removal, renders
from . import before, graph, group_sockets, node_group

MILLIMETRE = "Millimetre"  # the group's input: Blender units per millimetre


def build(material, name, draw, millimetre, inputs=(), again=False):
    """Make or refill the material's lateral group and link it to the material output. Returns the group.

    `draw(graph, length, sockets)` adds the nodes and returns the sockets of the shader and of the volume
    (None: no volume). `length` is the socket with the number of Blender units per millimetre; its initial
    value is `millimetre`. `inputs`: further inputs of the group, (name, socket type, initial value,
    description) each; `sockets` has their sockets by name. `again`: the group has these inputs already, and
    their values are kept. If `draw` fails, nothing is changed
    but further inputs, which the next build removes."""
    renders.stop_previews()
    before.switch_nodes_on(material)
    group = material.lamina.lateral_group
    is_new = group is None or not group.is_editable or _is_shared(material, group)
    if is_new:
        group = _new_group(f"Lamina {name} {material.name}")
    old_nodes = list(group.nodes)
    old_images = node_group.images_of(old_nodes)
    again = again and not is_new and {one[0] for one in inputs} <= _names(group)
    if not again:
        _set_inputs(group, inputs)
    drawing = graph.Graph(group)
    try:
        given = drawing.node("NodeGroupInput", -3, 0).outputs
        shader, volume = draw(drawing, given[MILLIMETRE], given)
        _settle_volume(group, volume is not None)
        outputs = drawing.node("NodeGroupOutput", 5, 0)
        drawing.link(shader, outputs.inputs["Shader"])
        if volume is not None:
            drawing.link(volume, outputs.inputs[node_group.VOLUME])
    except BaseException:
        new_images = node_group.images_of(drawing.created)
        drawing.remove_created()
        image_removal.remove_unused(new_images)
        if is_new:
            bpy.data.node_groups.remove(group)
        raise
    for node in old_nodes:
        group.nodes.remove(node)
    image_removal.remove_unused(old_images)
    group.name = f"Lamina {name} {material.name}"
    _input(group).default_value = millimetre
    material.lamina.lateral_group = group
    material.lamina.lateral_scatterings = 0
    for node in [*node_group.group_nodes(material, group), node_group.connect(material, group)]:
        node.label = f"Lamina {name}"
        if again:
            continue
        for one, value in ((MILLIMETRE, millimetre), *((one[0], one[2]) for one in inputs)):
            node.inputs[one].default_value = value
    return group


def _new_group(name):
    group = bpy.data.node_groups.new(name, "ShaderNodeTree")
    group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    socket = group.interface.new_socket(
        MILLIMETRE,
        in_out="INPUT",
        socket_type="NodeSocketFloat",
        description="Blender units per millimetre: .001 where a unit is a metre, whatever the object's scale",
    )
    socket.min_value = 0.0
    return group


def _set_inputs(group, inputs):
    """Give the group these inputs beside MILLIMETRE."""
    for item in list(group.interface.items_tree):
        if item.in_out == "INPUT" and item.name != MILLIMETRE:
            group.interface.remove(item)
    for name, kind, value, description in inputs:
        socket = group.interface.new_socket(name, in_out="INPUT", socket_type=kind, description=description)
        socket.default_value = value


def _names(group):
    return {item.name for item in group.interface.items_tree if item.in_out == "INPUT"}


def _settle_volume(group, wanted):
    """Give the group an output for a volume, or remove that output."""
    found = group_sockets.named(group, "OUTPUT").get(node_group.VOLUME)
    if wanted and found is None:
        group.interface.new_socket(node_group.VOLUME, in_out="OUTPUT", socket_type="NodeSocketShader")
    elif not wanted and found is not None:
        group.interface.remove(found)


def _input(group):
    return next(item for item in group.interface.items_tree if item.name == MILLIMETRE)


def _is_shared(material, group):
    return any(other != material and other.lamina.lateral_group == group for other in bpy.data.materials)
