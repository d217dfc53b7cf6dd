# SPDX-License-Identifier: GPL-3.0-or-later
"""One node group per material, kept up to date in place.

Artists link the group, add their own nodes and use the group in other materials. So a rebuild changes the
content of the group and its image only. The old content stays until the new one is complete.
"""

import json

import bpy

from ..base import data_image, image_removal, native, renders
from ..kinds.bases import PrincipledBase
from ..kinds.table import PRINCIPLED, Strip, strips_of
from . import (
    base_graph,
    before,
    closure_graph,
    group_sockets,
    in_place,
    links,
    lut_image,
    node_tree,
    own_nodes,
    principled,
    side_graph,
    sparkle_graph,
    table_view,
    thin_sheet,
)
from .group_sockets import LARGEST

VOLUME = before.VOLUME  # output of groups that need a volume, and input of the material's output


def build(material, lut):
    """Make or update the node group of `material` from `lut` and link it to the material output.

    Returns the node group. Nothing is changed when it fails. Raises closure_graph.UnknownClosureError,
    NativeMissingError.
    """
    renders.stop_previews()
    recipe_of, tables = recipe_source(), lut_image.tables(lut, few_closures)
    before.switch_nodes_on(material)
    group, is_new = _own_group(material)
    old_nodes = list(group.nodes)
    old_images = images_of(old_nodes)
    image = lut_image.create(f"Lamina {material.name}", tables)
    tau = table_view.largest_tau(lut)
    old_tau = group.get("lamina_largest_tau")
    base = _inputs(material, lut)
    added = group_sockets.add_missing(group, tau, base)
    is_thin = thin_sheet.add_missing(group, lut)
    try:
        closure_graph.draw(group, tables, image, recipe_of)
    except BaseException:
        image_removal.remove(image)
        group_sockets.remove(group, added)
        if is_thin:
            thin_sheet.remove(group)
        if is_new:
            bpy.data.node_groups.remove(group)
        raise
    for node in old_nodes:
        group.nodes.remove(node)
    group_sockets.settle(group, tau, base)
    if not thin_sheet.is_sheet(lut):
        thin_sheet.remove(group)
    _replace_images(group, old_images, image)
    _note_origin(group, lut)
    group["lamina_layout"] = json.dumps(_layout(tables))
    group["lamina_largest_tau"] = -1.0 if tau is None else min(tau, LARGEST)
    group["lamina_shows_back"] = side_graph.shows_back(lut)
    if is_new:
        for node in group_nodes(material):  # nodes with the group that this copied material still shared
            node.node_tree = group
    material.lamina.node_group = group
    before.switch_correction_off(material)
    is_placed = _place(material)
    group_sockets.follow_thickness(group, old_tau, tau)
    group_sockets.follow_base(group, base, added)
    if is_placed or not is_new:  # the group of a copied material is new, and its node has its links already
        for node in group_nodes(material):
            in_place.feed(material, node, *(() if is_placed else (added,)))
    kind = material.lamina.base.kind
    if is_placed or group.get("lamina_base_kind", kind) != kind:
        for node in group_nodes(material)[:1]:
            in_place.settle_after(material, node)
    group["lamina_base_kind"] = kind
    base_graph.keep_facets(group, _replaced(material))
    for node in group_nodes(material):
        thin_sheet.connect(material, node)
    return group


def update(material, lut):
    """Replace the image in the material's own group by that of `lut`, without changing nodes or links.

    Returns False, with nothing changed, when there is no such group or it was drawn for another layout.
    """
    renders.stop_previews()
    group = material.lamina.node_group
    if group is None or not group.is_editable or _is_shared(material, group):
        return False
    tables = lut_image.tables(lut, few_closures)
    drawn, wanted = _parse(group.get("lamina_layout")), _layout(tables)
    if not drawn or {**drawn, "drawn": None} != {**wanted, "drawn": None}:
        return False
    images = images_of(group.nodes)
    if not images or not set(wanted["drawn"]) <= set(drawn["drawn"]):
        return False
    base = _inputs(material, lut)
    if (group_sockets.TANGENT in base) != (group_sockets.TANGENT in group_sockets.named(group, "INPUT")):
        return False
    tau, old_tau = table_view.largest_tau(lut), group.get("lamina_largest_tau")
    if tau is not None and old_tau != min(tau, LARGEST):
        table_view.rescale(group, tables[0])
        group_sockets.settle(group, tau, base)
        group["lamina_largest_tau"] = min(tau, LARGEST)
        group_sockets.follow_thickness(group, old_tau, tau)
    group_sockets.follow_base(group, base)
    _replace_images(group, images, lut_image.create(f"Lamina {material.name}", tables))
    base_graph.keep_facets(group, _replaced(material))
    _note_origin(group, lut)
    return True


def _inputs(material, lut):
    """{name: default} of the group's inputs for `lut`, see group_sockets.of_table, with the tangent of a
    Principled BSDF whose own facets the group shows."""
    base = group_sockets.of_table(lut)
    if Strip(role=PRINCIPLED) not in strips_of(lut.header):
        return base
    node = _replaced(material) or principled.find(material)
    return base | ({group_sockets.TANGENT: None} if node is not None and principled.has_tangent(node) else {})


def _replaced(material):
    """The Principled BSDF that the layers have replaced, or None."""
    return principled.of(before.source(material.node_tree))


def _note_origin(group, lut):
    """Note on the group which stack it shows and which Lamina baked it, readable without the add-on."""
    group["lamina_stack_hash"] = lut.header["stack_hash"]
    group["lamina_version"] = lut.header.get("version", "")


def is_whole(material):
    """True if the material's tree has the group of the last bake, and the group's tables are packed."""
    group = material.lamina.node_group
    if group is None or not group_nodes(material):
        return False
    images = images_of(group.nodes)
    return bool(images) and all(image.packed_file is not None for image in images)


def has_tables(group):
    """True if the group reads tables, and each is packed or has its file."""
    images = images_of(group.nodes)
    return bool(images) and not any(map(data_image.is_lost, images))


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
            raise closure_graph.UnknownClosureError(f"closure {name}: not in this version's dictionary"
            ) from None

    return recipe_of


def few_closures(lut):
    """The closures of `lut` for Eevee. Raises closure_graph.UnknownClosureError, NativeMissingError."""
    try:
        return native.part("baking.table.real_time").few_closures(lut)
    except (KeyError, ValueError) as error:
        raise closure_graph.UnknownClosureError(error.args[0]) from None


def group_nodes(material, group=None):
    """The nodes of the material's tree that use `group`, by default the group of the last bake."""
    group = group or material.lamina.node_group
    if material.node_tree is None or group is None:
        return []
    return [node for node in material.node_tree.nodes if node.type == "GROUP" and node.node_tree == group]


def is_connected(material, group=None):
    """True if a node of `group`, by default that of the last bake, that is not muted is connected to the
    output that Cycles renders, directly or not. It may be inside a group of the artist's."""
    is_on = material.node_tree is not None and node_tree.is_on(material)
    output = material.node_tree.get_output_node("CYCLES") if is_on else None
    if output is None:
        return False
    group = group or material.lamina.node_group
    around = own_nodes.around(material, group)
    shown = (node for node in links.upstream(output) if node.type == "GROUP" and not node.mute)
    return any(node.node_tree == group or node in around for node in shown)


def unreachable(material):
    """Why no source can be linked to the inputs of the group of the last bake, in a sentence, or ''."""
    group = material.lamina.node_group
    around = own_nodes.around(material, group) if group and not group_nodes(material) else []
    if not around:
        return ""
    return f"The layers' node is inside your group “{around[0].node_tree.name}”: ungroup it first"


def shows_lateral(material):
    """True if the material's lateral group is connected to that output."""
    group = material.lamina.lateral_group
    return group is not None and is_connected(material, group)


def connect(material, group=None):
    """Link `group`, by default that of the last bake, to the Surface of the material's output, and the
    group's volume, if there is one, to the Volume. If `group` has none, the volume of the lateral group is
    unlinked. Other nodes are unchanged, and `before` keeps what fed the output. Returns the group node."""
    renders.stop_previews()
    tree = node_tree.of(material)
    node = (group_nodes(material, group) or [None])[0]
    if group is None:
        before.restore_sampling(material)  # light from inside an object no longer shines
    output = tree.get_output_node("CYCLES") or own_nodes.mark(tree.nodes.new("ShaderNodeOutputMaterial"))
    if node is None:
        node = _add_group_node(material, group or material.lamina.node_group, output)
    node.mute = False
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
    thin_sheet.connect(material, node)
    return node


def _lateral_nodes(material):
    group = material.lamina.lateral_group
    return [] if group is None else group_nodes(material, group)


def remove(material):
    """Restore the material's tree as it was before Lamina, and remove Lamina's groups and their images if
    they have no other users."""
    renders.stop_previews()
    groups = (material.lamina.node_group, material.lamina.lateral_group)
    before.restore(material)
    material.lamina.node_group = material.lamina.lateral_group = None
    for group in groups:
        if group is None or group.library is not None or group.users:
            continue
        images = images_of(group.nodes)
        bpy.data.node_groups.remove(group)
        image_removal.remove_unused(images)


def _own_group(material):
    """(group, True if it is new). If a copied material shares its group with the original, the copy gets a
    new one."""
    group = material.lamina.node_group
    if group is not None and group.is_editable and not _is_shared(material, group):
        return group, False
    return bpy.data.node_groups.new(f"Lamina {material.name}", "ShaderNodeTree"), True


def _is_shared(material, group):
    return any(other != material and other.lamina.node_group == group for other in bpy.data.materials)


def _layout(tables):
    """Everything that the group's nodes depend on: between tables of the same layout only the image
    differs."""
    first, *more = tables
    lut = first.lut
    axes = lut.header["axes"]
    layout = {
        "closures": lut.header["closures"],
        "eevee": [strip.name for strip in first.eevee.strips],
        "drawn": closure_graph.used_closures(lut),
        "sides": lut.header["sides"],
        "turns over": side_graph.turns_over(lut),
        "size": [axes["view"]["count"], axes["tau"]["count"], table_view.roughness_rows(lut)],
    } | ({"azimuth": axes["azimuth"]} if "azimuth" in axes else {})
    layout |= {"sparkle": True} if sparkle_graph.is_offered(lut) else {}
    return layout | {"uncovered": _layout(more)} if more else layout


def _parse(layout):
    try:
        return json.loads(layout) if layout else None
    except ValueError:
        return None


def _place(material):
    """Make and link a first node of `group` in the material's tree, in the place of the Principled BSDF that
    the layers lie over; an existing node is unchanged, also inside a group of the artist's. Returns True if
    there was none."""
    is_there = bool(group_nodes(material)) or is_connected(material)
    if is_there and material.node_tree.get_output_node("CYCLES") is not None:
        return False
    replaced = principled.find(material) if material.lamina.base.kind == PrincipledBase.kind else None
    node = connect(material)
    if replaced is not None:
        in_place.put(material, node, replaced)
    return True


def _add_group_node(material, group, output):
    node = own_nodes.mark(material.node_tree.nodes.new("ShaderNodeGroup"))
    node.node_tree = group
    node.label = "Lamina"
    node.select = False
    node.width = 180.0
    node.location = (output.location.x - 240.0, output.location.y + 160.0)
    return node


def images_of(nodes):
    """The images that the nodes read."""
    return {node.image for node in nodes if node.type == "TEX_IMAGE" and node.image is not None}


def _replace_images(group, old_images, image):
    """Put the new image in the old one's place in `group`, then remove the old one, unless the artist's own
    copy of the group still reads it.

    A new datablock is used instead of new pixels, so that undo restores the old pixels, and because Cycles
    reads the pixels of a datablock only once (measured with persistent data, bpy 4.5).
    """
    for node in group.nodes:
        if node.type == "TEX_IMAGE" and node.image in old_images:
            node.image = image
    for old in old_images:
        if old.library is None and old != image and not old.users:
            image_removal.replace(old, image)
