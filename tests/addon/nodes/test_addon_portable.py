# SPDX-License-Identifier: GPL-3.0-or-later
"""A baked material is ordinary Cycles: it renders the same without the add-on, after saving, in another file."""

import addon_utils
import bpy
import numpy as np
import own_blender
import pytest
from rendered_plane import add_plane, render


@pytest.mark.parametrize("base", ["lambert", "none"])
@pytest.mark.parametrize("varying", [False, True])
def test_same_pixels_everywhere(addon, lamina, material, tmp_path, disabled_afterwards, base, varying):
    material.lamina.base.kind = base
    addon.editing.layer_list.add_layer(material).albedo = (0.2, 0.3, 0.4)
    material.lamina.active_index = 1
    material.lamina.layers[1].varying = varying
    addon.baking.bake_job.bake_material(material)
    add_plane(material)
    expected = render(tmp_path / "first.exr")
    assert expected.max() > 0.05 and np.isfinite(expected).all()
    blend = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=blend)

    own_blender.disable()
    assert addon_utils.check(own_blender.MODULE) == (False, False)
    bpy.ops.wm.open_mainfile(filepath=blend)
    assert np.array_equal(render(tmp_path / "reopened.exr"), expected)

    bpy.ops.wm.save_as_mainfile(filepath=blend)  # a save without the add-on keeps its data too
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(blend) as (_source, target):
        target.materials = ["Bronze"]
    add_plane(bpy.data.materials["Bronze"])
    assert np.array_equal(render(tmp_path / "appended.exr"), expected)

    own_blender.enable()
    appended = bpy.data.materials["Bronze"]
    assert addon.baking.bake_job.state(appended) == "fresh"
    assert appended.lamina.node_group is not None and addon.nodes.node_group.is_connected(appended)


def test_a_bake_leaves_the_scene_alone(addon, lamina, material):
    bpy.context.scene.render.engine = "BLENDER_WORKBENCH"
    things = {
        name: len(getattr(bpy.data, name)) for name in ("scenes", "objects", "meshes", "worlds", "cameras")
    }
    addon.baking.bake_job.bake_material(material)
    assert bpy.context.scene.render.engine == "BLENDER_WORKBENCH"
    assert things == {name: len(getattr(bpy.data, name)) for name in things}
