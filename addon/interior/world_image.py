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


def of_scene(scene, axes):
    """float32 (ROWS, COLUMNS, 3) for lamina.Surroundings: the light of the world's nodes, for a Strength of
    1 of its Background. `axes`: (3, 3), as columns, the axes of the table in world space. Main thread only.
    All temporary data are removed. Raises RefusedError for nodes whose light depends on the kind of ray."""
    if any(node.type == "LIGHT_PATH" for node in scene.world.node_tree.nodes):
        raise RefusedError(
            f"{scene.world.name} has a Light Path node, with light that depends on the ray: remove it for Lit"
        )
    made, data = [], bpy.data
    try:
        temporary = data.scenes.new("lamina world")
        made.append((data.scenes, temporary))
        temporary.frame_set(scene.frame_current)
        world = scene.world.copy()
        made.append((data.worlds, world))
        temporary.world = world
        for node in world.node_tree.nodes:
            if node.type == "BACKGROUND":
                node.inputs["Strength"].default_value = 1.0
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


def _looking_along_x():
    """The axes of a camera that looks along +x, with z up, as columns."""
    return np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
