# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a layer lies: its place, grain and clouds, and masks painted by hand."""

import bpy

from ..base.messages import RefusedError
from ..editing import layer_list
from ..nodes import detail_wiring, displacement, rest_coordinates, thickness
from ..nodes.group_sockets import COVERAGE
from ..scene import place
from ..settling import dust_job, stamps, wiping
from . import common
from .dust import Dusting

MASKS = (
    ("AUTO", "Automatic", "An attribute on a fine mesh or without a UV map, otherwise an image"),
    ("attribute", "Attribute", "A color attribute of the mesh, as fine as its vertices"),
    ("image", "Image", "A packed image over the UV map"),
)


class LAMINA_OT_place(Dusting, bpy.types.Operator):
    bl_idname = "lamina.place"
    bl_label = "Where"
    bl_description = "Choose where this layer lies"
    bl_options = {"REGISTER", "UNDO"}

    kept = "Cancelled; nothing was changed"

    place: bpy.props.EnumProperty(
        name="Place", description="Where the layer lies", items=place.PLACES, options={"SKIP_SAVE"}
    )

    @classmethod
    def description(cls, _context, properties):
        return next(text for item, _name, text in place.PLACES if item == properties.place)

    @classmethod
    def poll(cls, context):
        if not common.has_layer(cls, context) or not common.has_native(cls):
            return False
        if dust_job.running() is not None:
            cls.poll_message_set("Dust is settling")
            return False
        return common.is_idle(cls)

    def invoke(self, context, event):
        if place.is_quick(common.material_of(context), self.place):
            return self.execute(context)
        return super().invoke(context, event)

    def execute(self, context):
        """Wait for it: scripts, and everything under `blender -b`."""
        try:
            told = place.put(context, common.material_of(context), self.place)
        except Exception as error:
            return self.failed(error, context)
        self.report({"INFO"}, told)
        return {"FINISHED"}

    def start(self, context):
        layer = layer_list.active_layer(common.material_of(context))
        return place.start(context, common.material_of(context), self.place), f"Lamina places “{layer.name}”"

    told = staticmethod(str)


class LAMINA_OT_dust_detail(bpy.types.Operator):
    bl_idname = "lamina.dust_detail"
    bl_label = "Grain and Clouds"
    bl_description = "Vary the thickness by noise, which stays with surfaces that deform; the mean stays"
    bl_options = {"REGISTER", "UNDO"}

    remove: bpy.props.BoolProperty(
        name="Remove", description="Remove the noise and the painted mask", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return common.has_thickness(cls, context)

    def execute(self, context):
        material, thing = common.material_of(context), context.object
        if self.remove:
            displacement.remove(material)
            detail_wiring.remove_detail(material)
            return {"FINISHED"}
        if thing is not None:
            rest_coordinates.store(thing, again=True)
        try:
            detail_wiring.add_detail(material)
        except RefusedError as error:
            return common.refused(self, error)
        return {"FINISHED"}


class LAMINA_OT_displace(bpy.types.Operator):
    bl_idname = "lamina.displace"
    bl_label = "Displace"
    bl_description = "Raise the surface by the varying layer: snow, mud, heavy dust. Needs a fine mesh"
    bl_options = {"REGISTER", "UNDO"}

    height: bpy.props.FloatProperty(
        name="Height (mm)", description="Millimetres for the optical thickness 1",
        default=1e3 * displacement.HEIGHT, min=0.0, soft_max=100.0,
    )  # fmt: skip
    remove: bpy.props.BoolProperty(
        name="Remove", description="Restore the surface", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return common.has_thickness(cls, context)

    def execute(self, context):
        material = common.material_of(context)
        if self.remove:
            displacement.remove(material)
            return {"FINISHED"}
        try:
            displacement.add(material, 1e-3 * self.height)
        except RefusedError as error:
            return common.refused(self, error)
        return {"FINISHED"}


class LAMINA_OT_dust_wipe(bpy.types.Operator):
    bl_idname = "lamina.dust_wipe"
    bl_label = "Wipe by Hand"
    bl_description = "Go to paint mode: white strokes wipe the varying layer off, black strokes bring it back"
    bl_options = {"REGISTER", "UNDO"}

    kept: bpy.props.EnumProperty(name="Kept In", description="Where the painted mask is kept", items=MASKS)
    paint: bpy.props.BoolProperty(name="Paint", description="Go to paint mode at once", default=True)

    @classmethod
    def poll(cls, context):
        if not common.has_thickness(cls, context):
            return False
        return _has_mesh(cls, context)

    def execute(self, context):
        try:
            if self.paint:
                wiping.require_shown(context.object)
            kept, image = wiping.add_mask(context.object, common.material_of(context), self.kept)
        except RefusedError as error:
            return common.refused(self, error)
        if self.paint:
            wiping.start_painting(context, context.object, kept, image)
            self.report({"INFO"}, "White wipes off, black brings back (X swaps the brush's colors)")
        return {"FINISHED"}


class LAMINA_OT_stamp(bpy.types.Operator):
    bl_idname = "lamina.stamp"
    bl_label = "Stamp"
    bl_options = {"REGISTER", "UNDO"}

    stamp: bpy.props.EnumProperty(
        name="Stamp", description="What a stroke leaves", options={"SKIP_SAVE"},
        items=[(key, stamp.name, stamp.description) for key, stamp in stamps.STAMPS.items()],
    )  # fmt: skip

    @classmethod
    def description(cls, _context, properties):
        return stamps.STAMPS[properties.stamp].description

    @classmethod
    def poll(cls, context):
        if not stamps.is_painting(context):
            cls.poll_message_set("Stamps need paint mode")
            return False
        return True

    def execute(self, context):
        try:
            stamps.choose(context, self.stamp)
        except RefusedError as error:
            return common.refused(self, error)
        return {"FINISHED"}


class LAMINA_OT_film_paint(bpy.types.Operator):
    bl_idname = "lamina.film_paint"
    bl_label = "Paint by Hand"
    bl_description = "Go to paint mode: white strokes put the film on, black strokes take it off"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not common.has_thickness(cls, context, COVERAGE) or not _has_mesh(cls, context):
            return False
        wiring = thickness.wiring(common.material_of(context), COVERAGE)
        if wiring.source != "image" or wiring.node.image is None:
            cls.poll_message_set("The coverage is not an image: choose Painted first")
            return False
        return True

    def execute(self, context):
        image = thickness.wiring(common.material_of(context), COVERAGE).node.image
        try:
            wiping.start_painting(context, context.object, "image", image)
        except RefusedError as error:
            return common.refused(self, error)
        self.report({"INFO"}, "White puts the film on, black takes it off (X swaps the brush's colors)")
        return {"FINISHED"}


def _has_mesh(cls, context):
    obj, material = context.object, common.material_of(context)
    if obj is None or obj.type != "MESH" or all(slot.material != material for slot in obj.material_slots):
        cls.poll_message_set(place.WITHOUT)
        return False
    return True
