# SPDX-License-Identifier: GPL-3.0-or-later
"""The words of the panel: descriptions of everything that has a tooltip, units, no Greek letters."""

import re

import bpy
from addon_helpers import drawn

GREEK = re.compile("[\u0370-\u03ff]|^(alpha|beta|eta|lambda|mu|sigma|tau)$", re.IGNORECASE)


def operators():
    for name in dir(bpy.ops.lamina):
        yield name, getattr(bpy.ops.lamina, name).get_rna_type()


def edited(addon):
    """The property groups with properties that a panel draws."""
    properties = addon.properties
    return (properties.layer_properties.LaminaDepth, properties.layer_properties.LaminaLayer,
            properties.layer_properties.LaminaBase, properties.dust_properties.LaminaDust,
            *properties.interior_properties.CLASSES, addon.base.preferences.LaminaPreferences)  # fmt: skip


def test_every_operator_and_each_of_its_properties_is_described(addon):
    silent = [name for name, rna in operators() if not rna.description]
    silent += [f"{name}.{prop.identifier}" for name, rna in operators() for prop in rna.properties
               if prop.identifier != "rna_type" and not prop.description]
    assert silent == [] and len(list(operators())) > 25


def test_every_property_in_a_panel_is_described(addon):
    silent = [f"{cls.__name__}.{prop.identifier}" for cls in edited(addon) for prop in cls.bl_rna.properties
              if prop.type not in ("POINTER", "COLLECTION")
              and prop.identifier not in ("rna_type", "name", "bl_idname") and not prop.description]
    assert silent == []


def test_a_number_of_millimetres_says_so_in_its_label(addon, material):
    layer = material.lamina.layers[0]
    layer.mode = "coefficients"
    texts = drawn(addon.ui.fields.draw_layer, layer)
    assert {"Scattering (1/mm) R", "Absorption (1/mm) R", "Thickness (mm)"} <= set(texts)
    for cls in edited(addon):
        for prop in cls.bl_rna.properties:
            if re.search(r"\b(in mm|in 1/mm|per mm|millimetres)\b", prop.description):
                assert "mm" in prop.name, f"{cls.__name__}.{prop.identifier}"


def test_no_label_is_a_greek_letter(addon, material):
    layer = material.lamina.layers[0]
    texts = drawn(addon.ui.fields.draw_base, material.lamina.base)
    for phase in layer.bl_rna.properties["phase"].enum_items:
        layer.phase = phase.identifier
        texts += drawn(addon.ui.fields.draw_layer, layer)
    assert [text for text in texts if GREEK.search(text)] == []
