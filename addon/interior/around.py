# SPDX-License-Identifier: GPL-3.0-or-later
"""The other objects of a scene: they cast shadows on a body, reflect light onto it, and may shine."""

import hashlib
from dataclasses import replace
from itertools import islice

import numpy as np
from mathutils import Matrix

from ..base import linking, mesh_arrays, native, rendered
from ..base.messages import RefusedError
from ..base.slots import materials_of
from ..nodes import links as node_links
from ..nodes import other_materials, principled
from . import lamps

MARKED = 1000  # objects that are looked at whenever a panel is drawn
_COLORS = {
    "BSDF_DIFFUSE": "Color",
    "BSDF_PRINCIPLED": "Base Color",
    "BSDF_METALLIC": "Base Color",
    "BSDF_GLOSSY": "Color",
    "BSDF_SHEEN": "Color",
}
_SHINING = {"EMISSION": ("Color", "Strength"), "BSDF_PRINCIPLED": ("Emission Color", "Emission Strength")}


def occluders(depsgraph, obj, frame, lamina, sources):
    """(a lamina.Occluders of what a dependency graph shows beside an object, in the object's axes, or None;
    `sources`, a list of lights.Source, with the numbers of the lamps' linkings). Materials that light passes,
    such as glass, are left out. Raises RefusedError."""
    shapes, places, found, looks, owners, first = {}, [], [], [], [], 0
    every = _linkings(depsgraph)
    for instance in depsgraph.object_instances:
        other = instance.object
        if rendered.is_itself(instance, obj) or not rendered.casts_shadow(instance):
            continue
        key = other.session_uid, other.data.session_uid
        if key not in shapes:
            shapes[key] = _shape(other)
        vertices, triangles, look = shapes[key]
        if len(triangles):
            matrix = np.array(instance.matrix_world, float)
            world = vertices @ matrix[:3, :3].T + matrix[:3, 3]
            places.append(frame.unit * (world - frame.origin) @ frame.axes)
            found.append(triangles + first)
            looks.append(look)
            first += len(vertices)
            owners.append((linking.names_of(instance, every), _of_emission(other, look, obj), len(triangles)))
    if not found:
        return None, sources
    places, found, looks = map(np.concatenate, (places, found, looks))
    links, sources = _linked(owners, sources, obj)
    return lamina.Occluders(places, found, looks[:, 0], looks[:, 1], **links), sources


def _linkings(depsgraph):
    """The linkings of all lamps and objects with faces."""
    kinds = {"LIGHT", *rendered.SHAPES}
    originals = {one.object.original for one in depsgraph.object_instances if one.object.type in kinds}
    return {linking.ALL, *map(linking.of, originals)}


def _of_emission(other, look, obj):
    """The linking of what an object emits, if it does. Raises RefusedError."""
    if not look[:, 1].any():
        return linking.ALL
    found = linking.of(other.original)
    lamps.check_blocks(other, found, obj)
    return found


def _linked(owners, sources, obj):
    """(links of lamina.Occluders, the sources with the numbers of their linkings). `owners`, of each:
    ((name as a receiver, as a blocker), linking of its emission, number of faces). Raises RefusedError."""
    shining = [one.linking for one in sources], [own for _, own, _ in owners]
    linkings = list(dict.fromkeys([linking.ALL, *shining[0], *shining[1]]))
    if len(linkings) == 1:
        return {}, sources
    most = native.part("interior.lamps").MOST_LINKINGS
    if len(linkings) > most:
        raise RefusedError(f"lamps and meshes have {len(linkings)} different light linkings: must be at most "
                           f"{most} for Lamps Stay")

    def mask(kind, name):
        return sum(1 << number for number, one in enumerate(linkings) if getattr(one, kind).holds(name))

    counts = [count for *_, count in owners]
    links = {"lit": [mask("receivers", names[0]) for names, *_ in owners],
             "shadows": [mask("blockers", names[1]) for names, *_ in owners]}
    links = {name: np.repeat(np.array(masks, np.uint64), counts) for name, masks in links.items()}
    links["linking"] = np.repeat([linkings.index(own) for own in shining[1]], counts)
    links["solid_lit"] = mask("receivers", obj.name_full)
    numbers = map(linkings.index, shining[0])
    return links, [replace(one, numbers=one.numbers | {"linking": number})
                   for one, number in zip(sources, numbers, strict=True)]


def mark(objects, obj, with_names=False):
    """A text that changes when other objects of the scene change place or size; cheap."""
    found = []
    for one in _marked(objects, obj):
        numbers = [round(value, 4) for row in one.matrix_world for value in row]
        size = [round(value, 4) for value in one.dimensions]
        linked = linking.of(one)
        name = [one.name] if with_names else []
        found.append((*name, numbers, size, *([] if linked == linking.ALL else [linked.note()])))
    return _digest(found)


def looks(objects, obj):
    """(a text that changes when materials of other objects reflect or emit other light, whether one emits);
    cheap."""
    every = [materials_of(one) for one in _marked(objects, obj)]
    known = {one: (albedo_of(one), emission_of(one)) for materials in every for one in materials}
    found = [[f"{value:.3g}" for one in materials for part in known[one] for value in part]
             for materials in every]
    return _digest(found), any(any(known[one][1]) for materials in every for one in materials)


def _marked(objects, obj):
    every = (one for one in objects if one != obj and one.type in rendered.SHAPES and one.visible_shadow)
    return islice(every, MARKED)


def _digest(found):
    return hashlib.sha256(repr(sorted(found)).encode()).hexdigest()[:16]


def _shape(obj):
    """(vertices, triangles, (albedo, emission) of each triangle) in the object's own space, of faces that
    light does not pass."""
    nothing = np.zeros((0, 3)), np.zeros((0, 3), np.int64), np.zeros((0, 2, 3))
    mesh = obj.to_mesh()
    if mesh is None:
        return nothing
    try:
        still = Matrix.Identity(4)
        vertices, triangles = mesh_arrays.vertices(mesh, still, 1.0), mesh_arrays.triangles(mesh, still)
        slots = other_materials.of_slots(mesh.loop_triangles, obj)
    finally:
        obj.to_mesh_clear()
    materials = materials_of(obj)
    opaque = np.array([not other_materials.passes(one) for one in materials])
    kept = opaque[slots]
    looks = np.array([(albedo_of(one), emission_of(one)) for one in materials])
    return vertices, triangles[kept].astype(np.int64), looks[slots[kept]]


def albedo_of(material):
    """About the share of light that a material reflects: the color of its Principled BSDF or of the first
    closure with one. The viewport's color stands for a texture."""
    if material is None:
        return (0.8, 0.8, 0.8)  # as Cycles renders an empty slot
    shader = principled.shown(material)
    for node in [] if shader is None else node_links.upstream(shader.node):
        if node.type in _COLORS and not node.mute:
            socket = node.inputs[_COLORS[node.type]]
            color = material.diffuse_color if socket.links else socket.default_value
            return tuple(min(max(value, 0.0), 1.0) for value in color[:3])
    return (0.0, 0.0, 0.0) if shader is not None else tuple(material.diffuse_color[:3])


def emission_of(material):
    """The radiance that a material emits: of its Emission nodes or its Principled BSDF; what a texture
    controls is left out."""
    shader = None if material is None else principled.shown(material)
    for node in [] if shader is None else node_links.upstream(shader.node):
        names = _SHINING.get(node.type)
        if names and not node.mute and not any(node.inputs[name].links for name in names):
            color, strength = (node.inputs[name].default_value for name in names)
            if strength > 0.0 and any(color[:3]):
                return tuple(strength * max(value, 0.0) for value in color[:3])
    return (0.0, 0.0, 0.0)
