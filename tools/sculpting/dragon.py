# SPDX-License-Identifier: GPL-3.0-or-later
"""The complete dragon as one mesh of closed surfaces, about 24 cm high; CC0."""

import functools

import numpy as np

from . import body, crest, distance, head, isosurface, shells, skin, wings

SPACING, HEAD_SPACING = 1.0, 0.5
SEED = 5


def build(spacing=SPACING, head_spacing=HEAD_SPACING):
    """(vertices (n, 3) in mm, quadrangles (m, 4), triangles (k, 3)), oriented outwards, z up, standing on z = 0.

    spacing, head_spacing: of the grid, in mm."""
    trunk = _scaled(body.parts() + wings.arm_parts(), spacing, skin.of_trunk)
    skull = _scaled(head.parts(), head_spacing, skin.of_head)
    of_head = [(head.enlarged(points), *faces) for points, *faces in [skull, *head.shells_of_head()]]
    pieces = [trunk, *of_head, *body.claws(), *wings.made(), *crest.blades(), *crest.spade()]
    return shells.join(pieces)


def _scaled(parts, spacing, skin_of):
    """The smooth union of `parts`, with scales."""
    boxes = np.stack([part.box for part in parts if not part.carve])
    box = np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
    vertices, triangles = isosurface.mesh(functools.partial(distance.melt, parts), box, spacing)
    normals = isosurface.normals(vertices, triangles)
    height = skin_of(vertices, normals, SEED)
    return vertices + height[:, None] * normals, np.empty((0, 4), int), triangles
