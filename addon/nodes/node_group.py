# SPDX-License-Identifier: GPL-3.0-or-later
"""One node group per material, kept up to date in place.

Artists link the group, add their own nodes and use the group in other materials. So a rebuild changes the
content of the group and its image only. The old content stays until the new one is complete.
"""

import json

import bpy

from ..base import native
from ..kinds.bases import PrincipledBase
from . import before, closure_graph, in_place, links, lut_image, own_nodes, principled, side_graph

GROUP_INPUTS = (
    ("Normal", "NodeSocketVector", "Normal map or bump; empty: the surface's own normal"),
    ("Thickness", "NodeSocketFloat", "Optical thickness of the varying layer, from 0 to what was baked"),
    (
        side_graph.BACK,
        "NodeSocketFloat",
        "Optical thickness of the varying layer on back faces; below 0: as on front faces",
    ),
    ("Base Color", "NodeSocketColor", "Reflectance of the base, linear; what the layers do to it is exact"),
)

VOLUME = before.VOLUME  # output of groups that need a volume, and input of the material's output

LARGEST = 1.0e6  # the panel's largest optical thickness


def build(material, lut):
    """Make or update the node group of `material` from `lut` and link it to the material output.

    Returns the node group. Nothing is changed when it fails. Raises closure_graph.UnknownClosureError,
    NativeMissingError.
    """
    recipe_of = recipe_source()
    before.switch_nodes_on(material)
    group, is_new = _own_group(material)
    old_nodes = list(group.nodes)
    old_images = images_of(old_nodes)
    image = lut_image.create(f"Lamina {material.name}", lut)
    tau = closure_graph.largest_tau(lut)
    old_tau = group.get("lamina_largest_tau")
    colour = closure_graph.base_colour(lut)
    added = _add_missing_sockets(group, tau, colour)
    try:
        closure_graph.draw(group, lut, image, recipe_of)
    except BaseException:
        bpy.data.images.remove(image)
        for socket in added:
            group.interface.remove(socket)
        if is_new:
            bpy.data.node_groups.remove(group)
        raise
    for node in old_nodes:
        group.nodes.remove(node)
    _settle_thickness(group, tau)
    _settle_base_colour(group, colour)
    _replace_images(old_images, image)
    group["lamina_stack_hash"] = lut.header["stack_hash"]
    group["lamina_layout"] = _layout(lut)
    group["lamina_largest_tau"] = -1.0 if tau is None else min(tau, LARGEST)
    group["lamina_shows_back"] = side_graph.shows_back(lut)
    if is_new:
        for node in group_nodes(material):  # nodes with the group that this copied material still shared
            node.node_tree = group
    material.lamina.node_group = group
    before.switch_correction_off(material)
    is_placed = _place(material)
    _follow_thickness(group, old_tau, tau)
    _follow_base_colour(group, colour)
    if not is_placed:
        _carry_to(material, [socket.name for socket in added])
    return group


def update(material, lut):
    """Replace the image in the material's own group by that of `lut`, without changing nodes or links.

    Returns False, with nothing changed, when there is no such group or it was drawn for another layout.
    """
    group = material.lamina.node_group
    if group is None or not group.is_editable or _is_shared(material, group):
        return False
    drawn, wanted = _parse(group.get("lamina_layout")), _parse(_layout(lut))
    if not drawn or {**drawn, "drawn": None} != {**wanted, "drawn": None}:
        return False
    images = images_of(group.nodes)
    if not images or not set(wanted["drawn"]) <= set(drawn["drawn"]):
        return False
    tau, old_tau = closure_graph.largest_tau(lut), group.get("lamina_largest_tau")
    if tau is not None and old_tau != min(tau, LARGEST):
        closure_graph.rescale(group, lut)
        _settle_thickness(group, tau)
        group["lamina_largest_tau"] = min(tau, LARGEST)
        _follow_thickness(group, old_tau, tau)
    _follow_base_colour(group, closure_graph.base_colour(lut))
    _replace_images(images, lut_image.create(f"Lamina {material.name}", lut))
    group["lamina_stack_hash"] = lut.header["stack_hash"]
    return True


def closures(material):
    """The closures of the last bake, in the order of their strips, or None."""
    group = material.lamina.node_group
    layout = _parse(group.get("lamina_layout")) if group is not None else None
    return layout["closures"] if layout else None


def recipe_source():
    """A function from a closure's id to its NodeRecipe. Raises NativeMissingError."""
    lobes = native.require().lobes

    def recipe_of(name):
        try:
            return lobes.recipe(name)
        except (KeyError, ValueError):
            raise closure_graph.UnknownClosureError(
                f"closure {name}: not in this version's dictionary"
            ) from None

    return recipe_of


def group_nodes(material, group=None):
    """The nodes of the material's tree that use `group`, by default the group of the last bake."""
    group = group or material.lamina.node_group
    if material.node_tree is None or group is None:
        return []
    return [node for node in material.node_tree.nodes if node.type == "GROUP" and node.node_tree == group]


def is_connected(material):
    """True if a node of the material's group is connected to the output that Cycles renders, directly or
    not."""
    output = material.node_tree.get_output_node("CYCLES") if material.node_tree else None
    if output is None:
        return False
    group = material.lamina.node_group
    return any(node.type == "GROUP" and node.node_tree == group for node in links.upstream(output))


def connect(material, group=None):
    """Link `group`, by default that of the last bake, to the Surface of the material's output, and the
    group's volume, if there is one, to the Volume. If `group` has none, the volume of the lateral group is
    unlinked. Other nodes are unchanged, and `before` keeps what fed the output. Returns the group node."""
    tree = material.node_tree
    node = (group_nodes(material, group) or [None])[0]
    output = tree.get_output_node("CYCLES") or own_nodes.mark(tree.nodes.new("ShaderNodeOutputMaterial"))
    if node is None:
        node = _add_group_node(material, group or material.lamina.node_group, output)
    before.keep(material, output.inputs["Surface"])
    tree.links.new(in_place.end_of(node), output.inputs["Surface"])
    volume = output.inputs[VOLUME]
    if VOLUME in node.outputs:
        before.keep(material, volume)
        tree.links.new(node.outputs[VOLUME], volume)
    elif volume.is_linked and volume.links[0].from_node in _lateral_nodes(material):
        tree.links.remove(volume.links[0])
        fed = before.kept(tree, VOLUME)
        if fed is not None:
            links.connect(fed, volume)
    return node


def _lateral_nodes(material):
    group = material.lamina.lateral_group
    return [] if group is None else group_nodes(material, group)


def remove(material):
    """Restore the material's tree as it was before Lamina, and remove Lamina's groups and their images if
    they have no other users."""
    groups = (material.lamina.node_group, material.lamina.lateral_group)
    before.restore(material)
    material.lamina.node_group = material.lamina.lateral_group = None
    for group in groups:
        if group is None or group.library is not None or group.users:
            continue
        images = images_of(group.nodes)
        bpy.data.node_groups.remove(group)
        for image in images:
            if image.users == 0:
                bpy.data.images.remove(image)


def _own_group(material):
    """(group, True if it is new). If a copied material shares its group with the original, the copy gets a
    new one."""
    group = material.lamina.node_group
    if group is not None and group.is_editable and not _is_shared(material, group):
        return group, False
    return bpy.data.node_groups.new(f"Lamina {material.name}", "ShaderNodeTree"), True


def _is_shared(material, group):
    return any(other != material and other.lamina.node_group == group for other in bpy.data.materials)


def _layout(lut):
    """Everything that the group's nodes depend on, as text: between tables of the same layout only the image
    differs."""
    axes = lut.header["axes"]
    layout = {
        "closures": lut.header["closures"],
        "drawn": closure_graph.used_closures(lut),
        "sides": lut.header["sides"],
        "turns over": side_graph.turns_over(lut),
        "size": [axes["view"]["count"], axes["tau"]["count"]],
    }
    return json.dumps(layout)


def _parse(layout):
    try:
        return json.loads(layout) if layout else None
    except ValueError:
        return None


def _place(material):
    """Make and link a first node of `group` in the material's tree, over the shader of the material if the
    stack's base is that shader; an existing node is unchanged. Returns True if a node was linked."""
    if group_nodes(material) and material.node_tree.get_output_node("CYCLES") is not None:
        return False
    is_over = material.lamina.base.kind == PrincipledBase.kind
    replaced = principled.find(material) if is_over else None
    node = connect(material)
    if replaced is not None:
        in_place.put(material, node, replaced)
    return True


def _carry_to(material, names):
    """Link new sockets of the group, `names`, to what feeds the Principled BSDF that the layers lie over."""
    replaced = principled.of(before.source(material.node_tree))
    if replaced is not None and material.lamina.base.kind == PrincipledBase.kind:
        for node in group_nodes(material):
            in_place.carry(node, replaced, [name for name in names if name in in_place.CARRIED])


def _add_group_node(material, group, output):
    node = own_nodes.mark(material.node_tree.nodes.new("ShaderNodeGroup"))
    node.node_tree = group
    node.label = "Lamina"
    node.select = False
    node.width = 180.0
    node.location = (output.location.x - 240.0, output.location.y + 160.0)
    return node


def _sockets(group, in_out):
    return {
        item.name: item
        for item in group.interface.items_tree
        if item.item_type == "SOCKET" and item.in_out == in_out
    }


def _add_missing_sockets(group, tau, colour):
    """Adds missing sockets and returns them."""
    wanted_by = {side_graph.FRONT: tau, side_graph.BACK: tau, "Base Color": colour}
    unwanted = {name for name, value in wanted_by.items() if value is None}
    if "Shader" not in _sockets(group, "OUTPUT"):
        group.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    added = []
    for name, kind, description in GROUP_INPUTS:
        if name in _sockets(group, "INPUT") or name in unwanted:
            continue
        socket = group.interface.new_socket(name, in_out="INPUT", socket_type=kind, description=description)
        socket.hide_value = name == "Normal"
        if name == "Thickness":
            socket.default_value = min(tau, LARGEST)
        if name == side_graph.BACK:
            socket.default_value = side_graph.AS_FRONT
        if name == "Base Color":
            socket.default_value = (*colour, 1.0)
        added.append(socket)
    return added


def _settle_thickness(group, tau):
    """Ranges and defaults of the sockets for thickness, or no such sockets when nothing varies."""
    sockets = _sockets(group, "INPUT")
    for name, lowest in ((side_graph.FRONT, 0.0), (side_graph.BACK, side_graph.AS_FRONT)):
        socket = sockets.get(name)
        if socket is None:
            continue
        if tau is None:
            group.interface.remove(socket)
            continue
        socket.min_value, socket.max_value = lowest, min(tau, LARGEST)
        socket.default_value = lowest if lowest < 0.0 else socket.max_value


def _follow_thickness(group, old, new):
    """A new Thickness input starts at the baked maximum. An input at the old maximum follows a new maximum;
    other values are kept."""
    if new is None:
        return
    for material in bpy.data.materials:
        for node in material.node_tree.nodes if material.node_tree else ():
            if node.type != "GROUP" or node.node_tree != group or node.inputs["Thickness"].is_linked:
                continue
            socket = node.inputs["Thickness"]
            untouched = old is None or old < 0.0 or abs(socket.default_value - old) <= 1.0e-6 * old
            if untouched:
                socket.default_value = min(new, LARGEST)


def _settle_base_colour(group, colour):
    """Default of the Base Color socket; removes the socket if the base has no texture."""
    socket = _sockets(group, "INPUT").get("Base Color")
    if socket is not None and colour is None:
        group.interface.remove(socket)


def _follow_base_colour(group, colour):
    """A new Base Color input starts at the stack's reflectance; an unchanged input follows a new
    reflectance."""
    socket = _sockets(group, "INPUT").get("Base Color")
    if socket is None or colour is None:
        return
    old, socket.default_value = tuple(socket.default_value), (*colour, 1.0)
    for material in bpy.data.materials:
        for node in material.node_tree.nodes if material.node_tree else ():
            if node.type == "GROUP" and node.node_tree == group and not node.inputs["Base Color"].is_linked:
                given = node.inputs["Base Color"]
                if tuple(given.default_value) in (old, (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)):
                    given.default_value = (*colour, 1.0)


def images_of(nodes):
    """The images that the nodes read."""
    return {node.image for node in nodes if node.type == "TEX_IMAGE" and node.image is not None}


def _replace_images(old_images, image):
    """Put the new image in the old one's place everywhere, then remove the old one.

    A new datablock is used instead of new pixels, so that undo restores the old pixels, and because Cycles
    reads the pixels of a datablock only once (measured with persistent data, bpy 4.5).
    """
    for old in old_images:
        if old.library is None and old != image:
            name = old.name
            old.user_remap(image)
            bpy.data.images.remove(old)
            image.name = name
