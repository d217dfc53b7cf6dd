# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of layers, the base, and what was imported into them."""

import re

import bpy

from ..base import messages, native
from ..base.messages import CHANNELS, RefusedError
from ..editing import layer_list, matched_colors, metals
from ..properties.layer_properties import LAYER_KINDS
from ..stack_json import coats, phases, profiles
from . import common


class LAMINA_OT_layer_add(bpy.types.Operator):
    bl_idname = "lamina.layer_add"
    bl_label = "Add Layer"
    bl_description = "Add a layer above the selected one"
    bl_options = {"REGISTER", "UNDO"}

    kind: bpy.props.EnumProperty(
        name="Kind", description="What the new layer is", items=LAYER_KINDS, default="medium"
    )

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context)

    def execute(self, context):
        layer_list.add_layer(common.material_of(context), self.kind)
        return {"FINISHED"}


class LAMINA_OT_layer_remove(bpy.types.Operator):
    bl_idname = "lamina.layer_remove"
    bl_label = "Remove Layer"
    bl_description = "Remove the selected layer"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_layer(cls, context)

    def execute(self, context):
        layer_list.remove_layer(common.material_of(context))
        return {"FINISHED"}


class LAMINA_OT_layer_duplicate(bpy.types.Operator):
    bl_idname = "lamina.layer_duplicate"
    bl_label = "Duplicate Layer"
    bl_description = "Put a copy of the selected layer below it"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_layer(cls, context)

    def execute(self, context):
        layer_list.duplicate_layer(common.material_of(context))
        return {"FINISHED"}


class LAMINA_OT_layer_move(bpy.types.Operator):
    bl_idname = "lamina.layer_move"
    bl_label = "Move Layer"
    bl_description = "Move the selected layer towards the light or towards the base"
    bl_options = {"REGISTER", "UNDO"}

    direction: bpy.props.EnumProperty(
        description="Towards the light, or towards the base",
        name="Direction",
        items=(("UP", "Up", "Towards the light"), ("DOWN", "Down", "Towards the base")),
        default="UP",
    )

    @classmethod
    def poll(cls, context):
        return common.has_layer(cls, context)

    def execute(self, context):
        moved = layer_list.move_layer(common.material_of(context), self.direction)
        return {"FINISHED"} if moved else {"CANCELLED"}


class LAMINA_OT_sheet_close(bpy.types.Operator):
    bl_idname = "lamina.sheet_close"
    bl_label = "Add Back Surface"
    bl_description = "Add an interface of IOR 1 at the bottom, as rough as the one above it: the sheet's back"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context)

    def execute(self, context):
        layer_list.close_sheet(common.material_of(context))
        return {"FINISHED"}


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


class LAMINA_OT_coats_replace(bpy.types.Operator):
    bl_idname = "lamina.coats_replace"
    bl_label = "Replace Films"
    bl_description = "Discard the imported films of the flakes and choose another one here"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_layer(cls, context)

    def execute(self, context):
        coats.replace(layer_list.active_layer(common.material_of(context)))
        return {"FINISHED"}


class LAMINA_OT_profile_replace(bpy.types.Operator):
    bl_idname = "lamina.profile_replace"
    bl_label = "Replace Profile"
    bl_description = "Discard the imported depth profile; its top and bottom stay as numbers"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_layer(cls, context)

    def execute(self, context):
        profiles.replace(layer_list.active_layer(common.material_of(context)))
        return {"FINISHED"}


def _color(name, default, tip):
    return bpy.props.FloatVectorProperty(
        name=name, description=tip, subtype="COLOR", size=3, min=0.0, max=1.0, default=default
    )


class LAMINA_OT_match_colors(bpy.types.Operator):
    bl_idname = "lamina.match_colors"
    bl_label = "Match Two Colors"
    bl_description = (
        "Find the albedo and the thickness of this layer from two of its colors. Colors can be picked from "
        "an image beside; dragging the eyedropper takes the mean of a patch"
    )
    bl_options = {"REGISTER", "UNDO"}

    known: bpy.props.EnumProperty(
        name="Known", description="Which colors of the layer are known", items=(
            ("CARD", "Black and White", "Over black and over white, as on a drawdown card of paint makers"),
            ("COATS", "Two Thicknesses", "One coat, and several, on the same surface"),
        ))  # fmt: skip
    over_black: _color("Over Black", (0.2, 0.2, 0.2), "What the layer shows on black, without gloss")
    over_white: _color("Over White", (0.6, 0.6, 0.6), "What the layer shows on white, without gloss")
    white: bpy.props.FloatProperty(
        name="White", description="Reflectance of the white surface", min=0.05, max=1.0, default=0.8
    )
    once: _color("One Coat", (0.3, 0.3, 0.3), "What one coat shows, without gloss")
    twice: _color("Several Coats", (0.4, 0.4, 0.4), "What several coats show, without gloss")
    over: _color("Surface", (0.1, 0.1, 0.1), "The surface without a coat")
    times: bpy.props.FloatProperty(
        name="Coats", description="Thickness of several coats, by that of one",
        min=1.05, max=100.0, default=2.0,
    )  # fmt: skip

    @classmethod
    def poll(cls, context):
        layer = common.has_layer(cls, context) and layer_list.active_layer(common.material_of(context))
        if layer and not matched_colors.can_match(layer):
            cls.poll_message_set("Only a medium that does not change with depth can match colors")
            return False
        return bool(layer) and common.has_native(cls)

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self, confirm_text="Match")

    def draw(self, _context):
        self.layout.row().prop(self, "known", expand=True)
        column = self.layout.column()
        column.use_property_split, column.use_property_decorate = True, False
        card, coats = ("over_black", "over_white", "white"), ("over", "once", "twice", "times")
        for name in card if self.known == "CARD" else coats:
            column.prop(self, name)

    def execute(self, context):
        layer = layer_list.active_layer(common.material_of(context))
        try:
            if self.known == "CARD":
                matched_colors.match(layer, self.over_black, self.over_white, self.white)
            else:
                matched_colors.match_coats(layer, self.once, self.twice, self.over, self.times)
        except (ValueError, native.NativeMissingError) as error:
            return common.refused(self, RefusedError(self._in_words(messages.sentence(error))))
        self.report({"INFO"}, f"“{layer.name}” has the albedo and the thickness of these colors")
        return {"FINISHED"}

    def _in_words(self, text):
        """A sentence of the core with the names of the dialog: 'once[0]' -> 'One Coat (red)'."""
        fields = self.properties.bl_rna.properties

        def named(match):
            name, channel = match.groups()
            return fields[name].name + (f" ({CHANNELS[int(channel)]})" if channel else "")

        names = r"over_black|over_white|once|twice|over(?=\[| = |, )"  # "over" is also a word of sentences
        return re.sub(rf"\b({names})\b(?:\[(\d)\])?", named, text)


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
