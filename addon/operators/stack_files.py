# SPDX-License-Identifier: GPL-3.0-or-later
"""Layer stacks in JSON files."""

import bpy
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ..base import messages
from ..editing import stack_io
from . import common


class LAMINA_OT_stack_import(bpy.types.Operator, ImportHelper):
    bl_idname = "lamina.stack_import"
    bl_label = "Import Layer Stack"
    bl_description = "Replace the layers and base of this material by those of a JSON file"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".json"
    filter_glob: common.listed("*.json")

    @classmethod
    def poll(cls, context):
        return common.can_edit(cls, context) and common.has_native(cls)

    def execute(self, context):
        try:
            stack_io.import_file(common.material_of(context), bpy.path.abspath(self.filepath))
        except (ValueError, OSError) as error:
            return common.refused(self, error)
        return {"FINISHED"}


class LAMINA_OT_stack_export(bpy.types.Operator, ExportHelper):
    bl_idname = "lamina.stack_export"
    bl_label = "Export Layer Stack"
    bl_description = "Write the layers and base of this material to a JSON file"
    bl_options = {"REGISTER"}

    filename_ext = ".json"
    filter_glob: common.listed("*.json")

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context) and common.has_native(cls)

    def invoke(self, context, event):
        self.filepath = bpy.path.clean_name(common.material_of(context).name) + self.filename_ext
        return super().invoke(context, event)

    def execute(self, context):
        material = common.material_of(context)
        try:
            stack_io.export_file(material, bpy.path.abspath(self.filepath))
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, messages.sentence(error, material))
            return {"CANCELLED"}
        return {"FINISHED"}
