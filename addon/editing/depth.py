# SPDX-License-Identifier: GPL-3.0-or-later
"""How light below the surface is shown: one of DEPTHS of material_properties."""

from ..nodes import node_group
from ..properties.material_properties import AUTOMATIC


def has_lengths(material):
    """True if a medium of the layers is given per millimetre."""
    settings, base = material.lamina, material.lamina.base
    if base.kind == "half-space" and base.half_space_form == "coefficients":
        return True
    media = (layer for layer in settings.layers if layer.kind == "medium")
    return any(layer.mode in ("coefficients", "pigment") for layer in media)


def chosen(material):
    """The artist's choice, or what the nodes show in a file of an earlier version."""
    settings = material.lamina
    if settings.depth != "SURFACE" or not node_group.shows_lateral(material):
        return settings.depth
    if settings.lateral_report:
        return "SOFT"
    return "EXACT" if settings.interior.source == "LAYERS" else "VEINS"


def shows_layers(material):
    """False with veins, which are between two materials of their own."""
    return chosen(material) != "VEINS"


def choose(material, depth, lamps_move=False):
    """Choose the depth of a material with layers. Until the artist chooses an output, Exact and Veins compute
    the output LIT, which is nearest to the truth, or RELIGHTABLE if lamps move; and Soft chooses
    automatically."""
    settings, interior = material.lamina, material.lamina.interior
    settings.depth = depth
    if depth == "SURFACE" and node_group.shows_lateral(material) and settings.node_group is not None:
        node_group.connect(material)
    if depth == "EXACT":
        interior.source = "LAYERS"
    elif depth == "VEINS" and interior.source == "LAYERS":
        interior.source = "MARBLE"
    is_new = not interior.is_property_set("output") and not interior.report
    if depth in ("EXACT", "VEINS") and is_new:
        interior.output = "RELIGHTABLE" if lamps_move else "LIT"
    if depth == "SOFT" and not settings.is_property_set("lateral") and not settings.lateral_report:
        settings.lateral = AUTOMATIC
