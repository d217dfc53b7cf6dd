# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials with the nodes of the panel Lateral."""

import bpy


def make(addon, stack, output="RELIGHTABLE", scatterings=0):
    """A new material of `stack`. `output`: "RELIGHTABLE", "PORTAL" or "VOLUME"; `scatterings` in a portal's volume, 0
    for the add-on's choice."""
    material = bpy.data.materials.new(output)
    addon.editing.layer_list.add_stack(material)
    addon.editing.stack_io.assign_stack(material, stack)
    material.lamina.lateral_orders = scatterings
    addon.baking.lateral_job.make(material, quality="preview", output=output)
    return material
