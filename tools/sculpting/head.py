# SPDX-License-Identifier: GPL-3.0-or-later
"""The head, in its own frame: x forward, y left, z up, the joint with the neck near the origin (mm)."""

import numpy as np

from . import distance, shells, splines

ORIGIN = np.array((52.0, -6.0, 214.0))
YAW, PITCH, JAW = np.radians(-24.0), np.radians(-10.0), np.radians(30.0)
SIZE = 1.14  # final factor on all lengths here
HINGE = np.array((1.0, 0.0, -5.5))

# x, half width, top, bottom.
SKULL = (
    (-16, 3.0, 5.0, -4.0), (-13, 7.5, 8.5, -7.0), (-8, 10.0, 11.0, -8.5), (0, 12.6, 13.6, -7.0), (7, 12.8, 15.0, -4.0),
    (13, 11.2, 14.2, -2.0), (19, 8.8, 11.2, -0.8), (26, 7.4, 9.4, -0.6), (34, 6.8, 8.8, -1.0), (41, 6.9, 9.4, -1.2),
    (47, 6.2, 8.6, -2.2), (51, 4.4, 6.2, -3.6), (53.5, 2.0, 3.4, -3.6),
)
# In the jaw's frame, x from the hinge forward.
LOWER = (
    (-5, 5.0, 3.0, -4.0), (0, 9.0, 4.0, -5.5), (8, 9.4, 1.4, -5.6), (16, 7.6, 0.0, -5.0), (26, 6.2, -0.6, -4.8),
    (36, 5.6, -0.6, -5.2), (42, 4.6, 0.2, -5.6), (46, 2.6, 0.4, -4.2), (47.5, 1.2, -0.4, -3.0),
)
EYE, EYE_RADIUS = np.array((12.5, 8.6, 9.6)), 3.5


def _frame(yaw, pitch):
    forward = np.array([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), np.sin(pitch)])
    left = np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    return np.stack([forward, left, np.cross(forward, left)])


FRAME = _frame(YAW, PITCH)
JAW_FRAME = _frame(0.0, -JAW) @ FRAME


def place(points):
    """From the head's frame to the dragon's."""
    return np.asarray(points, float) @ FRAME + ORIGIN


def place_jaw(points):
    """From the lower jaw's frame to the dragon's."""
    return np.asarray(points, float) @ JAW_FRAME + place(HINGE)


def enlarged(points):
    """Points in the dragon's frame, at their final size."""
    return ORIGIN + SIZE * (points - ORIGIN)


def parts():
    """All bodies that are blended with the head, including a stub of the neck."""
    made = [distance.loft(FRAME, ORIGIN, SKULL, 2.5, 3.0)]
    made.append(distance.bone(place((-16, 0, 0)), place((-4, 0, 1)), 8.6, 9.6, 6.0))
    made.append(distance.loft(JAW_FRAME, place(HINGE), LOWER, 2.4, 2.6))

    def both(make):
        for side in (1.0, -1.0):
            made.append(make(np.array([1.0, side, 1.0])))

    def bone(a, b, ra, rb, blend, at=place, carve=False):
        both(lambda s: distance.bone(at(np.array(a) * s), at(np.array(b) * s), ra, rb, blend, carve))

    bone((-4, 9.6, -3.5), (4, 10.6, -4.6), 5.6, 4.6, 4.0)  # jaw muscle
    bone((4, 10.8, -3.0), (16, 9.0, 1.6), 2.4, 1.6, 2.5)  # cheek bone
    both(lambda s: distance.ball(place(EYE * s + (1.5, 1.4 * s[1], -0.4)), 4.3, 1.2, carve=True))
    bone((20.5, 6.0, 12.0), (9, 11.2, 15.6), 1.7, 2.4, 1.8)  # brow
    bone((9, 11.2, 15.6), (-3, 13.4, 18.2), 2.4, 1.0, 1.8)
    bone((19, 8.4, 6.0), (8, 12.2, 5.8), 1.2, 1.4, 1.4)  # lower lid
    bone((21, 2.2, 12.0), (38, 2.6, 9.6), 1.3, 1.1, 2.0)  # ridges of the nose
    bone((40, 4.0, 8.8), (46, 4.4, 7.4), 2.6, 2.5, 1.8)  # nostril
    both(lambda s: distance.ball(place(np.array((47.2, 6.2, 8.0)) * s), (2.2, 1.7, 1.3), 0.8, FRAME, carve=True))
    bone((14, 9.2, -0.6), (30, 6.8, -0.6), 1.5, 1.5, 1.6)  # lips
    bone((30, 6.8, -0.6), (48, 5.2, -2.0), 1.5, 1.5, 1.6)
    bone((8, 8.8, 0.4), (26, 6.0, -0.6), 1.3, 1.4, 1.6, place_jaw)
    bone((26, 6.0, -0.6), (42, 4.2, 0.2), 1.4, 1.4, 1.6, place_jaw)
    # The mouth is hollow above the tongue and below the palate.
    made.append(distance.loft(JAW_FRAME, place(HINGE), [(4, 4.6, 3.0, -2.6), (16, 5.0, 2.0, -2.8), (36, 3.8, 2.0, -3.2),
                                                        (42, 2.0, 2.0, -1.0)], 2.2, 1.2, carve=True))
    made.append(distance.loft(FRAME, ORIGIN, [(12, 5.4, 2.0, -5.0), (30, 4.4, 2.2, -5.0), (44, 3.4, 1.6, -5.0),
                                              (48, 1.6, 0.0, -5.0)], 2.2, 1.2, carve=True))
    made.append(distance.bone(place_jaw((43, 0, -4.4)), place_jaw((46, 0, -8.0)), 2.6, 1.0, 2.4))  # chin
    return made


def shells_of_head():
    """Horns, eyes, teeth, tongue, spikes: shells in the dragon's frame."""
    local = _eyes() + _horns() + _upper_teeth()
    jaw = _lower_teeth() + [_tongue()] + _chin()
    return [(place(p), q, t) for p, q, t in local] + [(place_jaw(p), q, t) for p, q, t in jaw]


def _both(shell):
    points, quads, triangles = shell
    return [shell, (splines.mirrored(points), quads[:, ::-1], triangles[:, ::-1])]


def _eyes():
    """Balls with a low ridge at the slit of the pupil."""
    line = splines.curve([EYE - (0, 0, EYE_RADIUS), EYE, EYE + (0, 0, EYE_RADIUS)], (1, 0, 0), step=0.25)
    height = (line.points[:, 2] - EYE[2]) / EYE_RADIUS
    size = EYE_RADIUS * np.sqrt(np.maximum(1.0 - height**2, 4e-3))
    ball = splines.Curve(line.points, line.tangent, line.up, line.side, line.along, np.stack([size, size], axis=1))
    return _both(shells.swept(ball, 32, _slit))


def _slit(along, angle):
    """A groove down the middle of the outer side."""
    across = np.angle(np.exp(1j * (angle - SLIT_ANGLE)))
    middle = np.sin(np.pi * along / (2.0 * EYE_RADIUS)) ** 2
    return 1.0 - 0.16 * middle * np.exp(-((across / 0.16) ** 2))


SLIT_ANGLE = np.radians(25.0)


def _horns():
    def rings(along, angle):
        return 1.0 + 0.045 * np.sin(along * 2.1 + 0.5 * np.sin(angle)) * np.exp(-along / 30.0) + 0.0 * angle

    made = _both(_horn([(-4, 7.0, 12.0), (-16, 11.0, 20.0), (-32, 15.0, 23.0), (-48, 16.5, 29.0), (-56, 15.0, 39.0)],
                       4.4, rings))
    made += _both(_horn([(-7, 10.6, 6.0), (-17, 16.0, 8.0), (-28, 19.0, 8.0), (-37, 19.5, 12.0)], 2.9, rings))
    # Frill of the cheek, brow and nose.
    for foot, ahead, bend, length, width in (
        ((-6, 11.6, -0.5), (-0.8, 0.62, -0.05), (-1, -1, 2.5), 17, 2.4),
        ((-4, 11.4, -5.5), (-0.75, 0.6, -0.3), (-1, -1, 2.5), 14, 2.2),
        ((-1, 10.6, -9.5), (-0.65, 0.5, -0.6), (-2, -1, 1.5), 11, 2.0),
        ((-1, 13.0, 17.4), (-0.75, 0.35, 0.55), (-2, 0, 1.5), 9, 1.9),
    ):
        made += _both(shells.spike(foot, ahead, bend, length, width))
    made.append(shells.spike((43, 0, 8.2), (-0.1, 0, 1.0), (-4.0, 0, 0), 9.0, 2.3, flat=1.3))
    made.append(shells.spike((36, 0, 8.2), (-0.25, 0, 1.0), (-2.5, 0, 0), 5.0, 1.7, flat=1.4))
    made.append(shells.spike((30, 0, 8.6), (-0.3, 0, 1.0), (-2.0, 0, 0), 3.8, 1.5, flat=1.4))
    return made


def _horn(points, radius, relief):
    t = np.linspace(0.0, 1.0, len(points))
    size = radius * np.maximum((1.0 - t) ** 0.8, 0.05)
    curve = splines.curve(points, (0, 0, 1), np.stack([size, size], axis=1), step=0.5)
    return shells.swept(curve, 24, relief)


def _upper_teeth():
    made = []
    for x, y, length, width in ((49, 3.4, 3.6, 0.9), (45.5, 4.7, 8.4, 1.5), (41, 5.5, 3.6, 1.0), (37, 5.7, 5.0, 1.15),
                                (33, 5.8, 4.2, 1.05), (29, 6.0, 5.4, 1.2), (25, 6.4, 3.8, 1.0), (21.5, 7.0, 3.2, 0.9)):
        lip = np.interp(x, [14, 30, 48], [-0.6, -0.6, -2.0])
        made += _both(shells.spike((x, y, lip), (0.05, 0.08, -1.0), (-0.28 * length, 0, 0), length + 1.0, width,
                                   fullness=0.7))
    return made


def _lower_teeth():
    made = []
    for x, y, length, width in ((43.5, 2.2, 3.0, 0.8), (40.5, 4.0, 7.2, 1.35), (36, 4.7, 3.2, 0.95),
                                (32, 5.2, 4.4, 1.1), (28, 5.6, 3.6, 1.0), (24, 6.1, 4.2, 1.05), (20, 6.8, 3.0, 0.9)):
        made += _both(shells.spike((x, y, -0.2), (0.08, 0.1, 1.0), (-0.25 * length, 0, 0), length + 1.0, width,
                                   fullness=0.7))
    return made


def _tongue():
    points = [(2, 0, -2.0), (14, 0, -0.2), (26, 0, 0.6), (36, 0, 2.6), (42, 0, 5.6)]
    t = np.linspace(0.0, 1.0, 5)
    wide = np.interp(t, (0, 0.5, 0.8, 1.0), (3.4, 3.6, 2.6, 0.6))
    curve = splines.curve(points, (0, 0, 1), np.stack([wide, 0.42 * wide], axis=1), step=0.8)

    def furrow(along, angle):
        return 1.0 - 0.3 * np.exp(-(((angle - np.pi / 2) / 0.35) ** 2)) + 0.0 * along

    return shells.swept(curve, 20, furrow)


def _chin():
    made = []
    for x, y, length in ((34, 3.6, 5.0), (24, 4.2, 6.0), (14, 5.4, 7.0), (4, 6.6, 8.0)):
        made += _both(shells.spike((x, y, -3.6), (-0.6, 0.45, -0.8), (-1.5, 0, 0.6), length, 1.3))
    return made
