# SPDX-License-Identifier: GPL-3.0-or-later
"""What several add-on tests look at."""

import numpy as np


def image_of(group):
    """The one image that the group's texture nodes share."""
    images = {node.image for node in group.nodes if node.type == "TEX_IMAGE"}
    assert len(images) == 1
    return images.pop()


def pixels(image):
    """float32 (height, width, 4), bottom row first."""
    values = np.empty(image.size[0] * image.size[1] * 4, dtype=np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], 4)


def surface_source(material):
    """The node that feeds the Surface of the material's output."""
    return material.node_tree.get_output_node("CYCLES").inputs["Surface"].links[0].from_node


def snapshot(material):
    """All that a bake could change in the material's group."""
    group = material.lamina.node_group
    return sorted(node.name for node in group.nodes), pixels(image_of(group)).tobytes()
