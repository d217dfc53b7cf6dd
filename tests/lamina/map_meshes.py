# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids with UV maps."""

import numpy as np
from walk_meshes import WIDE, slab


def slab_with_uvs(thickness, inner=0.5):
    """(a wide slab, its UV map): the middle of the top face, of this share of its sides, fills the image; all other
    faces are points in the UV map."""
    solid, _, _ = slab(thickness)
    corners = solid.vertices[solid.triangles]
    top = (corners[:, :, 2] == 0.0).all(axis=1)
    uvs = np.zeros((len(solid.triangles), 3, 2))
    uvs[top] = corners[top][:, :, :2] / (WIDE * inner) + 0.5
    return solid, uvs
