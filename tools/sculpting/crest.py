# SPDX-License-Identifier: GPL-3.0-or-later
"""The crest of blades along the back, and the tail's spade."""

import numpy as np

from . import body, shells, splines

STARTS, ENDS = 40.0, 12.0  # mm without blades at the tail's tip and behind the skull


def blades():
    """Shells: blades in a row, large over the shoulders, small towards the head and the tail's tip."""
    spine = body.spine()
    made, at = [], STARTS
    while at < spine.length - ENDS:
        k = int(np.searchsorted(spine.along, at))
        half = spine.values[k, 1]
        size = _height(at / spine.length)
        up, back = spine.up[k], -spine.tangent[k]
        foot = spine.points[k] + (half - 0.18 * size - 0.6) * up
        made.append(shells.spike(foot, up + 0.45 * back, 0.55 * size * back, 1.25 * size, 0.15 * size + 0.45,
                                 flat=0.5 * size / (0.15 * size + 0.45), sides=16, rings=16, fullness=0.75))
        at += 0.80 * size + 1.2
    return made


def spade():
    """The leaf at the tail's tip."""
    spine = body.spine()
    tip, ahead, up = spine.points[0], -spine.tangent[0], spine.up[0]
    t = np.linspace(0.0, 1.0, 7)
    wide = np.array([1.2, 4.5, 8.2, 7.6, 5.2, 2.6, 0.3])
    line = tip + np.outer(26.0 * t - 3.0, ahead) + np.outer(5.0 * t * t, up)
    curve = splines.curve(line, up, np.stack([wide, np.maximum(0.22 * wide, 0.3)], axis=1), step=0.6)
    return [shells.swept(curve, 28, lambda along, angle: 1.0 + 0.10 * np.cos(2.0 * angle) ** 8 + 0.0 * along)]


def _height(along):
    """Height of a blade (mm) by its position from the tail's tip (0) to the skull (1)."""
    return float(np.interp(along, (0.0, 0.2, 0.45, 0.62, 0.72, 0.85, 1.0), (3.0, 5.0, 8.5, 13.0, 14.5, 11.0, 6.5)))
