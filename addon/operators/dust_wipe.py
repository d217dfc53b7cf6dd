# SPDX-License-Identifier: GPL-3.0-or-later
"""Paint the places where dust was wiped off."""

import bpy

from ..base.messages import RefusedError
from ..settling import wiping
from . import common

ITEMS = (
    ("AUTO", "Automatic", "An attribute on a fine mesh or without a UV map, otherwise an image"),
    ("attribute", "Attribute", "A color attribute of the mesh, as fine as its vertices"),
    ("image", "Image", "A packed image over the UV map"),
)


class LAMINA_OT_dust_wipe(bpy.types.Operator):
    bl_idname = "lamina.dust_wipe"
    bl_label = "Wipe by Hand"
    bl_description = "Go to paint mode: white strokes wipe the varying layer off, black strokes bring it back"
    bl_options = {"REGISTER", "UNDO"}

    kept: bpy.props.EnumProperty(name="Kept In", description="Where the painted mask is kept", items=ITEMS)
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
