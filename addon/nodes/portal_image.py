# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of the portal as rows of one image, and nodes that read the rows."""

import numpy as np

from ..base import data_image

# Rows of the image, from below; those by view cosine follow.
DEPTHS, VIEWS = 0, 1


def create(name, depths, views):
    """The image with `depths`, shape (count,), in its alpha channel, and `views`, (rows, count, channels)."""
    texels = np.ones((VIEWS + len(views), len(depths), 4), np.float32)
    texels[DEPTHS, :, 3] = depths
    texels[VIEWS:, :, :3] = views
    return data_image.create(name, texels)


def depth(graph, image, place):
    """The depth at the place in [0, 1]: 0 is the first texel, 1 the last."""
    scale = (1.0 - 1.0 / image.size[0], 0.0)
    node = _texture(graph, image, DEPTHS, "depth of the source", place, "Closest", scale)
    return graph.value(node.outputs["Alpha"])


def by_view(graph, image, place, cosine):
    """The weight of a ray by the place of its depth and by the view cosine."""
    width, height = image.size
    at = graph.combined("depth and view", place, cosine)
    # From [0, 1] to the centers of the first and the last row of views.
    scale = ((width - 1.0) / width, (height - VIEWS - 1.0) / height)
    node = _texture(graph, image, VIEWS, "by view and depth", at, "Linear", scale)
    return graph.value(node.outputs["Color"])


def _texture(graph, image, row, label, place, interpolation, scale):
    """The image at `place` times `scale` from the center of the first texel of a row."""
    node = graph.node("ShaderNodeTexImage", label)
    node.image, node.interpolation, node.extension = image, interpolation, "EXTEND"
    node.texture_mapping.scale = (*scale, 0.0)
    node.texture_mapping.translation = (0.5 / image.size[0], (row + 0.5) / image.size[1], 0.0)
    graph.link(place, node.inputs["Vector"])
    return node
