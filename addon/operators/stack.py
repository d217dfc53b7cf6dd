# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers on a material: over what it shows, alone, read again, and removed."""

import bpy

from ..baking import lateral_job
from ..base.messages import RefusedError
from ..editing import layer_list, over_material
from ..interior import interior_job
from ..settling import live_dust
from . import common

WIDTH = 380  # of the dialog


class LAMINA_OT_add_over(bpy.types.Operator):
    bl_idname = "lamina.add_over"
    bl_label = "Add Layers Over This Material"
    bl_description = (
        "Put layers over this material as it is, and bake a preview. Textures, bump, displacement, emission "
        "and alpha are kept. Remove Lamina from Material restores everything"
    )
    bl_options = {"REGISTER", "UNDO"}

    keep_shader: bpy.props.BoolProperty(
        name="Keep My Shader",
        description="The shader stays in use below the layers, with its transmission, subsurface scattering "
        "and sheen, which is approximate. Otherwise the layers lie over its values for color, metal, gloss "
        "and coat",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        if not common.can_edit(cls, context) or not common.has_native(cls) or not common.is_idle(cls):
            return False
        sentence = over_material.problem(common.material_of(context))
        if sentence:
            cls.poll_message_set(sentence)
        return not sentence

    def invoke(self, context, _event):
        """Ask first if something is lost."""
        material = common.material_of(context)
        self.keep_shader = over_material.keeps_shader(material)
        if bpy.app.background or not over_material.not_carried(material, False):
            return self.execute(context)
        return context.window_manager.invoke_props_dialog(
            self, width=WIDTH, title=self.bl_label, confirm_text="Add Layers"
        )

    def draw(self, context):
        material = common.material_of(context)
        column = self.layout.column(align=True)
        if over_material.has_choice(material):
            column.prop(self, "keep_shader")
        for text, icon in over_material.told(material, WIDTH // 7, self.keep_shader):
            column.label(text=text, icon=icon)

    def execute(self, context):
        material = common.material_of(context)
        is_chosen = self.properties.is_property_set("keep_shader")
        try:
            over_material.add(material, self.keep_shader if is_chosen else None)
        except RefusedError as error:
            return common.refused(self, error)
        return common.show_layers(self, context)


class LAMINA_OT_add_stack(bpy.types.Operator):
    bl_idname = "lamina.add_stack"
    bl_label = "Add Lamina Layers"
    bl_description = "Give this material new layers, and show them. Its nodes stay, unlinked"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not common.can_edit(cls, context):
            return False
        if common.material_of(context).lamina.enabled:
            cls.poll_message_set(over_material.TWICE)
            return False
        return True

    def invoke(self, context, _event):
        """A click: add the layers and show them. Scripts, which execute, bake themselves."""
        self.execute(context)
        return common.show_layers(self, context)

    def execute(self, context):
        layer_list.add_stack(common.material_of(context))
        return {"FINISHED"}


class LAMINA_OT_read_again(bpy.types.Operator):
    bl_idname = "lamina.read_again"
    bl_label = "Read Again"
    bl_description = (
        "Take the values and links of the Principled BSDF in the frame Before Lamina, its emission and alpha "
        "too, and bake. The earlier ones at the layers' own node are replaced"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context) and common.has_native(cls) and common.is_idle(cls)

    def execute(self, context):
        material = common.material_of(context)
        try:
            over_material.read_again(material)
        except RefusedError as error:
            return common.refused(self, error)
        return common.show_layers(self, context)


class LAMINA_OT_remove_stack(bpy.types.Operator):
    bl_idname = "lamina.remove_stack"
    bl_label = "Remove Lamina from Material"
    bl_description = (
        "Remove the layers, the light inside, and dust that only this material shows, and restore the "
        "material as before; nodes that you have added stay"
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
        material = common.material_of(context)
        live_dust.clear_of(material)
        layer_list.remove_stack(material)
        return {"FINISHED"}
