# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Blender: bakes one material 100 times. Prints data-blocks and memory (kB) after bakes 20 to 100."""

import bpy

material = bpy.data.objects["Cube"].active_material
for number in range(1, 101):
    material.lamina.layers[0].tau = 0.1 + 0.001 * number
    with bpy.context.temp_override(material=material):
        bpy.ops.lamina.bake()
    if number >= 20:
        with open("/proc/self/status", encoding="ascii") as status:
            resident = next(line.split()[1] for line in status if line.startswith("VmRSS"))
        print("bakes:", number, len(bpy.data.images), len(bpy.data.node_groups), resident)
