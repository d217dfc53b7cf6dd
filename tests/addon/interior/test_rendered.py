# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as it is rendered, and the body of an object in it."""

import bpy
import numpy as np
import pytest
from addon_helpers import icosphere


@pytest.fixture
def rendered(addon):
    from bl_ext.user_default.lamina.base import rendered

    return rendered


def linked(name, data=None, parent=None, collection=None):
    """A new object in a collection, by default that of the scene."""
    made = bpy.data.objects.new(name, data)
    made.parent = parent
    (collection or bpy.context.scene.collection).objects.link(made)
    return made


def point(name):
    return bpy.data.lights.new(name, "POINT")


def marble_ball():
    """A ball of 10 mm in Blender units of a metre, with the material Marble in large voxels."""
    mesh = icosphere("Ball", 0.01)
    material = bpy.data.materials.new("Marble")
    mesh.materials.append(material)
    settings = material.lamina.interior
    settings.resolution, settings.size, settings.noise = 16, 12, 40.0
    return linked("Ball", mesh)


def visit(rendered, read):
    return rendered.visit(bpy.context.scene, bpy.context.view_layer, read)


def test_what_the_render_sees(rendered):
    """Objects that the viewport hides, with the matrices of their parents, and instances of collections; not what is
    hidden in renders."""
    scene = bpy.context.scene
    parent = linked("Parent")
    parent.location = (1.0, 2.0, 3.0)
    linked("Child", point("Child"), parent).hide_viewport = True
    linked("Hidden", point("Hidden")).hide_render = True
    off, excluded, source = (bpy.data.collections.new(name) for name in ("Off", "Excluded", "Source"))
    for collection in (off, excluded):
        scene.collection.children.link(collection)
    off.hide_render = True
    bpy.context.view_layer.layer_collection.children["Excluded"].exclude = True
    for collection in (off, excluded, source):
        linked(f"In {collection.name}", point("Lamp"), None, collection)
    instance = linked("Instance")
    instance.instance_type, instance.instance_collection, instance.location = "COLLECTION", source, (5.0, 0.0, 0.0)
    found = visit(rendered, lambda depsgraph: {
        one.object.name: tuple(one.matrix_world.translation)
        for one in depsgraph.object_instances if one.object.type == "LIGHT"
    })  # fmt: skip
    assert found == {"Child": (1.0, 2.0, 3.0), "In Source": (5.0, 0.0, 0.0)}


def test_the_file_is_as_before(rendered):
    """Also after an exception, which is the caller's. No compositor runs, whose nodes could write files."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    render = scene.render
    render.use_compositing = render.use_sequencer = render.use_multiview = True
    layer.use = False
    before = render.engine

    def state():
        kinds = ("objects", "cameras", "scenes", "images")
        counts = [len([one for one in getattr(bpy.data, kind) if one.name != "Render Result"]) for kind in kinds]
        return counts, render.engine, render.use_compositing, render.use_sequencer, layer.use, scene.camera

    def fail(_depsgraph):
        raise KeyError("of the caller")

    earlier, calls = state(), []
    assert visit(rendered, lambda depsgraph: calls.append(render.use_compositing or render.use_sequencer)) is None
    assert calls == [False]  # once, although there are two eyes
    assert state() == earlier
    with pytest.raises(KeyError, match="of the caller"):
        visit(rendered, fail)
    assert state() == earlier and render.engine == before
    assert not hasattr(bpy.types, rendered._ENGINE)


def test_the_last_picture_stays(rendered, tmp_path):
    """That of the artist's last render, which no file may hold."""
    scene = bpy.context.scene
    scene.camera = linked("Eye", bpy.data.cameras.new("Eye"))
    scene.render.engine, scene.cycles.samples, scene.cycles.device = "CYCLES", 1, "CPU"
    scene.render.resolution_x = scene.render.resolution_y = 8
    bpy.ops.render.render()
    visit(rendered, lambda _depsgraph: None)
    # Without a picture, Blender refuses to save it.
    bpy.data.images["Render Result"].save_render(str(tmp_path / "picture.png"))


def test_no_reading_during_a_render(rendered, monkeypatch):
    monkeypatch.setattr(rendered.renders, "is_scene_rendering", lambda: True)
    with pytest.raises(ValueError, match="Blender is rendering: wait until the render ends"):
        visit(rendered, lambda _depsgraph: None)


def radius(jobs, obj):
    """The largest distance of a vertex from the centre, in mm, and the number of triangles."""
    solid = jobs.gather(bpy.context, obj, obj.active_material).solid
    return float(np.linalg.norm(solid.vertices, axis=1).max()), len(solid.triangles)


def test_modifiers_at_the_level_of_renders(jobs):
    """Also for an object that the viewport hides. One that is hidden in renders is as in the viewport."""
    ball = marble_ball()
    smooth = ball.modifiers.new("Smooth", "SUBSURF")
    smooth.levels, smooth.render_levels = 0, 1
    assert radius(jobs, ball)[1] == 80 * 6
    ball.hide_viewport = True
    assert radius(jobs, ball)[1] == 80 * 6
    ball.hide_viewport, ball.hide_render = False, True
    bpy.context.view_layer.update()
    assert radius(jobs, ball)[1] == 80
    ball.hide_viewport = True
    with pytest.raises(ValueError, match="Ball is hidden in renders and in the viewport: show it in one of them"):
        jobs.gather(bpy.context, ball, ball.active_material)


def test_the_size_of_a_hidden_object_after_loading(jobs, tmp_path):
    """Blender computes no matrices of hidden objects: they are the identity."""
    ball = marble_ball()
    ball.scale, ball.hide_viewport = (2.0, 2.0, 2.0), True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "hidden.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "hidden.blend"))
    ball = bpy.data.objects["Ball"]
    assert ball.matrix_world.to_scale().x == 1.0
    assert radius(jobs, ball)[0] == pytest.approx(20.0, rel=1e-4)
    lonely = bpy.data.collections.new("Excluded")
    bpy.context.scene.collection.children.link(lonely)
    lonely.objects.link(ball)
    bpy.context.scene.collection.objects.unlink(ball)
    bpy.context.view_layer.layer_collection.children["Excluded"].exclude = True
    with pytest.raises(ValueError, match="Ball is hidden in renders and in the viewport"):
        jobs.gather(bpy.context, ball, ball.active_material)


def test_stretched_by_a_parent(jobs):
    ball = marble_ball()
    ball.parent = linked("Stand")
    ball.parent.scale = (2.0, 1.0, 1.0)
    places = 1000.0 * np.array([vertex.co for vertex in ball.data.vertices]) * (2.0, 1.0, 1.0)
    assert radius(jobs, ball)[0] == pytest.approx(np.linalg.norm(places, axis=1).max(), rel=1e-4)
    ball.rotation_euler = (0.0, 0.0, 0.7)
    with pytest.raises(ValueError, match="Ball is sheared by its parent Stand: apply the scale"):
        jobs.gather(bpy.context, ball, ball.active_material)
