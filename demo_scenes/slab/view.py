# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera over the slab, and the directions of its pixels.

By perspective the view cosine runs from steep at the lower edge of the picture to grazing at the horizon, and the
azimuth to the sun varies along the columns.
"""

import math
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector

from . import light

HEIGHT = 2.0  # height of the eye over the slab's face, in slab thicknesses
FIELD = math.radians(74.0)  # across the picture
PITCH = math.radians(26.0)  # below the horizon
SUN_AZIMUTH = math.radians(-14.0)  # the camera looks along +x: the sun stands right of the middle
SMALLEST_COSINE = 0.05  # pixels with smaller view cosines are not compared


@dataclass(frozen=True)
class Pixels:
    """The view of every pixel of a square picture; arrays (size, size), first row on top."""

    mu_o: np.ndarray  # cosine of the view ray with the slab's normal at the pixel's centre; negative: sky
    dphi: np.ndarray  # azimuth against the sun's light, radians in [0, pi]; 0 = forward
    region: np.ndarray  # bool: the whole pixel sees the slab with mu_o >= SMALLEST_COSINE


def build(scene):
    """Add the camera to `scene`."""
    camera = bpy.data.cameras.new("camera")
    camera.angle = FIELD
    camera.clip_start, camera.clip_end = 0.01, 1.0e5
    eye = bpy.data.objects.new("camera", camera)
    scene.collection.objects.link(eye)
    backwards = Vector((-math.cos(PITCH), 0.0, math.sin(PITCH)))
    eye.matrix_world = light.frame(backwards)
    eye.location = (0.0, 0.0, HEIGHT)
    scene.camera = eye


def pixels(size):
    """Pixels of a picture of `size` x `size`."""
    centres, edges = np.arange(size) + 0.5, np.arange(size + 1.0)
    mu_o, dphi = _directions(centres, size)
    corner, _ = _directions(edges, size)
    flattest = np.minimum.reduce([corner[:-1, :-1], corner[1:, :-1], corner[:-1, 1:], corner[1:, 1:]])
    return Pixels(mu_o, dphi, flattest >= SMALLEST_COSINE)


def _directions(at, size):
    """(mu_o, dphi) of the rays through the pixel coordinates `at` x `at`."""
    reach = 2.0 * math.tan(FIELD / 2.0) / size
    right = (at[None, :] - size / 2.0) * reach
    up = (size / 2.0 - at[:, None]) * reach
    ahead = math.cos(PITCH) + up * math.sin(PITCH) + 0.0 * right
    down = math.sin(PITCH) - up * math.cos(PITCH) + 0.0 * right
    mu_o = down / np.sqrt(1.0 + right**2 + up**2)
    # Looking towards the sun's azimuth, the viewer sees light that keeps its azimuth.
    turned = np.arctan2(-right, ahead) - SUN_AZIMUTH
    return mu_o, np.arccos(np.clip(np.cos(turned), -1.0, 1.0))
