# SPDX-License-Identifier: GPL-3.0-or-later
"""Output sockets of material nodes whose values depend only on the position inside an object."""

from ..base.messages import RefusedError

# Nodes whose values depend on a surface, a ray or the scene, and not only on a position inside the object.
_ELSEWHERE = {
    "NEW_GEOMETRY",
    "OBJECT_INFO",
    "CAMERA",
    "LIGHT_PATH",
    "UVMAP",
    "UVALONGSTROKE",
    "TANGENT",
    "NORMAL_MAP",
    "BEVEL",
    "AMBIENT_OCCLUSION",
    "FRESNEL",
    "LAYER_WEIGHT",
    "WIREFRAME",
    "HAIR_INFO",
    "PARTICLE_INFO",
    "POINT_INFO",
    "VOLUME_INFO",
    "ATTRIBUTE",
    "VERTEX_COLOR",
    "BUMP",
}
_COORDINATES = ("Object", "Generated")
_COLOURS = ("Base Color", "Color", "Density")


def default_source(material):
    """Names (node, socket) of the output linked to the colour of the material's first shader, or else to its
    density. Raises RefusedError.
    """
    tree = _tree(material)
    output = tree.get_output_node("CYCLES")
    for name in ("Surface", "Volume"):
        links = output.inputs[name].links if output else ()
        for shader in _upstream(links[0].from_node) if links else ():
            for field in _COLOURS:
                socket = shader.inputs.get(field)
                if socket is not None and socket.links and _is_shader(shader):
                    link = socket.links[0]
                    return link.from_node.name, link.from_socket.identifier
    text = "has no texture linked to a color or density: link one, or name a node and its output"
    raise RefusedError(f"{material.name} {text}")


def find_source(tree, source, material):
    """The output socket named by `source` = (node, socket) in a material's tree. Raises RefusedError if the
    socket does not exist, or if its value depends on anything but the position in the object.
    """
    name, socket = source
    node = tree.nodes.get(name)
    outputs = node.outputs if node else ()
    found = next((one for one in outputs if socket in (one.identifier, one.name)), None)
    if found is None or found.type == "SHADER":
        text = f"has no output {socket} of a node {name}: name one that is no shader"
        raise RefusedError(f"{material.name} {text}")
    for one in _upstream(node):
        _check(one, material)
    return found


def _check(node, material):
    if node.type == "GROUP" and node.node_tree is not None:
        for inner in node.node_tree.nodes:
            _check(inner, material)
    if node.type == "TEX_COORD":
        wrong = next((one.name for one in node.outputs if one.links and one.name not in _COORDINATES), "")
        if wrong or node.object is not None:
            what = wrong or f"the coordinates of {node.object.name}"
            _refuse(node, material, f"gives {what}, which")
    elif node.type in _ELSEWHERE:
        _refuse(node, material, "")


def _refuse(node, material, what):
    use = "use the Object or Generated output of Texture Coordinate, without another object"
    words = f"{what} has no value inside the object: {use}".strip()
    raise RefusedError(f"{material.name}: node {node.name} {words}")


def _is_shader(node):
    return bool(node.outputs) and node.outputs[0].type == "SHADER"


def _upstream(node):
    """The node and all nodes upstream of it."""
    found, waiting = [], [node]
    while waiting:
        one = waiting.pop(0)
        if one not in found:
            found.append(one)
            waiting += [link.from_node for socket in one.inputs for link in socket.links]
    return found


def _tree(material):
    if material.node_tree is None:
        raise RefusedError(f"{material.name} has no nodes: switch Use Nodes on")
    return material.node_tree
