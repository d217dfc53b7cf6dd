# SPDX-License-Identifier: GPL-3.0-or-later
"""A ball of a table's material under a small studio: a lamp, a sky, and a floor.

The ball is seen from far away, along -z, with y up. A point of the ball is given by the view angle there and by its
azimuth on the picture, so a row of the ball is a column of the table."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ...closures.axes import column_angles
from ...common.srgb import linear, srgb

COLUMNS = range(0, 64, 4)  # of the table, one for each row of the ball
AROUND = 32  # azimuths of a row, the first on the right, then anticlockwise
# The studio: the lamp's direction and half width, the radiance of lamp, zenith, horizon and floor.
LAMP, LAMP_WIDTH = np.array([-0.45, 0.62, 0.64]), math.radians(18.0)
BRIGHT, ZENITH, HORIZON, FLOOR = 4.0, 0.72, 0.44, 0.1  # a white Lambert surface stays below 1
# Directions of light: rings about the mirror direction, each _RATIO times wider than the one before, up to _WIDEST.
_NARROWEST, _RATIO, _WIDEST, _SPOKES = 0.004, 1.35, 0.12, 30


def lit_ball(spread: Callable, transmitted: np.ndarray, turns: bool) -> str:
    """Colors without specular reflection, in sRGB as bytes in hexadecimal digits: [row][azimuth][channel].

    `spread(column, mu_i, dphi, phi_o)`: the fitted function times mu_i, (n, 3), for n pairs of directions.
    `transmitted`: [row][channel], shares of transmission. `turns`: the function depends on phi_o, the azimuth of the
    view from the tangent, which runs around the ball horizontally."""
    angles = column_angles()[list(COLUMNS)]
    lights, sizes = _lights(angles)
    row, cell = np.nonzero(lights[..., 2] > 1e-4)
    directions, columns = lights[row, cell], np.array(COLUMNS)[row]
    mu_i, dphi = directions[:, 2], np.arctan2(directions[:, 1], -directions[:, 0])
    sizes = sizes[cell][:, None]
    seen = None if turns else sizes * spread(columns, mu_i, dphi, 0.0)
    colors = np.tile(HORIZON * transmitted[:, None], (1, AROUND, 1))
    for place, azimuth in enumerate(2.0 * math.pi * np.arange(AROUND) / AROUND):
        frame = _frame(angles, azimuth)
        now = sizes * spread(columns, mu_i, dphi, _from_tangent(frame)[row]) if seen is None else seen
        light = now * radiance(np.einsum("nk,nkx->nx", directions, frame[row]))[:, None]
        np.add.at(colors[:, place], row, light)
    colors[0] = colors[0].mean(axis=0)  # the middle of the ball is one point
    return np.round(255.0 * srgb(np.clip(colors, 0.0, 1.0))).astype(np.uint8).tobytes().hex()


def colors_at(digits: str, mirrored: np.ndarray, angle: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    """Linear colors at points of the ball, (..., 3), by their view angles and azimuths. `digits`: of lit_ball;
    `mirrored`: [row][channel], shares of specular reflection. Raises ValueError."""
    ball = linear(np.frombuffer(bytes.fromhex(digits), np.uint8).reshape(len(COLUMNS), AROUND, 3) / 255.0)
    rows = np.interp(angle, column_angles()[list(COLUMNS)], np.arange(len(COLUMNS)))
    row, place = np.minimum(rows.astype(int), len(ball) - 2), azimuth / (2.0 * math.pi) * AROUND
    left = np.floor(place).astype(int)
    down, across = (rows - row)[..., None], (place - left)[..., None]
    left, right = left % AROUND, (left + 1) % AROUND
    upper = ball[row, left] * (1.0 - across) + ball[row, right] * across
    lower = ball[row + 1, left] * (1.0 - across) + ball[row + 1, right] * across
    normal = np.stack([np.sin(angle) * np.cos(azimuth), np.sin(angle) * np.sin(azimuth), np.cos(angle)], axis=-1)
    mirror = 2.0 * normal[..., 2:] * normal - [0.0, 0.0, 1.0]
    share = np.asarray(mirrored)[row] * (1.0 - down) + np.asarray(mirrored)[row + 1] * down
    return upper * (1.0 - down) + lower * down + share * radiance(mirror)[..., None]


def radiance(directions: np.ndarray) -> np.ndarray:
    """Of the studio, from unit directions (..., 3)."""
    up = directions[..., 1]
    sky = HORIZON + (ZENITH - HORIZON) * np.clip(up, 0.0, 1.0)
    above = _smooth(up, -0.06, 0.06)
    lamp = _smooth(directions @ (LAMP / np.linalg.norm(LAMP)), math.cos(LAMP_WIDTH), math.cos(0.7 * LAMP_WIDTH))
    return FLOOR + (sky - FLOOR) * above + BRIGHT * lamp


def _smooth(values: np.ndarray, low: float, high: float) -> np.ndarray:
    share = np.clip((values - low) / (high - low), 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


def _lights(angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(directions, solid angles) of cells of the sphere, (rows, cells, 3) and (cells,), about the mirror direction of
    each view angle. The normal is z, and the viewer has the azimuth 0."""
    radii = [0.0, _NARROWEST]
    while radii[-1] < math.pi:
        radii.append(min(radii[-1] + min((_RATIO - 1.0) * radii[-1], _WIDEST), math.pi))
    edges = np.array(radii)
    away, spoke = np.meshgrid(0.5 * (edges[1:] + edges[:-1]), 2.0 * math.pi * (np.arange(_SPOKES) + 0.5) / _SPOKES,
                              indexing="ij")
    sizes = np.repeat((np.cos(edges[:-1]) - np.cos(edges[1:])) * 2.0 * math.pi / _SPOKES, _SPOKES)
    x, y, z = (np.sin(away) * np.cos(spoke)).ravel(), (np.sin(away) * np.sin(spoke)).ravel(), np.cos(away).ravel()
    sine, cosine = np.sin(angles)[:, None], np.cos(angles)[:, None]
    across = np.broadcast_to(y, (len(angles), len(y)))
    return np.stack([x * cosine - z * sine, across, x * sine + z * cosine], axis=2), sizes


def _frame(angles: np.ndarray, azimuth: float) -> np.ndarray:
    """(rows, 3, 3): the unit vectors towards the viewer along the surface, across it, and along the normal, at points
    of the ball."""
    sine, cosine, zero = np.sin(angles), np.cos(angles), np.zeros(len(angles))
    c, s = math.cos(azimuth), math.sin(azimuth)
    normal = np.stack([sine * c, sine * s, cosine], axis=1)
    towards = np.stack([-cosine * c, -cosine * s, sine], axis=1)
    across = np.stack([zero + s, zero - c, zero], axis=1)
    return np.stack([towards, across, normal], axis=1)


def _from_tangent(frame: np.ndarray) -> np.ndarray:
    """(rows,): the azimuth of the viewer from the horizontal tangent y x N."""
    towards, _, normal = frame.transpose(1, 0, 2)
    tangent = np.cross([0.0, 1.0, 0.0], normal)
    across = np.cross(normal, tangent)
    return np.arctan2(np.sum(towards * across, axis=1), np.sum(towards * tangent, axis=1))
