# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust that settles on objects."""

import bpy

from ..base import messages, preferences, rendered
from ..base.messages import RefusedError
from ..scene import dusting
from ..settling import dust_job, live_dust, object_dust
from . import common
from .following import Following


class Dusting(Following):
    """Base of the operators that settle dust, see Following."""

    jobs = dust_job
    changes_engine = True

    def failed(self, error, _context, _job=None):
        if not messages.expected(error):
            dust_job.log.error("dust failed", exc_info=error)
        return common.refused(self, error)


class LAMINA_OT_dust_settle(Dusting, bpy.types.Operator):
    bl_idname = "lamina.dust_settle"
    bl_label = "Settle Dust"
    bl_description = (
        "Let dust settle on this object and, with All Selected, on each one that is selected. ESC cancels"
    )
    bl_options = {"REGISTER", "UNDO"}

    kept = "Cancelled; the last dust is kept"

    selected: bpy.props.BoolProperty(
        name="All Selected", description="Every selected mesh, each with its own settings"
    )

    @classmethod
    def poll(cls, context):
        return common.can_be_dusty(cls, context)

    def execute(self, context):
        """Settle and wait for it: scripts, and everything under `blender -b`."""
        objects = self._objects(context)
        try:
            for obj in objects:
                live_dust.leave(obj)
            job = dust_job.DustJob(object_dust.gather_all(context, objects), preferences.threads())
            job.wait()
            job.finish()
        except Exception as error:
            return self.failed(error, context)
        return {"FINISHED"}

    def start(self, context):
        objects = self._objects(context)
        for obj in objects:
            live_dust.leave(obj)
        job = dust_job.start(context, objects)
        return job, f"Dust settles on {objects[0].name if len(objects) == 1 else f'{len(objects)} objects'}"

    def told(self, objects):
        return "; ".join(f"{obj.name}: {obj.lamina_dust.told}" for obj in objects)

    def _objects(self, context):
        if not self.selected:
            return [context.object]
        chosen = [obj for obj in context.selected_objects if obj.type == "MESH"]
        return chosen or [context.object]


class LAMINA_OT_dust_image(bpy.types.Operator):
    bl_idname = "lamina.dust_image"
    bl_label = "Keep Dust in an Image"
    bl_description = (
        "Let the next dust of this object be an image. A UV map named Lamina is unwrapped if the chosen map "
        "is missing or overlaps itself"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.can_be_dusty(cls, context)

    def execute(self, context):
        try:
            object_dust.keep_in_image(context.object)
        except RefusedError as error:
            return common.refused(self, error)
        return {"FINISHED"}


class LAMINA_OT_dust_clear(bpy.types.Operator):
    bl_idname = "lamina.dust_clear"
    bl_label = "Clear Dust"
    bl_description = "Remove the settled dust from this object"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return common.has_dust(cls, context)

    def execute(self, context):
        live_dust.leave(context.object)
        object_dust.clear(context.object)
        return {"FINISHED"}


OBJECTS = (
    ("SELECTED", "Selected", "The selected objects"),
    ("COLLECTION", "Collection", "The objects of the active collection and of those within"),
    ("SCENE", "Scene", "All objects that renders show"),
)


def objects_of(context, which):
    """The objects of the scene that an item of OBJECTS means; without selected ones, all of the scene."""
    shown = rendered.shown(context.view_layer)
    if which == "COLLECTION":
        inside = set(context.collection.all_objects)
        return [obj for obj in shown if obj in inside]
    return (context.selected_objects if which == "SELECTED" else []) or shown


class LAMINA_OT_dust_objects(Dusting, bpy.types.Operator):
    bl_idname = "lamina.dust_objects"
    bl_label = "Dust These Objects"
    bl_description = (
        "Put a layer of dust over the materials of these objects, and let dust settle on all of them. ESC "
        "cancels"
    )
    bl_options = {"REGISTER", "UNDO"}

    kept = "Cancelled; nothing was changed"

    which: bpy.props.EnumProperty(
        name="Objects", description="Which objects", items=OBJECTS, options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return common.can_dust_objects(cls)

    def execute(self, context):
        """Dust and wait for it: scripts, and everything under `blender -b`."""
        try:
            done = dusting.dust(context, objects_of(context, self.which))
        except Exception as error:
            return self.failed(error, context)
        self.report({"INFO"}, str(done))
        return {"FINISHED"}

    def start(self, context):
        return dusting.start(context, objects_of(context, self.which)), "Lamina dusts these objects"

    told = staticmethod(str)


class LAMINA_OT_dust_objects_remove(bpy.types.Operator):
    bl_idname = "lamina.dust_objects_remove"
    bl_label = "Remove Dust from These Objects"
    bl_description = (
        "Remove the settled dust, and the layers that Dust These Objects has put over materials, which then "
        "are as before. A material that other dusty objects share keeps its layer"
    )
    bl_options = {"REGISTER", "UNDO"}

    which: bpy.props.EnumProperty(
        name="Objects", description="Which objects", items=OBJECTS, options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context):
        return common.can_dust_objects(cls)

    def execute(self, context):
        notes = []
        count = dusting.remove(objects_of(context, self.which), notes.append)
        text = "; ".join([f"Dust removed from {count} object{'s' * (count != 1)}", *notes])
        self.report({"WARNING" if notes else "INFO"}, text)
        return {"FINISHED"}
