# SPDX-License-Identifier: GPL-3.0-or-later
"""Conditions for running an operator, and the report of a refusal."""

import bpy

from ..baking import bake_job
from ..base import messages, native
from ..nodes import node_group, thickness
from ..nodes.side_graph import FRONT
from ..properties import migration
from ..settling import dust_job, object_dust


def material_of(context):
    """The material of the Properties editor, or of the active object."""
    material = getattr(context, "material", None)
    if material is None and getattr(context, "object", None) is not None:
        material = context.object.active_material
    return material


def refused(operator, error):
    """Report an error in a sentence; returns what `execute` then returns."""
    text = messages.sentence(error)
    blocks = (*bpy.data.objects, *bpy.data.meshes, *bpy.data.materials)
    is_word = text.split(" ", 1)[0].isalpha() and not any(text.startswith(one.name) for one in blocks)
    operator.report({"ERROR"}, text[0].upper() + text[1:] if is_word else text)
    return {"CANCELLED"}


def listed(pattern):
    """The property of an operator with a file browser for the files that the browser lists."""
    return bpy.props.StringProperty(
        description="Files that the browser lists", default=pattern, options={"HIDDEN"}
    )


def show_layers(operator, context):
    """Bake the changed layers of the material and show them: connects the material's node group, whose tables
    the bake replaces. In a window, the bake runs beside the artist's work, and its own operator reports a
    failure; `operator` reports one before the start. While another bake runs, the layers wait for their
    update. Returns what the calling operator returns."""
    material = material_of(context)
    if material.lamina.node_group is not None and not node_group.is_connected(material):
        node_group.connect(material)
    with context.temp_override(material=material):
        if bpy.ops.lamina.bake.poll():
            try:
                bpy.ops.lamina.bake("INVOKE_DEFAULT")
            except RuntimeError as error:  # Blender raises what the inner operator reports
                operator.report({"ERROR"}, messages.reported(error))
    return {"FINISHED"}


def can_edit(cls, context):
    """True for a material of this file; otherwise sets the reason."""
    material = material_of(context)
    if material is None:
        cls.poll_message_set("No active material")
        return False
    problem = migration.problem(material)
    if problem:
        cls.poll_message_set(f"The material is {problem}")
    return not problem


def has_stack(cls, context):
    if not can_edit(cls, context):
        return False
    if not material_of(context).lamina.enabled:
        cls.poll_message_set("The material has no Lamina layers")
        return False
    return True


def has_lamina(cls, context):
    """True for a material with layers, or with the nodes of an interior alone."""
    if not can_edit(cls, context):
        return False
    settings = material_of(context).lamina
    if not settings.enabled and settings.lateral_group is None:
        cls.poll_message_set("The material has no Lamina layers and no interior")
        return False
    return True


def has_thickness(cls, context, name=FRONT):
    """True if the baked material has this one of thickness.INPUTS; otherwise sets the reason."""
    if not has_stack(cls, context):
        return False
    if not thickness.has_input(material_of(context), name):
        cls.poll_message_set("No layer varies: choose the place of a layer in the panel Where")
        return False
    return True


def has_layer(cls, context):
    if not has_stack(cls, context):
        return False
    if not material_of(context).lamina.layers:
        cls.poll_message_set("There is no layer")
        return False
    return True


def has_native(cls):
    if not native.available():
        cls.poll_message_set(native.reason())
        return False
    return True


def is_idle(cls):
    if bake_job.running() is not None:
        cls.poll_message_set("A bake is running")
        return False
    return True


def can_be_dusty(cls, context):
    """True for a mesh object of this file with a working Embree layer; otherwise sets the reason."""
    sentence = object_dust.problem(context.object)
    if not sentence and dust_job.running() is not None:
        sentence = "Dust is settling"
    if sentence:
        cls.poll_message_set(sentence)
    return not sentence


def can_dust_objects(cls):
    """True if nothing settles or bakes now, and a working Embree layer is here; otherwise sets the reason."""
    sentence = object_dust.unavailable() or ("Dust is settling" if dust_job.running() is not None else "")
    if sentence:
        cls.poll_message_set(sentence)
    return not sentence and is_idle(cls)


def has_dust(cls, context):
    obj = context.object
    is_ours = obj is not None and obj.type == "MESH" and obj.is_editable and obj.data.is_editable
    if not is_ours or not obj.lamina_dust.told:
        cls.poll_message_set("There is no dust on the active object")
        return False
    return True
