# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects for dust to settle on, and the dust that their meshes hold."""

import bmesh
import bpy
import numpy as np
from addon_helpers import built_mesh, icosphere

NAME = "lamina_dust"


def grid(name="Plate", size=1.0, z=0.0, cells=8, material=None):
    """A horizontal square with a UV map, linked to the scene."""

    def build(bm):
        bmesh.ops.create_grid(bm, x_segments=cells, y_segments=cells, size=size, calc_uvs=False)
        uv = bm.loops.layers.uv.new("UVMap")
        for face in bm.faces:
            for loop in face.loops:
                loop[uv].uv = [0.5 + 0.5 * loop.vert.co[axis] / size for axis in range(2)]

    return placed(built_mesh(name, build), name, z, material)


def placed(mesh, name, z=0.0, material=None):
    """An object of this mesh, linked to the scene; it settles dust with few rays."""
    obj = bpy.data.objects.new(name, mesh)
    obj.location.z = z
    bpy.context.scene.collection.objects.link(obj)
    if material is not None:
        mesh.materials.append(material)
    obj.lamina_dust.rays = 64
    return obj


def ball(name="Ball", radius=1.0, smooth=False):
    return placed(icosphere(name, radius, smooth), name)


def alone(name, build, smooth=False):
    """An object that build(bm) makes, on which no other object keeps dust off."""
    obj = placed(built_mesh(name, build, smooth), name)
    obj.lamina_dust.others = False
    return obj


def cube(name="Cube", size=(2.0, 2.0, 2.0)):
    def build(bm):
        bmesh.ops.create_cube(bm, size=1.0)
        bmesh.ops.scale(bm, vec=size, verts=bm.verts)

    return alone(name, build)


def values(obj):
    """float32: the thickness at each vertex or face corner."""
    attribute = obj.data.attributes[NAME]
    assert attribute.data_type == "FLOAT" and attribute.domain in ("POINT", "CORNER")
    found = np.empty(len(attribute.data), np.float32)
    attribute.data.foreach_get("value", found)
    return found
