# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of a measured base: reflections at the knots of native/core/matter/measured_reflection.hpp.

An isotropic reflection that is reciprocal, and symmetric about the plane of incidence, depends on three numbers of a
pair of directions: the angle h of the half vector with the normal, the angle d between it and either direction, and
c = |cos| of the azimuth about it (Rusinkiewicz 1998)."""

from __future__ import annotations

import itertools
import math
from functools import cache

import numpy as np

from ..kinds.measured import SHAPE, STEPS, table_of, text_of

OFFSET = 0.01
LARGEST = 0.997
# Cosines below this are raised to it: no instrument measures there, and facets diverge.
LEAST_COSINE = 0.005
PEAK = 8.0  # tilts where the peak of GGX facets has fallen to 1/4000, in units of their width
DARKEST = 1e-7  # 1/sr; a table holds logarithms


@cache
def knots() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(h, d, c, mu_o, mu_i) at all knots, each of the shape SHAPE; mu_o >= mu_i."""
    t, s, c = (np.linspace(0.0, 1.0, count) for count in SHAPE)
    h, s, c = np.meshgrid(0.5 * math.pi * (LARGEST * t)**2, s, c, indexing="ij")
    d = np.arctan2(np.cos(h), np.sin(h) * c) * (1.0 - (1.0 - s)**2)
    middle, apart = np.cos(h) * np.cos(d), np.sin(h) * np.sin(d) * c
    return h, d, c, *(np.clip(mu, LEAST_COSINE, 1.0) for mu in (middle + apart, middle - apart))


def table_from(values: np.ndarray) -> np.ndarray:
    """The logarithms that a table holds, shape (*SHAPE, channels), from values in 1/sr at the knots. Values below 1e-7
    count as 1e-7; knots with nan take the value of the nearest known ones in d, then in h."""
    *_, mu_o, mu_i = knots()
    table = np.log(np.maximum(values, DARKEST)) + np.log(mu_o + mu_i + OFFSET)[..., None]
    for axis in (1, 0):
        table = _filled(table, axis)
    return table


def text_from(table: np.ndarray) -> str:
    """The text of a base from its logarithms."""
    channels = []
    for one in np.moveaxis(table, -1, 0):
        low, high = np.float32(one.min()), np.float32(one.max())
        low, high = np.nextafter(low, np.float32(-np.inf)), np.nextafter(high, np.float32(np.inf))
        steps = np.round((one - float(low)) / (float(high) - float(low)) * STEPS)
        channels.append((float(low), float(high), steps.astype("<u2").tobytes()))
    return text_of(channels)


def table_in(text: str) -> np.ndarray:
    """The logarithms in the text of a base."""
    channels = [low + (high - low) / STEPS * np.frombuffer(steps, "<u2").reshape(SHAPE).astype(float)
                for low, high, steps in table_of(text)]
    return np.stack(channels, axis=-1)


def widened(table: np.ndarray, alpha: float, wanted: float) -> np.ndarray:
    """The table with a peak about the mirror direction `wanted` / `alpha` times as wide, and the same flux. The peak is
    what exceeds the values at a tilt of PEAK alpha: the tail beyond stays in place."""
    h, d, c, mu_o, mu_i = knots()
    factor = wanted / alpha

    def at(tilt: np.ndarray) -> np.ndarray:
        return evaluate(table, tilt.ravel(), d.ravel(), c.ravel()).reshape(table.shape)

    floor = at(np.full_like(h, PEAK * alpha))
    peak = np.maximum(at(h / factor) - floor, 0.0) / factor**2
    return np.log((np.minimum(at(h), floor) + peak) * (mu_o + mu_i + OFFSET)[..., None])


def evaluate(table: np.ndarray, h: np.ndarray, d: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Values in 1/sr, (count, channels), between the knots, by cubic polynomials of the logarithm."""
    end = np.arctan2(np.cos(h), np.sin(h) * c)
    places = (np.minimum(np.sqrt(2.0 * h / math.pi) / LARGEST, 1.0), 1.0 - np.sqrt(1.0 - np.minimum(d / end, 1.0)), c)
    firsts, weights = zip(*(_stencil(place * (count - 1), count)
                            for place, count in zip(places, SHAPE, strict=True)), strict=True)
    logarithm = np.zeros((len(h), table.shape[-1]))
    for j, k, m in itertools.product(range(4), repeat=3):
        weight = weights[0][j] * weights[1][k] * weights[2][m]
        logarithm += weight[:, None] * table[firsts[0] + j, firsts[1] + k, firsts[2] + m]
    return np.exp(logarithm) / (2.0 * np.cos(h) * np.cos(d) + OFFSET)[:, None]


def albedos(table: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """The share of a beam from each cosine that the table reflects: (count, channels)."""
    return np.array([_albedo(table, one) for one in mu])


def _albedo(table: np.ndarray, mu: float) -> np.ndarray:
    # Half vectors uniform in t^(1/2) of their angle: dense about the mirror direction, and in equal azimuths
    count, around = 160, 64
    nodes, weights = np.polynomial.legendre.leggauss(count)
    t = 0.5 * (nodes + 1.0)
    tilt, step = 0.5 * math.pi * t**3, 0.5 * weights * 1.5 * math.pi * t**2
    azimuth = math.pi * (np.arange(around) + 0.5) / around
    h, azimuth = (one.ravel() for one in np.meshgrid(tilt, azimuth, indexing="ij"))
    along = mu * np.cos(h) + math.sqrt(1.0 - mu * mu) * np.sin(h) * np.cos(azimuth)
    leaving = 2.0 * along * np.cos(h) - mu
    flux = 2.0 * np.repeat(step * math.pi / around, around) * np.sin(h) * 4.0 * along * leaving
    seen = (along > 0.0) & (leaving > 0.0)
    h, along, leaving, flux = h[seen], along[seen], leaving[seen], flux[seen]
    d = np.arccos(np.minimum(along, 1.0))
    c = np.abs(leaving - mu) / np.maximum(2.0 * np.sin(h) * np.sin(d), 1e-12)
    return flux @ evaluate(table, h, d, np.minimum(c, 1.0))


def _stencil(place: np.ndarray, count: int) -> tuple[np.ndarray, list[np.ndarray]]:
    """The first of four knots about each place, and Lagrange's weights."""
    first = np.clip(place.astype(int) - 1, 0, count - 4)
    t = place - first
    return first, [-(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0, 0.5 * t * (t - 2.0) * (t - 3.0),
                   -0.5 * t * (t - 1.0) * (t - 3.0), t * (t - 1.0) * (t - 2.0) / 6.0]


def _filled(table: np.ndarray, axis: int) -> np.ndarray:
    """Unknown values along an axis from the nearest known ones."""
    table = np.moveaxis(table, axis, 0)
    place = np.arange(len(table)).reshape(-1, *[1] * (table.ndim - 1))
    known = ~np.isnan(table)
    before = np.maximum.accumulate(np.where(known, place, -1), axis=0)
    after = np.minimum.accumulate(np.where(known, place, len(table))[::-1], axis=0)[::-1]
    nearer = np.where((before >= 0) & ((after == len(table)) | (place - before <= after - place)), before, after)
    found = np.take_along_axis(table, np.clip(nearer, 0, len(table) - 1), 0)
    return np.moveaxis(found, 0, axis)
