# SPDX-License-Identifier: GPL-3.0-or-later
"""Where dust lands on Blender objects: amounts, roofs, transforms, modifiers, images and animated roofs."""

import json

import bpy
import numpy as np
import pytest
from addon_helpers import pixels
from dusty_objects import NAME, ball, grid, placed, values


def test_an_open_plate_gets_the_amount(dust, addon):
    plate = grid()
    plate.lamina_dust.amount, plate.lamina_dust.time = 0.7, 2.0
    found = dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 1.4, rtol=1e-3)
    assert plate.lamina_dust.told == str(found.statistics) and plate.lamina_dust.largest == pytest.approx(1.4, rel=1e-3)


def test_mass_makes_thickness_by_the_extinction_of_the_dust(dust, lamina):
    plate = grid()
    plate.lamina_dust.form, plate.lamina_dust.grams, plate.lamina_dust.substance = "mass", 3.0, "ash-mount-st-helens"
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 3.0 * 0.630, rtol=1e-3)


def test_every_dust_of_the_panel_is_one_of_the_package(addon, lamina):
    from lamina.kinds.substances import DUSTS

    assert [name for name, *_ in addon.properties.dust_properties.SUBSTANCES] == list(DUSTS)


ROOFS = {
    "object": (lambda roof: None, True),
    "hidden in renders": (lambda roof: setattr(roof, "hide_render", True), False),
    "without shadow": (lambda roof: setattr(roof, "visible_shadow", False), False),
    "let through": (lambda roof: setattr(roof.lamina_dust, "stops", False), False),
}


@pytest.mark.parametrize(("change", "stops"), ROOFS.values(), ids=ROOFS)
def test_what_is_in_the_way(dust, change, stops):
    plate, roof = grid(size=0.1), grid("Roof", size=5.0, z=1.0)
    change(roof)
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 0.0 if stops else 1.0, atol=1e-3)
    plate.lamina_dust.others = False
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 1.0, rtol=1e-3)


def test_instances_are_in_the_way(dust):
    plate, roof = grid(size=0.1), grid("Roof", size=5.0)
    hidden = bpy.data.collections.new("Parts")
    bpy.context.scene.collection.objects.unlink(roof)
    hidden.objects.link(roof)
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 1.0, rtol=1e-3)
    empty = bpy.data.objects.new("Instance", None)
    empty.instance_type, empty.instance_collection, empty.location.z = "COLLECTION", hidden, 1.0
    bpy.context.scene.collection.objects.link(empty)
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 0.0, atol=1e-3)


@pytest.mark.parametrize("scale", [(2.0, 0.5, 1.0), (1.0, 1.0, -1.0)])
def test_scale_and_rotation(dust, scale):
    """As if they had been applied to the mesh."""
    moved, applied = ball("Moved"), ball("Applied")
    applied.lamina_dust.others = moved.lamina_dust.others = False
    moved.scale, moved.rotation_euler, moved.location = scale, (0.5, 0.3, 1.0), (3.0, -2.0, 5.0)
    bpy.context.view_layer.update()
    applied.data.transform(moved.matrix_world)
    if moved.matrix_world.determinant() < 0.0:
        applied.data.flip_normals()
    dust.settle(bpy.context, moved)
    dust.settle(bpy.context, applied)
    assert values(moved).max() > 0.9 and values(moved).min() < 0.01
    assert np.allclose(values(moved), values(applied), atol=0.02)


def test_units(dust):
    """Two scenes of one size in metres are one scene."""
    small, large = ball(radius=0.01), ball(radius=1.0)
    for obj in (small, large):
        obj.lamina_dust.others, obj.lamina_dust.coverage = False, 0.5
    bpy.context.scene.unit_settings.scale_length, small.lamina_dust.patch = 1.0, 0.005
    dust.settle(bpy.context, small)
    bpy.context.scene.unit_settings.scale_length, large.lamina_dust.patch = 0.01, 0.5
    dust.settle(bpy.context, large)
    bpy.context.scene.unit_settings.scale_length = 1.0
    assert np.allclose(values(small), values(large), atol=0.02)


def test_gravity_is_the_scenes(dust):
    plate = grid()
    bpy.context.scene.gravity = (0.0, 0.0, 9.81)
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 0.0)
    bpy.context.scene.gravity = (0.0, 0.0, -9.81)


def test_modifiers_that_make_vertices(dust):
    """The vertices of the mesh itself have the dust of their rendered positions."""
    cube, evaluated = ball("Cube", smooth=True), None
    cube.lamina_dust.others = False
    cube.modifiers.new("Smooth", "SUBSURF").levels = 2
    evaluated = placed(bpy.data.meshes.new_from_object(cube.evaluated_get(bpy.context.evaluated_depsgraph_get())), "E")
    evaluated.lamina_dust.others = False
    dust.settle(bpy.context, cube)
    dust.settle(bpy.context, evaluated)
    own = np.array([vertex.co for vertex in cube.data.vertices])
    fine = np.array([vertex.co for vertex in evaluated.data.vertices])
    assert len(fine) > 4 * len(own)
    assert f"has the mesh's {len(own)} vertices for the {len(fine):,}" in cube.lamina_dust.told
    assert "vertices for" not in evaluated.lamina_dust.told
    # A vertex moves little under subdivision: its own is the nearest.
    nearest = [int(np.argmin(((fine - place) ** 2).sum(axis=1))) for place in own]
    assert np.allclose(values(cube), values(evaluated)[nearest], atol=0.03)
    assert [attribute.name for attribute in cube.data.attributes if attribute.name == "lamina_vertex"] == []


@pytest.mark.parametrize("kind", ["MIRROR", "SOLIDIFY", "REMESH", "DECIMATE", "ARRAY"])
def test_modifiers_of_all_sorts(dust, kind):
    plate = grid(cells=6)
    modifier = plate.modifiers.new("Any", kind)
    if kind == "SOLIDIFY":
        modifier.thickness = 0.05
    if kind == "REMESH":
        plate.modifiers.move(plate.modifiers.find(modifier.name), 0)
        modifier.voxel_size = 0.1
        thick = plate.modifiers.new("Thick", "SOLIDIFY")
        thick.thickness = 0.3
        plate.modifiers.move(1, 0)
    if kind == "MIRROR":
        modifier.use_axis = (False, True, False)
    dust.settle(bpy.context, plate)
    found = values(plate)
    assert len(found) == len(plate.data.vertices)
    assert np.median(found) == pytest.approx(1.0, abs=0.02)


def test_objects_that_share_a_mesh(dust):
    open_plate, roof = grid(size=0.1), grid("Roof", size=5.0, z=1.0)
    sheltered = placed(open_plate.data, "Sheltered")
    open_plate.location.z = 2.0
    dust.settle(bpy.context, sheltered)
    assert sheltered.data != open_plate.data and NAME not in open_plate.data.attributes
    dust.settle(bpy.context, open_plate)
    assert np.allclose(values(sheltered), 0.0, atol=1e-3) and np.allclose(values(open_plate), 1.0, rtol=1e-3)
    assert roof.lamina_dust.told == ""


def test_an_image_holds_what_the_vertices_would(dust):
    plate, roof = grid(size=1.0), grid("Roof", size=2.0, z=0.2)
    roof.location.x = -2.0  # over the half with u < .5
    settings = plate.lamina_dust
    settings.target, settings.size = "image", 32
    dust.settle(bpy.context, plate)
    image = settings.image
    assert image.packed_file is not None and image.colorspace_settings.name == "Non-Color" and image.is_float
    found = pixels(image)[..., 0]
    assert np.allclose(found[:, :8], 0.0, atol=1e-3) and np.allclose(found[:, -8:], 1.0, rtol=1e-3)
    first, name = image, image.name
    settings.amount = 2.0
    dust.settle(bpy.context, plate)
    assert settings.image != first and settings.image.name == name
    assert np.allclose(pixels(settings.image)[:, -8:, 0], 2.0, rtol=1e-3)
    assert len([one for one in bpy.data.images if "dust" in one.name]) == 1


def test_the_same_seed_gives_the_same_dust(dust):
    obj = ball()
    obj.lamina_dust.coverage = 0.5
    found = []
    for seed, threads in ((1, 1), (1, 2), (2, 1)):
        obj.lamina_dust.seed = seed
        dust.settle(bpy.context, obj, threads=threads)
        found.append(values(obj).tobytes())
    assert found[0] == found[1] != found[2]


def test_a_slope_of_180_degrees_is_one(dust):
    plate = grid()
    plate.lamina_dust.repose = 4.0  # single precision rounds the panel's largest value up
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 1.0, rtol=1e-3)


def test_dust_falls_over_the_frames_of_an_animation(dust, addon):
    """A roof moves from the left half to the right half: at two frames, each half gets half of the amount."""
    plate = grid(cells=8)
    roof = grid("Roof", size=1.2, z=0.4)
    for frame, shift in ((1, -1.24), (11, 1.24)):
        roof.location.x = shift
        roof.keyframe_insert("location", index=0, frame=frame)
    settings, scene = plate.lamina_dust, bpy.context.scene
    scene.frame_set(4)
    settings.spread, settings.repose = 0.0, 3.1
    settings.over_frames, settings.frame_first, settings.frame_last, settings.frame_step = True, 1, 11, 10
    found = dust.settle(bpy.context, plate)
    assert scene.frame_current == 4
    aside = np.abs([vertex.co.x for vertex in plate.data.vertices]) > 0.2
    assert found.tau[: len(aside)][aside] == pytest.approx(0.5, abs=1e-5)
    settings.frame_last = 0
    with pytest.raises(addon.base.messages.RefusedError, match="Last Frame = 0: must be at least First Frame, 1"):
        dust.settle(bpy.context, plate)
    settings.frame_last, settings.frame_step = 100000, 1
    with pytest.raises(addon.base.messages.RefusedError, match="100000 frames: at most 1000"):
        dust.settle(bpy.context, plate)
    assert scene.frame_current == 4


def test_edges_are_rubbed_within_their_width(dust, addon):
    """The width is in units of the scene. Dust of a file from before the setting is not out of date."""
    obj = grid(cells=16, size=0.5)
    solid = obj.modifiers.new("Solid", "SOLIDIFY")
    solid.thickness = 0.4
    bpy.context.scene.unit_settings.scale_length = 0.01
    dust.settle(bpy.context, obj)
    plain = values(obj)
    settings, outdated = obj.lamina_dust, addon.settling.dust_settings.is_outdated
    settled = json.loads(settings.settled)
    for name in ("rubbed", "edge"):
        del settled[name]
    settings.settled = json.dumps(settled)
    assert not outdated(settings)
    settings.rubbed, settings.edge = 1.0, 0.2
    assert outdated(settings)
    dust.settle(bpy.context, obj)
    rubbed = values(obj)
    far = np.array([0.5 - max(abs(vertex.co.x), abs(vertex.co.y)) for vertex in obj.data.vertices])
    assert not outdated(settings)
    assert rubbed[far > 0.21] == pytest.approx(plain[far > 0.21])
    assert rubbed[far < 0.01].max() < 0.5 and (rubbed <= plain + 1e-6).all()
