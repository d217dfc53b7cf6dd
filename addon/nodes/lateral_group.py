# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group for lateral light transport: one per material, in addition to the node group of the bake."""

import bpy

from ..base import image_removal, renders
from . import before, graph, group_sockets, node_group, socket_animation

MILLIMETRE = "Millimetre"  # the group's input: Blender units per millimetre


def build(material, name, draw, millimetre, inputs=(), again=False):
    """Make or refill the material's lateral group and link it to the material output. Returns the group.

    `draw(graph, length, sockets)` adds the nodes and returns the sockets of the shader and of the volume
    (None: no volume). `length` is the socket with the number of Blender units per millimetre; its initial
    value is `millimetre`. `inputs`: further inputs of the group, (name, socket type, initial value,
    description) each; `sockets` has their sockets by name. Inputs that the group has already keep their links
    and their animation, and values that the artist has set. `again`: all values are kept. If `draw` fails,
    nothing is changed."""
    renders.stop_previews()
    before.switch_nodes_on(material)
    earlier = material.lamina.lateral_group
    is_new = earlier is None or not earlier.is_editable or _is_shared(material, earlier)
    group = _new_group(f"Lamina {name} {material.name}", earlier) if is_new else earlier
    old_nodes = list(group.nodes)
    old_images = node_group.images_of(old_nodes)
    added = _add_inputs(group, inputs)
    again = again and not is_new and not added
    drawing = graph.Graph(group)
    try:
        given = drawing.node("NodeGroupInput").outputs
        shader, volume = draw(drawing, given[MILLIMETRE], given)
        _settle_volume(group, volume is not None)
        outputs = drawing.node("NodeGroupOutput")
        drawing.link(shader, outputs.inputs["Shader"])
        if volume is not None:
            drawing.link(volume, outputs.inputs[node_group.VOLUME])
        drawing.arrange()
    except BaseException:
        new_images = node_group.images_of(drawing.created)
        drawing.remove_created()
        image_removal.remove_unused(new_images)
        if is_new:
            bpy.data.node_groups.remove(group)
        else:
            _remove_inputs(group, added)
        raise
    for node in old_nodes:
        group.nodes.remove(node)
    image_removal.remove_unused(old_images)
    group.name = f"Lamina {name} {material.name}"
    if is_new and earlier is not None:
        for node in node_group.group_nodes(material, earlier):  # of the copied material
            node.node_tree = group
    values = {MILLIMETRE: millimetre, **{one[0]: one[2] for one in inputs}}
    _remove_inputs(group, group_sockets.named(group, "INPUT").keys() - values.keys())
    if not again:
        group_sockets.follow_base(group, values, added)
    material.lamina.lateral_group = group
    material.lamina.lateral_scatterings = 0
    material.lamina.trial = ""
    for node in [*node_group.group_nodes(material, group), node_group.connect(material, group)]:
        node.label = f"Lamina {name}"
    return group


def _new_group(name, earlier):
    """A group. A copied material shares the group `earlier` with the original: a copy of it has the same
    inputs, which keeps their links."""
    if earlier is not None:
        return earlier.copy()
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


def _add_inputs(group, inputs):
    """Give the group those of the inputs that it lacks. Returns their names."""
    present = group_sockets.named(group, "INPUT")
    added = [one for one in inputs if one[0] not in present or present[one[0]].socket_type != one[1]]
    _remove_inputs(group, [one[0] for one in added if one[0] in present])  # of another type
    for name, kind, value, description in added:
        socket = group.interface.new_socket(name, in_out="INPUT", socket_type=kind, description=description)
        socket.default_value = value
    return [one[0] for one in added]


def _remove_inputs(group, names):
    """Remove inputs by name. The animation of the others stays with them."""
    if not names:
        return
    with socket_animation.held(group_sockets.nodes_with(group)):
        group_sockets.remove(group, names)


def _settle_volume(group, wanted):
    """Give the group an output for a volume, or remove that output."""
    found = group_sockets.named(group, "OUTPUT").get(node_group.VOLUME)
    if wanted and found is None:
        group.interface.new_socket(node_group.VOLUME, in_out="OUTPUT", socket_type="NodeSocketShader")
    elif not wanted and found is not None:
        group.interface.remove(found)


def _is_shared(material, group):
    return any(other != material and other.lamina.lateral_group == group for other in bpy.data.materials)
