# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies as signed distances (negative inside, mm, exact only near the surface), and their smooth union.

Distances take points (n, 3) and return (n,). See Quilez, "Smooth minimum" and "Distance functions" (iquilezles.org).
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

FAR = 1.0e3


@dataclass(frozen=True)
class Part:
    """A body, the box (2, 3) that contains it, and the width over which it blends with the bodies before it (mm)."""

    distance: object
    box: np.ndarray
    blend: float
    carve: bool = False  # subtracted instead of added


def melt(parts, points, reach):
    """The distance to all `parts` joined in order; each is evaluated only at points nearer to its box than `reach`."""
    result = np.full(len(points), FAR)
    low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
    for part in parts:
        if np.any(part.box[1] < low) or np.any(part.box[0] > high):
            continue
        near = np.all((points > part.box[0] - reach) & (points < part.box[1] + reach), axis=1)
        if not near.any():
            continue
        here = part.distance(points[near])
        result[near] = (
            -smooth_minimum(-result[near], here, part.blend) if part.carve
            else smooth_minimum(result[near], here, part.blend)
        )
    return result


def smooth_minimum(a, b, blend):
    """min(a, b), rounded where they differ by less than `blend`."""
    h = np.maximum(blend - np.abs(a - b), 0.0) / max(blend, 1e-9)
    return np.minimum(a, b) - 0.25 * blend * h * h


def bone(a, b, ra, rb, blend=4.0, carve=False):
    """A cone with balls of radius ra and rb at its ends a and b."""
    a, b = np.asarray(a, float), np.asarray(b, float)

    def distance(points):
        axis = b - a
        t = np.clip((points - a) @ axis / max(axis @ axis, 1e-9), 0.0, 1.0)
        return np.linalg.norm(points - a - t[:, None] * axis, axis=1) - (ra + t * (rb - ra))

    r = max(ra, rb) + blend
    return Part(distance, np.array([np.minimum(a, b) - r, np.maximum(a, b) + r]), blend, carve)


def ball(centre, radii, blend=4.0, frame=None, carve=False):
    """An ellipsoid; frame: rows are its axes."""
    centre, radii = np.asarray(centre, float), np.broadcast_to(np.asarray(radii, float), 3)
    frame = np.eye(3) if frame is None else np.asarray(frame, float)

    def distance(points):
        q = (points - centre) @ frame.T
        k = np.linalg.norm(q / radii, axis=1)
        # Divide by the gradient, so that flat ellipsoids blend as wide as round ones.
        return k * (k - 1.0) / np.maximum(np.linalg.norm(q / radii**2, axis=1), 1e-6)

    r = radii.max() + blend
    return Part(distance, np.array([centre - r, centre + r]), blend, carve)


def tube(curve, blend=4.0):
    """The body swept along a curve, whose values are the half axes along `side` and `up`."""
    tree = cKDTree(curve.points)

    def distance(points):
        k = tree.query(points)[1]
        ahead = np.sum((points - curve.points[k]) * curve.tangent[k], axis=1)
        at = k + ahead / (curve.along[1] - curve.along[0])
        beyond = np.maximum(np.maximum(-at, at - (len(curve.points) - 1)), 0.0) * curve.along[1]
        q = points - curve.points[k] - ahead[:, None] * curve.tangent[k]
        u, v = np.sum(q * curve.side[k], axis=1), np.sum(q * curve.up[k], axis=1)
        where = np.clip(at, 0, len(curve.points) - 1)
        half = [np.interp(where, np.arange(len(curve.points)), column) for column in curve.values.T[:2]]
        k_radius = np.hypot(u / half[0], v / half[1])
        size = np.hypot(u, v)
        d = np.where(k_radius > 1e-6, size - size / np.maximum(k_radius, 1e-6), -np.minimum(*half))
        return np.where(beyond > 0.0, np.maximum(d, beyond), d)

    r = curve.values.max() + blend
    return Part(distance, np.array([curve.points.min(axis=0) - r, curve.points.max(axis=0) + r]), blend)


def loft(frame, origin, stations, power=2.6, blend=2.0, carve=False):
    """A body given by its outlines from above and from the side; stations: rows (x, half width, top, bottom).

    The frame has the rows forward, left, up, and its origin at `origin`. power: 2 is elliptic, more is squarer."""
    frame, origin, table = np.asarray(frame, float), np.asarray(origin, float), np.asarray(stations, float)

    def distance(points):
        q = (points - origin) @ frame.T
        x = np.clip(q[:, 0], table[0, 0], table[-1, 0])
        width, top, bottom = (np.interp(x, table[:, 0], column) for column in table.T[1:])
        middle, height = 0.5 * (top + bottom), 0.5 * (top - bottom)
        y, z = np.abs(q[:, 1]), q[:, 2] - middle
        k = ((y / width) ** power + (np.abs(z) / height) ** power) ** (1.0 / power)
        size = np.hypot(y, z)
        d = np.where(k > 1e-6, size - size / np.maximum(k, 1e-6), -np.minimum(width, height))
        beyond = np.abs(q[:, 0] - x)
        return np.where(beyond > 0.0, np.hypot(np.maximum(d, 0.0), beyond), d)

    low = np.array([table[0, 0], -table[:, 1].max(), table[:, 3].min()])
    high = np.array([table[-1, 0], table[:, 1].max(), table[:, 2].max()])
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    corners = corners @ frame + origin
    return Part(distance, np.array([corners.min(axis=0) - blend, corners.max(axis=0) + blend]), blend, carve)
