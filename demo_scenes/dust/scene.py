# SPDX-License-Identifier: GPL-3.0-or-later
"""The dust scene: a sphere and a step block under sun and sky, with a real shell of dust or with baked dust."""

import json
import math
from dataclasses import dataclass
from pathlib import Path

import bpy
import cycles_render
import numpy as np
from mathutils import Vector
from slab import light, volume

from . import shell

STACK = Path(__file__).resolve().parent / "stack.json"
TAU = 0.6  # of the dust, everywhere
# Of the shell, for a sphere of radius 1; the effect of curvature is of this order.
THICKNESS = 0.004
GAP = THICKNESS / 50.0  # of vacuum between shell and base, since coplanar faces are undefined
# Relative difference of area: light that enters through the shell's outer face falls on a smaller base.
CURVATURE = 2.0 * THICKNESS / shell.RADIUS
BOUNCES = 48  # longer paths carry less than 1e-5 of the radiance
SUN_AZIMUTH, SUN_ELEVATION = math.radians(-165.0), math.radians(36.0)
EYE, TARGET, FIELD = Vector((-3.4, -8.2, 3.7)), Vector((0.02, 0.0, 0.8)), math.radians(31.5)
ASPECT = 0.62  # height of the picture over its width
SMALLEST_COSINE = 0.2  # at smaller cosines a view is affected by the shell's curvature
EDGE = 6.0 * THICKNESS  # closer to an edge a shell is not a plane layer


def load_stack(path=STACK):
    """The stack as a dict. Raises ValueError for one whose top layer is not the one that varies."""
    stack = json.loads(Path(path).read_text(encoding="utf-8"))
    if [bool(layer.get("varying")) for layer in stack["layers"]] != [True]:
        raise ValueError(f"{path}: layers must be one medium that varies")
    return stack


def build(stack, body, material=None):
    """A new scene. body: "shell" (Cycles volumes around the stack's base) or "baked" (surfaces with `material`)."""
    scene = bpy.data.scenes.new(f"dust {body}")
    if body == "shell":
        layer = {**stack["layers"][0], "tau": TAU}
        dust = volume.medium_material(layer, THICKNESS)
        base = volume.base_material(stack["base"])
        for name in shell.SHAPES:
            shell.shell(scene, name, 0.0, THICKNESS, dust)
            shell.surface(scene, name, -GAP, base)
    else:
        for name in shell.SHAPES:
            shell.surface(scene, name, THICKNESS, material)
    volume.plane(scene, 60.0, volume.base_material({"kind": "lambert", "reflectance": 0.3}))
    camera = bpy.data.cameras.new("camera")
    camera.angle = FIELD
    eye = bpy.data.objects.new("camera", camera)
    scene.collection.objects.link(eye)
    eye.matrix_world = light.frame((EYE - TARGET).normalized())
    eye.location = EYE
    scene.camera = eye
    light.build(scene, SUN_AZIMUTH, SUN_ELEVATION)
    return scene


def height_of(width):
    return round(width * ASPECT)


def set_quality(scene, width, samples):
    cycles_render.unbiased(scene, width, height_of(width), samples, BOUNCES)


@dataclass(frozen=True)
class Pixels:
    """What each pixel of a picture sees; bool (height, width), first row on top. `shown`: a body; `compared`: by name,
    the pixels that see a body away from edges and not at grazing."""

    shown: np.ndarray
    compared: dict[str, np.ndarray]


def pixels(scene, width):
    """Pixels of the baked scene."""
    height = height_of(width)
    scene.view_layers[0].update()
    graph = scene.view_layers[0].depsgraph
    reach = 2.0 * math.tan(FIELD / 2.0) / width
    x = (np.arange(width + 1) - width / 2.0) * reach
    y = (height / 2.0 - np.arange(height + 1)) * reach
    turn = scene.camera.matrix_world.to_3x3()
    seen = np.full((height + 1, width + 1), "", object)
    sides = np.zeros((height + 1, width + 1, 3))
    for row in range(height + 1):
        for column in range(width + 1):
            ray = (turn @ Vector((x[column], y[row], -1.0))).normalized()
            hit, place, normal, _, thing, _ = scene.ray_cast(graph, EYE, ray)
            if hit and thing.name.split(".")[0] in shell.SHAPES:
                seen[row, column] = thing.name.split(".")[0]
                sides[row, column] = normal if _is_fair(seen[row, column], place, -ray.dot(normal)) else 0.0
    corners = [seen[:-1, :-1], seen[1:, :-1], seen[:-1, 1:], seen[1:, 1:]]
    facing = [sides[:-1, :-1], sides[1:, :-1], sides[:-1, 1:], sides[1:, 1:]]
    fair = np.min([np.linalg.norm(one, axis=-1) for one in facing], axis=0) > 0.5
    fair &= np.min([np.sum(one * facing[0], axis=-1) for one in facing], axis=0) > 0.9
    compared = {name: fair & np.all([one == name for one in corners], axis=0) for name in shell.SHAPES}
    return Pixels(np.any([one != "" for one in corners], axis=0), compared)


def _is_fair(name, place, cosine):
    """True if a point of a body may be compared."""
    if cosine < SMALLEST_COSINE:
        return False
    if name == "sphere":
        return True
    x, y, z = (place[k] - shell.STEPS_AT[k] for k in range(3))
    profile = np.array(shell.STEPS)
    along = sorted({*profile[:, 0]}), sorted({*profile[:, 1]})
    # A point near an edge is close to two planes of the block.
    at = ((x, along[0]), (y, shell.STEPS_Y), (z, along[1]))
    planes = [min(abs(one - plane) for plane in planes) for one, planes in at]
    return sorted(planes)[1] > EDGE
