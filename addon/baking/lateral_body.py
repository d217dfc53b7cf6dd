# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether objects can show light that travels sideways: closed meshes must not be inside out, and for
Relightable the body must scatter most of the light that enters."""

from ..base import mesh_arrays, native
from ..base.messages import RefusedError
from ..editing import stack_io
from ..nodes import other_materials


def require(context, scene, material, output):
    """Raise RefusedError or lamina.InteriorError if a mesh object of the scene with the material is unfit for
    the output. Open meshes, such as planes, pass: which of their sides is outside cannot be told. Returns a
    sentence about faces of other, opaque materials, or ''."""
    is_capped = False
    depsgraph, seen = context.evaluated_depsgraph_get(), set()
    unit = 1000.0 * scene.unit_settings.scale_length  # of a Blender unit, in mm
    for obj in scene.objects:
        if obj.type == "MESH" and any(slot.material == material for slot in obj.material_slots):
            evaluated = obj.evaluated_get(depsgraph)
            matrix = evaluated.matrix_world
            key = (evaluated.data.as_pointer(), *matrix.to_scale(), matrix.determinant() < 0.0)
            if key not in seen:  # many objects may share one mesh
                seen.add(key)
                _require(evaluated, obj.name, material, output, unit)
                is_capped = is_capped or other_materials.counts(obj, material)[2] > 0
    note = other_materials.OPEN_TO_LAMPS
    return f"{note[0].upper()}{note[1:]}." if is_capped else ""


def _require(evaluated, name, material, output, unit):
    mesh, matrix = evaluated.to_mesh(), evaluated.matrix_world
    try:
        vertices, triangles = mesh_arrays.vertices(mesh, matrix, unit), mesh_arrays.triangles(mesh, matrix)
    finally:
        evaluated.to_mesh_clear()
    if not len(triangles):  # shows nothing, or instances alone
        return
    lamina = native.require()
    if not lamina.Solid(vertices, triangles, name=name).is_closed() or output != "RELIGHTABLE":
        return
    light = native.part("subsurface.unscattered")
    try:
        extinction = light.largest_extinction(stack_io.to_stack(material))
    except lamina.StackError:  # the computation refuses such stacks, each with its own sentence
        return
    width = light.mean_width(vertices, triangles)
    paths = width * extinction
    share = light.unscattered_share(paths)
    if share > light.MOST_UNSCATTERED:
        raise RefusedError(
            f"{name} is {paths:.2g} mean free paths wide ({width:.3g} mm): {100.0 * share:.0f} % of the "
            "light crosses it without scattering, and Mean Distance would show this light as scattered. Use "
            "Exact in the panel Depth"
        )
