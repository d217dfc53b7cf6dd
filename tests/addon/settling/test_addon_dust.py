# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust on Blender objects: where it lands, how it is stored, and mass balance."""

from types import SimpleNamespace

import bmesh
import bpy
import numpy as np
import pytest
from addon_helpers import drawn

NAME = "lamina_dust"


@pytest.fixture
def dust(addon, lamina):
    reason = addon.settling.object_dust.unavailable()
    assert not reason, reason
    return addon.settling.object_dust


def grid(name="Plate", size=1.0, z=0.0, cells=8, material=None):
    """A horizontal square with a UV map, linked to the scene."""
    mesh = bpy.data.meshes.new(name)
    made = bmesh.new()
    bmesh.ops.create_grid(made, x_segments=cells, y_segments=cells, size=size, calc_uvs=False)
    uv = made.loops.layers.uv.new("UVMap")
    for face in made.faces:
        for loop in face.loops:
            loop[uv].uv = [0.5 + 0.5 * loop.vert.co[axis] / size for axis in range(2)]
    made.to_mesh(mesh)
    made.free()
    return placed(mesh, name, z, material)


def placed(mesh, name, z=0.0, material=None):
    obj = bpy.data.objects.new(name, mesh)
    obj.location.z = z
    bpy.context.scene.collection.objects.link(obj)
    if material is not None:
        mesh.materials.append(material)
    obj.lamina_dust.rays = 64
    return obj


def ball(name="Ball", radius=1.0, smooth=False):
    mesh = bpy.data.meshes.new(name)
    made = bmesh.new()
    bmesh.ops.create_icosphere(made, subdivisions=2, radius=radius)
    for face in made.faces:
        face.smooth = smooth
    made.to_mesh(mesh)
    made.free()
    return placed(mesh, name)


def values(obj):
    attribute = obj.data.attributes[NAME]
    assert attribute.data_type == "FLOAT" and attribute.domain in ("POINT", "CORNER")
    found = np.empty(len(attribute.data), np.float32)
    attribute.data.foreach_get("value", found)
    return found


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


def pixels(image):
    found = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(found)
    return found.reshape(image.size[1], image.size[0], 4)[..., 0]


def test_an_image_holds_what_the_vertices_would(dust):
    plate, roof = grid(size=1.0), grid("Roof", size=2.0, z=0.2)
    roof.location.x = -2.0  # over the half with u < .5
    settings = plate.lamina_dust
    settings.target, settings.size = "image", 32
    dust.settle(bpy.context, plate)
    image = settings.image
    assert image.packed_file is not None and image.colorspace_settings.name == "Non-Color" and image.is_float
    found = pixels(image)
    assert np.allclose(found[:, :8], 0.0, atol=1e-3) and np.allclose(found[:, -8:], 1.0, rtol=1e-3)
    first, name = image, image.name
    settings.amount = 2.0
    dust.settle(bpy.context, plate)
    assert settings.image != first and settings.image.name == name
    assert np.allclose(pixels(settings.image)[:, -8:], 2.0, rtol=1e-3)
    assert len([one for one in bpy.data.images if "dust" in one.name]) == 1


def test_without_a_uv_map_there_is_no_image(dust, addon):
    obj = ball()
    obj.lamina_dust.target = "image"
    with pytest.raises(addon.base.messages.RefusedError, match="Ball has no UV map"):
        dust.settle(bpy.context, obj)


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


def test_the_same_seed_gives_the_same_dust(dust):
    obj = ball()
    obj.lamina_dust.coverage = 0.5
    found = []
    for seed, threads in ((1, 1), (1, 2), (2, 1)):
        obj.lamina_dust.seed = seed
        dust.settle(bpy.context, obj, threads=threads)
        found.append(values(obj).tobytes())
    assert found[0] == found[1] != found[2]


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


def test_the_material_reads_the_dust(dust, addon, material):
    layer = material.lamina.layers[0]
    layer.varying, layer.tau = True, 2.0
    addon.baking.bake_job.bake_material(material)
    plate = grid(material=material)
    assert addon.nodes.thickness.wiring(material).source == "value"
    dust.settle(bpy.context, plate)
    found = addon.nodes.thickness.wiring(material)
    assert (found.source, found.name) == ("attribute", NAME)
    assert addon.ui.dust_panel.mismatch(material, plate.lamina_dust) == ""
    plate.lamina_dust.amount = 3.0
    dust.settle(bpy.context, plate)
    assert "above τ 2 nothing changes" in addon.ui.dust_panel.mismatch(material, plate.lamina_dust)
    plate.lamina_dust.target = "image"
    assert "does not read it" in addon.ui.dust_panel.mismatch(material, plate.lamina_dust)
    dust.settle(bpy.context, plate)
    assert addon.nodes.thickness.wiring(material).source == "image"


def test_the_first_dust_of_a_material_gets_grain_and_clouds(dust, addon, material):
    material.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(material)
    plate = grid(size=3.0, material=material)
    dust.settle(bpy.context, plate)
    node = addon.nodes.detail_wiring.detail(material)
    assert node.inputs["Cloud Size"].default_value == pytest.approx(0.2 * 6.0)
    addon.nodes.detail_wiring.remove_detail(material)
    dust.settle(bpy.context, plate)
    assert addon.nodes.detail_wiring.detail(material) is None
    assert addon.nodes.thickness.wiring(material).source == "attribute"


def test_an_artists_own_node_stays(dust, addon, material):
    material.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(material)
    socket = addon.nodes.node_group.group_nodes(material)[0].inputs["Thickness"]
    mine = material.node_tree.nodes.new("ShaderNodeValue")
    material.node_tree.links.new(mine.outputs[0], socket)
    dust.settle(bpy.context, grid(material=material))
    assert socket.links[0].from_node == mine


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


def test_a_slope_of_180_degrees_is_one(dust):
    plate = grid()
    plate.lamina_dust.repose = 4.0  # single precision rounds the panel's largest value up
    dust.settle(bpy.context, plate)
    assert np.allclose(values(plate), 1.0, rtol=1e-3)


def test_the_panels_of_dust_and_of_its_detail(dust, addon, material):
    layer = material.lamina.layers[0]
    layer.varying, layer.tau = True, 2.0
    addon.baking.bake_job.bake_material(material)
    plate = grid(material=material)
    context = SimpleNamespace(
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)), region=SimpleNamespace(width=600),
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get, object=plate, material=material,
        scene=bpy.context.scene,
    )  # fmt: skip

    def lines(panel):
        return drawn(lambda layout: panel.draw(SimpleNamespace(layout=layout), context))

    settling, thickness = addon.ui.dust_panel.LAMINA_PT_dust, addon.ui.thickness_panel.LAMINA_PT_thickness
    before = lines(settling)
    assert [line for line in before if line in ("How Much", "Where From", "Where It Stays", "Where To")] == [
        "How Much", "Where From", "Where It Stays", "Where To"]
    assert "Settle Dust" in before and "Grain and Clouds" in lines(thickness)
    dust.settle(bpy.context, plate)
    assert "Settle Again" in lines(settling)
    after = lines(thickness)
    assert "Cloud Size" in after and "Remove Grain and Clouds" in after and "Wipe by Hand" in after
