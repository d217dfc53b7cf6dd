# SPDX-License-Identifier: GPL-3.0-or-later
"""Places where dust was wiped off, painted by hand: a color attribute of the mesh, or an image."""

import bpy
import numpy as np

from ..base import data_image, editable, unwrap, uv_maps
from ..base.messages import RefusedError
from ..nodes import detail_wiring, thickness
from . import object_dust

ATTRIBUTE = "lamina_wiped"  # a mesh without this attribute has no wiped places
IMAGE_SIZE = 1024
FINE = 20_000  # vertices of a mesh that is fine enough for strokes in an attribute
_MODES = {"attribute": "VERTEX_PAINT", "image": "TEXTURE_PAINT"}


def store(obj):
    """Where a mask of this object is best kept: "attribute" or "image". An image needs a UV map whose faces
    do not overlap."""
    uv_map = uv_maps.find(obj.data, "")
    if len(obj.data.vertices) >= FINE or uv_map is None:
        return "attribute"
    overlaps = not object_dust.unavailable() and not unwrap.fits(obj.data, uv_map.name)
    return "attribute" if overlaps else "image"


def add_mask(obj, material, kept="AUTO"):
    """Make an empty mask of `obj`, and let `material` remove its varying layer where the mask is white.
    `kept`: "attribute", "image", or "AUTO" for the result of `store`. A mask that the material reads already
    is kept. Returns ("attribute" or "image", image or None). Raises RefusedError, with nothing changed."""
    kept = checked(obj, kept)
    uv_map = uv_maps.find(obj.data, "")
    to = detail_wiring.add_detail(material).inputs["Wiped"]
    before = to.links[0].from_node if to.is_linked else None
    if kept == "attribute":
        _color_attribute(obj.data)
        if before is None or before.type != "ATTRIBUTE" or before.attribute_name != ATTRIBUTE:
            node = material.node_tree.nodes.new("ShaderNodeAttribute")
            node.attribute_type, node.attribute_name = "GEOMETRY", ATTRIBUTE
            detail_wiring.wipe_by(material, node, "Fac")
        return kept, None
    if before is not None and before.type == "TEX_IMAGE" and before.image is not None:
        return kept, before.image
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    kept_image = material.pop(thickness.KEPT[thickness.MASK], None)
    node.image, node.extension = kept_image or data_image.plain(f"{obj.name} wiped", IMAGE_SIZE), "EXTEND"
    detail_wiring.wipe_by(material, node, "Color", uv_map.name)
    return kept, node.image


def checked(obj, kept="AUTO"):
    """Where `add_mask` keeps the mask: "attribute" or "image". Raises RefusedError if `obj` cannot have it.
    """
    if obj.type != "MESH" or not obj.data.is_editable:
        raise RefusedError("Dust is wiped off mesh objects of this file: select one")
    editable.require_no_edit_mode(obj)
    if kept == "AUTO":
        kept = store(obj)
    if kept == "image" and uv_maps.find(obj.data, "") is None:
        raise RefusedError(f"{uv_maps.missing(obj, '')}: unwrap it, or keep the mask in an attribute")
    mesh = obj.data
    if kept == "attribute" and ATTRIBUTE in mesh.attributes and ATTRIBUTE not in mesh.color_attributes:
        text = f"{mesh.name} has another kind of attribute named {ATTRIBUTE}: rename or remove it"
        raise RefusedError(text)
    return kept


def require_shown(obj):
    """Raises RefusedError if Blender refuses paint mode on the active object `obj`."""
    if not bpy.ops.object.mode_set.poll():
        raise RefusedError(f"{obj.name} is hidden in the viewport: show it to paint on it")


def start_painting(context, obj, kept, image):
    """Go to paint mode on the active object, with a white brush, and let solid views show the material.
    Raises RefusedError as `require_shown` does, with nothing changed."""
    require_shown(obj)
    for area in context.screen.areas if context.screen is not None else ():
        if area.type == "VIEW_3D" and area.spaces.active.shading.type in ("SOLID", "WIREFRAME"):
            area.spaces.active.shading.type = "MATERIAL"
    tools = context.tool_settings
    if kept == "image":
        tools.image_paint.mode, tools.image_paint.canvas = "IMAGE", image
    bpy.ops.object.mode_set(mode=_MODES[kept])
    paint = tools.image_paint if kept == "image" else tools.vertex_paint
    unified = getattr(paint, "unified_paint_settings", None) or tools.unified_paint_settings
    for owner in (unified, paint.brush):
        if owner is not None:
            owner.color = (1.0, 1.0, 1.0)


def _color_attribute(mesh):
    """The mask as the mesh's active color attribute, black if it is new."""
    if ATTRIBUTE not in mesh.color_attributes:
        found = mesh.color_attributes.new(ATTRIBUTE, "FLOAT_COLOR", "POINT")
        black = np.tile(np.array([0.0, 0.0, 0.0, 1.0], np.float32), len(mesh.vertices))
        found.data.foreach_set("color", black)
    mesh.color_attributes.active_color = mesh.color_attributes[ATTRIBUTE]
