# SPDX-License-Identifier: GPL-3.0-or-later
"""The node of the layers in the place of the shader that they lie over.

A Principled BSDF gives its links, values and animations to the sockets of the same names. Its emission and
alpha are made again by plain nodes behind the layers.
"""

from ..kinds.bases import PrincipledBase, ShaderBase
from . import base_graph, before, links, own_nodes, principled, socket_animation
from .graph import COLUMN, ROW, Graph

# Inputs of the layers' node that a Principled BSDF has too.
_SHARED = ("Base Color", "Metallic", "Roughness", "Normal", principled.TANGENT)

_AFTER = ("ADD_SHADER", "MIX_SHADER")  # nodes that follow the layers' node
# These and what they add.
_MADE_AFTER = (*_AFTER, "EMISSION", "BSDF_TRANSPARENT", "FRESNEL", "MATH", "NEW_GEOMETRY")


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
    before.note(material.node_tree, principled.described(replaced))


def has_changed(material):
    """True if the Principled BSDF that the layers replace was edited after the layers have read it."""
    node = replaced(material)
    return node is not None and before.noted(material.node_tree) not in ("", principled.described(node))


def read_again(material, nodes):
    """Give the layers' nodes `nodes` what the Principled BSDF that they replace has now, instead of their own
    links, values and animations. The first node's emission and alpha are made again."""
    for node in nodes:
        for name in _SHARED:
            if name in node.inputs:
                for link in list(node.inputs[name].links):
                    material.node_tree.links.remove(link)
                socket_animation.remove(node.inputs[name])
        feed(material, node)
    given = replaced(material)
    for node in nodes[:1]:
        _replace_after(material.node_tree, node, given)
    before.note(material.node_tree, principled.described(given))


def settle_after(material, node):
    """Make the emission and alpha of the Principled BSDF again behind the layers' node `node` if its values
    are the base of the layers, and remove them if not: a BSDF that stays in use shows them itself."""
    given = replaced(material)
    if (given is None) != (end_of(node).node == node):
        _replace_after(material.node_tree, node, given)


def replaced(material):
    """The Principled BSDF whose values are the base of the layers, or None."""
    if material.node_tree is None or material.lamina.base.kind != PrincipledBase.kind:
        return None
    return principled.of(before.source(material.node_tree))


def _replace_after(tree, node, given):
    """Make the emission and alpha of the Principled BSDF `given` behind the layers' node `node`, in place
    of those that are there. None: remove them."""
    targets = [link.to_socket for link in end_of(node).links]
    for made in [one for one in tree.nodes if one.type in _MADE_AFTER and own_nodes.is_marked(one)]:
        tree.nodes.remove(made)
    shader = node.outputs["Shader"] if given is None else _with_emission_and_alpha(tree, node, given)
    for target in targets:
        tree.links.new(shader, target)


def feed(material, node, names=(*_SHARED, base_graph.SHADER)):
    """Give those inputs `names` that the layers' node `node` has what the shader below the layers has: the
    links, values and animations of a Principled BSDF, or the shader itself."""
    kind, kept = material.lamina.base.kind, before.kept(material.node_tree)
    given = replaced(material)
    for name in names:
        if name not in node.inputs or kept is None:
            continue
        if given is not None and name in _SHARED:
            _carry(given.inputs[name], node.inputs[name])
        elif kind == ShaderBase.kind and name == base_graph.SHADER:
            links.connect(kept, node.inputs[name])


def _with_emission_and_alpha(tree, node, replaced):
    """The shader of the layers with the emission and alpha of the Principled BSDF."""
    graph, shader = Graph(tree), node.outputs["Shader"]
    if principled.emits(replaced):
        emission = graph.node("ShaderNodeEmission", "Emission")
        _carry(replaced.inputs[principled.EMISSION], emission.inputs["Color"])
        strength = emission.inputs["Strength"]
        if principled.is_coated(replaced):
            left, strength = _below_coat(graph, replaced)
            graph.link(left, emission.inputs["Strength"])
        _carry(replaced.inputs[principled.STRENGTH], strength)
        shader = graph.add_shaders("With emission", shader, emission.outputs[0])
    if principled.is_cut_out(replaced):
        clear = graph.node("ShaderNodeBsdfTransparent", "Nothing")
        alpha = replaced.inputs[principled.ALPHA]
        shader = graph.mix_shaders("Alpha", alpha.default_value, clear.outputs[0], shader)
        _carry(alpha, shader.node.inputs[0])
    for made in graph.created:
        own_nodes.mark(made)
        made.parent = node.parent
    graph.arrange(node.location.x + COLUMN, node.location.y + 5.0 * ROW)
    return shader


def _below_coat(graph, replaced):
    """(a value with the share of a strength that passes the coat, the input for that strength). The share is
    1 - Coat Weight x Fresnel reflectance, as in Cycles for a smooth coat."""
    fresnel = graph.node("ShaderNodeFresnel", "coat")
    # The Fresnel node inverts the index on back faces, and the coat does not.
    back = graph.values(graph.node("ShaderNodeNewGeometry"))["Backfacing"]
    ior = (1.0 ** (1.0 - back * 2.0)).named("IOR of the coat")
    _carry(replaced.inputs[principled.COAT_IOR], ior.socket.node.inputs[0])
    graph.link(ior, fresnel.inputs["IOR"])
    _carry(replaced.inputs[principled.COAT_NORMAL], fresnel.inputs["Normal"])
    reflected = (graph.value(fresnel.outputs[0]) * 0.0).named("reflected")
    _carry(replaced.inputs[principled.COAT], reflected.socket.node.inputs[1])
    strength = ((1.0 - reflected).named("left") * 0.0).named("strength")
    return strength, strength.socket.node.inputs[1]


def _carry(given, target):
    """Give the input socket `target` the value, link and animation of the input socket `given`."""
    if not target.hide_value:
        target.default_value = given.default_value
    fed = links.feed(given)
    if fed is not None and (fed.muted or links.source(given) is not None):
        links.connect(fed, target)
    socket_animation.copy(given, target)
