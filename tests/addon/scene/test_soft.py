# SPDX-License-Identifier: GPL-3.0-or-later
"""The automatic choice of how soft light is shown."""

import bpy
import numpy as np
import pytest
from tried_bodies import blocks, body

from lamina import Interface, Isotropic, Medium, Stack


@pytest.fixture
def soft(addon, lamina):
    from bl_ext.user_default.lamina.scene import soft

    yield soft
    addon.baking.lateral_job.stop()


def layered(addon, obj, *media):
    """The object's material with these layers, and Soft chosen."""
    material = obj.active_material
    addon.editing.layer_list.add_stack(material)
    addon.editing.stack_io.assign_stack(material, Stack(list(media)))
    material.lamina.quality = "preview"
    addon.editing.depth.choose(material, "SOFT")
    assert material.lamina.lateral == "AUTO"
    return material


def medium(path, thickness=np.inf):
    return Medium(sigma_s=0.95 / path, sigma_a=0.05 / path, thickness=thickness, phase=Isotropic())


def test_the_fastest_output_where_it_is_right(addon, soft, call):
    obj = body("torus", "sky")
    material = layered(addon, obj, medium(0.05))
    assert call(bpy.ops.lamina.lateral, material) == {"FINISHED"}
    assert material.lamina.lateral_shown == "RELIGHTABLE" and "on the whole" in material.lamina.trial
    assert addon.baking.lateral_job.stale(material) == ""


def test_volume_where_the_others_are_wrong(addon, soft):
    obj = body("plate", "behind")
    material = layered(addon, obj, medium(0.1))
    assert soft.make(bpy.context, obj, material) == ("VOLUME", None)
    assert material.lamina.lateral_shown == "VOLUME"
    assert material.lamina.trial.startswith("Tried: Mean Distance ")
    assert "Full Profile" in material.lamina.trial


def test_the_best_of_the_others_where_a_boundary_hides_lamps_from_a_volume(addon, soft):
    obj = body("plate", "behind")
    material = layered(addon, obj, Interface(1.4), medium(0.1))
    output, tried = soft.make(bpy.context, obj, material)
    assert output in ("RELIGHTABLE", "PORTAL") and material.lamina.lateral_shown == output
    assert abs(tried.error) > soft.MEAN or tried.spread > soft.SPREAD
    assert material.lamina.trial.endswith("Exact is nearer")


def test_without_light_the_thickness_decides(addon, soft):
    obj = body("plate", "sky")
    bpy.context.scene.world = None
    material = layered(addon, obj, medium(0.1))
    assert soft.make(bpy.context, obj, material)[0] == "VOLUME"
    material = layered(addon, obj, medium(0.01))
    assert soft.make(bpy.context, obj, material)[0] == "RELIGHTABLE"


def test_several_layers_are_never_a_volume(addon, soft):
    obj = body("plate", "sky")
    material = layered(addon, obj, medium(0.2, 0.05), medium(0.1))
    assert soft.make(bpy.context, obj, material)[0] == "RELIGHTABLE"
    assert material.lamina.trial.startswith("Mean Distance, by the thickness of the object. No trial: layers: must be")


def test_a_job_leaves_nothing_behind(addon, soft):
    obj = body("torus", "sky")
    material = layered(addon, obj, medium(0.05))
    before = blocks()
    job = soft.start(bpy.context, obj, material)
    while not job.done:
        job.tick()
        job.wait(0.01)
    assert job.finish() == material and material.lamina.lateral_shown == "RELIGHTABLE"
    now = blocks()
    assert (now.materials, now.objects, now.scenes) == (before.materials, before.objects, before.scenes)
    assert now.groups == before.groups + 1


def test_a_cancelled_job_changes_nothing(addon, soft):
    obj = body("torus", "sky")
    material = layered(addon, obj, medium(0.05))
    before = blocks()
    job = soft.start(bpy.context, obj, material)
    job.cancel()
    job.wait(60.0)
    with pytest.raises(addon.base.native.require().Cancelled):
        job.finish()
    assert blocks() == before and material.lamina.lateral_shown == ""


def test_an_artists_choice_stays(addon, soft):
    material = layered(addon, body("torus", "sky"), medium(0.05))
    material.lamina.lateral = "PORTAL"
    addon.editing.depth.choose(material, "SURFACE")
    addon.editing.depth.choose(material, "SOFT")
    assert material.lamina.lateral == "PORTAL"


def test_another_object_is_refused(addon, soft, call):
    obj = body("torus", "sky")
    material = layered(addon, obj, medium(0.05))
    bpy.context.view_layer.objects.active = bpy.context.scene.camera
    with pytest.raises(RuntimeError, match="select an object with"):
        call(bpy.ops.lamina.lateral, material)


def test_a_curve_has_no_trial(addon, soft, call):
    curve = bpy.data.curves.new("cord", "CURVE")
    obj = bpy.data.objects.new("cord", curve)
    bpy.context.scene.collection.objects.link(obj)
    curve.materials.append(bpy.data.materials.new("Wax"))
    bpy.context.view_layer.objects.active = obj
    material = layered(addon, obj, medium(0.05))
    assert call(bpy.ops.lamina.lateral, material) == {"FINISHED"}
    assert material.lamina.trial.endswith("No trial: cord has no mesh of its own: convert it")
