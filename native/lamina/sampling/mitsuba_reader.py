# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a table for renderers in a variant of Mitsuba, with numbers or with Dr.Jit's arrays."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np

from ..common.errors import ArgumentError
from ..common.observer import rec709
from .facet_densities import summed
from .render_table import RenderTable, lagrange

QUARTER = 0.5 * math.pi


class Reader:
    """Values, densities and directions of `table`. `mi` and `dr`: the modules mitsuba and drjit. Directions are those
    of Mitsuba's local frame, where the surface's top has z > 0."""

    def __init__(self, table: RenderTable, mi: Any, dr: Any):
        self._table, self._mi, self._dr = table, mi, dr
        self._sheet = len(table.sights) > 1
        self._is_array = bool(dr.is_jit_v(mi.Float))
        colours = functools.partial(_colours, table.wavelengths, mi)
        self._channels = colours(table.mirrored).shape[-1]
        self._wavelengths = sorted(table.wavelengths or ()) if mi.is_spectral and self._channels > 1 else None
        self._smooth = self._array(colours(table.smooth))
        self._facets = self._array(colours(table.facets)) if any(table.densities) else None
        beyond = table.mirrored[:, :, 1:2]  # the knot beyond the normal
        self._mirrored = self._array(colours(np.concatenate([beyond, table.mirrored], axis=2)))
        self._chances = self._array(table.chance)
        density, parameters = table.density, [table.theta_views.tolist()]
        if table.rows > 1:
            parameters.insert(0, [float(k) for k in range(table.rows)])
        else:
            density = density[:, 0]
        if self._sheet:
            parameters.insert(0, [float(k) for k in range(len(table.sights))])
        else:
            density = density[0]
        kind = (mi.MarginalContinuous2D1, mi.MarginalContinuous2D2, mi.MarginalContinuous2D3)[len(parameters) - 1]
        self._marginal = kind(np.ascontiguousarray(density, np.float32), parameters)
        self._parameter = (mi.Vector1f, mi.Vector2f, mi.Vector3f)[len(parameters) - 1]

    def row(self, tau):
        """The row of a thickness, 0 where nothing varies."""
        return self._table.row_of(tau, self._dr) if self._table.rows > 1 else None

    def values(self, wi, wo, row, wavelengths, active):
        """The function in 1/sr."""
        mi, dr = self._mi, self._dr
        mu_o, mu_i = dr.abs(wi.z), dr.abs(wo.z)
        square_o, square_i = wi.x * wi.x + wi.y * wi.y, wo.x * wo.x + wo.y * wo.y
        across = dr.square(wi.x + wo.x) + dr.square(wi.y + wo.y)
        dphi = dr.abs(dr.atan2(wo.y * wi.x - wo.x * wi.y, -(wo.x * wi.x + wo.y * wi.y)))
        _, _, rows, columns, turns, _ = self._table.smooth.shape
        places = [self._stencil(dr.atan2(dr.sqrt(square_o), mu_o) * ((rows - 2) / QUARTER), rows),
                  self._stencil(dr.atan2(dr.sqrt(square_i), mu_i) * ((columns - 2) / QUARTER), columns),
                  self._stencil(dr.asin(dr.minimum(dr.sqrt(dphi * (1.0 / math.pi)), 1.0)) * ((turns - 3) / QUARTER),
                                turns)]
        sight = self._sight(wi, wi.z * wo.z < 0.0)
        steps = [columns * turns, turns, 1]
        base = self._start(sight, row, rows * steps[0], places, steps)
        smooth = self._sum(self._smooth, base, places, steps, wavelengths, active)
        value = smooth * dr.rcp(dr.maximum(mu_o + mu_i, 1e-6))
        if self._facets is not None:
            around = mi.Float(0.0)
            for number, densities in enumerate(self._table.densities):
                if densities:
                    around = dr.select(sight == number, summed(densities, square_o, square_i, across, dr), around)
            value = value + self._sum(self._facets, base, places, steps, wavelengths, active) * around
        return dr.select(active & self._seen(wi, wo), dr.maximum(value, 0.0), 0.0)

    def specular(self, path: int, wi, row, wavelengths, active):
        """The light of a mirror image, or unscattered light."""
        knots = self._table.mirrored.shape[2] + 1
        places, steps = [self._stencil(self._theta(wi) * ((knots - 2) / QUARTER), knots)], [1]
        base = self._start(self._sight(wi, path == 1), row, knots, places, steps)
        return self._dr.maximum(self._sum(self._mirrored, base, places, steps, wavelengths, active), 0.0)

    def chance(self, path: int, specular: int, wi, row):
        """The share of one part in all light towards a view, linear between the table's views and rows."""
        mi, dr = self._mi, self._dr
        views, rows = len(self._table.theta_views), self._table.rows
        far = float(self._table.theta_views[-1])
        place = (1.0 - dr.sqrt(dr.maximum(1.0 - self._theta(wi) * (1.0 / far), 0.0))) * (views - 1)
        first = dr.minimum(mi.Int32(place), views - 2)
        upper = 0 if row is None else dr.minimum(mi.Int32(row), rows - 2)
        at = ((self._sight(wi, path == 1) * rows + upper) * views + first) * 2 + specular

        def between(at):
            low, high = (self._one(self._chances, at + step) for step in (0, 2))
            return dr.lerp(low, high, place - mi.Float(first))
        return between(at) if row is None else dr.lerp(between(at), between(at + 2 * views), row - mi.Float(upper))

    def drawn(self, path: int, wi, row, sample2, active):
        """(a direction of light, where it lies on the wanted side)."""
        mi, dr = self._mi, self._dr
        view = mi.Vector3f(wi.x, wi.y, dr.abs(wi.z))
        place, _ = self._marginal.sample(sample2, self._parameters(path, wi, row), active)
        theta = dr.square(place.x) * QUARTER
        phi = (2.0 * place.y - 1.0) * math.pi + dr.atan2(wi.y, wi.x)
        sine = dr.sin(theta)
        normal = mi.Vector3f(dr.cos(phi) * sine, dr.sin(phi) * sine, dr.cos(theta))
        cosine = dr.dot(view, normal)
        light = normal * (2.0 * cosine) - view
        side = dr.select((wi.z > 0.0) == (path == 0), 1.0, -1.0)
        return mi.Vector3f(light.x, light.y, light.z * side), (light.z > 0.0) & (cosine > 0.0) & active

    def density(self, path: int, wi, wo, row, active):
        """Probability per solid angle of light on one side."""
        mi, dr = self._mi, self._dr
        view = mi.Vector3f(wi.x, wi.y, dr.abs(wi.z))
        normal = dr.normalize(view + mi.Vector3f(wo.x, wo.y, dr.abs(wo.z)))
        theta = dr.atan2(dr.sqrt(dr.square(normal.x) + dr.square(normal.y)), normal.z)
        u = dr.sqrt(theta * (1.0 / QUARTER))
        turn = (dr.atan2(normal.y, normal.x) - dr.atan2(wi.y, wi.x)) * (0.5 / math.pi) + 0.5
        v = turn - dr.floor(turn)
        size = dr.maximum(2.0 * math.pi**2 * u * dr.sin(theta), 1e-6) * 4.0 * dr.dot(view, normal)
        found = self._marginal.eval(mi.Point2f(u, v), self._parameters(path, wi, row), active)
        return dr.select(active, found * dr.rcp(dr.maximum(size, 1e-12)), 0.0)

    def _parameters(self, path: int, wi, row):
        found = [] if row is None else [row]
        if self._sheet:
            found.insert(0, self._mi.Float(self._sight(wi, path == 1)))
        return self._parameter(*found, self._theta(wi))

    def _start(self, sight, row, size: int, places: list, steps: list):
        """The first knot of all stencils, in a table whose rows have `size` knots; adds that of the row to them."""
        base = sight * (self._table.rows * size)
        if row is not None:
            mi, dr = self._mi, self._dr
            first = dr.clip(mi.Int32(dr.floor(row)) - 1, 0, self._table.rows - 4)
            places.insert(0, (first, lagrange(row - mi.Float(first))))
            steps.insert(0, size)
        return base + sum((first * step for (first, _), step in zip(places, steps, strict=True)), 0)

    def _sight(self, wi, transmitted):
        """The number of the table's sight."""
        if not self._sheet:
            return self._mi.Int32(0)
        side = self._dr.select(wi.z > 0.0, self._mi.Int32(0), self._mi.Int32(2))
        return side + self._dr.select(transmitted, self._mi.Int32(1), self._mi.Int32(0))

    def _seen(self, wi, wo):
        return (wi.z * wo.z != 0.0) if self._sheet else (wi.z > 0.0) & (wo.z > 0.0)

    def _theta(self, w):
        return self._dr.atan2(self._dr.sqrt(w.x * w.x + w.y * w.y), self._dr.abs(w.z))

    def _stencil(self, place, size: int):
        """(first knot, Lagrange's weights), as in render_table.stencil."""
        mi, dr = self._mi, self._dr
        first = dr.clip(mi.Int32(dr.floor(place)), 0, size - 4)
        return first, lagrange(place + 1.0 - mi.Float(first))

    def _sum(self, array, base, places, steps, wavelengths, active):
        """The weighted sum of the knots of all stencils, as a spectrum."""
        if not self._is_array:
            at, own = np.array([base]), np.ones(1)
            for (_, weights), step in zip(places, steps, strict=True):
                at = (at[:, None] + step * np.arange(4)).ravel()
                own = np.outer(own, weights).ravel()
            return self._mi.Spectrum(self._at_wavelengths(own @ array[at], wavelengths))
        read = self._packets(array, wavelengths, active)
        total = 0.0
        corners = [(base, 1.0)]
        for (_, weights), step in zip(places, steps, strict=True):
            corners = [(at + k * step, own * weights[k]) for at, own in corners for k in range(4)]
        for at, own in corners:
            total = total + read(at) * own
        return self._mi.Spectrum(total)

    def _packets(self, array, wavelengths, active):
        """A function that reads all channels of a knot, or the wavelengths of a ray."""
        mi, dr = self._mi, self._dr
        if self._wavelengths is None:
            kind = mi.Float if self._channels == 1 else mi.Color3f
            return lambda at: dr.gather(kind, array, mi.UInt32(at), active)
        known = self._wavelengths
        lanes = []
        for wavelength in wavelengths:
            first, share = mi.UInt32(0), mi.Float(0.0)
            for k, (low, high) in enumerate(zip(known, known[1:], strict=False)):
                inside = wavelength >= low
                first = dr.select(inside, mi.UInt32(k), first)
                share = dr.select(inside, dr.minimum((wavelength - low) * (1.0 / (high - low)), 1.0), share)
            lanes.append((first, share))
        last = self._channels - 1

        def read(at):
            start = mi.UInt32(at) * self._channels
            return mi.Spectrum([dr.lerp(dr.gather(mi.Float, array, start + first, active),
                                        dr.gather(mi.Float, array, start + dr.minimum(first + 1, last), active), share)
                                for first, share in lanes])
        return read

    def _at_wavelengths(self, total, wavelengths):
        if self._wavelengths is not None:
            return np.interp(np.array(wavelengths), self._wavelengths, total).tolist()
        return float(total[0]) if self._channels == 1 else total.tolist()

    def _array(self, values):
        flat = np.ascontiguousarray(values, np.float32)
        return self._mi.Float(flat.ravel()) if self._is_array else flat.reshape(-1, flat.shape[-1]).astype(float)

    def _one(self, array, index):
        if self._is_array:
            return self._dr.gather(self._mi.Float, array, self._mi.UInt32(index))
        return float(array.ravel()[index])


def _colours(wavelengths, mi: Any, values: np.ndarray) -> np.ndarray:
    """Values of all channels as the variant needs them: its wavelengths, red, green and blue, or luminance."""
    if values.shape[-1] == 1:
        return values
    if mi.is_spectral:
        if wavelengths is None:
            raise ArgumentError("the stack is red, green and blue: a spectral variant needs a grey one, or wavelengths")
        return values[..., np.argsort(wavelengths)]
    shown = values if wavelengths is None else rec709(values, tuple(wavelengths))
    return shown if mi.is_rgb else shown @ np.array([[0.212671], [0.715160], [0.072169]])
