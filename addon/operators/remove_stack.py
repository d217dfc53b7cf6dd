# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove Lamina from a material."""

import bpy

from ..baking import lateral_job
from ..editing import layer_list
from ..interior import interior_job
from . import common


class LAMINA_OT_remove_stack(bpy.types.Operator):
    bl_idname = "lamina.remove_stack"
    bl_label = "Remove Lamina from Material"
    bl_description = (
        "Remove the layers and the light inside, and restore the material as before; nodes that you have "
        "added stay"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not common.has_lamina(cls, context) or not common.is_idle(cls):
            return False
        material = common.material_of(context)
        if interior_job.running_for(material) or lateral_job.running_for(material):
            cls.poll_message_set("Light inside this material is being computed: cancel it first")
            return False
        return True

    def execute(self, context):
        layer_list.remove_stack(common.material_of(context))
        return {"FINISHED"}
