# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that show a lookup table at a glance: light scattered in the plane of incidence, exact and fitted, for a few
views, and the reflectance and transmittance over the view angle."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...closures.axes import column_angles
from ...closures.closure_table import LOWEST_COSINE, view_cosines
from ...common.srgb import LUMINANCE
from ...kinds.bases import ShaderBase
from ...kinds.fields import channel
from ...kinds.table import BASE_WEIGHT, THROWN_BACK, Strip, strips_of
from ...material.stack import Stack
from ...solver.solve import ScatteringFunction, solve, solve_with_mirrors
from ..fit import geometric_series
from ..fit.fitted_function import FittedFunction
from ..fit.slices import on_lambert
from . import lit_ball

VIEW_COLUMNS = (0, 28, 49)  # of the table: views at exactly 0, 40 and 70 degrees
# Directions of light in degrees. They miss the tangent of each view, where a Hair closure has a pole.
LIGHTS = np.arange(-89.5, 90.0, 1.0)
ALBEDO_COLUMNS = range(0, 64, 3)
DIGITS = 4


def result_curves(stack: Stack, lut, threads: int = 0) -> dict:
    """Curves of a table, a Lut, that lamina.bake made of `stack`, for its top side. A varying layer has its largest
    thickness; inputs of the base have the stack's own values; anisotropic facets are seen along the tangent. Lists
    of numbers, rounded, so that JSON can hold them:

    `views`: view angles in degrees; the viewer is on the side of negative light angles.
    `lights`: angles of light in degrees, LIGHTS; the mirror direction of a view is its positive angle.
    `exact`, `fitted`: [view][light], luminance of f * cos(theta_i) in 1/sr, without specular light; `through_exact`,
        `through_fitted`: the same for transmitted light, whose straight continuation is the positive angle; None for
        a stack on a base.
    `mirrored`, `straight`: [view], shares of specular reflection and of unscattered transmission (luminance).
    `ball`, `ball_mirrored`: the picture of a ball, see lit_ball.
    `angles`: view angles in degrees, for `reflectance` and `transmittance`: [angle][channel], everything included.
        The transmittance is None for a stack on a base.

    A base that another shader renders is taken to be a Lambert surface of the stack's reflectance. Raises SolveError.
    """
    if stack.is_oriented:
        exact = solve(stack, "preview", threads)  # "final" would take longer than the bake
    else:
        exact = solve_with_mirrors(on_lambert(stack), lut.header["quality"], threads, lut.report["solver"]["nodes"])
    mu = view_cosines()[list(VIEW_COLUMNS)]
    is_sheet = stack.base is None
    every = column_angles()[list(ALBEDO_COLUMNS)]
    cosines = np.maximum(np.cos(every), LOWEST_COSINE)
    scattered, mirrored = exact.reflectance(mu, parts=True)
    curves = {
        "views": np.degrees(column_angles()[list(VIEW_COLUMNS)]),
        "lights": LIGHTS,
        "exact": _luminance(stack.seen(_in_plane(exact, "reflect", mu))),
        "fitted": _luminance(_in_plane_of_fit(lut, stack.given_base, "reflect")),
        "mirrored": _luminance(stack.seen(mirrored)),
        "angles": np.degrees(every),
        "reflectance": _rgb(stack.seen(exact.reflectance(cosines))),
        **_ball(lut, stack),
        "through_exact": None, "through_fitted": None, "straight": np.zeros(len(mu)), "transmittance": None,
    }
    if is_sheet:
        curves |= {
            "through_exact": _luminance(stack.seen(_in_plane(exact, "transmit", mu))),
            "through_fitted": _luminance(_in_plane_of_fit(lut, stack.base, "transmit")),
            "straight": _luminance(stack.seen(exact.transmittance(mu, parts=True)[1])),
            "transmittance": _rgb(stack.seen(exact.transmittance(cosines))),
        }
    return {name: values if values is None or isinstance(values, str) else _rounded(values)
            for name, values in curves.items()}


def _in_plane(function: ScatteringFunction, path: str, mu_o: np.ndarray) -> np.ndarray:
    """f * cos(theta_i) at LIGHTS, [view, light, channel], for viewers on the top side. `path` "reflect" or
    "transmit"."""
    if function.stack.is_oriented:
        cosines, dphi = _cosines(LIGHTS), np.where(LIGHTS >= 0.0, 0.0, math.pi)
        return function.brdf(mu_o[:, None], cosines, dphi) * cosines[:, None]
    cosines, place = np.unique(_cosines(LIGHTS), return_inverse=True)
    side = "top" if path == "reflect" else "bottom"  # of the light
    values = function.grid(path, mu_o, cosines, [0.0, math.pi], side)
    return values[:, place, np.where(LIGHTS >= 0.0, 0, 1)] * cosines[place, None]


def _in_plane_of_fit(lut, base, path: str) -> np.ndarray:
    """The table's mixture of closures times cos(theta_i) at LIGHTS, [view, light, 3], without specular light."""
    dphi = np.where(LIGHTS >= 0.0, 0.0, math.pi)
    return _fitted(lut, base, path)(np.array(VIEW_COLUMNS)[:, None], _cosines(LIGHTS), dphi, 0.0)


def _ball(lut, stack: Stack) -> dict:
    """The ball of lit_ball, seen from the top side."""
    mu = np.maximum(np.cos(column_angles()[list(lit_ball.COLUMNS)]), LOWEST_COSINE)
    mirrored = lut.reflectance(mu, parts=True)[1]
    transmitted = lut.transmittance(mu) if stack.base is None else np.zeros_like(mirrored)
    spread = _fitted(lut, stack.given_base, "reflect")
    return {"ball": lit_ball.lit_ball(spread, transmitted, stack.is_oriented), "ball_mirrored": mirrored}


def _fitted(lut, base, path: str) -> Callable:
    """The table's mixture of closures times mu_i, without specular light, as a function of (column of the table, mu_i,
    dphi, phi_o), which broadcast: (..., 3). A shader below counts as a Lambert surface."""
    function = FittedFunction(lut.header, lut.weights, lut.stack.given_base)
    strips = strips_of(lut.header)
    is_specular = [function.is_specular(strip.closure) for strip in strips]
    weights = np.where(np.array(is_specular)[None, :, None, None, None], 0.0, lut.weights).astype(np.float32)
    spread = replace(lut, weights=weights)
    side = "top" if path == "reflect" else "bottom"  # of the light

    def of(column: np.ndarray, mu_i: np.ndarray, dphi: np.ndarray, phi_o) -> np.ndarray:
        found = spread.evaluate(view_cosines()[column], mu_i, dphi, path, side, phi_o=phi_o) * mu_i[..., None]
        if isinstance(base, ShaderBase):
            color = np.array([channel(base.reflectance, index) for index in range(3)])
            weight, thrown_back = (lut.weights[0, strips.index(Strip(role=role)), -1, column]
                                   for role in (BASE_WEIGHT, THROWN_BACK))
            found = found + weight * geometric_series.gain(color, thrown_back) * mu_i[..., None] / math.pi
        return found

    return of


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
