# SPDX-License-Identifier: GPL-3.0-or-later
"""How light below the surface is shown."""

import bpy

from ..nodes import node_group
from ..properties.material_properties import DEPTHS
from . import common


class LAMINA_OT_depth(bpy.types.Operator):
    bl_idname = "lamina.depth"
    bl_label = "Depth"
    bl_description = "Choose how light below the surface is shown"
    bl_options = {"REGISTER", "UNDO"}

    depth: bpy.props.EnumProperty(
        name="Depth", description="How light below the surface is shown", items=DEPTHS, options={"SKIP_SAVE"}
    )

    @classmethod
    def description(cls, _context, properties):
        return next(text for item, _name, text in DEPTHS if item == properties.depth)

    @classmethod
    def poll(cls, context):
        return common.has_stack(cls, context)

    def execute(self, context):
        choose(common.material_of(context), self.depth)
        return {"FINISHED"}


def choose(material, depth):
    """Show light below the surface of a material with layers by one of DEPTHS. Until the artist chooses an
    output, Exact and Veins compute Lit, which is nearest to the truth."""
    settings, interior = material.lamina, material.lamina.interior
    settings.depth = depth
    if depth == "SURFACE" and node_group.shows_lateral(material) and settings.node_group is not None:
        node_group.connect(material)
    if depth not in ("EXACT", "VEINS"):
        return
    if depth == "EXACT" or interior.source == "LAYERS":
        interior.source = "LAYERS" if depth == "EXACT" else "MARBLE"
    if not interior.is_property_set("output") and not interior.report:
        interior.output = "LIT"
