# SPDX-License-Identifier: GPL-3.0-or-later
"""The interior of an object: its images, their nodes and interruptions."""

import re
from dataclasses import replace
from types import SimpleNamespace

import bmesh
import bpy
import numpy as np
import pytest
from addon_helpers import drawn, pixels, sun, surface_source


def images(group):
    return {node.label: pixels(node.image) for node in group.nodes if node.type == "TEX_IMAGE"}


def make(jobs, obj, **more):
    return jobs.make(bpy.context, obj, obj.active_material, **more)


def test_relightable(jobs, ball, lamina):
    """The images are those of lamina.relightable_images, in mm of the object's scale, over a map that was unwrapped."""
    bpy.context.scene.unit_settings.scale_length = 0.5  # so that the ball has a radius of 5 mm
    found = make(jobs, ball)
    material = ball.active_material
    group = material.lamina.lateral_group
    assert [layer.name for layer in ball.data.uv_layers] == ["Lamina"]
    shown = images(group)
    np.testing.assert_array_equal(shown["color"][..., :3], found.inputs.color)
    np.testing.assert_array_equal(shown["radius"][..., :3], found.inputs.radius)
    assert ("extra_color" in shown) == (found.inputs.extra_weight > 0.0)
    assert surface_source(material).node_tree == group
    node = next(node for node in group.nodes if node.type == "SUBSURFACE_SCATTERING")
    assert node.inputs["IOR"].default_value == pytest.approx(1.5)
    assert node.inputs["Scale"].links[0].from_socket.name == "Millimetre"
    assert surface_source(material).inputs["Millimetre"].default_value == pytest.approx(0.002)
    assert next(node for node in group.nodes if node.type == "UVMAP").uv_map == "Lamina"
    assert material.lamina.interior.report.startswith("Colors and radii: ")
    task = jobs.gather(bpy.context, ball, material)
    assert np.linalg.norm(task.solid.vertices, axis=1) == pytest.approx(5.0, rel=1e-5)
    veins = task.fill(None, None)
    assert veins.low[0] == pytest.approx(task.solid.vertices[:, 0].min(), rel=1e-4) and max(veins.voxels.shape) == 16
    assert not task.folder.exists()


def test_small_holes_are_closed_and_told(jobs, ball):
    """As in Suzanne, whose eyes and sockets are open."""
    editing = bmesh.new()
    editing.from_mesh(ball.data)
    bmesh.ops.delete(editing, geom=editing.faces[:1], context="FACES")
    editing.to_mesh(ball.data)
    editing.free()
    share = 100.0 / len(ball.data.polygons)
    (note,) = make(jobs, ball).notes
    told = re.fullmatch(r"the walks close a hole of Ball, (.*) % of the area", note)
    assert float(told[1]) == pytest.approx(share, rel=0.3)  # the faces of the ball have different areas
    assert note[1:] in ball.active_material.lamina.interior.report


def test_new_faces_after_a_first_run(jobs, ball, lamina):
    """Lamina's own map is made again, also when it is the map of the panel."""
    settings = ball.active_material.lamina.interior
    make(jobs, ball)
    assert settings.map == "OWN"
    editing = bmesh.new()
    editing.from_mesh(ball.data)
    bmesh.ops.subdivide_edges(editing, edges=editing.edges[:], cuts=1, use_grid_fill=True)
    layer = editing.loops.layers.uv.verify()
    for corner in [corner for face in editing.faces[:200] for corner in face.loops]:
        corner[layer].uv = (0.0, 0.0)  # as of faces that are new
    editing.to_mesh(ball.data)
    editing.free()
    assert not make(jobs, ball).notes and [layer.name for layer in ball.data.uv_layers] == ["Lamina"]


def test_a_map_that_is_gone(jobs, ball, lamina):
    """An object without UV maps is unwrapped, also where the panel still names a map."""
    ball.active_material.lamina.interior.uv_map = "Gone"
    make(jobs, ball)
    assert [layer.name for layer in ball.data.uv_layers] == ["Lamina"]


def test_lit(jobs, ball, lamina):
    """One input of strength and one of colour for each lamp and the world; the sum is emitted, nothing else is lit."""
    sun("Key", (0.5, 0.2, 0.0))
    second = sun("Back", (2.5, 0.0, 0.3), 3.0)
    world = bpy.data.worlds.new("Sky")
    bpy.context.scene.world = world
    settings = ball.active_material.lamina.interior
    settings.output = "LIT"
    found = make(jobs, ball)
    group = ball.active_material.lamina.lateral_group
    shown = images(group)
    assert set(shown) == {f"{name}{what}" for name in ("Back", "Key", "World")
                          for what in ("", " by view", " by view squared")}
    np.testing.assert_array_equal(shown["Back"][..., :3], found.lamps[0])
    np.testing.assert_array_equal(shown["World"][..., :3], found.sky)
    node = surface_source(ball.active_material)
    assert node.inputs["Back Strength"].default_value == pytest.approx(3.0)
    assert tuple(node.inputs["Key Color"].default_value)[:3] == pytest.approx((1.0, 0.5, 0.25))
    shaders = sorted(one.type for one in group.nodes if one.type.startswith(("BSDF", "EMISSION", "SUBSURFACE")))
    assert shaders == ["BSDF_GLOSSY", "EMISSION"]
    # The lamp's direction in the object's axes.
    local = np.array(ball.matrix_world.to_3x3().normalized().inverted() @ second.matrix_world.col[2].xyz)
    np.testing.assert_allclose(found.estimate.lamps_used[0].towards, local, atol=1e-6)
    assert found.estimate.lamps_used[0].angle == pytest.approx(0.05)
    # The next relightable nodes have no inputs of lamps.
    settings.output = "RELIGHTABLE"
    make(jobs, ball)
    assert [socket.name for socket in surface_source(ball.active_material).inputs] == ["Millimetre"]
    assert not [image for image in bpy.data.images if "Key" in image.name]


def test_camera(jobs, ball, lamina):
    """Lit for the camera: texels that look away from it have no value of their own."""
    settings = ball.active_material.lamina.interior
    settings.output, settings.view = "LIT", "CAMERA"
    bpy.context.scene.world = bpy.data.worlds.new("Sky")
    camera = bpy.data.objects.new("Eye", bpy.data.cameras.new("Eye"))
    camera.location = (1.0, 2.0, 5.0)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    bpy.context.view_layer.update()
    found = make(jobs, ball)
    task = jobs.gather(bpy.context, ball, ball.active_material)
    # The camera lies 2 m above the ball's centre in world space, and in its own space beyond its upper side.
    up = np.array(ball.matrix_world.to_3x3().normalized().inverted().col[2])
    assert np.array(task.view["eye"]) == pytest.approx(2000.0 * up, rel=1e-4)
    settings.view = "ALL"
    assert set(images(ball.active_material.lamina.lateral_group)) == {"World"}
    everywhere = make(jobs, ball)
    assert 0.3 < found.mask.sum() / everywhere.mask.sum() < 0.7 and (found.estimate.sky.value > 0.0).all()


@pytest.mark.parametrize("ior", [1.0, 1.5])
def test_light_follows_the_view(jobs, ball, lamina, ior):
    """A render of a turned and stretched object against the formula of lamina.LitImages, with one value everywhere."""
    from bl_ext.user_default.lamina.interior import seen, trial_render

    sun("Key", (0.5, 0.2, 0.0), 2.0)
    ball.scale = (0.03, 0.01, 0.02)
    bpy.context.view_layer.update()
    material = ball.active_material
    settings = material.lamina.interior
    settings.output, settings.ior, settings.roughness = "LIT", ior, 0.0
    task = jobs.gather(bpy.context, ball, material)
    found = jobs.compute(task)
    body = seen.of_object(bpy.context, ball, material).body
    camera = trial_render.camera_of(bpy.context.scene, body)
    places = trial_render.places(body, None, camera)
    assert len(places.pixels) > 500
    # Radiance changes across the narrow picture, and is limited on a part of it.
    rng = np.random.default_rng(2)
    color, factors = 0.2 * np.array([0.2, 0.4, 0.9]), rng.normal(0.0, 1.0, 8)
    x, y, z = places.directions.T
    exponent = factors @ [x, y, z, x * x, y * y, x * y, y * z, z * x]
    constant = np.log(5.0) - np.quantile(exponent, 0.7)
    lamps, changes = np.empty_like(found.lamps), np.empty_like(found.lamp_changes)
    lamps[:], changes[:] = color, [*factors, constant]
    jobs.apply(material, task, replace(found, lamps=lamps, lamp_changes=changes))
    picture = trial_render.pictures(bpy.context, ball, camera, {}, {})[0][places.pixels]
    wanted = np.exp(np.minimum(exponent + constant, np.log(5.0)))
    assert np.quantile(wanted, 0.1) < 4.5 < 5.0 - 1e-9 < np.quantile(wanted, 0.9)
    lamp = task.sources[0]
    light = lamp.factor * lamp.strength * np.array(lamp.colour) * color
    cosine = np.einsum("ij,ij->i", places.directions, places.normals)
    passed = 1.0 - lamina.common.fresnel.fresnel(cosine, ior)
    # Pixels of the silhouette see past it, and those on the limit see both sides.
    inside = (cosine > 0.3) & (np.abs(exponent + constant - np.log(5.0)) > 0.02)
    is_close = np.isclose(picture, (wanted * passed)[:, None] * light, rtol=1e-4, atol=1e-3).all(axis=1)
    assert is_close[inside].mean() > 0.997  # a few pixels see two faces


@pytest.mark.parametrize("stretch", [1.0, 3.0])
def test_node_texture_between_materials(jobs, ball, lamina, stretch):
    """A gradient along x in the object's own coordinates, also after the nodes were replaced by the result."""
    material = ball.active_material
    ball.scale.x *= stretch
    bpy.context.view_layer.update()
    tree = material.node_tree
    gradient, coordinates = tree.nodes.new("ShaderNodeSeparateXYZ"), tree.nodes.new("ShaderNodeTexCoord")
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    tree.links.new(coordinates.outputs["Object"], gradient.inputs[0])
    tree.links.new(gradient.outputs["X"], shader.inputs["Base Color"])
    material.lamina.interior.source = "NODES"
    for _ in range(2):
        interior = jobs.gather(bpy.context, ball, material).fill(None, None)
        _, width, height = interior.voxels.shape
        coordinate = interior.voxels[:, width // 2, height // 2] / 65535.0
        # In units of the object's space
        centres = 0.1 / stretch * interior.high[0] * ((np.arange(16) + 0.5) / 8.0 - 1.0)
        np.testing.assert_allclose(coordinate, np.clip(centres, 0.0, 1.0), atol=2e-3)
        make(jobs, ball)


def test_a_stretched_object_is_like_one_whose_scale_is_applied(jobs, ball):
    """Its shape in mm, the normals, and a lamp as seen from its axes."""
    sun("Sun", (0.6, 0.2, 0.0))
    ball.active_material.lamina.interior.output = "LIT"

    def gathered():
        bpy.context.view_layer.update()
        task = jobs.gather(bpy.context, ball, ball.active_material)
        normals = task.normals / np.linalg.norm(task.normals, axis=2, keepdims=True)
        return task.solid.vertices, task.solid.triangles, normals, task.sources[0].numbers["towards"]

    ball.scale = (0.03, 0.01, 0.005)
    stretched = gathered()
    with bpy.context.temp_override(selected_editable_objects=[ball], active_object=ball, object=ball):
        bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    assert tuple(ball.scale) == (1.0, 1.0, 1.0)
    for one, other in zip(stretched, gathered(), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-4)


def test_homogeneous(jobs, ball, addon, lamina):
    addon.editing.stack_io.assign_stack(ball.active_material, lamina.presets.load("marble-honed"))
    ball.active_material.lamina.interior.source = "LAYERS"
    task = jobs.gather(bpy.context, ball, ball.active_material)
    assert task.fill(None, None).palette[0].sigma_s == (2.19, 2.62, 3.0)
    assert (task.surface.ior, task.surface.alpha) == (1.5, pytest.approx(0.35))


def test_cancel_keeps_the_material_and_the_parts(jobs, ball, lamina, tmp_path, monkeypatch):
    """And the next call continues, with the same pixels as one without interruption."""
    from lamina.maps import part_folder

    monkeypatch.setattr(part_folder, "SAMPLES_PER_PART", 100)
    material = ball.active_material
    before = [(node.name, node.type) for node in material.node_tree.nodes]
    said = []
    with pytest.raises(lamina.Cancelled):
        make(jobs, ball, folder=tmp_path, progress=lambda _, text: said.append(text),
             cancel=lambda: said[-1:] and said[-1].startswith("Part 4 of "))  # fmt: skip
    assert [(node.name, node.type) for node in material.node_tree.nodes] == before
    assert material.lamina.lateral_group is None and not material.lamina.interior.report
    assert not [image for image in bpy.data.images if image.name.startswith("Lamina")]
    assert len(list(tmp_path.glob("*/part-*.npz"))) == 4
    said.clear()
    make(jobs, ball, folder=tmp_path, progress=lambda _, text: said.append(text))
    assert not any(text.startswith("Part 3 of ") for text in said) and not list(tmp_path.iterdir())
    first = images(material.lamina.lateral_group)
    make(jobs, ball)
    for name, texels in images(material.lamina.lateral_group).items():
        np.testing.assert_array_equal(texels, first[name])


def test_operator_and_worker(jobs, ball, lamina, call):
    material = ball.active_material
    assert call(bpy.ops.lamina.interior, material) == {"FINISHED"}
    group, first = material.lamina.lateral_group, images(material.lamina.lateral_group)
    job = jobs.start(bpy.context, ball, material)
    assert jobs.running_for(material) is job and not bpy.ops.lamina.interior.poll()
    job.wait()
    assert job.finish() == material
    jobs.forget()
    assert material.lamina.lateral_group == group
    np.testing.assert_array_equal(images(group)["color"], first["color"])
    job = jobs.start(bpy.context, ball, material)
    assert call(bpy.ops.lamina.cancel, material, work="INTERIOR") == {"FINISHED"}
    job.wait()
    jobs.forget()
    with pytest.raises(lamina.Cancelled):
        job.finish()


def test_previews(jobs, ball, lamina, tmp_path):
    """Images while the job runs; numbers that an artist sets in the nodes meanwhile are kept."""
    from bl_ext.user_default.lamina.ui import interior_fields

    sun("Key", (0.5, 0.2, 0.0))
    material = ball.active_material
    material.lamina.interior.output = "LIT"
    seen = []
    found = jobs.compute(jobs.gather(bpy.context, ball, material, tmp_path), preview=seen.append)
    assert seen[0].done == 0.0 and 0.0 < seen[1].done < 1.0 and found.done == 1.0
    job = jobs.start(bpy.context, ball, material)
    job.wait()
    for preview in seen[:2]:
        job._keep(preview)
        job.tick()
        np.testing.assert_array_equal(images(material.lamina.lateral_group)["Key"][..., :3], preview.lamps[0])
        assert material.lamina.interior.report.startswith("Light, preview from ")
        surface_source(material).inputs["Key Strength"].default_value = 7.0
    context = SimpleNamespace(
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)), region=SimpleNamespace(width=600),
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get, object=ball, material=material,
        scene=bpy.context.scene, view_layer=bpy.context.view_layer,
    )  # fmt: skip
    assert any("preview from" in line for line in drawn(
        lambda layout: interior_fields.draw(context, layout)))  # fmt: skip
    assert job.finish() == material
    jobs.forget()
    np.testing.assert_array_equal(images(material.lamina.lateral_group)["Key"][..., :3], found.lamps[0])
    assert surface_source(material).inputs["Key Strength"].default_value == 7.0
    assert material.lamina.interior.report == found.report and not job.task.folder.exists()


def test_a_cancelled_job_leaves_its_preview(jobs, ball, lamina, tmp_path):
    material = ball.active_material
    seen = []
    jobs.compute(jobs.gather(bpy.context, ball, material, tmp_path), preview=seen.append)
    job = jobs.start(bpy.context, ball, material)
    job._keep(seen[0])
    job.tick()
    job.cancel()
    job.wait()
    job._keep(seen[1])
    job.tick()  # after a cancel nothing changes any more
    assert job.finish() == material
    jobs.forget()
    np.testing.assert_array_equal(images(material.lamina.lateral_group)["color"][..., :3], seen[0].inputs.color)
    assert material.lamina.interior.report.endswith(jobs.STOPPED)


def test_a_preview_after_an_undo_is_a_first_one(jobs, ball, lamina, monkeypatch, tmp_path):
    """The previews refill a group that was there: an undo between them must find it in a step of its own. A cancel
    after an undo tells nothing in the report."""
    material, seen, steps = ball.active_material, [], []
    jobs.compute(jobs.gather(bpy.context, ball, material, tmp_path), preview=seen.append)
    recorded = jobs.undo.recorded
    monkeypatch.setattr(
        jobs.undo, "recorded", lambda text, always: steps.append(always) or recorded(text, always))  # fmt: skip
    job = jobs.start(bpy.context, ball, material)
    for report in (None, None, ""):
        if report is not None:
            material.lamina.interior.report = report  # as before the first preview
        job._keep(seen[0])
        job.tick()
    assert steps == [True, False, True]
    material.lamina.interior.report = ""
    job.cancel()
    job.wait()
    with pytest.raises(lamina.Cancelled):
        job.finish()
    jobs.forget()
    assert material.lamina.interior.report == ""


def test_presets_of_end_materials(jobs, ball, addon, call):
    from bl_ext.user_default.lamina.interior import contents

    names = dict(contents.presets())
    assert "marble-polished" in names and "leaf" not in names
    assert call(bpy.ops.lamina.end_preset, ball.active_material, preset="skin-light", second=True) == {"FINISHED"}
    end = ball.active_material.lamina.interior.second
    assert end.preset == names["skin-light"] and tuple(end.sigma_s) == pytest.approx((1.09, 1.59, 1.79))
    with pytest.raises(RuntimeError, match="must be one homogeneous medium"):
        call(bpy.ops.lamina.end_preset, ball.active_material, preset="leaf")


def test_panel(addon, ball):
    from bl_ext.user_default.lamina.ui import interior_fields

    material = ball.active_material
    context = SimpleNamespace(
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)), region=SimpleNamespace(width=600),
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get, object=ball, material=material,
        scene=bpy.context.scene, view_layer=bpy.context.view_layer,
    )  # fmt: skip
    said = {}
    for source in ("MARBLE", "NODES", "LAYERS"):
        for output in ("RELIGHTABLE", "LIT"):
            material.lamina.interior.source, material.lamina.interior.output = source, output
            said[source, output] = drawn(lambda layout: interior_fields.draw(context, layout))  # fmt: skip
    assert "Spacing (mm)" in said["MARBLE", "LIT"] and "Spacing (mm)" not in said["NODES", "LIT"]
    assert "View" in said["NODES", "LIT"] and "View" not in said["LAYERS", "RELIGHTABLE"]
    assert all("Ball has no UV map: Lamina unwraps it" in lines and "Compute Interior" in lines
               for lines in said.values())  # fmt: skip
    coarse = "The object is 20 mm large, so voxels are 1.2 mm wide and veins 0.25 mm"
    assert not any("voxels are" in line for lines in said.values() for line in lines)
    material.lamina.interior.source, material.lamina.interior.spacing = "MARBLE", 1.0
    assert any(coarse in line for line in drawn(
        lambda layout: interior_fields.draw(context, layout)))  # fmt: skip
    ball.data.uv_layers.new(name="Own")
    assert any("the map “Own” is used" in line for line in drawn(
        lambda layout: interior_fields.draw(context, layout)))  # fmt: skip
