# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Blender: settles dust on the opened file's cube, and again below a roof. Prints the mean thickness on the
upper face, on the other faces, and on the upper face below the roof.

Blender has an Embree of its own. If rays reached that library, they would meet nothing, and a roof would keep no dust
off."""

import bpy
import numpy as np

cube = bpy.data.objects["Cube"]
mesh, material = cube.data, cube.active_material


def settled():
    """The settled thickness at each face corner."""
    with bpy.context.temp_override(object=cube, material=material):
        bpy.ops.lamina.dust_settle()
    (attribute,) = [one for one in mesh.attributes if one.name.startswith("lamina")]
    assert attribute.domain == "CORNER", attribute.domain
    values = np.empty(len(attribute.data))
    attribute.data.foreach_get("value", values)
    return values


with bpy.context.temp_override(object=cube, material=material):
    bpy.ops.lamina.bake()
is_upper = np.empty(len(mesh.loops), bool)
for polygon in mesh.polygons:
    is_upper[polygon.loop_indices] = polygon.normal.z > 0.5
values = settled()
print("upper:", values[is_upper].mean(), "others:", values[~is_upper].mean())
bpy.ops.mesh.primitive_plane_add(size=20.0, location=(0.0, 0.0, 2.0))
print("roofed:", settled()[is_upper].mean())
