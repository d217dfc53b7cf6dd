# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement of the surface by the layer on it: snow, mud and heavy dust rise by their thickness.

A Displacement node reads the height of the node of detail, which has clouds and wiped places, but no grain
and no litter: finer than the mesh, they would make spikes of its vertices. It is added to the artist's own
displacement. The method that was there before is noted in the material."""

import bpy

from ..base import editable, renders
from ..base.messages import RefusedError
from . import detail_wiring, dust_detail, thickness

METHOD = "lamina_displacement_method"  # property of a displaced material: its method before
MARKS = ("displacement", "displacement sum")
HEIGHT = 0.002  # metres for the optical thickness 1
_TRUE = "DISPLACEMENT"


def node(material):
    """The Displacement node made here, or None. Its input Scale is the height of the optical thickness 1, in
    units of the scene."""
    return _marked(material, MARKS[0])


def add(material, height=HEIGHT):
    """Displace surfaces with the material by its varying layer. `height`: in metres, of the optical thickness
    1. A material without a node of detail gets one. Returns the Displacement node; one that is there already
    gets this height. Raises RefusedError, with nothing changed."""
    found = node(material)
    unit = bpy.context.scene.unit_settings.scale_length
    if found is not None:
        found.inputs["Scale"].default_value = height / unit
        return found
    thickness.required_sockets(material)
    editable.require(material)
    tree, own = material.node_tree, _target(material)
    if own is None:
        raise RefusedError("The material has no Material Output: add one")
    if own.is_linked and material.displacement_method == "BUMP":
        raise RefusedError("The material's own displacement is shown as bump: first set Displacement in its "
                           "Settings to Displacement Only or Displacement and Bump")
    renders.stop_previews()
    detail = detail_wiring.add_detail(material)
    made = thickness.marked_node(tree, "ShaderNodeDisplacement", MARKS[0], own.node, 1)
    made.space = "WORLD"
    made.inputs["Midlevel"].default_value, made.inputs["Scale"].default_value = 0.0, height / unit
    tree.links.new(detail.outputs[dust_detail.HEIGHT], made.inputs["Height"])
    last = made
    if own.is_linked:
        last = thickness.marked_node(tree, "ShaderNodeVectorMath", MARKS[1], own.node, 0.5)
        last.operation = "ADD"
        tree.links.new(own.links[0].from_socket, last.inputs[0])
        tree.links.new(made.outputs[0], last.inputs[1])
    tree.links.new(last.outputs[0], own)
    material[METHOD] = material.displacement_method
    if material.displacement_method == "BUMP":
        material.displacement_method = _TRUE
    return made


def remove(material):
    """Restore the displacement as it was before `add`."""
    made = node(material)
    if made is None:
        return
    renders.stop_previews()
    tree, last = material.node_tree, _marked(material, MARKS[1]) or made
    own = last.inputs[0].links[0].from_socket if last != made and last.inputs[0].is_linked else None
    targets = [link.to_socket for link in last.outputs[0].links]
    for one in {last, made}:
        tree.nodes.remove(one)
    for target in targets if own is not None else ():
        tree.links.new(own, target)
    before = material.pop(METHOD, None)
    if before is not None and material.displacement_method == _TRUE:
        material.displacement_method = before


def _target(material):
    """The displacement input of the material's output, or None."""
    output = material.node_tree.get_output_node("CYCLES")
    return None if output is None else output.inputs["Displacement"]


def _marked(material, mark):
    if material.node_tree is None:
        return None
    return next((one for one in material.node_tree.nodes if one.get(thickness.MARK) == mark), None)
