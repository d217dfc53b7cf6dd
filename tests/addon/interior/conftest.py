# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the tests of interiors."""

import bpy
import pytest
from addon_helpers import icosphere


@pytest.fixture
def jobs(addon, lamina):
    from bl_ext.user_default.lamina.interior import interior_job

    yield interior_job
    interior_job.stop()


@pytest.fixture
def ball(addon):
    """A ball of radius 10 mm, turned and moved, with the material Marble in large voxels and a small noisy image."""
    mesh = icosphere("Ball", 1.0)
    obj = bpy.data.objects.new("Ball", mesh)
    obj.scale, obj.location, obj.rotation_euler = (0.01,) * 3, (1.0, 2.0, 3.0), (0.4, 0.5, 0.6)
    bpy.context.scene.collection.objects.link(obj)
    material = bpy.data.materials.new("Marble")
    addon.nodes.node_tree.of(material)
    mesh.materials.append(material)
    settings = material.lamina.interior
    settings.resolution, settings.size, settings.noise, settings.second.sigma_a = 16, 12, 40.0, (0.5, 0.4, 0.3)
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()
    return obj
