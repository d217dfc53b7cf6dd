# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes of light that comes through a sheet: Cycles' Hair BSDF on a mesh, component Transmission.

The lobe is a product of two Lorentzians about a tangent T: one in the elevation from the plane perpendicular to T, one
in the azimuth about T. With T in the plane of incidence and perpendicular to the viewer, azimuth 0 is the direction
straight through, -I, and the elevation turns this direction in the plane of incidence. The socket Offset moves the
centre of the elevation, so the lobe leans from -I towards the normal of the far side, -N.
"""
from __future__ import annotations

import numpy as np

from ..common.arguments import check_field
from ..kinds.fields import Field
from .lobe import Geometry, Lobe, NodeRecipe, number

RANGES = (Field("along", 0.0, 1.0, above=True), Field("across", 0.0, 1.0, above=True), Field("lean", 0.0, 1.0))


def through(along: float, across: float, lean: float = 0.0) -> Lobe:
    """Hair BSDF, component Transmission, about the direction that lies the share `lean` of the view angle away from
    -I, towards -N: 0 is straight through, 1 along the normal.

    Its widths are 2 `along` in the plane of incidence and `across` out of it; `along` and `across` lie in (0, 1], to
    which Cycles clamps them, and `lean` in [0, 1]. Raises ArgumentError."""
    along, across, lean = (check_field(*one) for one in zip((along, across, lean), RANGES, strict=True))

    def evaluate(mu_o, mu_i, dphi):
        g = Geometry(mu_o, mu_i, dphi, below=True)
        return _lorentzian(g.mu_o, g.sin_o, g.light_x, g.light_y, g.light_z, along, across, lean)

    def strayed(mu_o, mu_i, dphi):
        g = Geometry(mu_o, mu_i, dphi)
        ahead = g.cos_between < 0.0  # azimuths about T up to a right angle
        return ahead * _lorentzian(g.mu_o, g.sin_o, g.light_x, g.light_y, g.light_z, along, across, lean)

    node = NodeRecipe(
        "ShaderNodeBsdfHair", inputs={"Offset": 0.0, "RoughnessU": along, "RoughnessV": across},
        enums={"component": "Transmission"}, normal_input="", vectors={"Tangent": "T"},
        view_angles={"Offset": 0.5 * lean} if lean else {},
    )
    name = f"through_{number(along)}_{number(across)}" + (f"_lean{number(lean)}" if lean else "")
    return Lobe(name, "transmission", evaluate, node, narrow=True, strayed=strayed)


def _lorentzian(mu_o, sin_o, x, y, z, along, across, lean):
    """Density of the light (x, y, z), by its elevation and azimuth about the tangent (-mu_o, 0, sin_o).

    Cycles samples elevations up to a right angle and azimuths up to a right angle, over which the integral is 1. It
    evaluates the same tails at azimuths further round."""
    sine = np.clip(-mu_o * x + sin_o * z, -1.0, 1.0)
    elevation = np.arcsin(sine)
    cosine = np.maximum(np.cos(elevation), 1e-6)
    turn = np.arctan2(y, -(sin_o * x + mu_o * z))  # azimuth from straight through
    centre = -0.5 * lean * np.arccos(np.clip(mu_o, -1.0, 1.0))  # half the elevation of the lobe's middle
    whole = np.arctan((np.pi / 4 - centre) / along) - np.arctan((-np.pi / 4 - centre) / along)
    elevation_density = along / (2.0 * whole * ((0.5 * elevation - centre) ** 2 + along**2) * cosine)
    azimuth_density = across / (2.0 * np.arctan(np.pi / 2 / across) * (turn**2 + across**2))
    return elevation_density * azimuth_density
