# SPDX-License-Identifier: GPL-3.0-or-later
"""The coat scene: one interface on a Lambert base under a sky with a bright cap, as a painted slab of glass or as
the baked plane."""

import json
import math
from pathlib import Path

import bpy
import cycles_render
from mathutils import Matrix, Vector
from slab import view

from . import geometry, light

HERE = Path(__file__).resolve().parent
STACKS = {"smooth": HERE / "smooth.json", "rough": HERE / "rough.json"}
# The share that remains after all bounces: .6 (light inside that the face reflects back) times .5 (paint), to the 24th.
BOUNCES = 48


def load_stack(path):
    """A stack as a dict."""
    return json.loads(Path(path).read_text(encoding="utf-8"))


def build(stack, body, material=None):
    """A new scene with slab, sky and the slab demo's camera, which looks along +x.

    body: "glass" (the painted slab) or "baked" (a plane that wears `material`). Raises ValueError."""
    scene = bpy.data.scenes.new(f"coat {body}")
    _add(scene, stack, body, material)
    view.build(scene)
    scene.world = light.world(view.SUN_AZIMUTH, aimed=body == "baked")
    return scene


def instrument(stack, body, mu_o, azimuth=0.0, cap=light.CAP, sky=light.SKY, material=None):
    """The same body seen by an orthographic camera from one direction, at the cosine `mu_o` with the vertical; all
    pixels measure the same quantity. The cap stands `azimuth` radians from straight ahead."""
    scene = bpy.data.scenes.new(f"coat {body}")
    _add(scene, stack, body, material)
    camera = bpy.data.cameras.new("eye")
    camera.type, camera.ortho_scale, camera.clip_end = "ORTHO", 1.0, 1000.0
    eye = bpy.data.objects.new("eye", camera)
    scene.collection.objects.link(eye)
    scene.camera = eye
    back, right = Vector((-math.sqrt(1.0 - mu_o * mu_o), 0.0, mu_o)), Vector((0.0, -1.0, 0.0))
    turn = Matrix((right, back.cross(right), back)).transposed().to_4x4()
    eye.matrix_world = Matrix.Translation(20.0 * back) @ turn
    scene.world = light.world(azimuth, cap, sky, aimed=body == "baked")
    return scene


def set_quality(scene, size, samples):
    """Unbiased settings for a picture of `size` x `size` pixels, including caustics."""
    cycles_render.unbiased(scene, size, size, samples, BOUNCES)


def _add(scene, stack, body, material):
    if body == "glass":
        geometry.build(scene, stack)
    else:
        geometry.plane(scene, material)
