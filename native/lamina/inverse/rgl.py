# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured materials of RGL (.bsdf), at the nodes of their grids: Dupuy and Jakob 2018, "An Adaptive Parameterization
for Efficient Material Acquisition and Rendering"."""

from __future__ import annotations

import math
import os

import numpy as np

from ..common.arguments import finite_list
from ..common.errors import ArgumentError, MeasurementError, quoted
from ..common.observer import rec709
from ..common.tensor_file import NoTensors, read_tensors
from .directions import Directions

NEEDED = ("phi_i", "theta_i", "ndf", "sigma", "vndf", "jacobian")
DENSITIES = ("ndf", "sigma", "vndf")
SMALLEST = 1e-7  # 1/sr, in place of 0 in a logarithm


def read_rgl(path: str | os.PathLike, wavelengths=None) -> Directions:
    """The directions of all nodes. `wavelengths` in nm, between which the file's are interpolated; None for all of a
    spectral file, or for red, green and blue. Raises MeasurementError, ArgumentError and OSError."""
    fields = _fields(path)
    return _directions(fields, _channels(fields, wavelengths))


def rgl_at(path: str | os.PathLike, h: np.ndarray, d: np.ndarray, c: np.ndarray, *_: np.ndarray) -> np.ndarray:
    """The values in 1/sr, (*h.shape, 3), red, green and blue, at half vectors, see half_table: the mean of both
    directions. Raises MeasurementError and OSError."""
    fields = _fields(path)
    values = _channels(fields, None)
    if "spectra" in fields:
        values = rec709(values, tuple(fields["wavelengths"].astype(float).tolist()))
    found = [_at(fields, values, h.ravel(), d.ravel(), sign * c.ravel()) for sign in (1.0, -1.0)]
    return np.exp(0.5 * sum(np.log(np.maximum(one, SMALLEST)) for one in found)).reshape(*h.shape, -1)


def _fields(path: str | os.PathLike) -> dict[str, np.ndarray]:
    """The arrays of an isotropic material. Raises MeasurementError and OSError."""
    try:
        fields = read_tensors(path)
    except NoTensors as reason:
        raise MeasurementError(f"{path}: must be a .bsdf file of RGL: {reason}") from None
    kind = "spectra" if "spectra" in fields else "rgb"
    for name in (*NEEDED, kind, *(["wavelengths"] if kind == "spectra" else [])):
        if name not in fields:
            raise MeasurementError(f"{path}: has no {quoted(name)}: must be a .bsdf file of RGL")
    if fields["phi_i"].size > 2:
        raise MeasurementError(f"{path}: holds an anisotropic material: must be isotropic like all layers")
    _check_shapes(path, fields, kind)
    if not np.all(np.isfinite(fields[kind])):
        raise MeasurementError(f"{path}: holds values that are not finite")
    for name in DENSITIES:
        own = fields[name]
        if not np.all(np.isfinite(own)) or own.min() < 0.0 or not np.all(own.max(axis=(-2, -1)) > 0.0):
            raise MeasurementError(f"{path}: {name} holds numbers that cannot be densities or areas")
    for name, high in (("theta_i", 0.5 * math.pi + 1e-6), ("wavelengths", math.inf)):
        own = fields.get(name, np.empty(0))
        if not np.all((own >= 0.0) & (own <= high) & np.isfinite(own)) or not np.all(np.diff(own) > 0.0):
            raise MeasurementError(f"{path}: {name} holds numbers that do not ascend, or cannot be")
    return fields


def _check_shapes(path, fields: dict[str, np.ndarray], kind: str) -> None:
    """Raises MeasurementError if arrays do not fit together; `kind`: the name of the values."""
    slices = (fields["phi_i"].size, fields["theta_i"].size)
    channels = fields["wavelengths"].size if kind == "spectra" else 3
    # The axes before the two of a grid.
    before = {"ndf": (), "sigma": (), "vndf": slices, kind: (*slices, channels)}
    lists = [fields[name] for name in ("phi_i", "theta_i", "jacobian", "wavelengths") if name in fields]
    if (any(one.ndim != 1 or not one.size for one in lists) or fields["jacobian"].size != 1
            or any(fields[name].ndim != len(axes) + 2 or fields[name].shape[:-2] != axes
                   or min(fields[name].shape[-2:]) < 2 for name, axes in before.items())):
        raise MeasurementError(f"{path}: the arrays have shapes that do not fit together")


def _channels(fields: dict[str, np.ndarray], wavelengths) -> np.ndarray:
    """Values [theta_i, v, u, channel]."""
    if "spectra" not in fields:
        if wavelengths is not None:
            raise ArgumentError(f"wavelengths = {quoted(wavelengths)}: the file has none, its channels are red, green "
                                "and blue")
        return np.moveaxis(fields["rgb"][0].astype(float), 1, -1)
    spectra, known = np.moveaxis(fields["spectra"][0].astype(float), 1, -1), fields["wavelengths"].astype(float)
    if wavelengths is None:
        return spectra
    wanted = finite_list(wavelengths, "wavelengths")
    outside = (wanted < known.min()) | (wanted > known.max())
    if np.any(outside):
        raise ArgumentError(f"wavelengths hold {wanted[outside][0]:g}: must lie in [{known.min():g}, {known.max():g}] "
                            "nm, the range of the file")
    return spectra @ np.array([np.interp(wanted, known, one) for one in np.eye(len(known))])


def _directions(fields: dict[str, np.ndarray], values: np.ndarray) -> Directions:
    theta_i = fields["theta_i"].astype(float)
    ndf, sigma = fields["ndf"].astype(float), fields["sigma"].astype(float)
    rows, columns = values.shape[1:3]
    u, v = (axis.ravel() for axis in np.meshgrid(np.linspace(0.0, 1.0, columns), np.linspace(0.0, 1.0, rows)))
    parts = []
    for index, theta in enumerate(theta_i):
        warped = warp(fields["vndf"][0, index].astype(float), u, v)
        theta_m, phi_m = 0.5 * math.pi * warped[0]**2, (2.0 * warped[1] - 1.0) * math.pi
        m = np.stack([np.sin(theta_m) * np.cos(phi_m), np.sin(theta_m) * np.sin(phi_m), np.cos(theta_m)], axis=-1)
        wi = np.broadcast_to([math.sin(theta), 0.0, math.cos(theta)], m.shape)
        wo = 2.0 * np.sum(m * wi, axis=-1, keepdims=True) * m - wi
        weighted = values[index].reshape(len(u), -1)  # f cos(theta_o), except for the jacobian
        if fields["jacobian"][0]:
            area = bilinear(sigma, math.sqrt(2.0 * theta / math.pi), 0.5)
            weighted = weighted * (bilinear(ndf, *warped) / (4.0 * area))[:, None]
        cosine = np.maximum(wo[:, 2:], 1e-9)
        parts.append(Directions.of_vectors(wi, wo, weighted / cosine))
    return Directions(*(np.concatenate([getattr(part, name) for part in parts])
                        for name in ("mu_o", "mu_i", "dphi", "values")))


def _at(fields: dict[str, np.ndarray], values: np.ndarray, h: np.ndarray, d: np.ndarray,
        turn: np.ndarray) -> np.ndarray:
    """The values (count, channels) at half vectors; `turn`: the cosine of the light's azimuth about the half vector, 1
    towards the normal. Between the slices of two incident angles, densities and values are linear in the angle."""
    across = np.sqrt(np.maximum(1.0 - turn**2, 0.0))
    x, y, z = np.sin(d) * turn, np.sin(d) * across, np.cos(d)
    # In the plane of the normal and the half vector, the light; then the half vector's azimuth from the light
    wi = np.cos(h) * -x + np.sin(h) * z, y, np.cos(h) * z + np.sin(h) * x
    mu_i = np.clip(wi[2], 1e-3, 1.0)
    leaving = np.clip(2.0 * np.cos(d) * np.cos(h) - wi[2], 1e-3, 1.0)
    azimuth = np.abs(np.arctan2(y * np.sin(h), wi[0] * np.sin(h)))
    place_x = np.sqrt(2.0 * h / math.pi)
    place_y = 0.5 * (azimuth / math.pi + 1.0)
    theta = fields["theta_i"].astype(float)
    angle = np.clip(np.arccos(mu_i), theta[0], theta[-1])
    low = np.clip(np.searchsorted(theta, angle) - 1, 0, max(len(theta) - 2, 0))
    high = np.minimum(low + 1, len(theta) - 1)
    share = (angle - theta[low]) / np.maximum(theta[high] - theta[low], 1e-12)
    u, v = _unwarped(fields["vndf"][0].astype(float), (low, high, share), place_x, place_y)
    found = ((1.0 - share)[:, None] * _bilinear_of(values, low, u, v)
             + share[:, None] * _bilinear_of(values, high, u, v))
    if fields["jacobian"][0]:
        ndf, sigma = fields["ndf"].astype(float), fields["sigma"].astype(float)
        area = bilinear(sigma, np.sqrt(2.0 * angle / math.pi), 0.5)
        found = found * (bilinear(ndf, place_x, place_y) / (4.0 * area))[:, None]
    return found / leaving[:, None]


def _unwarped(densities: np.ndarray, between: tuple[np.ndarray, np.ndarray, np.ndarray], x: np.ndarray,
              y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The inverse of `warp` for a density that is linear between two of `densities` [slice, row, column], each with the
    integral 1."""
    low, high, share = between
    rows, columns = densities.shape[1:]
    along = np.zeros_like(densities)  # integral over the columns, in cells
    along[..., 1:] = np.cumsum(0.5 * (densities[..., 1:] + densities[..., :-1]), axis=-1)
    whole = along[..., -1]
    across = np.zeros_like(whole)
    across[:, 1:] = np.cumsum(0.5 * (whole[:, 1:] + whole[:, :-1]), axis=1)
    row = np.clip((y * (rows - 1)).astype(int), 0, rows - 2)
    column = np.clip((x * (columns - 1)).astype(int), 0, columns - 2)
    s, t = y * (rows - 1) - row, x * (columns - 1) - column

    def integrals(one: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        total = across[one, -1]
        below = across[one, row] + s * whole[one, row] + 0.5 * s * s * (whole[one, row + 1] - whole[one, row])
        lines = []
        for end in (row, row + 1):
            left, right = densities[one, end, column], densities[one, end, column + 1]
            lines.append(along[one, end, column] + t * left + 0.5 * t * t * (right - left))
        to_left = (1.0 - s) * lines[0] + s * lines[1]
        line = (1.0 - s) * whole[one, row] + s * whole[one, row + 1]
        return below / total, to_left / total, line / total

    below, to_left, line = ((1.0 - share) * a + share * b for a, b in zip(integrals(low), integrals(high), strict=True))
    return np.clip(to_left / np.maximum(line, 1e-300), 0.0, 1.0), np.clip(below, 0.0, 1.0)


def _bilinear_of(tables: np.ndarray, which: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The tables [table, row, column, channel] at places (x, y) of the unit square, a table for each place."""
    x, y = x * (tables.shape[2] - 1), y * (tables.shape[1] - 1)
    i, j = (np.clip(place.astype(int), 0, size - 2) for place, size in ((x, tables.shape[2]), (y, tables.shape[1])))
    s, t = (x - i)[:, None], (y - j)[:, None]
    return ((tables[which, j, i] * (1.0 - s) + tables[which, j, i + 1] * s) * (1.0 - t)
            + (tables[which, j + 1, i] * (1.0 - s) + tables[which, j + 1, i + 1] * s) * t)


def warp(density: np.ndarray, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Moves uniform points (u, v) of the unit square so that their density is proportional to the table `density` [row,
    column], interpolated bilinearly. v chooses the row, by the integrals over the columns; u chooses the column in this
    row."""
    rows, columns = density.shape
    along = np.zeros_like(density)  # integral over the columns, in cells
    along[:, 1:] = np.cumsum(0.5 * (density[:, 1:] + density[:, :-1]), axis=1)
    whole = along[:, -1]
    across = np.concatenate([[0.0], np.cumsum(0.5 * (whole[1:] + whole[:-1]))])
    row, y = _inverted(across, whole, v * across[-1])
    line = along[row] * (1.0 - y[:, None]) + along[row + 1] * y[:, None]
    height = density[row] * (1.0 - y[:, None]) + density[row + 1] * y[:, None]
    target = u * line[:, -1]
    column = np.clip(np.sum(line <= target[:, None], axis=1) - 1, 0, columns - 2)
    each = np.arange(len(u))
    x = _share(height[each, column], height[each, column + 1], target - line[each, column])
    return (column + x) / (columns - 1.0), (row + y) / (rows - 1.0)


def _inverted(integral: np.ndarray, density: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(cell, place in it) at which the integral of a piecewise linear density reaches `target`."""
    cell = np.clip(np.searchsorted(integral, target, side="right") - 1, 0, len(integral) - 2)
    return cell, _share(density[cell], density[cell + 1], target - integral[cell])


def _share(first: np.ndarray, last: np.ndarray, area: np.ndarray) -> np.ndarray:
    """The share of a cell over which a density from `first` to `last` has this area."""
    root = np.sqrt(np.maximum(first**2 + 2.0 * area * (last - first), 0.0))
    return np.clip(2.0 * area / np.maximum(first + root, 1e-300), 0.0, 1.0)


def bilinear(table: np.ndarray, x, y) -> np.ndarray:
    """A table [row, column] at places (x, y) of the unit square."""
    x, y = (np.clip(np.asarray(place) * (size - 1.0), 0.0, size - 1.0)
            for place, size in zip((x, y), table.shape[::-1], strict=True))
    i, j = (np.minimum(place.astype(int), max(size - 2, 0)) for place, size in zip((x, y), table.shape[::-1],
                                                                                 strict=True))
    right, below = np.minimum(i + 1, table.shape[1] - 1), np.minimum(j + 1, table.shape[0] - 1)
    x, y = x - i, y - j
    return ((table[j, i] * (1.0 - x) + table[j, right] * x) * (1.0 - y)
            + (table[below, i] * (1.0 - x) + table[below, right] * x) * y)
