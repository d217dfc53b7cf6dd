# SPDX-License-Identifier: GPL-3.0-or-later
"""The solid of an object, in millimetres and in the object's own axes."""

from dataclasses import dataclass

import numpy as np
from mathutils import Matrix

from ..base import mesh_arrays, native, rendered
from ..base.messages import RefusedError
from ..nodes import other_materials

SAME = 1e-3  # cosine between axes that count as perpendicular
HOLES = 0.1  # the largest area of holes that are closed, relative to that of the mesh


@dataclass(frozen=True)
class Frame:
    """The object's own axes. `axes`: (3, 3), unit vectors in world space, as columns. `origin`: of the
    object, in world space. `scale`: (3,), of the object along its axes. `unit`: mm of a Blender unit."""

    axes: np.ndarray
    origin: np.ndarray
    scale: np.ndarray
    unit: float

    def towards(self, direction):
        """A direction in world space, in the object's own axes."""
        return self.axes.T @ np.array(direction, float)

    def place(self, position):
        """A position in world space, in mm in the object's own axes."""
        return self.unit * self.towards(np.array(position, float) - self.origin)

    def view(self, camera):
        """The view of a camera object, as arguments of lamina.lit_images."""
        matrix = np.array(camera.matrix_world, float)
        if camera.data.type == "ORTHO":
            return {"view": tuple(map(float, self.towards(matrix[:3, 2])))}
        return {"eye": tuple(map(float, self.place(matrix[:3, 3])))}


@dataclass(frozen=True)
class Body:
    """`arrays`: in the object's own axes, in mm. `millimetres`: (3,), of a unit of the object's own space
    along its axes. `own`, (m,) bool: which triangles have the material; `opaque`: which have an opaque one.
    `notes`: sentences about faces of other materials."""

    arrays: mesh_arrays.Arrays
    millimetres: np.ndarray
    frame: Frame
    own: np.ndarray
    opaque: np.ndarray
    notes: tuple[str, ...]

    def solid(self):
        """The lamina.Solid, whose small holes are closed."""
        arrays = self.arrays
        return native.require().Solid(arrays.vertices, arrays.triangles, HOLES, arrays.name, self.opaque)


def problem(obj):
    """The reason why an object has no interior, in a sentence, or ''."""
    if rendered.can_convert(obj):
        return f"{obj.name} has no mesh of its own: convert it"
    if obj is None or obj.type != "MESH":
        return "An interior needs a mesh object: select one"
    if not obj.is_editable or not obj.data.is_editable:
        return f"{obj.name} is linked from another file: edit it there, or make it local"
    if obj.mode != "OBJECT":
        return f"{obj.name} is being edited: change to Object Mode"
    return ""


def of_object(depsgraph, obj, material, uv_map):
    """The Body of an object in a dependency graph, with modifiers, and its UV map `uv_map`; "": the one for
    rendering; None: without. Faces of other materials have no area in the UV map. None for an object that is
    not to be seen there. Raises RefusedError."""
    # Matrices of hidden objects are not up to date elsewhere: after loading they are the identity.
    for instance in depsgraph.object_instances:
        if rendered.is_itself(instance, obj) and instance.show_self:
            frame = _frame(obj, instance.matrix_world, depsgraph.scene)
            return _of_mesh(instance.object, obj, material, uv_map, frame)
    return None


def hidden(obj):
    """The refusal of an object that is nowhere to be seen."""
    return RefusedError(f"{obj.name} is hidden in renders and in the viewport: show it in one of them")


def _of_mesh(evaluated, obj, material, uv_map, frame):
    mesh = evaluated.to_mesh()
    try:
        mean = float(frame.scale.mean())
        stretch = Matrix.Diagonal((*(frame.scale / mean), 1.0))
        vertices = mesh_arrays.vertices(mesh, stretch, mean * frame.unit)
        triangles, loops = mesh_arrays.triangles(mesh, stretch), mesh_arrays.loops(mesh, stretch)
        if not len(triangles):
            raise RefusedError(f"{obj.name} has no faces: an interior needs a closed mesh")
        normals = mesh_arrays.corner_normals(mesh, stretch)[loops]
        uvs, own = None, with_material(mesh.loop_triangles, obj, material)
        if uv_map is not None:
            uvs = mesh_arrays.uvs(obj, mesh, uv_map, "let Lamina unwrap it")[loops]
            uvs[~own] = -1.0  # one point outside of the image
        slots = other_materials.of_slots(mesh.loop_triangles, obj)
        opaque, notes = other_materials.opaque_faces(slots, obj, material)
    finally:
        evaluated.to_mesh_clear()
    arrays = mesh_arrays.Arrays(vertices, triangles, normals, uvs, obj.name)
    return Body(arrays, frame.scale * frame.unit, frame, own, opaque, notes)


def frame_of(obj, scene):
    """The Frame of an object. Raises RefusedError for a scale of 0, and for a sheared object."""
    return _frame(obj, obj.matrix_world, scene)


def with_material(faces, obj, material):
    """(m,) bool: which of `faces`, of a mesh or its triangles, have the material. Raises RefusedError if no
    slot of the object has the material."""
    own = np.array([slot.material == material for slot in obj.material_slots] or [True])
    if not own.any():
        raise RefusedError(
            f"{material.name} is not a material of the active object: select an object that has it"
        )
    return own[other_materials.of_slots(faces, obj)]


def _frame(obj, matrix, scene):
    columns, origin = np.array(matrix, float)[:3, :3], np.array(matrix, float)[:3, 3]
    scale = np.linalg.norm(columns, axis=0)
    if not scale.min() > 0.0:
        raise RefusedError(f"{obj.name} has the scale 0: must be above 0")
    axes = columns / scale
    if not np.allclose(axes.T @ axes, np.eye(3), atol=2.0 * SAME):
        by = "" if obj.parent is None else f" by its parent {obj.parent.name}"
        raise RefusedError(f"{obj.name} is sheared{by}: apply the scale (Object > Apply > Scale)")
    return Frame(axes, origin, scale, scene.unit_settings.scale_length * 1000.0)
