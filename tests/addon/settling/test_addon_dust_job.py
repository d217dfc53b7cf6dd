# SPDX-License-Identifier: GPL-3.0-or-later
"""Settling by operators and in the background: selected objects, cancelled runs, meshes edited meanwhile."""

import bpy
import numpy as np
import pytest
from dusty_objects import NAME, grid, values


def test_the_operator_does_what_the_function_does(dust):
    one, other = grid("One"), grid("Other", z=-50.0)
    one.lamina_dust.others = other.lamina_dust.others = False
    dust.settle(bpy.context, one)
    with bpy.context.temp_override(object=other):
        assert bpy.ops.lamina.dust_settle() == {"FINISHED"}
    assert np.allclose(values(one), values(other), rtol=1e-6)
    with bpy.context.temp_override(object=other):
        assert bpy.ops.lamina.dust_clear() == {"FINISHED"}
        assert not bpy.ops.lamina.dust_clear.poll()
    assert NAME not in other.data.attributes and other.lamina_dust.told == ""


def test_all_selected(dust):
    one, other, third = grid("One"), grid("Other", z=-1.0), grid("Third", z=-2.0)
    with bpy.context.temp_override(object=one, selected_objects=[one, other]):
        bpy.ops.lamina.dust_settle(selected=True)
    assert np.allclose(values(one), 1.0, rtol=1e-3) and values(other).max() < 1.0
    assert NAME not in third.data.attributes


def finish(addon):
    job = addon.settling.dust_job.running()
    job.wait(60.0)
    addon.settling.dust_job.forget()
    return job


def test_in_the_background(dust, addon):
    one, other = grid("One"), grid("Other", z=-1.0)
    told = []
    job = addon.settling.dust_job.start(bpy.context, [one, other])
    job._progress = lambda fraction, text="": told.append(fraction)
    assert finish(addon).finish() == [one, other]
    assert told == sorted(told)
    assert np.allclose(values(one), 1.0, rtol=1e-3) and values(other).max() < 1.0


def test_a_cancelled_run_leaves_the_last_dust(dust, addon, lamina):
    plate = grid()
    dust.settle(bpy.context, plate)
    last, said = values(plate), plate.lamina_dust.told
    plate.lamina_dust.amount, plate.lamina_dust.rays = 5.0, 65536
    addon.settling.dust_job.start(bpy.context, [plate])
    addon.settling.dust_job.running().cancel()
    job = finish(addon)
    with pytest.raises(lamina.Cancelled):
        job.finish()
    assert np.array_equal(values(plate), last) and plate.lamina_dust.told == said


def test_a_mesh_that_was_edited_meanwhile_is_left_alone(dust, addon):
    plate = grid()
    addon.settling.dust_job.start(bpy.context, [plate])
    plate.data.vertices.add(1)
    with pytest.raises(addon.base.messages.RefusedError, match="Plate has been edited"):
        finish(addon).finish()
    assert NAME not in plate.data.attributes


def test_an_object_that_is_gone_is_passed_over(dust, addon):
    plate = grid()
    addon.settling.dust_job.start(bpy.context, [plate])
    bpy.data.objects.remove(plate)
    assert finish(addon).finish() == []


def test_a_mesh_that_is_being_edited_at_the_end_is_left_alone(dust, addon):
    plate = grid()
    addon.settling.dust_job.start(bpy.context, [plate])
    bpy.context.view_layer.objects.active = plate
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(addon.base.messages.RefusedError, match="Plate is being edited: leave Edit Mode"):
        finish(addon).finish()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert NAME not in plate.data.attributes and plate.lamina_dust.told == ""


@pytest.mark.parametrize("way", ["operator", "job"])
def test_all_selected_or_none(dust, addon, way):
    """One refused object leaves the others as they were: a cancelled operator makes no undo step."""
    one, other = grid("One"), grid("Other", z=-1.0)
    if way == "job":
        addon.settling.dust_job.start(bpy.context, [one, other])
        other.data.vertices.add(1)
        with pytest.raises(addon.base.messages.RefusedError, match="Other has been edited"):
            finish(addon).finish()
    else:
        other.data.attributes.new(NAME, "FLOAT_COLOR", "POINT")
        chosen = {"object": one, "selected_objects": [one, other]}
        with bpy.context.temp_override(**chosen), pytest.raises(RuntimeError, match="another kind of attribute"):
            bpy.ops.lamina.dust_settle(selected=True)
    assert NAME not in one.data.attributes and one.lamina_dust.told == ""
