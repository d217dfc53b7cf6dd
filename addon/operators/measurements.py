# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of measured materials."""

import bpy
from bpy_extras.io_utils import ImportHelper

from ..base import messages, native
from ..editing import match_job, measured
from . import common
from .following import Following


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
    filter_glob: common.listed("*.binary;*.bsdf")

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context) and common.has_native(cls)

    def execute(self, context):
        try:
            warning = measured.read(common.material_of(context), bpy.path.abspath(self.filepath))
        except (ValueError, OSError, native.NativeMissingError) as error:
            return common.refused(self, error)
        if warning:
            self.report({"WARNING"}, warning)
        return {"FINISHED"}


class LAMINA_OT_match_measurement(Following, bpy.types.Operator):
    bl_idname = "lamina.match_measurement"
    bl_label = "Match Measurement"
    bl_description = (
        "Replace the layers and base by the nearest stack to a measured material, from a file of MERL "
        "(.binary) or RGL (.bsdf). Takes up to half a minute; ESC cancels"
    )
    bl_options = {"REGISTER", "UNDO"}

    jobs = match_job
    kept = "Cancelled; the earlier layers are kept"

    filepath: bpy.props.StringProperty(name="File", description="The measured material", subtype="FILE_PATH")
    filter_glob: common.listed("*.binary;*.bsdf")

    @classmethod
    def poll(cls, context):
        if not common.can_edit(cls, context) or not common.has_native(cls):
            return False
        if match_job.running() is not None:
            cls.poll_message_set("A measurement is being matched")
            return False
        return True

    def invoke(self, context, event):
        """Ask for a file, then start the search."""
        if self.filepath:
            return super().invoke(context, event)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        """Called by scripts, which wait for the result, and by the file browser, which starts a search."""
        material = common.material_of(context)
        if not bpy.app.background and context.window is not None and self.options.is_invoke:
            with context.temp_override(material=material):
                bpy.ops.lamina.match_measurement("INVOKE_DEFAULT", filepath=self.filepath)
            return {"CANCELLED"}  # nothing is changed yet: the search makes the one undo step
        try:
            sentence = match_job.match(material, bpy.path.abspath(self.filepath))
        except Exception as error:
            return self.failed(error, context)
        self.report({"INFO"}, sentence)
        return {"FINISHED"}

    def start(self, context):
        material = common.material_of(context)
        return match_job.start(material, bpy.path.abspath(self.filepath)), f"Lamina matches {material.name}"

    def told(self, _material):
        return self._job.sentence

    def failed(self, error, _context, _job=None):
        if not messages.expected(error):
            match_job.log.error("%s failed", self.bl_idname, exc_info=error)
        return common.refused(self, error)
