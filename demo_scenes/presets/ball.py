# SPDX-License-Identifier: GPL-3.0-or-later
"""The body that shows a preset: a ball with a groove on a thin plate; for sheets, a sheet with waves."""

import math

import bpy
import numpy as np
from mathutils import Vector

AROUND = 128  # points of a circle
SHARP = math.radians(35.0)  # an edge with a larger angle is sharp
RADIUS, CENTRE = 0.375, 0.385  # of the ball, above the ground
PLATE, THICKNESS, BEVEL = 0.475, 0.022, 0.006  # radius and thickness of the plate
GROOVE = (0.53, 0.585, 0.05)  # lower and upper height, depth


def solid():
    """The ball, as a Blender mesh with one material slot."""
    mesh = _mesh("ball", *_revolved(np.array(_outline())))
    # Brushed metal shows its direction: horizontal for the camera
    uv = mesh.uv_layers.new(name="brushed")
    for loop, place in zip(mesh.loops, uv.data, strict=True):
        x, y, z = mesh.vertices[loop.vertex_index].co
        place.uv = (x, 0.3 * y + 0.95 * z)
    return mesh


def sheet():
    """A sheet with waves that stands on the ground, as a Blender mesh with one material slot."""
    wide, high = 65, 17
    across, up = np.meshgrid(np.linspace(-0.43, 0.43, wide), np.linspace(0.0, 0.78, high))
    away = 0.11 * np.sin(2.0 * np.pi * across / 0.62 + 0.6) + 0.12 * (up / 0.78) ** 2
    points = np.stack([across, away, up], axis=-1)
    number = np.arange(wide * high).reshape(high, wide)
    faces = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1)
    return _mesh("sheet", points.reshape(-1, 3), faces.reshape(-1, 4))


def _outline():
    """(radius, height) of the outline of plate and ball, from the middle of the ground to the top."""
    def at(height):
        return math.sqrt(max(RADIUS**2 - (height - CENTRE) ** 2, 0.0))

    points = [(0.0, 0.0), (PLATE - BEVEL, 0.0), (PLATE, BEVEL), (PLATE, THICKNESS - BEVEL), (PLATE - BEVEL, THICKNESS)]
    bottom, top, depth = GROOVE
    points += [(at(height), height) for height in np.linspace(THICKNESS, bottom, 28)]
    points += [(at(bottom) - depth, bottom + 0.006), (at(top) - depth, top - 0.006)]
    angles = np.linspace(math.asin((top - CENTRE) / RADIUS), 0.5 * math.pi, 20)
    points += [(RADIUS * math.cos(angle), CENTRE + RADIUS * math.sin(angle)) for angle in angles]
    return points


def _revolved(outline):
    """(vertices (n, 3), quads (m, 4)) of an outline (k, 2) that turns around the z axis. Points on the axis become
    small circles, without faces across."""
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    radius = np.maximum(outline[:, 0], 1e-5)
    points = np.stack([radius[:, None] * np.cos(angle), radius[:, None] * np.sin(angle),
                       np.repeat(outline[:, 1:], AROUND, axis=1)], axis=-1)
    number = np.arange(len(outline) * AROUND).reshape(len(outline), AROUND)
    after = np.roll(number, -1, axis=1)
    quads = np.stack([number[:-1], after[:-1], after[1:], number[1:]], axis=-1)
    return points.reshape(-1, 3), quads.reshape(-1, 4)


def _mesh(name, points, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([Vector(point) for point in points], [], faces.tolist())
    mesh.shade_smooth()
    mesh.set_sharp_from_angle(angle=SHARP)
    mesh.materials.append(None)
    return mesh
