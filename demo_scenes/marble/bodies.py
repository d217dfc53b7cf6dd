# SPDX-License-Identifier: GPL-3.0-or-later
"""The bodies: a slab, and a cup with thin walls, a foot and a handle. Closed meshes, in mm."""

from dataclasses import dataclass
from pathlib import Path

import bpy
import mesh_file
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

SLAB_WIDTH, SLAB_THICKNESS = 40.0, 12.0
FACE_STEP = 0.3  # mm between vertices
CUP = Path(__file__).resolve().parent / "cup.ply.gz"  # in mm; tools/sculpting made it
MAPPED = 1.125  # side of the mapped square, relative to the picture
UNWRAPPED = 0.43  # share of the image that an automatic UV map fills, about


@dataclass(frozen=True, eq=False)
class Body:
    """A closed mesh with outward normals, and the picture of the body: `towards_eye` (unit vector), the `middle` of the
    picture (mm) and its `width` (mm). `voxels`: along the longest side. `mapped`: whether the UV map holds the picture
    alone, seen from above; otherwise the extension unwraps the body."""

    name: str
    vertices: np.ndarray  # (n, 3), mm
    faces: np.ndarray  # (m, 3) or (m, 4)
    towards_eye: Vector
    middle: Vector
    width: float
    voxels: int
    mapped: bool = False

    def texels(self, size):
        """Texels along an edge of the images for a picture of `size` pixels: about as large as pixels."""
        if self.mapped:
            return round(MAPPED * size)
        triangles = self.triangles()
        edges = self.vertices[triangles[:, 1:]] - self.vertices[triangles[:, :1]]
        area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1).sum()
        return round(np.sqrt(2.0 * area / UNWRAPPED) * size / self.width)

    def triangles(self):
        """(k, 3) indices of vertices."""
        corners = range(2, self.faces.shape[1])
        return np.concatenate([self.faces[:, [0, k - 1, k]] for k in corners])

    def tree(self):
        """For rays in Python."""
        return BVHTree.FromPolygons(self.vertices.tolist(), self.triangles().tolist(), all_triangles=True)

    def mesh(self):
        """A Blender mesh with smooth faces."""
        mesh = bpy.data.meshes.new(self.name)
        mesh.from_pydata(self.vertices, [], self.faces.tolist())
        mesh.shade_smooth()
        if self.mapped:
            self._map(mesh)
        return mesh

    def _map(self, mesh):
        """The upper face's UV map, in which the picture with a margin fills the image; other faces have no area."""
        corners = self.vertices[self.faces]
        uvs = 0.5 + (corners[..., :2] - np.array(self.middle)[:2]) / (MAPPED * self.width)
        uvs[~(corners[..., 2] == corners[..., 2].max()).all(axis=1)] = 0.0
        mesh.uv_layers.new(name="above").uv.foreach_set("vector", uvs.astype(np.float32).ravel())


def slab(step=FACE_STEP):
    """A slab with its upper face at z = 0. The eye looks straight down at the middle half."""
    half = 0.5 * SLAB_WIDTH
    count = 2 * round(half / step)
    line = np.linspace(-half, half, count + 1)
    top_points = np.array([(x, y, 0.0) for y in line for x in line])
    at = np.arange((count + 1) ** 2).reshape(count + 1, -1)
    top = np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], axis=-1).reshape(-1, 4)
    # The edge of the face, counter-clockwise, and the same edge below.
    loop = np.concatenate([at[0, :-1], at[:-1, -1], at[-1, :0:-1], at[:0:-1, 0]])
    below = top_points.copy()
    below[:, 2] = -SLAB_THICKNESS
    other = len(top_points)
    sides = np.stack([loop, loop + other, np.roll(loop, -1) + other, np.roll(loop, -1)], axis=1)
    quads = np.concatenate([top, top[:, ::-1] + other, sides])
    return Body("slab", np.concatenate([top_points, below]), quads, Vector((0.0, 0.0, 1.0)), Vector((0.0, 0.0, 0.0)),
                0.4 * SLAB_WIDTH, 200, mapped=True)


def cup():
    """A cup, about 18 mm wide, seen from above its rim with the sun behind."""
    vertices, sizes, corners = mesh_file.read(CUP)
    eye = Vector((0.35, -1.0, 0.62)).normalized()
    return Body("cup", vertices, corners.reshape(len(sizes), 3), eye, Vector((1.0, 0.0, 5.2)), 23.0, 150)
