# SPDX-License-Identifier: GPL-3.0-or-later
"""The layer of dust that `dusting` puts over a material, and the way back: what was added to a material is
noted in the material, so that `remove` takes exactly that away."""

import bpy

from ..baking import bake_job
from ..base import editable, messages
from ..base.slots import materials_of
from ..editing import layer_list, over_material
from ..nodes import detail_wiring, node_tree, rest_coordinates, thickness
from ..settling import live_dust, object_dust

# House dust, by eye: warm grey grains and fibers, which scatter more evenly than the compact grains of Mie
# theory (substances). The optical thickness is the most that settled dust may have.
LAYER = {"name": "Dust", "mode": "optical", "albedo": (0.88, 0.84, 0.78), "phase": "hg", "g": 0.3,
         "varying": True, "tau": 4.0}  # fmt: skip

MARK = detail_wiring.DUSTED  # of a material: what was added to it, see below
_STACK, _LAYER, NEW = "stack", "layer", "new"
_EVEN, _PLAIN = "even", "plain"  # nothing, but the artist's own layer was even, and without grain


def has_dust(material):
    return material.lamina.enabled and any(
        layer.varying and layer.kind == "medium" for layer in material.lamina.layers)


def cover(material):
    """Give a material a layer of dust, if no layer varies yet. Returns what was added: a value of MARK, or
    None. Raises RefusedError."""
    if has_dust(material):
        return None
    added = _LAYER if material.lamina.enabled else _STACK
    if added == _STACK:
        over_material.add(material)
        layer = material.lamina.layers[0]
    else:
        material.lamina.active_index = 0
        layer = layer_list.add_layer(material)
    for name, value in {**LAYER, "dusted": True}.items():
        setattr(layer, name, value)
    return added


def evenness(material):
    """(a value of MARK, the thickness) of a material whose own layer is even, or None."""
    if material is None or MARK in material or not has_dust(material):
        return None
    now = thickness.wiring(material)
    if now.source != "value":
        return None
    return _PLAIN if detail_wiring.detail(material) is None else _EVEN, now.socket.default_value


def plain():
    material = bpy.data.materials.new("Material")
    node_tree.of(material)
    return material


def users(material):
    return {obj for obj in bpy.data.objects for slot in obj.material_slots if slot.material == material}


def note(error, material):
    """A sentence on an error of a material. Raises the error if it is not for the user."""
    if not messages.expected(error):
        raise error
    return f"{material.name}: {messages.sentence(error, material)}"


def remove(objects, tell=print):
    """Take the dust of `objects` away, and what `dust` has added to their materials, unless other objects
    have dust on them. Returns the number of objects that had dust. `tell(sentence)`: of a material whose
    other layers could not be baked."""
    cleared, materials = set(), {}
    for obj in objects:
        if obj.type != "MESH" or not obj.is_editable or not obj.data.is_editable:
            continue
        materials |= {one.session_uid: one for one in materials_of(obj) if one is not None and MARK in one}
        if obj.lamina_dust.told:
            live_dust.leave(obj)
            object_dust.clear(obj)
            cleared.add(obj)
    still = {slot.material for obj in bpy.data.objects if obj.type == "MESH" and obj.lamina_dust.told
             for slot in obj.material_slots}
    # Grain has rest coordinates on all objects with its material.
    resting = cleared.union(*(users(one) for one in materials.values()))
    for material in materials.values():
        if material not in still and editable.is_editable(material):
            try:
                _take_away(material, cleared)
            except Exception as error:
                tell(note(error, material))
    for obj in resting:
        is_ours = obj.type == "MESH" and obj.data.is_editable
        read = any(one is not None and rest_coordinates.is_read(one.node_tree) for one in materials_of(obj))
        if is_ours and not read:
            rest_coordinates.remove(obj.data)
    return len(cleared)


def _take_away(material, cleared):
    """Take away what `dust` has added to a material; what the artist has made of it since stays. `cleared`:
    the objects that had dust."""
    if material[MARK] in (_EVEN, _PLAIN):
        _make_even(material, material.pop(MARK))
        return
    index, is_alone = _our_layer(material), len(material.lamina.layers) == 1
    if index is not None and is_alone and material[MARK] != _LAYER:
        is_new = material[MARK] == NEW
        layer_list.remove_stack(material)
        material.pop(MARK, None)
        if is_new and users(material) <= cleared and _is_untouched(material):
            _remove(material)
        return
    if index is not None:
        material.lamina.active_index = index
        layer_list.remove_layer(material)
    del material[MARK]
    if index is not None:
        bake_job.bake_material(material)


def _make_even(material, mark):
    """Let the artist's own layer lie where it lay before dust settled on it."""
    if not object_dust.is_source(thickness.wiring(material)):
        return
    if mark == _PLAIN:
        detail_wiring.remove_detail(material)
    socket = thickness.wire_thickness(material, "value", replace=True).socket
    socket.default_value = material.pop(thickness.EVEN)


def _our_layer(material):
    """The index of the layer that `dust` has added to a material, under any name; None if it is gone."""
    layers = list(enumerate(material.lamina.layers))
    ours = [(index, one) for index, one in layers if one.dusted]
    ours = ours or [(index, one) for index, one in layers  # of earlier versions
                    if one.varying and one.kind == "medium" and one.name.startswith(LAYER["name"])]
    # A duplicate does not vary.
    return max(ours, key=lambda each: each[1].varying, default=(None, None))[0]


def _is_untouched(material):
    """True if a new material has the name and the nodes with which `plain` made it."""
    new = plain()
    try:
        return material.name.startswith("Material") and _values(material) == _values(new)
    finally:
        bpy.data.materials.remove(new)


def _values(material):
    """The kinds of a material's nodes and the values of their inputs."""
    found = [(node.bl_idname, [getattr(one, "default_value", None) for one in node.inputs])
             for node in material.node_tree.nodes]
    return sorted((kind, [tuple(one) if hasattr(one, "__len__") else one for one in values])
                  for kind, values in found)


def _remove(material):
    """Remove a new material, which leaves slots empty."""
    for obj in users(material):
        for slot in obj.material_slots:
            if slot.material == material:
                slot.material = None
    bpy.data.materials.remove(material)
