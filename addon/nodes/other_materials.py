# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces of an object's other materials. Opaque ones absorb the light inside; light passes the others as it
passes the interior's own faces."""

import numpy as np

from ..base.slots import materials_of
from . import links, node_tree, principled

OPEN_TO_LAMPS = (
    "lamps shine into the body through opaque faces of other materials: choose Lamps Stay in the panel Depth"
)
_PASSING = frozenset(
    {
        "BSDF_GLASS",
        "BSDF_HAIR",
        "BSDF_HAIR_PRINCIPLED",
        "BSDF_RAY_PORTAL",
        "BSDF_REFRACTION",
        "BSDF_TRANSLUCENT",
        "BSDF_TRANSPARENT",
        "SUBSURFACE_SCATTERING",
    }
)


def of_slots(faces, obj):
    """(m,), the material slot of each of `faces`, of a mesh or its triangles."""
    numbers = np.empty(len(faces), np.int32)
    faces.foreach_get("material_index", numbers)
    return _in_range(numbers, obj)


def opaque_faces(numbers, obj, material):
    """((m,) bool, sentences): which faces, with the slots `numbers`, have an opaque material other than
    `material`, and what is said about the faces of other materials."""
    slots = materials_of(obj, material)
    used = {slots[number] for number in np.unique(numbers)} - {material}
    passing = {one for one in used if passes(one)}
    opaque = np.array([one != material and one not in passing for one in slots])[numbers]
    sentences = []
    if opaque.any():
        sentences.append(f"faces of {_listed(used - passing)} count as black: they absorb the light inside")
    if passing:
        sentences.append(f"light passes faces of {_listed(passing)} as if they were of {material.name}")
    return opaque, tuple(sentences)


def counts(obj, material):
    """The numbers of faces of an object's mesh that have the material, another one, and an opaque one."""
    mesh, slots = obj.data, materials_of(obj, material)
    indices = mesh.attributes.get("material_index")  # absent if all are 0; read much faster than faces
    numbers = np.zeros(len(mesh.polygons), np.int32)
    if indices is not None and len(indices.data) == len(numbers):
        indices.data.foreach_get("value", numbers)
    faces = np.bincount(_in_range(numbers, obj), minlength=len(slots)).tolist()
    found = [0, 0, 0]
    for one, count in zip(slots, faces, strict=True):
        if count:
            found[0 if one == material else 1 if passes(one) else 2] += count
    return found


def _in_range(numbers, obj):
    """As Blender draws faces whose number is that of no slot."""
    return np.minimum(numbers, max(len(obj.material_slots), 1) - 1)


def _listed(materials):
    return " and ".join(sorted("an empty slot" if one is None else one.name for one in materials))


def passes(material):
    """True if light may pass a surface of the material."""
    if material is not None and material.lamina.lateral_group is not None:
        return True  # an interior or lateral light of its own
    if material is None or material.node_tree is None or not node_tree.is_on(material):
        return False
    output = material.node_tree.get_output_node("CYCLES")
    if output is None:
        return False
    shader = links.source(output.inputs["Surface"])
    if links.source(output.inputs["Volume"]) is not None:
        return True
    return shader is not None and any(map(_node_passes, links.upstream(shader.node)))


def _node_passes(node):
    if node.mute:
        return False
    if node.type == "GROUP" and node.node_tree is not None:
        return any(map(_node_passes, node.node_tree.nodes))
    return principled.transmits(node) if node.type == "BSDF_PRINCIPLED" else node.type in _PASSING
