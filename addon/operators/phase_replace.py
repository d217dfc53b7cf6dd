# SPDX-License-Identifier: GPL-3.0-or-later
"""Replace an imported phase function."""

import bpy

from ..editing import layer_list
from ..stack_json import phases
from . import common


class LAMINA_OT_phase_replace(bpy.types.Operator):
    bl_idname = "lamina.phase_replace"
    bl_label = "Replace Phase Function"
    bl_description = "Discard the imported phase function and choose another one here"
    bl_options = {"REGISTER", "UNDO"}

    base: bpy.props.BoolProperty(
        name="Of the Base", description="Replace that of the base", options={"SKIP_SAVE"}
    )
    bottom: bpy.props.BoolProperty(
        name="Of the Layer's Bottom", description="Replace that of the layer's bottom", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context)

    def execute(self, context):
        material = common.material_of(context)
        owner = material.lamina.base if self.base else layer_list.active_layer(material)
        if owner is None:
            return {"CANCELLED"}
        phases.replace(owner.bottom if self.bottom and not self.base else owner)
        return {"FINISHED"}
