# SPDX-License-Identifier: GPL-3.0-or-later
"""The node of the layers in the place of the shader that they lie over.

A Principled BSDF gives its links, values and animations to the sockets of the same names. Its emission and
alpha are made again by plain nodes behind the layers.
"""

from ..kinds.bases import PrincipledBase, ShaderBase
from . import before, links, mix_shader, own_nodes, principled, shader_base_graph, socket_animation
from .graph import COLUMN, ROW, Graph

# Inputs of the layers' node that a Principled BSDF has too.
_SHARED = ("Base Color", "Metallic", "Roughness", "Normal")

_AFTER = ("ADD_SHADER", "MIX_SHADER")  # nodes that follow the layers' node
_MADE_AFTER = (*_AFTER, "EMISSION", "BSDF_TRANSPARENT")  # these and what they add


def end_of(node):
    """The shader behind the layers' node `node` with the emission and alpha: an output socket."""
    shader = node.outputs["Shader"]
    while True:
        after = [link.to_node for link in shader.links
                 if link.to_node.type in _AFTER and own_nodes.is_marked(link.to_node)]
        if not after:
            return shader
        shader = after[0].outputs[0]


def put(material, node, replaced):
    """Put the layers' node `node`, which is linked to the output, in the place of the Principled BSDF
    `replaced`, which fed the output before."""
    parent, place = before.put_aside(material.node_tree, replaced)
    node.parent = parent
    node.location = place


def settle_after(material, node):
    """Make the emission and alpha of the Principled BSDF again behind the layers' node `node` if its values
    are the base of the layers, and remove them if not: a BSDF that stays in use shows them itself."""
    tree, end = material.node_tree, end_of(node)
    replaced = principled.of(before.source(tree))
    is_base = material.lamina.base.kind == PrincipledBase.kind and replaced is not None
    targets = [link.to_socket for link in end.links]
    if is_base and end.node == node:
        shader = _with_emission_and_alpha(tree, node, replaced)
    elif not is_base and end.node != node:
        for made in [one for one in tree.nodes if one.type in _MADE_AFTER and own_nodes.is_marked(one)]:
            tree.nodes.remove(made)
        shader = node.outputs["Shader"]
    else:
        return
    for target in targets:
        tree.links.new(shader, target)


def feed(material, node, names=(*_SHARED, shader_base_graph.SHADER)):
    """Give those inputs `names` that the layers' node `node` has what the shader below the layers has: the
    links, values and animations of a Principled BSDF, or the shader itself."""
    kind, kept = material.lamina.base.kind, before.kept(material.node_tree)
    replaced = principled.of(before.source(material.node_tree))
    for name in names:
        if name not in node.inputs or kept is None:
            continue
        if kind == PrincipledBase.kind and replaced is not None and name in _SHARED:
            _carry(replaced.inputs[name], node.inputs[name])
        elif kind == ShaderBase.kind and name == shader_base_graph.SHADER:
            links.connect(kept, node.inputs[name])


def _with_emission_and_alpha(tree, node, replaced):
    """The shader of the layers with the emission and alpha of the Principled BSDF."""
    graph, shader = Graph(tree), node.outputs["Shader"]
    column, row = node.location.x / COLUMN, -node.location.y / ROW
    if principled.emits(replaced):
        emission = graph.node("ShaderNodeEmission", column, row - 3, "Emission")
        _carry(replaced.inputs[principled.EMISSION], emission.inputs["Color"])
        _carry(replaced.inputs[principled.STRENGTH], emission.inputs["Strength"])
        shader = mix_shader.added(graph, column + 1, row - 2, "With emission", shader, emission.outputs[0])
    if principled.is_cut_out(replaced):
        clear = graph.node("ShaderNodeBsdfTransparent", column, row - 2, "Nothing")
        alpha = replaced.inputs[principled.ALPHA]
        shader = mix_shader.between(graph, column + 1, row - 1, "Alpha", alpha.default_value,
                                    clear.outputs[0], shader)
        _carry(alpha, shader.node.inputs[0])
    for made in graph.created:
        own_nodes.mark(made)
        place = tuple(made.location)
        made.parent = node.parent
        made.location = place
    return shader


def _carry(given, target):
    """Give the input socket `target` the value, link and animation of the input socket `given`."""
    if not target.hide_value:
        target.default_value = given.default_value
    fed = links.feed(given)
    if fed is not None and (fed.muted or links.source(given) is not None):
        links.connect(fed, target)
    socket_animation.copy(given, target)
