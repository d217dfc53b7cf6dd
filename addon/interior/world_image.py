# SPDX-License-Identifier: GPL-3.0-or-later
"""The radiance of a scene's world by direction, rendered by a panoramic camera."""

import bpy
import numpy as np
from mathutils import Matrix

from ..base.messages import RefusedError
from . import float_render

ROWS, COLUMNS = 128, 256
SAMPLES = 64
FILTER = 1.0  # width in pixels


def of_scene(scene, axes, background=""):
    """float32 (ROWS, COLUMNS, 3) for lamina.Surroundings: the light of the world's nodes. `axes`: (3, 3), as
    columns, the axes of the table in world space. `background`: name of a Background node that counts with a
    Strength of 1. Main thread only. All temporary data are removed. Raises RefusedError for nodes whose light
    depends on the kind of ray."""
    if _depends_on_rays(scene.world.node_tree):
        raise RefusedError(
            f"{scene.world.name} has a Light Path node, with light that depends on the ray: remove it for "
            "Lamps Stay"
        )
    made, data = [], bpy.data
    try:
        temporary = data.scenes.new("lamina world")
        made.append((data.scenes, temporary))
        temporary.frame_set(scene.frame_current)
        world = scene.world.copy()
        made.append((data.worlds, world))
        temporary.world = world
        # Ray Visibility for the camera matters for the scene's own camera only.
        if hasattr(world, "cycles_visibility"):
            world.cycles_visibility.camera = True
        if background:
            world.node_tree.nodes[background].inputs["Strength"].default_value = 1.0
        camera = data.cameras.new("lamina world")
        made.append((data.cameras, camera))
        camera.type = "PANO"
        # Blender 5.0 moved the property.
        panorama = camera if hasattr(camera, "panorama_type") else camera.cycles
        panorama.panorama_type = "EQUIRECTANGULAR"
        eye = data.objects.new("lamina world", camera)
        made.append((data.objects, eye))
        eye.matrix_world = Matrix((axes @ _looking_along_x()).tolist()).to_4x4()
        temporary.collection.objects.link(eye)
        temporary.camera = eye
        float_render.prepare(temporary, COLUMNS, ROWS)
        temporary.cycles.samples = SAMPLES
        temporary.cycles.pixel_filter_type = "BOX"
        temporary.cycles.filter_width = FILTER
        return np.maximum(float_render.picture(temporary)[..., :3], 0.0)
    finally:
        for collection, item in reversed(made):
            collection.remove(item)


def _depends_on_rays(tree):
    """True if the tree or a group in it has a Light Path node."""
    groups = [node.node_tree for node in tree.nodes if node.type == "GROUP" and node.node_tree is not None]
    return any(node.type == "LIGHT_PATH" for node in tree.nodes) or any(map(_depends_on_rays, groups))


def _looking_along_x():
    """The axes of a camera that looks along +x, with z up, as columns."""
    return np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
