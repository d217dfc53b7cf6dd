# SPDX-License-Identifier: GPL-3.0-or-later
"""Choose the source of the varying layer's thickness."""

import bpy

from ..base.messages import RefusedError
from ..nodes import thickness
from . import common

ITEMS = (
    ("VALUE", "Value", "One thickness everywhere: the number of the input"),
    ("ATTRIBUTE", "Attribute", "A float attribute of the mesh, such as settled dust"),
    ("IMAGE", "Image", "A float image of optical thickness and a UV map"),
)


class LAMINA_OT_thickness_wire(bpy.types.Operator):
    bl_idname = "lamina.thickness_wire"
    bl_label = "Thickness From"
    bl_description = "Choose the source of the varying layer's thickness; your own nodes stay"
    bl_options = {"REGISTER", "UNDO"}

    source: bpy.props.EnumProperty(
        name="Source", description="What feeds the thickness", items=ITEMS, options={"SKIP_SAVE"}
    )
    name: bpy.props.StringProperty(
        name="Name", description="Name of the attribute or image; empty: the usual attribute, a new image",
        options={"SKIP_SAVE"},
    )
    uv_map: bpy.props.StringProperty(
        name="UV Map", description="UV map of the image; empty: the active one", options={"SKIP_SAVE"}
    )
    replace: bpy.props.BoolProperty(
        name="Replace", description="Replace a link of your own", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return common.has_thickness(cls, context)

    def execute(self, context):
        material = common.material_of(context)
        try:
            thickness.wire_thickness(material, self.source.lower(), self.name, self.uv_map, self.replace)
        except RefusedError as error:
            return common.refused(self, error)
        return {"FINISHED"}
