# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin sheets in Eevee. Eevee takes every object as a solid body, whose light passes two surfaces: the colors
of Translucent closures then count twice. A Thickness of 0 at the material's output makes the surface a sheet.
Cycles ignores the socket."""

from . import group_sockets, links

OUTPUT = "Eevee Thickness"  # of the group
_INPUT = "Thickness"  # of the material's output


def is_sheet(lut):
    return lut.header["stack"]["base"] is None


def add_missing(group, lut):
    """Give the group of a sheet the output. Returns True if the output is new."""
    if not is_sheet(lut) or OUTPUT in group_sockets.named(group, "OUTPUT"):
        return False
    group.interface.new_socket(OUTPUT, in_out="OUTPUT", socket_type="NodeSocketFloat",
                               description="0: Eevee shows a thin sheet, not a solid body")
    return True


def remove(group):
    """Take the output away."""
    found = group_sockets.named(group, "OUTPUT").get(OUTPUT)
    if found is not None:
        group.interface.remove(found)


def draw(graph, lut, output):
    """Feed the output of the group, `output` being its node."""
    if is_sheet(lut):
        value = graph.node("ShaderNodeValue", "thin in Eevee")
        value.outputs[0].default_value = 0.0
        graph.link(value.outputs[0], output.inputs[OUTPUT])


def connect(material, node):
    """Link the output of the group `node` to the material's output if the node feeds the Surface, and unlink
    that of a group that does not. A link to another node stays."""
    tree = material.node_tree
    output = tree.get_output_node("EEVEE")
    if output is None or _INPUT not in output.inputs:
        return
    thickness, shown = output.inputs[_INPUT], links.source(output.inputs["Surface"])
    feeding = {one.name for one in links.upstream(shown.node)} if shown is not None else set()
    for link in list(thickness.links):
        if link.from_socket.name == OUTPUT and link.from_node.name not in feeding:
            tree.links.remove(link)
    if OUTPUT in node.outputs and node.name in feeding and not thickness.is_linked:
        tree.links.new(node.outputs[OUTPUT], thickness)
