# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the thickness of the varying layer, and the coverage of the varying interface, come from."""

import bpy

from ..base.messages import RefusedError
from ..nodes import detail_wiring, rest_coordinates, thickness
from ..settling import wiping
from . import common

SOURCES = (
    ("VALUE", "Value", "One thickness everywhere: the number of the input"),
    ("ATTRIBUTE", "Attribute", "A float attribute of the mesh, such as settled dust"),
    ("IMAGE", "Image", "A float image of optical thickness and a UV map"),
)

MASKS = (
    ("AUTO", "Automatic", "An attribute on a fine mesh or without a UV map, otherwise an image"),
    ("attribute", "Attribute", "A color attribute of the mesh, as fine as its vertices"),
    ("image", "Image", "A packed image over the UV map"),
)


class LAMINA_OT_thickness_wire(bpy.types.Operator):
    bl_idname = "lamina.thickness_wire"
    bl_label = "Thickness From"
    bl_description = "Choose the source of the varying layer's thickness or coverage; your own nodes stay"
    bl_options = {"REGISTER", "UNDO"}

    source: bpy.props.EnumProperty(
        name="Source", description="What feeds the thickness", items=SOURCES, options={"SKIP_SAVE"}
    )
    name: bpy.props.StringProperty(
        name="Name",
        description="Name of the attribute or image; empty: the usual attribute, a new image",
        options={"SKIP_SAVE"},
    )
    uv_map: bpy.props.StringProperty(
        name="UV Map", description="UV map of the image; empty: the active one", options={"SKIP_SAVE"}
    )
    replace: bpy.props.BoolProperty(
        name="Replace", description="Replace a link of your own", options={"SKIP_SAVE"}
    )
    input: bpy.props.EnumProperty(
        name="Input",
        description="Which input of the node group",
        items=[(name.upper(), name, f"The input {name}") for name in thickness.INPUTS],
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        return common.has_thickness(cls, context, *thickness.INPUTS)

    def execute(self, context):
        material = common.material_of(context)
        try:
            to = self.input.capitalize()
            thickness.wire_thickness(material, self.source.lower(), self.name, self.uv_map, self.replace, to)
        except RefusedError as error:
            return common.refused(self, error)
        return {"FINISHED"}


class LAMINA_OT_dust_detail(bpy.types.Operator):
    bl_idname = "lamina.dust_detail"
    bl_label = "Grain and Clouds"
    bl_description = "Vary the thickness by noise, which stays with surfaces that deform; the mean stays"
    bl_options = {"REGISTER", "UNDO"}

    remove: bpy.props.BoolProperty(
        name="Remove", description="Remove the noise and the painted mask", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return common.has_thickness(cls, context)

    def execute(self, context):
        material, thing = common.material_of(context), context.object
        if self.remove:
            detail_wiring.remove_detail(material)
            return {"FINISHED"}
        if thing is not None:
            rest_coordinates.store(thing, again=True)
        try:
            detail_wiring.add_detail(material)
        except RefusedError as error:
            return common.refused(self, error)
        return {"FINISHED"}


class LAMINA_OT_dust_wipe(bpy.types.Operator):
    bl_idname = "lamina.dust_wipe"
    bl_label = "Wipe by Hand"
    bl_description = "Go to paint mode: white strokes wipe the varying layer off, black strokes bring it back"
    bl_options = {"REGISTER", "UNDO"}

    kept: bpy.props.EnumProperty(name="Kept In", description="Where the painted mask is kept", items=MASKS)
    paint: bpy.props.BoolProperty(name="Paint", description="Go to paint mode at once", default=True)

    @classmethod
    def poll(cls, context):
        if not common.has_thickness(cls, context):
            return False
        if context.object is None or context.object.type != "MESH":
            cls.poll_message_set("Select a mesh object")
            return False
        return True

    def execute(self, context):
        try:
            kept, image = wiping.add_mask(context.object, common.material_of(context), self.kept)
        except RefusedError as error:
            return common.refused(self, error)
        if self.paint:
            wiping.start_painting(context, context.object, kept, image)
        return {"FINISHED"}
