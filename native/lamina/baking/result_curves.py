# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that show a lookup table at a glance: light scattered in the plane of incidence, exact and fitted, for a few
views, and the reflectance and transmittance over the view angle."""

from __future__ import annotations

import math

import numpy as np

from ..closures import lobes, narrow_lobes
from ..closures.axes import column_angles
from ..closures.closure_table import LOWEST_COSINE, view_cosines
from ..kinds.bases import PrincipledBase
from ..kinds.fields import channel
from ..kinds.table import BASE_WEIGHT, METAL, PREFIX, PRINCIPLED, THROWN_BACK, lobe_of
from ..material.stack import Stack
from ..solver.solve import ScatteringFunction, solve
from . import geometric_series
from .lut import Lut
from .shader_base import LUMINANCE, on_lambert

VIEW_COLUMNS = (0, 28, 49)  # of the table: views at exactly 0, 40 and 70 degrees
# Directions of light in degrees. They miss the tangent of each view, where a Hair closure has a pole.
LIGHTS = np.arange(-89.5, 90.0, 1.0)
ALBEDO_COLUMNS = range(0, 64, 3)
DIGITS = 4


def result_curves(stack: Stack, lut: Lut, threads: int = 0) -> dict:
    """Curves of a table that lamina.bake made of `stack`, for its top side. A varying layer has its largest thickness;
    inputs of the base have the stack's own values. Lists of numbers, rounded, so that JSON can hold them:

    `views`: view angles in degrees; the viewer is on the side of negative light angles.
    `lights`: angles of light in degrees, LIGHTS; the mirror direction of a view is its positive angle.
    `exact`, `fitted`: [view][light], luminance of f * cos(theta_i) in 1/sr, without specular light; `through_exact`,
        `through_fitted`: the same for transmitted light, whose straight continuation is the positive angle; None for
        a stack on a base.
    `mirrored`, `straight`: [view], shares of specular reflection and of unscattered transmission (luminance).
    `angles`: view angles in degrees, for `reflectance` and `transmittance`: [angle][channel], everything included.
        The transmittance is None for a stack on a base.

    A base that another shader renders is taken to be a Lambert surface of the stack's reflectance. Raises SolveError.
    """
    solver = {"quality": lut.header["quality"], "threads": threads, "nodes": lut.report["solver"]["nodes"]}
    exact = solve(on_lambert(narrow_lobes.resolved(stack)), **solver)
    table = ShownMixture(stack, lut, solver)
    directions = _cosines(LIGHTS), np.where(LIGHTS >= 0.0, 0.0, math.pi)
    mu = view_cosines()[list(VIEW_COLUMNS)]
    is_sheet = stack.base is None
    every = column_angles()[list(ALBEDO_COLUMNS)]
    cosines = np.maximum(np.cos(every), LOWEST_COSINE)
    scattered, mirrored = exact.reflectance(mu, parts=True)
    curves = {
        "views": np.degrees(column_angles()[list(VIEW_COLUMNS)]),
        "lights": LIGHTS,
        "exact": _luminance(_in_plane(exact, "reflect", mu)),
        "fitted": _luminance(table.fitted("reflection", *directions)),
        "mirrored": _luminance(mirrored),
        "angles": np.degrees(every),
        "reflectance": _rgb(exact.reflectance(cosines)),
        "through_exact": None, "through_fitted": None, "straight": np.zeros(len(mu)), "transmittance": None,
    }
    if is_sheet:
        curves |= {
            "through_exact": _luminance(_in_plane(exact, "transmit", mu)),
            "through_fitted": _luminance(table.fitted("transmission", *directions)),
            "straight": _luminance(exact.transmittance(mu, parts=True)[1]),
            "transmittance": _rgb(exact.transmittance(cosines)),
        }
    return {name: None if values is None else _rounded(values) for name, values in curves.items()}


def _in_plane(function: ScatteringFunction, path: str, mu_o: np.ndarray) -> np.ndarray:
    """f * cos(theta_i) at LIGHTS, [view, light, channel], for viewers on the top side. `path` "reflect" or
    "transmit"."""
    cosines, place = np.unique(_cosines(LIGHTS), return_inverse=True)
    side = "top" if path == "reflect" else "bottom"  # of the light
    values = function.grid(path, mu_o, cosines, [0.0, math.pi], side)
    return values[:, place, np.where(LIGHTS >= 0.0, 0, 1)] * cosines[place, None]


class ShownMixture:
    """The mixture of closures that a table's node group shows at the stack's own values, for the top side and the views
    VIEW_COLUMNS. `solver`: further arguments of lamina.solve, for a Principled base."""

    def __init__(self, stack: Stack, lut: Lut, solver: dict):
        self._base, self._solver = stack.base, solver
        rows = self._rows(lut.header["axes"], lut.weights[0].astype(float))  # [closure, column, channel]
        self._strips = dict(zip(lut.closures, rows[:, list(VIEW_COLUMNS)], strict=True))

    def fitted(self, kind: str, mu_i: np.ndarray, dphi: np.ndarray) -> np.ndarray:
        """f * cos(theta_i) of the mixture, [view, light, channel], without specular light. `kind` "reflection" or
        "transmission"; the light's cosines `mu_i` and azimuths `dphi` are (n,)."""
        found = self._layers(kind, mu_i, dphi, "")
        if any(name.startswith(METAL) for name in self._strips):
            assert isinstance(self._base, PrincipledBase)
            found = (1.0 - self._base.metallic) * found + self._base.metallic * self._layers(kind, mu_i, dphi, METAL)
        if PRINCIPLED in self._strips:
            found = found + self._strips[PRINCIPLED][:, None] * self._bare(mu_i, dphi)
        if BASE_WEIGHT in self._strips:
            told = self._color()
            weight = self._strips[BASE_WEIGHT] / (1.0 - told * self._strips[THROWN_BACK])
            found = found + (weight * told)[:, None] * mu_i[:, None] / math.pi
        return found

    def _rows(self, axes: dict, weights: np.ndarray) -> np.ndarray:
        """Weights at the largest thickness, and at the base's own roughness if roughness is an input."""
        count = max(1, axes["tau"]["count"])
        last = weights[:, count - 1::count]  # one row for each roughness
        rough = axes.get("roughness", {}).get("values", [])
        if len(rough) < 2:
            return last[:, 0]
        assert isinstance(self._base, PrincipledBase)
        place = float(np.interp(self._base.roughness, rough, np.arange(len(rough))))
        row = min(int(place), len(rough) - 2)
        share = place - row
        return (1.0 - share) * last[:, row] + share * last[:, row + 1]

    def _layers(self, kind: str, mu_i: np.ndarray, dphi: np.ndarray, prefix: str) -> np.ndarray:
        """The sum of the closures whose strips begin with `prefix`: "" or METAL."""
        mu_o = view_cosines()[list(VIEW_COLUMNS)]
        channels = next(iter(self._strips.values())).shape[-1]
        total = np.zeros((len(mu_o), len(mu_i), channels))
        for name, weight in self._strips.items():
            if name.startswith(METAL) != bool(prefix) or not lobe_of(name):
                continue
            if name == "transparent" or name.startswith("mirror:") or lobes.by_id(lobe_of(name)).side != kind:
                continue
            if name.removeprefix(prefix).startswith(PREFIX):
                weight = weight * geometric_series.gain(self._color(), self._strips[prefix + THROWN_BACK])
            shape = lobes.by_id(lobe_of(name)).evaluate(mu_o[:, None], mu_i, dphi)
            total += weight[:, None] * np.broadcast_to(shape, total.shape[:2])[..., None]
        return total

    def _bare(self, mu_i: np.ndarray, dphi: np.ndarray) -> np.ndarray:
        """The Principled base without layers."""
        bare = solve(Stack([], self._base), **self._solver)
        return bare.brdf(view_cosines()[list(VIEW_COLUMNS)][:, None], mu_i, dphi) * mu_i[:, None]

    def _color(self) -> np.ndarray:
        """The color of the base, three channels."""
        name = "color" if isinstance(self._base, PrincipledBase) else "reflectance"
        return np.array([channel(getattr(self._base, name), index) for index in range(3)])


def _cosines(light: np.ndarray) -> np.ndarray:
    return np.maximum(np.cos(np.radians(light)), LOWEST_COSINE)


def _luminance(values: np.ndarray) -> np.ndarray:
    """Of values with one or three channels along the last axis."""
    return values[..., 0] if values.shape[-1] == 1 else values @ np.array(LUMINANCE)


def _rgb(values: np.ndarray) -> np.ndarray:
    return np.broadcast_to(values, (*values.shape[:-1], 3))


def _rounded(values: np.ndarray) -> list:
    """Nested lists of numbers with a few significant digits."""
    if values.ndim > 1:
        return [_rounded(row) for row in values]
    return [float(f"{max(value, 0.0) if abs(value) < 1e-9 else value:.{DIGITS}g}") for value in values]
