# SPDX-License-Identifier: GPL-3.0-or-later
"""Import a layer stack."""

import bpy
from bpy_extras.io_utils import ImportHelper

from ..editing import stack_io
from . import common


class LAMINA_OT_stack_import(bpy.types.Operator, ImportHelper):
    bl_idname = "lamina.stack_import"
    bl_label = "Import Layer Stack"
    bl_description = "Replace the layers and base of this material by those of a JSON file"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".json"
    filter_glob: bpy.props.StringProperty(
        description="Files that the browser lists", default="*.json", options={"HIDDEN"}
    )

    @classmethod
    def poll(cls, context):
        return common.can_edit(cls, context) and common.has_native(cls)

    def execute(self, context):
        try:
            stack_io.import_file(common.material_of(context), self.filepath)
        except (ValueError, OSError) as error:
            return common.refused(self, error)
        return {"FINISHED"}
