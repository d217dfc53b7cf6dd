# SPDX-License-Identifier: GPL-3.0-or-later
"""A baked material is ordinary Cycles: it renders alike without the add-on, after saving, in another file."""

import addon_utils
import bpy
import conftest
import numpy as np
import pytest

SIZE = 24


def add_plane(material):
    """A tilted plane with `material` under a sun and sky, seen by an orthographic camera."""
    scene = bpy.context.scene
    mesh = bpy.data.meshes.new("Patch")
    mesh.from_pydata([(-2, -2, 0), (2, -2, 0), (2, 2, 0.6), (-2, 2, 0.6)], [], [(0, 1, 2, 3)])
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("Patch", mesh))
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy, sun.angle = 3.0, 0.0
    lamp = bpy.data.objects.new("Sun", sun)
    lamp.rotation_euler = (0.7, 0.2, 0.0)
    scene.collection.objects.link(lamp)
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", 1.0
    eye = bpy.data.objects.new("Camera", camera)
    eye.location, eye.rotation_euler = (0.1, -2.0, 2.0), (0.785, 0.0, 0.0)
    scene.collection.objects.link(eye)
    scene.camera = eye
    scene.world = bpy.data.worlds.new("Sky")
    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.cycles.samples, scene.cycles.seed = 4, 0
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False


def render(path):
    """float32 pixels of the scene as it is."""
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    values = np.empty(SIZE * SIZE * 4, dtype=np.float32)
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    return values


@pytest.fixture
def disabled_afterwards():
    """The add-on may be disabled in the test; the next one finds it enabled."""
    yield
    conftest.enable()


@pytest.mark.parametrize("base", ["lambert", "none"])
@pytest.mark.parametrize("varying", [False, True])
def test_same_pixels_everywhere(addon, lamina, material, tmp_path, disabled_afterwards, base, varying):
    material.lamina.base.kind = base
    addon.layer_list.add_layer(material).albedo = (0.2, 0.3, 0.4)
    material.lamina.active_index = 1
    material.lamina.layers[1].varying = varying
    addon.bake_job.bake_material(material)
    add_plane(material)
    expected = render(tmp_path / "first.exr")
    assert expected.max() > 0.05 and np.isfinite(expected).all()
    blend = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=blend)

    conftest.disable()
    assert addon_utils.check(conftest.MODULE) == (False, False)
    bpy.ops.wm.open_mainfile(filepath=blend)
    assert np.array_equal(render(tmp_path / "reopened.exr"), expected)

    bpy.ops.wm.save_as_mainfile(filepath=blend)  # a save without the add-on keeps its data too
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(blend) as (_source, target):
        target.materials = ["Bronze"]
    add_plane(bpy.data.materials["Bronze"])
    assert np.array_equal(render(tmp_path / "appended.exr"), expected)

    conftest.enable()
    appended = bpy.data.materials["Bronze"]
    assert addon.bake_job.state(appended) == "fresh"
    assert appended.lamina.node_group is not None and addon.node_group.is_connected(appended)


def test_a_bake_leaves_the_scene_alone(addon, lamina, material):
    bpy.context.scene.render.engine = "BLENDER_WORKBENCH"
    things = {
        name: len(getattr(bpy.data, name)) for name in ("scenes", "objects", "meshes", "worlds", "cameras")
    }
    addon.bake_job.bake_material(material)
    assert bpy.context.scene.render.engine == "BLENDER_WORKBENCH"
    assert things == {name: len(getattr(bpy.data, name)) for name in things}
