# SPDX-License-Identifier: GPL-3.0-or-later
"""Output sockets of material nodes whose values depend only on the position inside an object."""

from ..base.messages import RefusedError

# Nodes whose values depend on a surface, a ray or the scene, and not only on a position inside the object.
_ELSEWHERE = {
    "NEW_GEOMETRY",
    "OBJECT_INFO",
    "CAMERA",
    "LIGHT_PATH",
    "LIGHT_FALLOFF",
    "MATERIAL_RAYCAST",  # from Blender 5.1 on
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
    "DISPLACEMENT",
    "VECTOR_DISPLACEMENT",
    "SCRIPT",  # can read all of the above
    "SHADERTORGB",
    "TEX_POINTDENSITY",
}
# What Cycles takes for a texture's Vector without a link. Other textures take Generated, or a constant.
_WITHOUT_VECTOR = {
    "TEX_IMAGE": "the UV map",
    "TEX_ENVIRONMENT": "the place in the scene",
    "TEX_IES": "the direction of the ray",
}
_COORDINATES = ("Object", "Generated")
_COLOURS = ("Base Color", "Color", "Density")
_USE = "use the Object or Generated output of Texture Coordinate, without another object"


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
    for one in _feeding(found):
        _check(*one, material)
    return found


def _check(node, output, groups, material):
    if node.type == "TEX_COORD":
        if output.name not in _COORDINATES:
            _refuse(node, material, f"gives {output.name}, which has no value inside the object")
        if output.name == "Object" and node.object is not None:
            what = f"the coordinates of {node.object.name}"
            _refuse(node, material, f"gives {what}, which has no value inside the object")
    elif node.type in _ELSEWHERE:
        _refuse(node, material, "has no value inside the object")
    elif node.type in _WITHOUT_VECTOR and not _linked(node.inputs["Vector"], groups):
        _refuse(node, material, f"has no Vector and so takes {_WITHOUT_VECTOR[node.type]}")
    elif node.type == "TEX_IMAGE" and node.projection == "BOX":
        what = "projects by Box, along the surface's normal, which has no value inside the object"
        _refuse(node, material, what, "choose another projection")
    elif node.type == "VECT_TRANSFORM" and node.convert_from != node.convert_to:
        spaces = f"{node.convert_from.lower()} to {node.convert_to.lower()}"
        _refuse(node, material, f"converts from {spaces} space, but an interior moves with its object")


def _refuse(node, material, what, instead=_USE):
    raise RefusedError(f"{material.name}: node {node.name} {what}: {instead}")


def _feeding(socket):
    """All (node, output, groups) whose values reach an output socket of a material's tree, also in groups.
    `groups`: the group nodes around the node, outermost first."""
    found, waiting = [], _behind(socket, ())
    while waiting:
        one = waiting.pop(0)
        if one not in found:
            found.append(one)
            node, _, groups = one
            waiting += [more for socket in node.inputs for more in _linked(socket, groups)]
    return found


def _linked(socket, groups):
    """The (node, output, groups) linked to an input socket. The links that are skipped have no effect."""
    if socket.is_unavailable:
        return []
    links = [link for link in socket.links if link.is_valid and not link.is_muted]
    return [one for link in links for one in _behind(link.from_socket, groups)]


def _behind(output, groups):
    """The (node, output, groups) behind an output socket, which may belong to a reroute, a muted node, a
    group, or the inputs of a group."""
    node = output.node
    if node.type == "REROUTE":
        return _linked(node.inputs[0], groups)
    if node.type == "GROUP_INPUT":
        outer = _same(groups[-1].inputs, output) if groups else None
        return _linked(outer, groups[:-1]) if outer else []
    if node.mute:
        passed = [link.from_socket for link in node.internal_links if link.to_socket == output]
        return [one for socket in passed for one in _linked(socket, groups)]
    if node.type == "GROUP":
        nodes = node.node_tree.nodes if node.node_tree else ()
        last = next((one for one in nodes if one.type == "GROUP_OUTPUT" and one.is_active_output), None)
        inner = _same(last.inputs, output) if last else None
        return _linked(inner, (*groups, node)) if inner else []
    return [(node, output, groups)]


def _same(sockets, socket):
    return next((one for one in sockets if one.identifier == socket.identifier), None)


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
