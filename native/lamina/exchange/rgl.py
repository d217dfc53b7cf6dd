# SPDX-License-Identifier: GPL-3.0-or-later
"""Solved stacks as .bsdf files of RGL, which Mitsuba 3 (plugin `measured`), powitacq, and with wavelengths pbrt-v4
(material `measured`) read.

Format: Dupuy and Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering". A file
holds f cos(theta_o) of reflection on half vectors, and a probability density for sampling. The format has no place for
mirror reflection and transmission; save_bsdf returns the share of light that is left out."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence

import numpy as np

from ..common.arguments import check_callable, check_whole, finite_list
from ..common.atomic import write_atomically
from ..common.errors import ArgumentError, quoted
from ..common.tensor_file import write_tensors
from ..material.any_stack import AnyStack, as_stack
from ..solver.solve import ScatteringFunction, solve
from .half_vectors import GRAZING, dilated, half_vector_grid, incident_angles

# Nodes in theta_o and dphi of the product grid from which the half vectors are interpolated. The azimuths are denser
# about the mirror direction and back towards the light: dphi = pi (1 - cos(pi t)) / 2, with t uniform.
TABLE = (128, 61)


def save_bsdf(solved: ScatteringFunction | AnyStack, path: str | os.PathLike, size: int = 64, angles: int = 32,
              wavelengths: Sequence[float] | None = None,
              progress: Callable[[float, str], object] | None = None) -> float:
    """Writes the reflection from the top as a .bsdf file, completely or not at all. `solved`: what lamina.solve
    returns, or a stack, which is solved first.

    `size`: nodes of the half vector in elevation and in azimuth, [8, 1024]; `angles`: slices in theta_i, [4, 512].
    Readers interpolate linearly between them, so errors fall with the squares of both. Three channels are red, green
    and blue (linear sRGB), in a file for RGB renderers; one channel is grey and is written three times. With
    `wavelengths` (nm, one per channel, in any order) the file is for spectral renderers instead.

    Returns the largest share of a beam in the omitted mirror reflection, over theta_i and channels. Raises ValueError
    and OSError."""
    for name, value, low, high in (("size", size, 8, 1024), ("angles", angles, 4, 512)):
        check_whole(value, name, low, high, f"must be a whole number in [{low}, {high}]")
    check_callable(progress, "progress")
    (solved.stack if isinstance(solved, ScatteringFunction) else as_stack(solved)).require_isotropic("an export")
    if not isinstance(solved, ScatteringFunction):
        solved = solve(solved)
    spectral = check_wavelengths(wavelengths, solved.stack.channels)
    theta_i = incident_angles(angles)
    values, importance = _tabulate(solved, theta_i, size, progress or (lambda fraction, text: None))
    if spectral is None and values.shape[1] == 1:
        values = np.repeat(values, 3, axis=1)
    mirrored = float(solved.reflectance(np.cos(theta_i), parts=True)[1].max())
    fields = {
        "description": np.frombuffer(_describe(solved, mirrored, spectral).encode(), np.uint8),
        # The values are f cos(theta_o) itself, not to be multiplied by ndf / (4 sigma). pbrt-v4 does not read the flag
        # and always multiplies: by 1 ...
        "jacobian": np.zeros(1, np.uint8),
        "ndf": np.ones((2, 2)), "sigma": np.full((2, 2), 0.25),
        # ... on the plain grid of half vectors: a constant density does not warp it.
        "vndf": np.ones((1, angles, 2, 2)),
        "phi_i": np.zeros(1), "theta_i": theta_i,
        "luminance": importance[None],
    }
    if spectral is None:
        fields["rgb"] = values[None]
    else:
        ascending = np.argsort(spectral)
        fields["wavelengths"], fields["spectra"] = spectral[ascending], values[None, :, ascending]
    write_atomically(path, lambda file: write_tensors(file, fields))
    return mirrored


def check_wavelengths(wavelengths: Sequence[float] | None, channels: int) -> np.ndarray | None:
    """The wavelengths as an array, or None for a file in RGB or grey. Raises ValueError if a .bsdf file cannot hold
    this number of channels."""
    if wavelengths is None:
        if channels not in (1, 3):
            raise ArgumentError(f"the stack has {channels} channels: a .bsdf file without wavelengths holds 1 or 3")
        return None
    nm = finite_list(wavelengths, "wavelengths")
    if nm.shape != (channels,):
        raise ArgumentError(f"wavelengths = {quoted(nm.tolist())}: must be one for each of {channels} channel(s)")
    if nm.min() <= 0.0 or len(np.unique(nm)) < len(nm):
        raise ArgumentError(f"wavelengths = {quoted(nm.tolist())}: must be positive nanometres, all different")
    return nm


def _tabulate(solved: ScatteringFunction, theta_i: np.ndarray, size: int, progress):
    """(values [theta_i, channel, v, u], importance [theta_i, v, u]) on the half vectors of a file."""
    grid = half_vector_grid(size)
    theta_o = np.linspace(0.0, GRAZING, TABLE[0])
    half = math.pi / 2.0
    azimuths = half * (1.0 - np.cos(np.linspace(0.0, math.pi, TABLE[1])))
    values = np.empty((len(theta_i), solved.stack.channels, size, size))
    importance = np.empty((len(theta_i), size, size))
    valid = np.empty((len(theta_i), size, size), bool)
    progress(0.0, "reflection")
    table = solved.grid("reflect", np.cos(theta_o), np.cos(theta_i), azimuths)
    for index, theta in enumerate(theta_i):
        cosine, wo, density = grid.lights(np.array([math.sin(theta), 0.0, math.cos(theta)]))
        valid[index] = (wo[..., 2] > 0.0) & (cosine > 0.0)
        # dphi is 0 when light keeps its azimuth: it then leaves opposite to the direction where it came from.
        dphi = np.abs(np.arctan2(wo[..., 1], -wo[..., 0]))
        elevation = np.arccos(np.minimum(np.abs(wo[..., 2]), 1.0))
        place = np.arccos(np.clip(1.0 - dphi / half, -1.0, 1.0)) / math.pi * (TABLE[1] - 1)
        f = _bicubic(table[:, index], elevation / theta_o[1], place)
        values[index] = np.moveaxis(f * np.maximum(wo[..., 2:], 0.0), -1, 0)
        importance[index] = f.mean(axis=-1) * np.abs(wo[..., 2]) * density
        progress((index + 1) / len(theta_i), "half vectors")
    # Nodes outside all cells with a valid direction need no samples.
    importance *= dilated(valid)
    # A stack that reflects nothing also needs a density.
    importance += np.where(importance.sum(axis=(1, 2)) > 0.0, 0.0, 1.0)[:, None, None]
    return values, importance


def _bicubic(table: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """`table` [x, y, channel] at fractional indices. y, which is dphi, is mirrored at its ends; the ends of x are the
    normal, where all azimuths meet, and grazing."""
    rows, columns = table.shape[:2]
    i, j = (np.clip(np.floor(t).astype(int), 0, n - 2) for t, n in ((x, rows), (y, columns)))
    total = 0.0
    for a, wa in enumerate(_cubic_weights(np.clip(x, 0.0, rows - 1) - i)):
        row = i + a - 1
        for b, wb in enumerate(_cubic_weights(np.clip(y, 0.0, columns - 1) - j)):
            column = np.abs(j + b - 1)
            column = np.where(column >= columns, 2 * (columns - 1) - column, column)
            # Beyond the normal, continue on the other side of the same plane.
            across = np.where(row < 0, columns - 1 - column, column)
            total = total + (wa * wb)[..., None] * table[np.minimum(np.abs(row), rows - 1), across]
    return np.maximum(total, 0.0)


def _cubic_weights(t: np.ndarray):
    """Catmull and Rom's weights of four neighbours."""
    return (0.5 * t * (t * (2.0 - t) - 1.0), 0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
            0.5 * t * (t * (4.0 - 3.0 * t) + 1.0), 0.5 * t * t * (t - 1.0))


def _describe(solved: ScatteringFunction, mirrored: float, spectral: np.ndarray | None) -> str:
    parts = [f"Lamina stack {solved.stack.hash[:16]}, reflection from the top"]
    if spectral is None:
        parts.append("RGB" if solved.stack.channels == 3 else "grey")
    if mirrored > 0.0:
        parts.append(f"without mirror reflection of up to {mirrored:.3g}")
    if solved.stack.base is None:
        parts.append("without transmission")
    return ", ".join(parts)
