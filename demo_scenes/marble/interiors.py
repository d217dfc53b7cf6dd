# SPDX-License-Identifier: GPL-3.0-or-later
"""Interiors whose voxels sample a material's own nodes."""

import cycles_render
import extension
import numpy as np

from . import veins


def sampled(thing, material, vertices, voxel, ground, vein):
    """The lamina.Interior of the Blender object `thing` with the nodes of `material`, in the box of `vertices` (mm).

    voxel: side in mm, about. ground, vein: (sigma_s, sigma_a) in 1/mm."""
    import lamina  # the extension's wheel: not there before the extension is installed

    low, high = vertices.min(axis=0), vertices.max(axis=0)
    shape = np.maximum(np.rint((high - low) / voxel).astype(int), 1)
    with cycles_render.quiet():
        share = extension.part("interior.node_texture").sample_nodes(
            thing, material, low, high, shape, source=(veins.SHARE, "Result"))[..., 0]
    return lamina.Interior.mixed(np.clip(share, 0.0, 1.0), [lamina.EndMaterial(*ground), lamina.EndMaterial(*vein)],
                                 low, high)
