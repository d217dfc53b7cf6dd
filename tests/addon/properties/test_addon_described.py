# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties, rows and JSON that the add-on makes from the descriptions in lamina.kinds."""

import bpy
import numpy as np
import pytest
from addon_helpers import drawn

from lamina.kinds import bases, dust, media, phases


def ends(field):
    """The range of a field's property in single precision."""
    panel = field.panel
    return np.float32([field.low if panel.low is None else panel.low, field.high if panel.high is None else panel.high])


def described(addon):
    """(owner's class, field) of every field that the panel edits."""
    properties = addon.properties.layer_properties
    for form in media.FORMS:
        yield from ((properties.LaminaLayer, field) for field in form)
        yield from ((properties.LaminaDepth, field) for field in form.local)
    for owner in (properties.LaminaLayer, properties.LaminaDepth, properties.LaminaBase):
        yield from ((owner, field) for cls in phases.IN_PANEL for field in cls.fields)
    for cls in bases.IN_PANEL:
        yield from ((properties.LaminaBase, field) for form in (cls.fields, *cls.forms) for field in form)


def test_every_field_has_its_property(addon):
    for owner, field in described(addon):
        prop = owner.bl_rna.properties[field.prop]
        assert [prop.hard_min, prop.hard_max] == pytest.approx(ends(field)), field.name
        assert (prop.name, prop.description) == (field.panel.label, field.panel.tip)
        default = list(prop.default_array) if prop.is_array else [prop.default]
        wanted = np.broadcast_to(field.panel.default, len(default))
        assert default == pytest.approx(np.float32(wanted)) and prop.is_array == field.panel.rgb


def test_every_option_of_settling_has_its_property(addon):
    usual = dust.Settling()
    for option in dust.OPTIONS:
        if option.panel is None:
            continue
        prop = addon.properties.dust_properties.LaminaDust.bl_rna.properties[option.name]
        assert (prop.name, prop.description) == (option.panel.label, option.panel.tip)
        default = getattr(usual, option.name) if option.panel.default is None else option.panel.default
        assert prop.default == pytest.approx(default)
        if not option.switch:
            assert [prop.hard_min, prop.hard_max] == pytest.approx(ends(option))


@pytest.mark.parametrize("cls", phases.IN_PANEL, ids=lambda cls: cls.kind)
def test_a_phase_function_is_drawn_and_written(addon, lamina, material, cls):
    layer = material.lamina.layers[0]
    layer.phase = cls.kind
    labels = {field.panel.label for field in cls.fields}
    assert labels <= set(drawn(addon.ui.fields.draw_layer, layer))
    phase = addon.editing.stack_io.to_stack(material).layers[0].phase
    assert phase == cls(**{field.name: pytest.approx(field.panel.default) for field in cls.fields})


@pytest.mark.parametrize("cls", bases.IN_PANEL, ids=lambda cls: cls.kind)
def test_a_base_is_drawn_written_and_read(addon, lamina, material, cls):
    base = material.lamina.base
    base.kind = cls.kind
    lines = " ".join(drawn(addon.ui.fields.draw_base, base))
    form = next((form for form in cls.forms if form.item.id == getattr(base, cls.form_prop)), ())
    for field in (*form, *cls.fields):
        assert (field.panel.label if field.prop != "alpha" else "Roughness") in lines
    for option in cls.options:
        assert option.label in lines
    data = addon.editing.stack_io.to_dict(material)
    assert data["base"]["kind"] == cls.kind and addon.editing.stack_io.to_stack(material).base.kind == cls.kind
    other = bpy.data.materials.new("Other")
    addon.editing.stack_io.assign(other, data)
    assert addon.editing.stack_io.to_dict(other) == data


def test_a_base_that_becomes_a_metal_is_gold(addon, lamina, material):
    """In both forms, by the table of metals that lamina has."""
    base = material.lamina.base
    base.kind = "conductor"
    gold = lamina.metals.conductor("gold")
    eta, k = lamina.metals.indices_of(gold, 3, "base")
    assert base.metal_form == "colours"
    for name, numbers in (("facing", gold.facing), ("grazing", gold.grazing), ("eta", eta), ("k", k)):
        assert tuple(getattr(base, name)) == pytest.approx(numbers, rel=1e-6)
    assert addon.editing.metals.name_of(base) == "gold"


def test_a_metal_without_the_wheel_has_numbers_too(addon, material, monkeypatch):
    monkeypatch.setattr(addon.base.native, "_package", None)
    base = material.lamina.base
    base.kind = "conductor"
    assert base.facing[0] == 1.0 and base.k[0] > 60.0
