# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences of the user: threads, updates, and the quality and basis of new materials."""

import bpy

from ..kinds.limits import MOST_THREADS
from . import native, package

QUALITIES = (
    ("preview", "Preview", "Fast and coarse: to find the look"),
    ("final", "Final", "Accurate: for the render"),
)

CLOSURE_BASES = (
    ("standard", "Standard", "Few lobes: about as quick to render as a Principled BSDF"),
    ("accurate", "Accurate", "Some twenty lobes: nearer to the exact function, slower to render"),
)


MOVING = {"standard": "moving", "accurate": "moving-accurate"}  # the same with lobes that move with the view


class LaminaPreferences(bpy.types.AddonPreferences):
    bl_idname = package.NAME

    threads: bpy.props.IntProperty(
        name="Threads",
        description="Threads that a bake may use; 0 uses all of the machine",
        default=0,
        min=0,
        max=MOST_THREADS,
    )
    automatic: bpy.props.BoolProperty(
        name="Update by Itself",
        description="Bake a material after each change: coarse while a slider moves, with the material's "
        "quality when it rests and before a render. Otherwise the panel has a button Update",
        default=True,
    )
    default_quality: bpy.props.EnumProperty(
        name="Quality of New Materials",
        description="Bake quality that a material starts with",
        items=QUALITIES,
        default="final",
    )
    default_basis: bpy.props.EnumProperty(
        name="Fit of New Materials",
        description="How closely a new material's lobes follow the exact function",
        items=CLOSURE_BASES,
        default="standard",
    )

    def draw(self, context):
        column = self.layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        if not native.available():
            column.label(text=native.reason(), icon="ERROR")
        column.prop(self, "threads", text="Threads (0 = All)")
        column.prop(self, "automatic")
        column.prop(self, "default_quality")
        column.prop(self, "default_basis")


def threads():
    return _value("threads", 0)


def automatic():
    """True if materials are baked after each change."""
    return _value("automatic", True)


def default_quality():
    return _value("default_quality", "final")


def default_basis():
    return _value("default_basis", "standard")


def shows_anisotropy():
    """True if Cycles samples lobes that move with the view rightly: from Blender 5.0 on. Anisotropic surfaces
    need them."""
    return bpy.app.version >= (5, 0)


def table_basis(basis):
    """The basis of lamina.bake for a material's fit."""
    return MOVING.get(basis, basis) if shows_anisotropy() else basis


def fit_of(basis):
    """The fit of the panel that a basis of lamina.bake belongs to. Files from before there were fits have the
    standard one."""
    return {moving: fit for fit, moving in MOVING.items()}.get(basis, basis) or "standard"


def _value(name, default):
    """The user's preference, or the default where the add-on runs without preferences."""
    entry = bpy.context.preferences.addons.get(package.NAME)
    return getattr(entry.preferences, name) if entry and entry.preferences else default
