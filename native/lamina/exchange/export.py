# SPDX-License-Identifier: GPL-3.0-or-later
"""The full scattering function of a solved stack as an archive of arrays with axes."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..common.archive import Damaged, load_archive, save_archive
from ..common.arguments import check_callable, check_kind, finite_list
from ..common.errors import ArgumentError, ExportError
from ..material.any_stack import AnyStack, as_stack
from ..solver.solve import ScatteringFunction, solve

FORMAT = "lamina scattering function"
SCHEMA = 1
_AXES = ("theta_o", "theta_i", "dphi")
_KERNELS = ("brdf", "btdf")
_BY_ANGLE = ("reflectance", "mirror_reflectance", "transmittance", "unscattered_transmittance")
_DIFFUSE = ("diffuse_reflectance", "diffuse_transmittance")
_UNITS = {"theta_o": "rad", "theta_i": "rad", "dphi": "rad", "brdf": "1/sr", "btdf": "1/sr",
          **{name: "1" for name in (*_BY_ANGLE, *_DIFFUSE)}}
_CONVENTIONS = {
    "brdf, btdf": "[side, theta_o, theta_i, dphi, channel]; radiance out per irradiance in, without the mirror "
                  "image and without unscattered light, which are deltas; no cosine is multiplied in",
    "side": "where light enters: top, and bottom for a sheet; theta is measured from the normal there, and "
            "theta_o of btdf from the normal of the other side",
    "dphi": "azimuth of travel out minus azimuth of travel in: 0 is forward, the mirror direction; values are even "
            "in dphi",
    "reflectance, transmittance": "[side, theta_i, channel]; share of the flux of a beam that leaves as light "
                                  "without deltas; the deltas' shares are mirror_reflectance and "
                                  "unscattered_transmittance, and the directional albedo is the sum of all four",
    "diffuse_reflectance, diffuse_transmittance": "[side, channel]; for uniform diffuse light, deltas included",
    "channel": "as in the stack; three are red, green and blue (linear sRGB)",
}


def default_angles() -> np.ndarray:
    """theta_o and theta_i in radians, shape (46,): 0 to 88 degrees in steps of 2, and 89.5."""
    return np.radians(np.append(np.arange(0.0, 89.0, 2.0), 89.5))


def default_azimuths() -> np.ndarray:
    """dphi in radians, shape (37,): 0 to 180 degrees in steps of 5."""
    return np.radians(np.arange(0.0, 181.0, 5.0))


@dataclass(frozen=True, eq=False)
class Export:
    """The contents of an archive. `header`: a JSON object with format, schema, stack, stack_hash, sides, channels,
    units, conventions and solver. `arrays`: axes, kernels and fluxes by the names in `header["units"]`; a stack on a
    base has no btdf."""

    header: dict
    arrays: dict[str, np.ndarray]

    def __getitem__(self, name: str) -> np.ndarray:
        return self.arrays[name]


def tabulate(solved: ScatteringFunction, theta_o=None, theta_i=None, dphi=None,
             progress: Callable[[float, str], object] | None = None) -> Export:
    """The scattering function on a product grid of angles in radians: thetas in [0, pi/2), dphi any.

    For a glossy stack, the axes must be fine enough for its peak. Raises ArgumentError, a ValueError, and StackError
    for a sheet that does not end in air."""
    check_kind(solved, "solved", ScatteringFunction, "what lamina.solve returns")
    check_callable(progress, "progress")
    axes = {"theta_o": _thetas(theta_o, "theta_o"), "theta_i": _thetas(theta_i, "theta_i"),
            "dphi": _angles(default_azimuths() if dphi is None else dphi, "dphi")}
    solved.stack.require_isotropic("an export")
    solved.stack.require_air_below()
    sheet = solved.stack.base is None
    sides = ["top", "bottom"] if sheet else ["top"]
    mu_o, mu_i = np.cos(axes["theta_o"]), np.cos(axes["theta_i"])
    paths = [("brdf", "reflect"), ("btdf", "transmit")] if sheet else [("brdf", "reflect")]
    arrays = dict(axes)
    done = 0
    for name, path in paths:
        kernels = []
        for side in sides:
            if progress is not None:
                progress(done / (len(paths) * len(sides)), f"{name} from the {side}")
            kernels.append(solved.grid(path, mu_o, mu_i, axes["dphi"], side))
            done += 1
        arrays[name] = np.array(kernels, np.float32)
    fluxes = [(*solved.reflectance(mu_i, side, parts=True), *solved.transmittance(mu_i, side, parts=True))
              for side in sides]
    arrays.update(zip(_BY_ANGLE, map(np.array, zip(*fluxes, strict=True)), strict=True))
    arrays["diffuse_reflectance"] = np.array([solved.reflectance("diffuse", side) for side in sides])
    arrays["diffuse_transmittance"] = np.array([solved.transmittance("diffuse", side) for side in sides])
    header = {
        "format": FORMAT, "schema": SCHEMA, "stack": solved.stack.to_json(), "stack_hash": solved.stack.hash,
        "sides": sides, "channels": solved.stack.channels, "conventions": _CONVENTIONS,
        "units": {name: _UNITS[name] for name in arrays},
        "solver": {"nodes": solved.nodes, "orders": solved.orders, "checks": solved.checks},
    }
    return Export(header, arrays)


def save_npz(solved: ScatteringFunction | AnyStack, path: str | os.PathLike, theta_o=None, theta_i=None, dphi=None,
             progress: Callable[[float, str], object] | None = None) -> None:
    """Writes the result of tabulate as .npz, completely or not at all: no pickle, the header as bytes of JSON. A
    stack, also the id of a preset or the path of a JSON file, is solved first at quality "final". Raises ValueError,
    SolveError and OSError."""
    if not isinstance(solved, ScatteringFunction):
        as_stack(solved).require_isotropic("an export")
        solved = solve(solved)
    export = tabulate(solved, theta_o, theta_i, dphi, progress)
    save_archive(path, export.header, **export.arrays)


def load_npz(path: str | os.PathLike) -> Export:
    """Reads a file that save_npz wrote. Raises ExportError for a file that is truncated, foreign, or of a newer schema,
    and OSError when it cannot be opened."""
    try:
        header, _ = load_archive(path)
        if not isinstance(header, dict) or header.get("format") != FORMAT:
            raise Damaged("its header names another format")
        schema = header.get("schema")
        if isinstance(schema, int) and schema > SCHEMA:
            raise ExportError(f"{path}: schema {schema} needs a newer Lamina, which reads up to {SCHEMA}")
        names = _names(header.get("sides"))
        _, arrays = load_archive(path, *names)
    except Damaged as error:
        raise ExportError(f"{path}: not a complete scattering function exported by Lamina: {error}") from None
    export = Export(header, dict(zip(names, arrays, strict=True)))
    problem = _problem(export)
    if problem:
        raise ExportError(f"{path}: {problem}")
    return export


def _thetas(values, name: str) -> np.ndarray:
    array = _angles(default_angles() if values is None else values, name)
    bad = ~((array >= 0.0) & (array < 0.5 * math.pi))
    if bad.any():
        raise ArgumentError(f"{name} = {array[bad][0]:g}: must lie in [0, pi/2)")
    return array


def _angles(values, name: str) -> np.ndarray:
    try:
        array = finite_list(values, name)
    except ArgumentError:
        array = np.array([])
    if not len(array):
        raise ArgumentError(f"{name}: must be a list of finite angles in radians")
    return array


def _names(sides) -> list[str]:
    """The arrays of an archive with these sides."""
    if sides not in (["top"], ["top", "bottom"]):
        raise Damaged("its header names no sides")
    return [*_AXES, *_KERNELS[:len(sides)], *_BY_ANGLE, *_DIFFUSE]


def _problem(export: Export) -> str:
    """The first problem of an archive, in words, or ''."""
    header, arrays = export.header, export.arrays
    if not all(key in header for key in ("stack", "stack_hash", "channels", "units", "conventions", "solver")):
        return "the header is incomplete"
    sides, channels = len(header["sides"]), header["channels"]
    lengths = tuple(arrays[name].size for name in _AXES)
    shapes = {name: (sides, *lengths, channels) for name in _KERNELS}
    shapes.update({name: (sides, lengths[1], channels) for name in _BY_ANGLE})
    shapes.update({name: (sides, channels) for name in _DIFFUSE})
    shapes.update({name: (length,) for name, length in zip(_AXES, lengths, strict=True)})
    for name, array in arrays.items():
        if array.shape != shapes[name]:
            return f"{name} has the shape {array.shape}: the header and the axes say {shapes[name]}"
        if array.dtype.kind != "f" or not np.all(np.isfinite(array)):
            return f"{name} holds values that are not finite numbers"
        if name not in _AXES and array.min(initial=0.0) < 0.0:
            return f"{name} holds negative values"
    return ""
