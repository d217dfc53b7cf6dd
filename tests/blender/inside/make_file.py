# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Blender: saves a .blend with a cube and a sun. Arguments: the file, and the number of materials with dust."""

import sys

import bpy

path, count = sys.argv[-2], int(sys.argv[-1])
lamina = sys.modules["bl_ext.user_default.lamina"]
for number in range(count):
    material = bpy.data.materials.new(f"Dusty {number}")
    lamina.nodes.node_tree.of(material)
    lamina.editing.layer_list.add_stack(material)
    material.lamina.quality = "preview"
    material.lamina.layers[0].tau = 0.2 + 0.1 * number
    material.use_fake_user = True
bpy.data.objects["Cube"].data.materials.clear()
bpy.data.objects["Cube"].data.materials.append(material)
bpy.data.objects["Light"].data.type = "SUN"
bpy.context.scene.render.engine = "CYCLES"
bpy.ops.wm.save_as_mainfile(filepath=path)
