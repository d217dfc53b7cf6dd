# SPDX-License-Identifier: GPL-3.0-or-later
"""Give a material the layers of a preset."""

import bpy

from ..base import native
from ..editing import presets
from . import common


class LAMINA_OT_preset_apply(bpy.types.Operator):
    bl_idname = "lamina.preset_apply"
    bl_label = "Apply Preset"
    bl_description = (
        "Replace the layers and base of this material by those of the preset. Layers that lie over the "
        "material's own nodes keep their base"
    )
    bl_options = {"REGISTER", "UNDO"}

    preset: bpy.props.StringProperty(name="Preset", description="Its id, or its name if it is your own")
    user: bpy.props.BoolProperty(
        name="My Preset", description="One of your own, not of the library", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return common.can_edit(cls, context) and common.has_native(cls)

    @classmethod
    def description(cls, _context, properties):
        if properties.user or not native.available():
            return cls.bl_description
        try:
            entry = presets.entry(properties.preset)
        except native.NativeMissingError as error:
            return str(error)
        return cls.bl_description if entry is None else f"{cls.bl_description}.\n{entry.source.rstrip('.')}"

    def execute(self, context):
        use = presets.apply_user if self.user else presets.apply
        try:
            use(common.material_of(context), self.preset)
        except (ValueError, OSError, native.NativeMissingError) as error:
            return common.refused(self, error)
        return {"FINISHED"}
