# SPDX-License-Identifier: GPL-3.0-or-later
"""Settling that is refused or cannot succeed: each reason is one sentence that names the object."""

import bpy
import numpy as np
import pytest
from dusty_objects import NAME, ball, grid, placed, values


def test_bad_meshes_are_one_sentence(dust, addon, lamina):
    empty = placed(bpy.data.meshes.new("Empty"), "Empty")
    with pytest.raises(addon.base.messages.RefusedError, match="Empty has no faces"):
        dust.settle(bpy.context, empty)
    plate = grid()
    plate.data.vertices[3].co.x = float("nan")
    with pytest.raises(lamina.DustError) as caught:
        dust.settle(bpy.context, plate)
    assert "\n" not in addon.base.messages.sentence(caught.value)
    light = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    with pytest.raises(addon.base.messages.RefusedError, match="mesh objects"):
        dust.settle(bpy.context, light)


def test_another_attribute_of_that_name_is_kept(dust, addon):
    plate = grid()
    plate.data.attributes.new(NAME, "FLOAT_COLOR", "CORNER")
    with pytest.raises(addon.base.messages.RefusedError, match="another kind of attribute"):
        dust.settle(bpy.context, plate)
    assert plate.data.attributes[NAME].data_type == "FLOAT_COLOR" and plate.lamina_dust.told == ""


def test_without_a_uv_map_there_is_no_image(dust, addon):
    obj = ball()
    obj.lamina_dust.target = "image"
    with pytest.raises(addon.base.messages.RefusedError, match="Ball has no UV map"):
        dust.settle(bpy.context, obj)


def test_without_embree_dust_says_why_and_baking_works(addon, lamina, material, monkeypatch):
    module = addon.base.native.part("dust")
    monkeypatch.setattr(module, "available", lambda: "dust needs the module lamina._mesh, which is not there")
    plate = grid(material=material)
    with pytest.raises(addon.base.messages.RefusedError, match="lamina._mesh"):
        addon.settling.object_dust.settle(bpy.context, plate)
    with bpy.context.temp_override(object=plate):
        assert not bpy.ops.lamina.dust_settle.poll()
    addon.baking.bake_job.bake_material(material)
    assert addon.baking.bake_job.state(material) == "fresh"


def test_what_keeps_dust_off_or_is_broken_is_named(dust, lamina):
    plate, dome = grid(size=0.1), ball("Sky", radius=50.0)
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 0.0)
    assert "Sky keeps nearly all dust off" in plate.lamina_dust.told
    assert "switch off Keeps Dust Off Others in the panel of Sky" in plate.lamina_dust.told
    dome.lamina_dust.stops = False
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 1.0, rtol=1e-3) and "Sky" not in plate.lamina_dust.told
    broken = grid("Broken", z=3.0)
    broken.data.vertices[3].co.x = float("nan")
    with pytest.raises(lamina.DustError, match=r"^Broken.vertices\[3\] has the coordinate nan"):
        dust.settle(bpy.context, plate)


def test_a_uv_map_beyond_the_image_is_told(dust, lamina):
    plate = grid()
    plate.lamina_dust.target, plate.lamina_dust.size = "image", 16
    for loop in plate.data.uv_layers[0].uv:
        loop.vector = (loop.vector[0] + 1.0, loop.vector[1])
    with pytest.raises(lamina.DustError, match="^Plate: the UV map lies outside the image, with u from 1 to 2"):
        dust.settle(bpy.context, plate)
    assert plate.lamina_dust.image is None and plate.lamina_dust.told == ""
    for loop in plate.data.uv_layers[0].uv:
        loop.vector = (2.0 * loop.vector[0] - 2.0, loop.vector[1])
    dust.settle(bpy.context, plate)
    assert "50 % of the surface is unwrapped beyond the image (u from 0 to 2" in plate.lamina_dust.told


def test_what_the_artist_made_of_the_dust_stays(dust, addon, material, call):
    """An attribute of another kind is the artist's: it stops no removal."""
    plate = grid(material=material)
    bpy.context.view_layer.objects.active = plate
    for name in ("clear", "objects", "stack"):
        addon.scene.dusting.dust(bpy.context, [plate])
        attribute = plate.data.attributes
        attribute.remove(attribute[NAME])
        attribute.new(NAME, "FLOAT", "FACE")
        if name == "clear":
            assert bpy.ops.lamina.dust_clear() == {"FINISHED"}
        elif name == "objects":
            assert bpy.ops.lamina.dust_objects_remove(which="SCENE") == {"FINISHED"}
        else:
            assert call(bpy.ops.lamina.remove_stack, material) == {"FINISHED"}
            assert not material.lamina.enabled
        assert plate.lamina_dust.told == "" and attribute[NAME].domain == "FACE"
        attribute.remove(attribute[NAME])


def test_dust_of_a_linked_mesh_is_not_cleared(dust, addon, tmp_path):
    dust.settle(bpy.context, grid())
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "library.blend"))
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, wanted):
        wanted.objects = ["Plate"]
    bpy.context.scene.collection.objects.link(wanted.objects[0])
    plate = wanted.objects[0].override_create(remap_local_usages=True)
    assert plate.is_editable and plate.lamina_dust.told
    with bpy.context.temp_override(object=plate):
        assert not bpy.ops.lamina.dust_clear.poll()


def test_a_sentence_keeps_the_name_of_an_object(dust):
    table = placed(bpy.data.meshes.new("table"), "table")
    with bpy.context.temp_override(object=table), pytest.raises(RuntimeError, match="^Error: table has no faces"):
        bpy.ops.lamina.dust_settle()
