# SPDX-License-Identifier: GPL-3.0-or-later
"""Any mesh in place of the dragon: read by Blender's importers, put upright, and scaled to the plinth."""

import gzip
import tempfile
import zlib
from pathlib import Path

import bpy
import cycles_render
import numpy as np

IMPORTERS = {".ply": "ply_import", ".obj": "obj_import", ".stl": "stl_import"}


def load(path, width, height, up="y"):
    """(vertices (n, 3), face sizes (m,), corners (k,)) of the file's faces: z up, standing on z = 0 with the middle of
    its box over the origin, as large as fits into a box of `width` x `width` x `height`.

    up: the file's upright axis, "y" or "z". Vertices without faces are dropped. Raises ValueError, in a sentence."""
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
    """The file's vertices and faces, without change of axes and lengths. Curves and points are ignored."""
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
