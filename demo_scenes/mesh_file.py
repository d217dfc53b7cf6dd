# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes from files, by Blender's importers: as they are, or upright and scaled to a box."""

import gzip
import tempfile
import zlib
from pathlib import Path

import bpy
import cycles_render
import numpy as np

IMPORTERS = {".ply": "ply_import", ".obj": "obj_import", ".stl": "stl_import"}


def read(path):
    """(vertices (n, 3), face sizes (m,), corners (k,)) of a PLY, OBJ or STL file, which gzip may have packed.

    Curves and points are ignored. Raises ValueError, in a sentence."""
    path = Path(path)
    kind = path.suffix.lower()
    packed = kind == ".gz"
    if packed:
        kind = Path(path.stem).suffix.lower()
    if kind not in IMPORTERS:
        raise ValueError(f"{path}: must end in {', '.join(IMPORTERS)}, or in one of these and .gz")
    if not path.is_file():
        raise ValueError(f"{path}: no such file")
    vertices, sizes, corners = _unpacked(path, kind) if packed else _read(path, kind)
    if not len(sizes):
        raise ValueError(f"{path}: holds no faces")
    return vertices, sizes, corners


def upright(path, width, height, up="y"):
    """What `read` returns, turned so that z is up, standing on z = 0 with the middle of its box over the origin, as
    large as fits into a box of `width` x `width` x `height`.

    up: the file's upright axis, "y" or "z". Vertices without faces are dropped. Raises ValueError, in a sentence."""
    vertices, sizes, corners = read(path)
    used, corners = np.unique(corners, return_inverse=True)
    vertices = vertices[used]
    if not np.all(np.isfinite(vertices)):
        raise ValueError(f"{path}: {np.count_nonzero(~np.isfinite(vertices).all(axis=1))} vertices are not finite")
    if up == "y":
        vertices = vertices[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    if not high[2] > low[2]:
        raise ValueError(f"{path}: has no height")
    foot = np.array([*(0.5 * (low + high))[:2], low[2]])
    scale = np.min(np.array([width, width, height]) / np.maximum(high - low, 1e-30))
    return (vertices - foot) * scale, sizes, corners.ravel()


def as_mesh(name, vertices, sizes, corners):
    """A Blender mesh with smooth faces: vertices (n, 3), the faces' numbers of corners (m,), their vertices (k,)."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(vertices, np.float32).ravel())
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", np.ascontiguousarray(corners, np.int32))
    mesh.polygons.add(len(sizes))
    mesh.polygons.foreach_set("loop_start", np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.int32))
    mesh.update(calc_edges=True)
    mesh.validate()
    mesh.shade_smooth()
    return mesh


def triangles(mesh):
    """(m, 3) indices of vertices: the triangles of a Blender mesh."""
    mesh.calc_loop_triangles()
    indices = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", indices)
    return indices.reshape(-1, 3).astype(int)


def _unpacked(path, kind):
    """The result of `_read` for a file packed by gzip. Raises ValueError, in a sentence."""
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / f"mesh{kind}"
        try:
            plain.write_bytes(gzip.decompress(path.read_bytes()))
        except (OSError, EOFError, zlib.error) as error:
            raise ValueError(f"{path}: is a damaged gzip file ({error})") from None
        return _read(plain, kind)


def _read(path, kind):
    """The file's vertices and faces, without change of axes and lengths."""
    before = set(bpy.data.objects)
    # Import without rotation: `load` handles the upright axis.
    with cycles_render.quiet():
        getattr(bpy.ops.wm, IMPORTERS[kind])(filepath=str(path), forward_axis="Y", up_axis="Z")
    made = [thing for thing in bpy.data.objects if thing not in before]
    vertices, sizes, corners, first = [np.empty((0, 3))], [np.empty(0, int)], [np.empty(0, int)], 0
    for thing in made:
        if thing.type != "MESH":
            bpy.data.batch_remove([one for one in (thing, thing.data) if one is not None])
            continue
        mesh = thing.data
        points, at = np.empty(3 * len(mesh.vertices), np.float32), np.empty(len(mesh.loops), np.int32)
        size = np.empty(len(mesh.polygons), np.int32)
        mesh.vertices.foreach_get("co", points)
        mesh.loops.foreach_get("vertex_index", at)
        mesh.polygons.foreach_get("loop_total", size)
        vertices.append(points.reshape(-1, 3).astype(float))
        sizes.append(size)
        corners.append(at.astype(int) + first)
        first += len(mesh.vertices)
        bpy.data.objects.remove(thing)
        bpy.data.meshes.remove(mesh)
    return np.concatenate(vertices), np.concatenate(sizes), np.concatenate(corners)
