# SPDX-License-Identifier: GPL-3.0-or-later
"""Coefficients of scattering and absorption in the voxels of a box."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..common.archive import Damaged, load_archive, save_archive
from ..common.arguments import finite_array
from ..common.errors import ArgumentError, InteriorError, quoted
from ..kinds.interiors import MOST_COEFFICIENT
from .end_material import CHANNELS, EndMaterial, check_g

FORMAT, SCHEMA = "lamina-interior", 1
MOST_COORDINATE = 65535  # coordinate of the palette's last material
MOST_VOXELS = 1 << 30
MOST_MATERIALS = 256


@dataclass(frozen=True, eq=False)
class Interior:
    """The interior of a mesh. Create one with `uniform`, `mixed`, `of_coefficients`, `lamina.marble` or `load`.

    `voxels`: array [x, y, z]. Either uint16: a palette coordinate from 0 (first material) to 65535 (last material);
    values between two neighbouring materials are linear mixtures. Or float16 with a last axis of 6: sigma_s, then
    sigma_a, of red, green and blue in 1/mm.
    `low`, `high`: corners in mm of the box that the voxels fill, in the space of the mesh. Outside of the box the
    coefficients at its faces are used.
    `palette`: the end materials; empty for coefficients. `g`: mean cosine of the phase function, for coefficients.
    `smooth`: if true, trilinear interpolation between voxel centres; otherwise constant in each voxel."""

    voxels: np.ndarray
    low: tuple[float, ...]
    high: tuple[float, ...]
    palette: tuple[EndMaterial, ...] = ()
    g: float = 0.0
    smooth: bool = True

    @classmethod
    def uniform(cls, material: EndMaterial) -> Interior:
        """The same material everywhere. Raises InteriorError."""
        return cls(np.zeros((1, 1, 1), np.uint16), (0.0,) * 3, (1.0,) * 3, checked_palette([material]))

    @classmethod
    def mixed(cls, coordinate, palette: Sequence[EndMaterial], low, high, smooth: bool = True) -> Interior:
        """Mixtures of one to 256 end materials. `coordinate`: array [x, y, z], from 0 (first material of the palette)
        to 1 (last material); multiples of 1 / (materials - 1) are pure materials. Coordinates are stored with 16 bits.
        `low`, `high`: corners of the box, mm. Raises InteriorError, a ValueError, that names the first bad voxel."""
        corners = checked_box(low, high)
        materials = checked_palette(palette)
        array = _voxels(coordinate, "coordinate", (3,))
        _check_range(array, "coordinate", 1.0, "")
        voxels = np.empty(array.shape, np.uint16)
        for x in range(len(array)):  # a slice at a time, to limit memory
            voxels[x] = np.rint(array[x].astype(np.float64) * MOST_COORDINATE)
        return cls(voxels, *corners, materials, smooth=bool(smooth))

    @classmethod
    def of_coefficients(cls, sigma_s, sigma_a, low, high, g: float = 0.0, smooth: bool = True) -> Interior:
        """Coefficients in 1/mm, range [0, 65504], each of shape [x, y, z] or [x, y, z, 3 channels]. Coefficients are
        stored as halves, with an error up to .05 %. `low`, `high`: corners of the box, mm. Raises InteriorError that
        names the first bad voxel."""
        corners = checked_box(low, high)
        g = check_g(g)
        arrays = {name: _voxels(values, name, (3, 4)) for name, values in (("sigma_s", sigma_s), ("sigma_a", sigma_a))}
        shapes = {name: array.shape[:3] for name, array in arrays.items()}
        if shapes["sigma_s"] != shapes["sigma_a"]:
            raise InteriorError(f"sigma_a has the shape {arrays['sigma_a'].shape}: must have the voxels of sigma_s, "
                                f"{shapes['sigma_s']}")
        voxels = np.empty((*shapes["sigma_s"], 2 * CHANNELS), np.float16)
        for place, (name, array) in enumerate(arrays.items()):
            if array.ndim == 4 and array.shape[3] != CHANNELS:
                raise InteriorError(f"{name} has the shape {array.shape}: must be (nx, ny, nz), or (nx, ny, nz, 3)")
            _check_range(array, name, MOST_COEFFICIENT, " 1/mm")
            voxels[..., place * CHANNELS:(place + 1) * CHANNELS] = array if array.ndim == 4 else array[..., None]
        voxels += 0.0  # makes -0 equal to 0, for the hash
        return cls(voxels, *corners, g=g, smooth=bool(smooth))

    @property
    def bytes(self) -> int:
        """Memory of the voxels in bytes."""
        return self.voxels.nbytes

    @property
    def hash(self) -> str:
        """Hash of the content: equal interiors have equal hashes."""
        digest = hashlib.sha256(json.dumps(self._header(), sort_keys=True).encode())
        digest.update(np.ascontiguousarray(self.voxels).data)
        return digest.hexdigest()

    def at(self, places) -> tuple[np.ndarray, np.ndarray]:
        """(sigma_s, sigma_a) in 1/mm at positions in mm; all arrays have shape (n, 3). Raises ArgumentError."""
        places = finite_array(places, "places")
        if places.ndim != 2 or places.shape[1] != 3:
            raise ArgumentError(f"places has the shape {places.shape}: must be (n, 3)")
        size = np.array(self.voxels.shape[:3])
        u = (places - self.low) / (np.array(self.high) - self.low) * size
        if not self.smooth:
            return self._coefficients(*np.clip(np.floor(u), 0, size - 1).astype(int).T)
        u = np.clip(u - 0.5, 0.0, size - 1.0)
        first = np.floor(u).astype(int)
        second = np.minimum(first + 1, size - 1)
        share = u - first
        sums = [np.zeros(places.shape), np.zeros(places.shape)]
        for corner in np.ndindex(2, 2, 2):
            chosen = np.where(corner, second, first)
            weight = np.prod(np.where(corner, share, 1.0 - share), axis=1)
            for total, values in zip(sums, self._coefficients(*chosen.T), strict=True):
                total += weight[:, None] * values
        return sums[0], sums[1]

    def _coefficients(self, x, y, z) -> tuple[np.ndarray, np.ndarray]:
        """(sigma_s, sigma_a) in 1/mm of the voxels with these indices."""
        values = self.voxels[x, y, z]
        if not self.palette:
            return values[:, :CHANNELS].astype(float), values[:, CHANNELS:].astype(float)
        place = values * (len(self.palette) - 1) / MOST_COORDINATE
        first = np.floor(place).astype(int)
        share = (place - first)[:, None]
        found = []
        for name in ("sigma_s", "sigma_a"):
            table = np.array([getattr(material, name) for material in (*self.palette, self.palette[-1])])
            found.append((1.0 - share) * table[first] + share * table[first + 1])
        return found[0], found[1]

    def _header(self) -> dict:
        return {"format": FORMAT, "schema": SCHEMA, "low": list(self.low), "high": list(self.high), "g": self.g,
                "palette": [material.to_json() for material in self.palette], "smooth": self.smooth}

    def save(self, path: str | os.PathLike) -> None:
        """Writes an .npz file atomically. The header is JSON as bytes; no pickle. Raises OSError."""
        save_archive(path, self._header(), voxels=self.voxels)

    @classmethod
    def load(cls, path: str | os.PathLike) -> Interior:
        """Reads a file written by `save`. Raises InteriorError if the file is truncated, not an interior, of a newer
        schema, or has values out of range. Raises OSError if the file cannot be opened."""
        try:
            header, (voxels,) = load_archive(path, "voxels")
        except Damaged:
            raise InteriorError(f"{path}: not a whole interior saved by Lamina") from None
        if not isinstance(header, dict) or header.get("format") != FORMAT:
            raise InteriorError(f"{path}: not a whole interior saved by Lamina")
        schema = header.get("schema")
        if isinstance(schema, int) and schema > SCHEMA:
            raise InteriorError(f"{path}: schema {schema} needs a newer Lamina, which reads up to {SCHEMA}")
        try:
            return cls._of_header(header, voxels)
        except InteriorError as error:
            raise InteriorError(f"{path}: {error}") from None

    @classmethod
    def _of_header(cls, header: dict, voxels: np.ndarray) -> Interior:
        if set(header) != {"format", "schema", "low", "high", "g", "palette", "smooth"}:
            raise InteriorError("the header is incomplete")
        corners = checked_box(header["low"], header["high"])
        if not isinstance(header["palette"], list) or not isinstance(header["smooth"], bool):
            raise InteriorError("palette must be a list, and smooth true or false")
        materials = [EndMaterial.from_json(one, f"palette[{k}]") for k, one in enumerate(header["palette"])]
        dtype, axes = (np.uint16, 3) if materials else (np.float16, 4)
        if voxels.dtype != dtype or voxels.ndim != axes or voxels.size == 0 or \
                (axes == 4 and voxels.shape[3] != 2 * CHANNELS):
            raise InteriorError(f"voxels has the shape {voxels.shape} of {voxels.dtype}: does not fit the header")
        if not materials:
            _check_range(voxels, "voxels", MOST_COEFFICIENT, " 1/mm")
        palette = checked_palette(materials) if materials else ()
        return cls(voxels, *corners, palette, check_g(header["g"]), header["smooth"])


def checked_box(low, high) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Check the corners of a box and return them. Raises InteriorError."""
    corners = []
    for name, value in (("low", low), ("high", high)):
        try:
            array = finite_array(value, name)
        except ArgumentError as error:
            raise InteriorError(str(error)) from None
        if array.shape != (3,):
            raise InteriorError(f"{name} = {quoted(value)}: must be three lengths in mm")
        corners.append(tuple(map(float, array)))
    for axis, below, above in zip("xyz", *corners, strict=True):
        if not below < above:
            raise InteriorError(f"high = {corners[1]}: must be above low = {corners[0]} along {axis}")
    return corners[0], corners[1]


def checked_palette(palette) -> tuple[EndMaterial, ...]:
    if isinstance(palette, EndMaterial) or not isinstance(palette, Sequence) or not \
            1 <= len(palette) <= MOST_MATERIALS or not all(isinstance(one, EndMaterial) for one in palette):
        raise InteriorError(f"palette = {quoted(palette)}: must be a list of 1 to {MOST_MATERIALS} lamina.EndMaterial")
    return tuple(palette)


def _voxels(values, name: str, axes: tuple[int, ...]) -> np.ndarray:
    try:
        array = np.asarray(values)
        array = array if array.dtype.kind == "f" else array.astype(np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InteriorError(f"{name}: must be an array of numbers") from None
    if array.ndim not in axes or array.size == 0 or array.size > 6 * MOST_VOXELS:
        wanted = "(nx, ny, nz)" if axes == (3,) else "(nx, ny, nz), or (nx, ny, nz, 3)"
        raise InteriorError(f"{name} has the shape {array.shape}: must be {wanted}")
    return array


def _check_range(array: np.ndarray, name: str, high: float, unit: str) -> None:
    """Raises InteriorError that names the first voxel with a value outside [0, high] or NaN."""
    for x in range(len(array)):
        wrong = ~((array[x] >= 0.0) & (array[x] <= high))
        if wrong.any():
            place = (x, *map(int, np.argwhere(wrong)[0]))
            raise InteriorError(f"{name}[{', '.join(map(str, place))}] = {float(array[place])!r}: must lie in "
                                f"[0, {high:g}]{unit}")
