# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials whose layers and nodes can be changed, and meshes that can be written.

A library override of a material keeps neither the add-on's properties nor nodes: Blender takes both from the
library when the file is opened again.
"""

from .messages import RefusedError


def is_editable(material):
    return not problem(material)


def problem(material):
    """What a material is that cannot be changed, after "The material is", or ''."""
    if not material.is_editable:
        return "linked from another file: edit it there, or make it local"
    if material.override_library is not None:
        return "a library override, which does not keep changes of layers: make it local"
    if material.is_grease_pencil:
        return "a Grease Pencil material"
    return ""


def require_no_edit_mode(obj):
    """Raises RefusedError for an object in Edit Mode, in which its mesh has no arrays."""
    if obj.mode == "EDIT":
        raise RefusedError(f"{obj.name} is being edited: leave Edit Mode")


def require(material):
    """Raises RefusedError for a material that cannot be changed."""
    found = problem(material)
    if found:
        raise RefusedError(f"The material is {found}")
