# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the base a named metal."""

import bpy

from ..base import native
from ..editing import metals
from . import common


class LAMINA_OT_metal(bpy.types.Operator):
    bl_idname = "lamina.metal"
    bl_label = "Choose Metal"
    bl_description = "Give the base the colors of this metal; its roughness stays"
    bl_options = {"REGISTER", "UNDO"}

    metal: bpy.props.StringProperty(name="Metal", description="Name of the metal in the table")

    @classmethod
    def description(cls, _context, properties):
        source = metals.source(properties.metal) if native.available() else ""
        return f"{cls.bl_description}.\n{source.rstrip('.')}" if source else cls.bl_description

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context) and common.has_native(cls)

    def execute(self, context):
        try:
            metals.fill(common.material_of(context).lamina.base, self.metal)
        except (ValueError, native.NativeMissingError) as error:
            return common.refused(self, error)
        return {"FINISHED"}
