# SPDX-License-Identifier: GPL-3.0-or-later
"""Sparkle of flakes close by."""

import bpy

from ..base.messages import RefusedError
from ..editing import sparkle
from . import common


class LAMINA_OT_sparkle(bpy.types.Operator):
    bl_idname = "lamina.sparkle"
    bl_label = "Sparkle"
    bl_description = (
        "Show single flakes close by, with the same mean; they fade where a flake is as wide as a pixel of "
        "the scene's camera. Again: fade by the present camera"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not common.has_stack(cls, context):
            return False
        if not sparkle.sockets(common.material_of(context)):
            cls.poll_message_set(sparkle.MISSING)
            return False
        return True

    def execute(self, context):
        try:
            distance = sparkle.add(common.material_of(context), context.scene)
        except RefusedError as error:
            return common.refused(self, error)
        told = f"Flakes sparkle, and fade at distances from the camera above {distance:.3g}"
        if sparkle.has_perspective(context.scene):
            self.report({"INFO"}, told)
        else:
            self.report({"WARNING"}, f"{told}. {sparkle.BY_HAND}")
        return {"FINISHED"}
