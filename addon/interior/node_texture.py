# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples a node texture into voxels: Cycles renders slices of the object's box, many per image."""

import bpy
import numpy as np
from mathutils import Matrix

from ..base.messages import RefusedError
from . import float_render
from .node_sources import default_source, find_source

MOST_PIXELS = 1 << 22  # in one rendered image
MOST_SIDE = 1024  # voxels
NEAR_FILTER = 0.01  # filter width in pixels: samples lie within this distance of the voxel centres


class SamplingCancelled(Exception):  # noqa: N818 - an outcome that the caller asked for, not an error
    """The caller's `cancel` returned true."""


def sample_nodes(obj, material, low, high, shape, source=None, progress=None, cancel=None):
    """float32 [x, y, z, 3]: values of a colour or number of a material's nodes at the centres of voxels.

    `low`, `high`: corners of the box in the object's own space; `shape`: voxels along x, y, z, 1 to 1024.
    `source`: names (node, output socket); None: the output linked to the material's colour or density.
    Values are not clipped. `progress(fraction, text)` reports progress. `cancel()` is called before each
    image; if it returns true, SamplingCancelled is raised. Main thread only. All temporary data are removed
    from the file, also after an error. Raises RefusedError for nodes whose values depend on anything but the
    position.
    """
    low, high, shape = np.array(low, float), np.array(high, float), tuple(int(count) for count in shape)
    if len(shape) != 3 or not all(1 <= count <= MOST_SIDE for count in shape):
        raise RefusedError(f"voxels = {shape}: must be three whole numbers from 1 to {MOST_SIDE}")
    if low.shape != (3,) or high.shape != (3,) or not (np.isfinite(low).all() and (low < high).all()):
        raise RefusedError(f"box from {low.tolist()} to {high.tolist()}: must have an extent along each axis")
    with _Studio(obj, material, source or default_source(material), low, high, shape) as studio:
        return studio.sampled(progress, cancel)


class _Studio:
    """A temporary scene that renders the images. All its data are removed at the end."""

    def __init__(self, obj, material, source, low, high, shape):
        self._obj, self._material, self._source = obj, material, source
        self._low, self._high, self._shape = low, high, shape
        nx, ny, nz = shape
        self._columns = max(1, min(nz, int(2048 / nx)))
        rows = max(1, min(MOST_PIXELS // (nx * ny * self._columns), int(2048 / ny), -(-nz // self._columns)))
        self._tiles = self._columns * rows
        self._size = self._columns * nx, rows * ny
        self._made = []

    def __enter__(self):
        try:
            self._build()
        except BaseException:
            self._remove()
            raise
        return self

    def __exit__(self, *_):
        self._remove()

    def sampled(self, progress, cancel):
        nx, ny, nz = self._shape
        found = np.empty((nx, ny, nz, 3), np.float32)
        for first in range(0, nz, self._tiles):
            if cancel is not None and cancel():
                raise SamplingCancelled("the sampling of nodes was cancelled")
            if progress is not None:
                progress(first / nz, f"slice {first + 1} of {nz}")
            last = min(first + self._tiles, nz)
            self._place(first, last)
            picture = float_render.picture(self._scene)
            for place in range(last - first):
                row, column = divmod(place, self._columns)
                tile = picture[row * ny : (row + 1) * ny, column * nx : (column + 1) * nx, :3]
                found[:, :, first + place] = tile.transpose(1, 0, 2)
        if progress is not None:
            progress(1.0, "Done")
        return found

    def _keep(self, collection, item):
        """Record temporary data. They are removed in reverse order."""
        self._made.append((collection, item))
        return item

    def _remove(self):
        for collection, item in reversed(self._made):
            collection.remove(item)
        self._made.clear()

    def _build(self):
        data = bpy.data
        scene = self._scene = self._keep(data.scenes, data.scenes.new("lamina slices"))
        scene.frame_set(bpy.context.scene.frame_current)
        material = self._keep(data.materials, self._material.copy())
        self._emit(material)
        self._mesh = self._keep(data.meshes, self._slice(material))
        camera = self._keep(data.cameras, data.cameras.new("lamina slices"))
        camera.type, camera.sensor_fit = "ORTHO", "HORIZONTAL"
        camera.ortho_scale = self._size[0]
        eye = self._keep(data.objects, data.objects.new("lamina slices", camera))
        eye.matrix_world = Matrix.Translation((0.5 * self._size[0], 0.5 * self._size[1], 1.0))
        scene.collection.objects.link(eye)
        scene.camera = eye
        self._slices = []
        for _ in range(min(self._tiles, self._shape[2])):
            mesh = self._keep(data.meshes, self._mesh.copy())
            one = self._keep(data.objects, data.objects.new("lamina slice", mesh))
            scene.collection.objects.link(one)
            self._slices.append(one)
        float_render.prepare(scene, *self._size)
        scene.cycles.samples = 1
        scene.cycles.filter_width = NEAR_FILTER

    def _emit(self, material):
        """Connect the chosen socket as the material's only emission."""
        tree = material.node_tree
        if tree is None:
            raise RefusedError(f"{material.name} has no nodes: switch Use Nodes on")
        socket = find_source(tree, self._source, self._material)
        for node in [node for node in tree.nodes if node.type == "OUTPUT_MATERIAL"]:
            tree.nodes.remove(node)
        emission = tree.nodes.new("ShaderNodeEmission")
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(socket, emission.inputs["Color"])
        tree.links.new(emission.outputs[0], output.inputs["Surface"])

    def _slice(self, material):
        """A rectangle through the box, with the texture space of the object's mesh."""
        mesh = bpy.data.meshes.new("lamina slice")
        (x0, y0, _), (x1, y1, _) = self._low, self._high
        mesh.from_pydata([(x0, y0, 0.0), (x1, y0, 0.0), (x1, y1, 0.0), (x0, y1, 0.0)], [], [(0, 1, 2, 3)])
        mesh.materials.append(material)
        own = self._obj.data
        mesh.use_auto_texspace = False
        if hasattr(own, "texspace_location"):
            mesh.texspace_location, mesh.texspace_size = own.texspace_location, own.texspace_size
        return mesh

    def _place(self, first, last):
        """Place slices [first, last) side by side. Their local coordinates equal the object's coordinates; a
        pixel has width 1."""
        nx, ny, nz = self._shape
        side = self._high - self._low
        scale = Matrix.Diagonal((nx / side[0], ny / side[1], 1.0, 1.0))
        for place, one in enumerate(self._slices):
            one.hide_render = first + place >= last
            if one.hide_render:
                continue
            z = self._low[2] + side[2] * (first + place + 0.5) / nz
            for vertex in one.data.vertices:
                vertex.co.z = z
            one.data.update()
            row, column = divmod(place, self._columns)
            corner = Matrix.Translation((column * nx, row * ny, 0.0))
            one.matrix_world = corner @ scale @ Matrix.Translation((-self._low[0], -self._low[1], -z))
