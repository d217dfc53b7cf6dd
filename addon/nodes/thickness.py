# SPDX-License-Identifier: GPL-3.0-or-later
"""The source of the varying layer's thickness, or of the coverage of the varying interface: the input's own
value, an attribute of the mesh, or an image.

Sources are plain nodes beside the baked group, so that the file renders without the add-on. Nodes made here
are marked and may be replaced. The artist's own nodes are replaced only on request. A node of detail (see
detail_group) may lie between a source and the baked group; sources are then linked to its inputs.
"""

from dataclasses import dataclass

import bpy
import numpy as np

from ..base import data_image, editable, renders
from ..base.messages import RefusedError
from ..kinds.dust import ATTRIBUTE, BACK_ATTRIBUTE
from . import detail_group, node_group
from .group_sockets import COVERAGE, LARGEST
from .side_graph import BACK, FRONT

SOURCES = ("value", "attribute", "image")
TWO_SIDES = "lamina_two_sides"  # marks images whose alpha is the thickness on back faces
IMAGE_SIZE = 1024

MARK = "lamina_thickness"
_LABELS = {
    "attribute": "Thickness attribute",
    "back": "Thickness attribute, back faces",
    "image": "Thickness image",
    "uv": "Thickness UV map",
    "detail": "Dust detail",
    "film": "Film",
    "displacement": "Displacement by the layer",
    "displacement sum": "With the material's own",
    "coverage attribute": "Coverage attribute",
    "coverage image": "Coverage image",
    "coverage uv": "Coverage UV map",
}
INPUTS = {FRONT: "", COVERAGE: "coverage "}  # inputs that a source feeds: before the marks of its nodes
MASK = "Wiped"  # input of the node of detail
# Keys of a material: the last image of an input that something else feeds now, with a layer's name behind it
# if the input is one of INPUTS; the thickness while even
KEPT = {FRONT: "lamina_kept_thickness", COVERAGE: "lamina_kept_coverage", MASK: "lamina_kept_mask"}
EVEN = "lamina_even_thickness"
_MISSING = {
    FRONT: "The material has no thickness input: choose the place of a layer in the panel Where",
    COVERAGE: "The material has no coverage input: choose Painted of an interface in the panel Where",
}


@dataclass(frozen=True)
class Wiring:
    """`source`: one of SOURCES, "custom" for nodes of the artist's own, or "none" without the input.
    `name`: of the attribute, the image, or the artist's node. `socket`: the input that the source feeds, of
    the baked group or of the node of detail before it; `node`: the node linked to it; `uv`: the UV Map node
    of an image."""

    source: str
    name: str = ""
    socket: bpy.types.NodeSocket | None = None
    node: bpy.types.Node | None = None
    uv: bpy.types.Node | None = None


def wiring(material, of=FRONT):
    """The present source of this one of the INPUTS of `material`: a Wiring."""
    sockets, mark = sockets_to_feed(material, of), INPUTS[of]
    if not sockets:
        return Wiring("none")
    socket = sockets[0]
    if not socket.is_linked:
        return Wiring("value", socket=socket)
    node = socket.links[0].from_node
    if node.get(MARK) == f"{mark}attribute":
        return Wiring("attribute", node.attribute_name, socket, node)
    if node.get(MARK) == f"{mark}image":
        links = node.inputs["Vector"].links
        uv = links[0].from_node if links and links[0].from_node.get(MARK) == f"{mark}uv" else None
        return Wiring("image", node.image.name if node.image else "", socket, node, uv)
    return Wiring("custom", node.label or node.name, socket, node)


def wire_thickness(material, source, name="", uv_map="", replace=False, to=FRONT):
    """Feed the thickness input of `material`, a baked one with a varying layer, or with `to` another of the
    INPUTS. Returns its new Wiring.

    source: "value" (the input's own number), "attribute" (`name`: a float attribute of the mesh that holds
    optical thickness; default lamina_dust; 0 for a mesh without it), or "image" (`name`: an image of optical
    thickness, or its name, read by the UV map `uv_map`, default the active one; without a name a new black
    image is made). The image becomes Non-Color, and is packed if no file holds it. Its infinite texels become
    the largest thickness and NaN becomes 0, since Blender 5.2 reads both as 0; such an image is packed too.

    Settled dust lies on one side of a face: front faces read lamina_dust, and back faces lamina_dust_back,
    which is 0 for a mesh without it. With an image of settled dust, back faces read the alpha. Other sources,
    and the coverage, apply to both sides.

    Links of the artist's own are kept, and RefusedError is raised, unless `replace`; their nodes are always
    kept. Raises RefusedError, with nothing changed, for impossible requests.
    """
    renders.stop_previews()
    if source not in SOURCES:
        raise RefusedError(f"source = {source!r}: must be one of {', '.join(SOURCES)}")
    editable.require(material)
    sockets, mark = required_sockets(material, to), INPUTS[to]
    foreign = [link.from_node for socket in sockets for link in socket.links if not link.from_node.get(MARK)]
    if foreign and not replace:
        raise RefusedError(f"{to} is linked to the node “{foreign[0].label or foreign[0].name}”: "
                           "unlink it, or replace the link")
    image = _image(material, name, to) if source == "image" else None
    tree = material.node_tree
    backs = [socket for socket in sockets_to_feed(material, BACK)
             if to == FRONT and (not socket.is_linked or socket.links[0].from_node.get(MARK))]
    for socket in (*sockets, *backs):
        for link in list(socket.links):
            tree.links.remove(link)
    remove_nodes(tree)
    if source == "attribute":
        name = name or ATTRIBUTE
        _feed(sockets, _attribute(tree, sockets[0].node, name, f"{mark}attribute").outputs["Fac"])
        if name == ATTRIBUTE and backs:
            _feed(backs, _attribute(tree, sockets[0].node, BACK_ATTRIBUTE, "back").outputs["Fac"])
    elif source == "image":
        texture = _texture(tree, sockets[0].node, image, uv_map, mark)
        _feed(sockets, texture.outputs["Color"])
        if image.get(TWO_SIDES):
            _feed(backs, texture.outputs["Alpha"])
    return wiring(material, to)


def has_input(material, name=FRONT):
    """True if the material's baked group has this input."""
    return bool(sockets_to_feed(material, name))


def image_problem(image):
    """The reason why an image cannot be read as thickness, in a sentence, or ''."""
    if image is None:
        return "No image: the values are undefined"
    if image.colorspace_settings.name != "Non-Color":
        return f"The image “{image.name}” is read as {image.colorspace_settings.name}: it must be Non-Color"
    return ""


def reconnect(material, name):
    """Links the nodes made here again, to that one of the INPUTS, which was removed and added by bakes."""
    renders.stop_previews()
    if name == COVERAGE:
        sockets = [socket for socket in sockets_to_feed(material, name) if not socket.is_linked]
        for node in material.node_tree.nodes:
            if node.get(MARK) in ("coverage attribute", "coverage image"):
                _feed(sockets, node.outputs["Fac" if node.type == "ATTRIBUTE" else "Color"])
        return
    for node in material.node_tree.nodes:
        if detail_group.is_detail(node) and node.get(MARK):
            for side in (FRONT, BACK):
                if side in node.outputs:
                    idle = [socket for socket in group_sockets(material, side) if not socket.is_linked]
                    _feed(idle, node.outputs[side])
    fronts, backs = ([socket for socket in sockets_to_feed(material, name) if not socket.is_linked]
                     for name in (FRONT, BACK))
    for node in material.node_tree.nodes:
        mark = node.get(MARK)
        if mark == "attribute":
            _feed(fronts, node.outputs["Fac"])
        elif mark == "back":
            _feed(backs, node.outputs["Fac"])
        elif mark == "image":
            _feed(fronts, node.outputs["Color"])
            if node.image is not None and node.image.get(TWO_SIDES):
                _feed(backs, node.outputs["Alpha"])


def remove_nodes(tree):
    """Remove the nodes made here, except those that the artist uses for something else."""
    while True:  # remove a node after the nodes that it feeds
        idle = [node for node in tree.nodes
                if node.get(MARK) and not any(output.is_linked for output in node.outputs)]
        for node in idle:
            tree.nodes.remove(node)
        if not idle:
            return


def group_sockets(material, name):
    """The thickness inputs of the material's baked group, one for each use of the group."""
    nodes = node_group.group_nodes(material)
    return [node.inputs[name] for node in nodes if name in node.inputs]


def sockets_to_feed(material, name=FRONT):
    """The inputs that a source of the thickness feeds: of the baked group, or of the node of detail."""
    found = []
    for socket in group_sockets(material, name):
        before = socket.links[0].from_node if socket.is_linked else None
        if before is not None and detail_group.is_detail(before) and name in before.inputs:
            socket = before.inputs[name]
        if socket not in found:
            found.append(socket)
    return found


def required_sockets(material, name=FRONT):
    """The inputs that a source of that one of the INPUTS feeds. Raises RefusedError if there are none."""
    found = sockets_to_feed(material, name)
    if not found:
        raise RefusedError(_MISSING[name])
    return found


def _feed(sockets, output):
    for socket in sockets:
        socket.id_data.links.new(output, socket)


def marked_node(tree, kind, mark, beside, columns):
    node = tree.nodes.new(kind)
    node[MARK], node.label = mark, _LABELS[mark]
    node.location = (beside.location.x - columns * 280.0, beside.location.y - 160.0)
    node.select = False
    return node


def _attribute(tree, beside, name, mark="attribute"):
    node = marked_node(tree, "ShaderNodeAttribute", mark, beside, 1)
    node.attribute_type, node.attribute_name = "GEOMETRY", name
    return node


def _texture(tree, beside, image, uv_map, mark):
    node = marked_node(tree, "ShaderNodeTexImage", f"{mark}image", beside, 1)
    # Interpolate linearly between texels, without a seam at the border of the map.
    node.image, node.interpolation, node.extension = image, "Linear", "EXTEND"
    read_by(tree, node, beside, uv_map, mark)
    return node


def read_by(tree, texture, beside, uv_map, mark=""):
    """Add the node of the UV map by which an image texture is read."""
    uv = marked_node(tree, "ShaderNodeUVMap", f"{mark}uv", beside, 2)
    uv.location.y = texture.location.y
    uv.uv_map = uv_map
    tree.links.new(uv.outputs[0], texture.inputs["Vector"])


def new_image(material, of=FRONT, value=0.0):
    """A new image of this value everywhere, for this one of the INPUTS."""
    name = f"{material.name} {INPUTS[of] or 'thickness'}".rstrip()
    return data_image.plain(name, IMAGE_SIZE, value, float_buffer=True)


def kept_keys(material):
    """The keys of a material for images that it keeps for later."""
    return [key for key, _ in material.items() if key.startswith(tuple(KEPT.values()))]


def images_read(tree):
    """The images that a material's nodes read as thickness, coverage or a painted mask."""
    return {node.image for node in tree.nodes if MARK in node and node.type == "TEX_IMAGE" and node.image}


def _image(material, wanted, of):
    """The wanted image, set up to hold numbers, or a new black one. Raises RefusedError."""
    if not wanted:
        image = new_image(material, of)
    else:
        image = wanted if isinstance(wanted, bpy.types.Image) else bpy.data.images.get(wanted)
    if image is None:
        raise RefusedError(f"image = {wanted!r}: this file has no image of that name")
    texels = _odd_texels(image)
    if image_problem(image) or texels is not None:
        mine = images_read(material.node_tree)
        if not image.is_editable or image.users - image.use_fake_user > (image in mine):
            problem = image_problem(image) or f"The image “{image.name}” holds texels that are not finite"
            raise RefusedError(f"{problem}, and it is used elsewhere as it is")
        image.colorspace_settings.name = "Non-Color"
    if texels is not None:
        image.pixels.foreach_set(_finite(texels, image.channels))
        image.update()
        image.pack()
    elif image.is_editable and image.packed_file is None and (image.source == "GENERATED" or image.is_dirty):
        image.pack()
    return image


def _odd_texels(image):
    """The texels of an image that holds infinities or NaN, flat; None for any other image."""
    if not image.is_float:
        return None
    texels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(texels)
    return None if np.isfinite(texels).all() else texels


def _finite(texels, channels):
    """Texels with infinity as the largest thickness, and -infinity and NaN as 0; in the alpha they become
    1."""
    colours = np.nan_to_num(texels, nan=0.0, posinf=LARGEST, neginf=0.0).reshape(-1, channels)
    if channels == 4:
        alphas = texels[3::4]
        colours[:, 3] = np.where(np.isfinite(alphas), alphas, 1.0)
    return colours.ravel()
