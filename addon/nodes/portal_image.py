# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of the portal as rows of one image, and nodes that read the rows."""

import numpy as np

from ..base import data_image

# Rows of the image, from below.
DEPTHS, WEIGHTS, VIEWS, SHARES, ROWS = 0, 1, 2, 3, 4


def create(name, depths, tables):
    """The image with `depths`, shape (width,), and `tables`: row number -> values, (count, channels)."""
    width = len(depths)
    texels = np.zeros((ROWS, width, 4), np.float32)
    texels[:, :, 3] = 1.0
    texels[DEPTHS, :, :3] = depths[:, None]
    for number, values in tables.items():
        places = np.linspace(0.0, len(values) - 1.0, width)
        wide = np.stack([np.interp(places, np.arange(len(values)), column) for column in values.T], axis=1)
        texels[number, :, :3] = wide
    return data_image.create(name, texels)


def row(graph, image, number, label, place, interpolation):
    """Look up a row of the image at a coordinate in [0, 1]: 0 is the first texel, 1 the last. Returns the
    colour."""
    half = 0.5 / image.size[0]
    node = graph.node("ShaderNodeTexImage", 3, 2 * number, label)
    node.image, node.interpolation, node.extension = image, interpolation, "EXTEND"
    # From the coordinate to the centers of the row's texels.
    node.texture_mapping.scale = (1.0 - 2.0 * half, 0.0, 0.0)
    node.texture_mapping.translation = (half, (number + 0.5) / ROWS, 0.0)
    graph.link(place, node.inputs["Vector"])
    return node.outputs["Color"]


def at_distance(graph, image, scale, r):
    """The weight of a ray by the distance `r` on the plane, mm."""
    place = graph.math("DIVIDE", 2, 8, "place", r, graph.math("ADD", 1, 9, "and scale", r, scale))
    return row(graph, image, WEIGHTS, "weight", place, "Linear")
