# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions that edit the layer list of a material. The top layer is first."""

import hashlib
import json

from ..base import changes, preferences, renders
from ..kinds.spectra import ILLUMINANT
from ..nodes import detail_wiring, displacement, dust_detail, node_group, own_nodes, painted_images, thickness
from ..properties import migration
from ..stack_json import stack_write
from ..stack_json.stack_read import FIRST_NAMES

NOT_COPIED = ("name", "varying", "roughness", "roughness_v")  # roughness is computed from alpha


def add_stack(material):
    """Give `material` a first stack: a thin layer over the present colour of the material."""
    renders.stop_previews()
    settings = material.lamina
    if material.node_tree is not None and not settings.enabled and settings.lateral_group is None:
        own_nodes.unmark_all(material.node_tree)  # Paste Material copies Lamina's nodes of another material
    migration.start(material)
    if not settings.layers:
        layer = settings.layers.add()
        layer.name = "Dust"
    settings.active_index = 0
    settings.quality = preferences.default_quality()
    settings.basis = preferences.default_basis()
    settings.base.kind = "lambert"
    settings.base.reflectance = _shown_colour(material)


def remove_stack(material):
    """Take layers, node groups and their images away from `material`, and restore its nodes and links as they
    were before Lamina. Nodes that the artist has added and painted images stay."""
    for image in painted_images.of(material):  # Blender saves no image without users
        if image.packed_file is not None and image.is_editable and thickness.TWO_SIDES not in image:
            image.use_fake_user = True
    displacement.remove(material)
    node_group.remove(material)
    if material.node_tree is not None:
        thickness.remove_nodes(material.node_tree)
    dust_detail.remove_unused()
    for key in (detail_wiring.WANTED, detail_wiring.DUSTED, thickness.EVEN, *thickness.kept_keys(material)):
        material.pop(key, None)
    changes.removed(material)
    material.property_unset("lamina")


def add_layer(material, kind="medium"):
    """Put a new layer, a 'medium' or an 'interface', on top of the active one and select it. Returns it."""
    settings = material.lamina
    _new_layer(material, kind)
    return _place_last(settings, max(settings.active_index, 0))


def close_sheet(material):
    """Add an interface of ior 1 at the bottom, as rough as the one above it, so that a sheet ends in air.
    Returns it."""
    settings = material.lamina
    above = [index for index, layer in enumerate(settings.layers) if layer.kind == "interface"]
    layer = _new_layer(material, "interface")
    if above:
        _copy(settings.layers[above[-1]], layer)
    layer.ior, layer.ior_per_channel = 1.0, False
    return _place_last(settings, len(settings.layers))


def open_ior(material):
    """Index of the dielectric at the bottom of a sheet; None if the sheet ends in air, or if there is a
    base."""
    settings = material.lamina
    interfaces = [layer for layer in settings.layers if layer.kind == "interface"]
    if settings.base.kind != "none" or not interfaces:
        return None
    last = interfaces[-1]
    ior = max(last.ior_rgb) if last.ior_per_channel else last.ior
    return ior if ior > 1.0 else None


def remove_layer(material):
    """Remove the active layer; the one that takes its place becomes active."""
    renders.stop_previews()
    settings = material.lamina
    settings.layers.remove(_active_index(settings))
    settings.active_index = _active_index(settings)
    changes.tell(material)


def duplicate_layer(material):
    """Put a copy of the active layer below it, select it and return it. The copy does not vary, because only
    one medium and one interface may vary."""
    renders.stop_previews()
    settings = material.lamina
    index = _active_index(settings)
    copy, source = settings.layers.add(), settings.layers[index]
    _copy(source, copy)
    copy.name = unique_name(material, source.name)
    return _place_last(settings, index + 1)


def move_layer(material, direction):
    """Move the active layer 'UP' or 'DOWN'. Returns True if it moved."""
    settings = material.lamina
    index = _active_index(settings)
    target = index + (-1 if direction == "UP" else 1)
    if not 0 <= target < len(settings.layers):
        return False
    renders.stop_previews()
    settings.layers.move(index, target)
    settings.active_index = target
    changes.tell(material)
    return True


def active_layer(material):
    """The selected layer, or None."""
    settings = material.lamina
    index = settings.active_index
    return settings.layers[index] if 0 <= index < len(settings.layers) else None


def mark(material):
    """A short text that changes with the layers and the base of `material`, and with the illuminant if it
    matters, but not with names. It needs no native module and is quick enough for a panel."""
    stack = stack_write.stack(material.lamina)
    layers = [{**layer, "name": ""} for layer in stack["layers"]]
    light = [stack[ILLUMINANT.name]] if ILLUMINANT.name in stack else []
    return hashlib.sha256(json.dumps([layers, stack["base"], *light]).encode()).hexdigest()[:24]


def _active_index(settings):
    """The index of the active layer, or of the nearest one: scripts may give any number."""
    return max(0, min(settings.active_index, len(settings.layers) - 1))


def unique_name(material, wanted):
    """`wanted`, or `wanted` with the next free number as Blender writes them."""
    taken = {layer.name for layer in material.lamina.layers}
    stem = wanted[:-4] if wanted[-4:-3] == "." and wanted[-3:].isdigit() else wanted
    if wanted not in taken:
        return wanted
    number = 1
    while f"{stem}.{number:03d}" in taken:
        number += 1
    return f"{stem}.{number:03d}"


def _new_layer(material, kind):
    renders.stop_previews()
    name = unique_name(material, FIRST_NAMES[kind])
    layer = material.lamina.layers.add()
    layer.kind, layer.name = kind, name
    return layer


def _copy(source, target):
    for prop in source.bl_rna.properties:
        if prop.type == "POINTER" and prop.identifier == "bottom":
            _copy(source.bottom, target.bottom)
        elif not prop.is_readonly and prop.identifier not in NOT_COPIED:
            setattr(target, prop.identifier, getattr(source, prop.identifier))


def _place_last(settings, target):
    last = len(settings.layers) - 1
    target = min(target, last)
    settings.layers.move(last, target)
    settings.active_index = target
    changes.edited(settings)
    return settings.layers[target]


def _shown_colour(material):
    """Base colour of the material's Principled BSDF, or its viewport colour."""
    if material.node_tree is not None:
        for node in material.node_tree.nodes:
            if node.type == "BSDF_PRINCIPLED" and not node.inputs[0].is_linked:
                return tuple(min(max(value, 0.0), 1.0) for value in node.inputs[0].default_value[:3])
    return tuple(min(max(value, 0.0), 1.0) for value in material.diffuse_color[:3])
