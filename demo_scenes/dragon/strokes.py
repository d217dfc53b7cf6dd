# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes of two fingers through the dust on the plinth, as the attribute that the material's detail reads. In metres."""

import math

import numpy as np

from . import stage

ATTRIBUTE = "lamina_wiped"
WIDTH, EDGE = 0.0075, 0.0025  # of a stroke, and of its soft edge
# Strokes in the plane of the plinth: (start, end) in polar coordinates, angle from the viewer's side and radius.
STROKES = (((-0.95, 0.1035), (-0.12, 0.1000)), ((-0.84, 0.0925), (-0.22, 0.0895)))


def wipe(mesh, vertices):
    """Write the attribute: 1 where a stroke removed the dust, 0 elsewhere. vertices: (n, 3)."""
    wiped = np.zeros(len(vertices))
    for stroke in STROKES:
        distance = _to_arc(vertices[:, :2], *stroke)
        wiped = np.maximum(wiped, np.clip((0.5 * WIDTH + EDGE - distance) / EDGE, 0.0, 1.0))
    mesh.attributes.new(ATTRIBUTE, "FLOAT", "POINT").data.foreach_set("value", wiped.astype(np.float32))


def _to_arc(points, start, end):
    """Distance of points (n, 2) to a stroke whose angle and radius change evenly from start to end."""
    share = np.linspace(0.0, 1.0, 33)[:, None]
    angle, radius = (np.array(start) * (1.0 - share) + np.array(end) * share).T
    angle = angle + math.atan2(stage.AHEAD.y, stage.AHEAD.x)
    places = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.linalg.norm(points[:, None] - places[None], axis=2).min(axis=1)
