# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties, rows and JSON that the add-on makes from the descriptions in lamina.kinds."""

import dataclasses
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from addon_helpers import drawn_base, drawn_layer
from measured_tables import facets, measured

from lamina.kinds import bases, boundaries, dust, interiors, media, phases
from lamina.kinds.fields import Option


def ends(field):
    """The range of a field's property in single precision."""
    panel = field.panel
    low, high = (field.low if panel.low is None else panel.low, field.high if panel.high is None else panel.high)
    return np.float32([low, high]) * (100 if getattr(panel, "percent", False) else 1)


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
    inside = addon.properties.interior_properties
    for owner, fields in ((inside.LaminaGround, interiors.GROUND), (inside.LaminaVeins, interiors.VEINS),
                          (inside.LaminaInterior, interiors.MARBLE + interiors.BODY + interiors.MAPS)):
        yield from ((owner, field) for field in fields if field.panel is not None)


def test_every_field_has_its_property(addon):
    for owner, field in described(addon):
        prop = owner.bl_rna.properties[field.prop]
        if isinstance(field, Option):
            assert prop.default == field.usual and {item.identifier for item in prop.enum_items} == set(field.values)
            assert (prop.name, prop.description) == (field.label, field.tip)
            continue
        assert [prop.hard_min, prop.hard_max] == pytest.approx(ends(field)), field.name
        assert (prop.name, prop.description) == (field.panel.label, field.panel.tip)
        default = list(prop.default_array) if prop.is_array else [prop.default]
        wanted = np.broadcast_to(field.panel.default, len(default)) * (100 if field.panel.percent else 1)
        assert default == pytest.approx(np.float32(wanted)) and prop.is_array == field.panel.rgb


def test_an_untouched_interior_is_the_marble_of_lamina(addon, lamina, material):
    """Its numbers are read as the decimals of lamina's own defaults, and the veins differ from the ground."""
    from bl_ext.user_default.lamina.interior import contents
    from bl_ext.user_default.lamina.properties import described

    settings = material.lamina.interior
    corners = np.array([[0.0, 0.0, 0.0], [8.0, 4.0, 2.0]])
    corner_uvs = np.array([[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]])
    body = SimpleNamespace(arrays=SimpleNamespace(vertices=corners, uvs=corner_uvs))
    settings.resolution = 4
    filled = contents.of_material(None, material, body)
    found = filled.fill(None, None)
    assert found.palette == lamina.Marble().palette and found.palette[0] != found.palette[1]
    assert found.hash == lamina.marble(found.low, found.high, 4).hash
    assert filled.surface == lamina.Surface(1.5, 0.3**2)
    assert described.quantity(settings, interiors.NOISE) == interiors.NOISE.panel.default


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
    assert labels <= set(drawn_layer(addon, layer))
    phase = addon.editing.stack_io.to_stack(material).layers[0].phase
    assert phase == cls(**{field.name: pytest.approx(field.panel.default) for field in cls.fields})


@pytest.mark.parametrize("cls", bases.IN_PANEL, ids=lambda cls: cls.kind)
def test_a_base_is_drawn_written_and_read(addon, lamina, material, cls):
    base = material.lamina.base
    base.kind = cls.kind
    if cls is bases.Measured:
        base.table, base.measured_name = measured(facets(0.2, 0.1, 0.3)).table, "paint"
    lines = " ".join(drawn_base(addon, base))
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


@pytest.mark.parametrize("form", bases.Conductor.forms, ids=lambda form: form.item.id)
def test_a_metal_is_drawn_written_and_read_in_each_form(addon, material, form):
    base = material.lamina.base
    base.kind, base.metal_form = "conductor", form.item.id
    data = addon.editing.stack_io.to_dict(material)
    assert {quantity.name for quantity in form} <= set(data["base"])
    assert drawn_base(addon, base).count("Metal") == 1  # a menu, or the name alone
    other = bpy.data.materials.new("Other")
    addon.editing.stack_io.assign_stack(other, addon.editing.stack_io.to_stack(material))
    assert addon.editing.stack_io.to_dict(other)["base"] == data["base"]


@pytest.mark.parametrize("form", media.FORMS, ids=lambda form: form.item.id)
def test_a_medium_is_drawn_written_and_read_in_each_form(addon, material, form):
    layer = material.lamina.layers[0]
    layer.mode = form.item.id
    data = addon.editing.stack_io.to_dict(material)
    assert {quantity.name for quantity in form.local} <= set(data["layers"][0])
    lines = " ".join(drawn_layer(addon, layer))
    for quantity in form.local:
        assert (quantity.label if isinstance(quantity, Option) else quantity.panel.label) in lines
    other = bpy.data.materials.new("Other")
    addon.editing.stack_io.assign_stack(other, addon.editing.stack_io.to_stack(material))
    assert addon.editing.stack_io.to_dict(other)["layers"] == data["layers"]


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


def test_two_numbers_of_one_name(addon):
    """Two different quantities cannot share a property; one quantity of two kinds can. No property replaces another."""
    quantities, having = addon.properties.described.quantities, addon.properties.described.having
    assert list(quantities([boundaries.IOR, boundaries.ALPHA, boundaries.IOR])) == ["ior", "alpha"]
    with pytest.raises(ValueError, match="two properties are named ior"):
        quantities([boundaries.IOR, dataclasses.replace(boundaries.IOR, high=9.0)])
    owner = type("Owner", (), {"__annotations__": {"ior": None}})
    with pytest.raises(ValueError, match="Owner has a property of this name already: ior"):
        having(quantities([boundaries.IOR]))(owner)
    assert list(having(quantities([boundaries.ALPHA]))(owner).__annotations__) == ["ior", "alpha"]
