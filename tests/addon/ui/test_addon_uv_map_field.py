# SPDX-License-Identifier: GPL-3.0-or-later
"""The field of a UV map says which map is used when it is empty, and when the map is missing."""

from types import SimpleNamespace

import bpy
import pytest


class Layout:
    """Stands for Blender's layout, which exists in a window alone; holds the labels."""

    def __init__(self):
        self.labels, self.fields = [], []

    def column(self, **_):
        return self

    row = column

    def prop(self, *_args, **_named):
        pass

    def label(self, text="", icon="NONE"):
        self.labels.append((text, icon))

    def prop_search(self, _owner, name, *_args, **_named):
        self.fields.append(name)


@pytest.fixture
def body(addon):
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    thing = bpy.data.objects.new("Body", mesh)
    bpy.context.scene.collection.objects.link(thing)
    yield thing
    bpy.data.objects.remove(thing)
    bpy.data.meshes.remove(mesh)


def drawn(addon, thing, name):
    """(all labels below the field as one text, icon of the first) for the UV map `name`."""
    layout = Layout()
    context = SimpleNamespace(
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)), region=SimpleNamespace(width=600),
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get,
    )
    addon.ui.uv_map_field.draw_uv_map(context, layout, SimpleNamespace(uv_map=name), thing)
    assert layout.fields == ["uv_map"]
    return " ".join(text for text, _ in layout.labels), layout.labels[0][1] if layout.labels else None


def test_an_empty_field_names_the_map_that_is_used(addon, body):
    body.data.uv_layers.new(name="First")
    body.data.uv_layers.new(name="Second").active_render = True
    text, icon = drawn(addon, body, "")
    assert text == "The field is empty: the map “Second” is used, which is active for rendering" and icon == "INFO"


def test_a_mesh_without_a_map_is_a_fault(addon, body):
    assert drawn(addon, body, "") == ("Body has no UV map: unwrap it", "ERROR")


def test_a_name_without_a_map_is_a_fault(addon, body):
    body.data.uv_layers.new(name="First")
    text, icon = drawn(addon, body, "Second")
    assert text == "Body has no UV map named “Second”: unwrap it, or choose another map" and icon == "ERROR"


def test_a_named_map_needs_no_sentence(addon, body):
    body.data.uv_layers.new(name="First")
    assert drawn(addon, body, "First") == ("", None)


def test_a_tangent_by_uv_map_needs_one(addon, body, material):
    material.lamina.base.anisotropic = True
    body.data.materials.append(material)
    bpy.context.view_layer.objects.active = body
    assert orientation(addon, material) == [("The mesh has no UV map", "ERROR")]
    material.lamina.tangent = "Z"
    assert orientation(addon, material) == []
    material.lamina.tangent = "UV"
    body.data.uv_layers.new(name="First")
    assert orientation(addon, material) == []


def orientation(addon, material):
    """The labels below the fields of the base's anisotropy."""
    layout = Layout()
    addon.ui.fields._draw_orientation(layout, material.lamina.base)
    return layout.labels
