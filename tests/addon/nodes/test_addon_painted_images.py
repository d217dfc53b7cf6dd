# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes on images of thickness, coverage and masks, which are saved with the file."""

import bpy
import numpy as np


def paint(image, value):
    image.pixels.foreach_set(np.full(len(image.pixels), value, np.float32))
    image.update()


def test_strokes_are_saved_with_the_file(addon, lamina, material, tmp_path):
    thickness = addon.nodes.thickness
    material.use_fake_user = True
    layer = material.lamina.layers[0]
    layer.varying, layer.tau = True, 2.0
    addon.baking.bake_job.bake_material(material)
    thickness.wire_thickness(material, "image")
    material[thickness.KEPT["Coverage"]] = thickness.new_image(material, "Coverage")
    foreign = bpy.data.images.new("Foreign", 4, 4, float_buffer=True)
    foreign.use_fake_user = True
    foreign.pack()
    paint(thickness.wiring(material).node.image, 0.5)
    paint(material[thickness.KEPT["Coverage"]], 0.25)
    paint(foreign, 0.25)

    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "painted.blend"))
    assert foreign.is_dirty  # it is the artist's
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "painted.blend"))
    (material,) = bpy.data.materials
    assert thickness.wiring(material).node.image.pixels[0] == 0.5
    assert material[thickness.KEPT["Coverage"]].pixels[0] == 0.25


def test_strokes_of_a_mask_are_saved_with_the_file(addon, lamina, material, tmp_path):
    material.use_fake_user = True
    material.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(material)
    bpy.ops.mesh.primitive_plane_add()
    _, image = addon.settling.wiping.add_mask(bpy.context.object, material, "image")
    paint(image, 1.0)

    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "wiped.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "wiped.blend"))
    (material,) = bpy.data.materials
    assert addon.nodes.detail_wiring.mask(material).image.pixels[0] == 1.0


def test_painted_images_stay_without_layers(addon, lamina, material):
    thickness = addon.nodes.thickness
    material.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(material)
    thickness.wire_thickness(material, "image")
    material[thickness.KEPT["Coverage"]] = thickness.new_image(material, "Coverage")
    bpy.ops.mesh.primitive_plane_add()
    addon.settling.wiping.add_mask(bpy.context.object, material, "image")
    addon.editing.layer_list.remove_stack(material)
    stay = {image.name for image in bpy.data.images if image.use_fake_user}
    assert stay == {"Bronze thickness", "Bronze coverage", "Plane wiped"}
