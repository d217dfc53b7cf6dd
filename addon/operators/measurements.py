# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of measured materials."""

import bpy
from bpy_extras.io_utils import ImportHelper

from ..base import native
from ..editing import measured
from . import common


class LAMINA_OT_measured_base(bpy.types.Operator, ImportHelper):
    bl_idname = "lamina.measured_base"
    bl_label = "Read Measured Material"
    bl_description = (
        "Read the base from a file of MERL (.binary) or RGL (.bsdf). The material keeps the data, and needs "
        "the file no more"
    )
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".binary"
    check_extension = None
    filter_glob: bpy.props.StringProperty(
        description="Files that the browser lists", default="*.binary;*.bsdf", options={"HIDDEN"}
    )

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context) and common.has_native(cls)

    def execute(self, context):
        try:
            warning = measured.read(common.material_of(context), self.filepath)
        except (ValueError, OSError, native.NativeMissingError) as error:
            return common.refused(self, error)
        if warning:
            self.report({"WARNING"}, warning)
        return {"FINISHED"}
