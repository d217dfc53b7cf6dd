# SPDX-License-Identifier: GPL-3.0-or-later
"""A ball of veined stone for benchmarks: a mesh of 100,352 faces with 256^3 voxels."""

import numpy as np

SIDE = 256  # voxels
RADIUS = 10.0  # mm
RINGS = AROUND = 224
# 1/mm, of the white stone. Equal in all channels, because Mitsuba's volpath is noisy with unequal extinctions.
EXTINCTION = 2.2


def mesh() -> tuple[np.ndarray, np.ndarray]:
    """(vertices, triangles)."""
    theta = np.linspace(0.0, np.pi, RINGS + 1)[:, None]
    phi = np.arange(AROUND) * 2.0 * np.pi / AROUND
    vertices = RADIUS * np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi),
                                  np.cos(theta) + 0.0 * phi], axis=-1)
    i, j = np.mgrid[:RINGS, :AROUND]
    a, b = i * AROUND + j, i * AROUND + (j + 1) % AROUND
    triangles = np.stack([a, a + AROUND, b, b, a + AROUND, b + AROUND], axis=-1).reshape(-1, 3)
    return vertices.reshape(-1, 3), triangles


def coefficients() -> tuple[np.ndarray, np.ndarray]:
    """(extinction [x, y, z] in 1/mm, single-scattering albedo [x, y, z, channel])."""
    x, y, z = np.meshgrid(*[np.arange(SIDE, dtype=np.float32)] * 3, indexing="ij", sparse=True)
    wave = np.sin(0.11 * x + 2.0 * np.sin(0.07 * y) + 1.5 * np.sin(0.05 * z))
    vein = np.exp(-20.0 * wave**2)
    extinction = (EXTINCTION * (1.0 - 0.3 * vein)).astype(np.float32)
    absorption = np.array([0.0021, 0.0041, 0.0071], np.float32) + 0.06 * vein[..., None]
    return extinction, (1.0 - absorption / extinction[..., None]).astype(np.float32)
