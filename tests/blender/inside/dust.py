# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Blender: settles dust on the opened file's cube, and prints the mean thickness of upper and lower faces.

Blender brings an Embree of its own: rays that reached that one would meet nothing, and dust would lie below too."""

import bpy
import numpy as np

cube = bpy.data.objects["Cube"]
bpy.context.view_layer.objects.active = cube
material = cube.active_material
with bpy.context.temp_override(object=cube, material=material):
    bpy.ops.lamina.bake()
    bpy.ops.lamina.dust_settle()
mesh = cube.data
(attribute,) = [one for one in mesh.attributes if one.name.startswith("lamina")]
values = np.empty(len(attribute.data))
attribute.data.foreach_get("value", values)
up = np.array([vertex.co.z > 0.0 for vertex in mesh.vertices])
if attribute.domain == "CORNER":
    up = up[[loop.vertex_index for loop in mesh.loops]]
print("above:", values[up].mean(), "below:", values[~up].mean())
