# SPDX-License-Identifier: GPL-3.0-or-later
"""Trunk, neck and tail along one spine, and the four legs: their curves and their thickness (mm).

The dragon sits, looking along +x with z up; its left is +y. The tail lies around its right side.
"""

from dataclasses import dataclass

import numpy as np

from . import distance, shells, splines

# From the tail's tip to the skull: x, y, z, half width, half height, and the direction of the back.
SPINE = np.array([
    (70, -20, 20, 1.3, 1.3, 0.0, 0, 1.0),
    (72, -42, 11, 2.3, 2.3, 0.1, 0, 1.0),
    (50, -66, 5.0, 3.6, 3.6, 0.0, 0, 1.0),
    (8, -78, 5.8, 5.0, 5.2, 0.0, 0, 1.0),
    (-36, -74, 7.5, 6.8, 7.0, 0.0, 0, 1.0),
    (-70, -52, 10, 9.0, 9.4, 0.0, 0, 1.0),
    (-84, -18, 13.5, 11.5, 12.0, 0.0, 0, 1.0),
    (-72, 4, 22, 15.0, 15.5, -0.4, 0, 0.9),
    (-48, 0, 42, 19.0, 20.0, -0.65, 0, 0.75),
    (-20, 0, 66, 19.5, 22.0, -0.7, 0, 0.7),
    (8, 0, 89, 21.0, 25.0, -0.7, 0, 0.7),
    (28, 0, 109, 18.0, 22.0, -0.75, 0, 0.65),
    (42, 0, 131, 12.8, 15.0, -0.97, 0, 0.1),
    (43, 0, 153, 10.5, 12.0, -0.95, 0, -0.25),
    (32, 0, 173, 9.6, 11.0, -0.92, 0, -0.4),
    (27, 0, 192, 9.4, 10.6, -1.0, 0, 0.15),
    (36, -1, 209, 9.4, 10.4, -0.6, 0, 0.8),
    (54, -6, 215, 9.6, 10.0, -0.1, 0, 1.0),
])


@dataclass(frozen=True)
class Leg:
    """Joints of a leg from the hip down (n, 3), their radii, and the foot's toes as polylines (3, 3)."""

    joints: np.ndarray
    radii: tuple
    toes: tuple


def spine():
    """The curve of the spine; its values are the half axes."""
    return splines.curve(SPINE[:, :3], SPINE[:, 5:8], SPINE[:, 3:5])


def legs():
    """The four legs; the right forepaw steps ahead."""
    fore = ((18, 19, 92), (0, 30, 60), (19, 28, 24), (25, 28, 9))
    stepping = ((18, -19, 92), (6, -31, 60), (31, -31, 25), (38, -31, 9))
    hind = ((-40, 21, 46), (0, 40, 40), (-36, 44, 14), (-4, 46, 7))
    found = []
    for joints in (fore, stepping):
        found.append(Leg(np.array(joints, float), (13.5, 9.4, 6.2, 6.8), _toes(joints[-1], 1.0)))
    for side in (1.0, -1.0):
        joints = np.array(hind, float) * (1.0, side, 1.0)
        found.append(Leg(joints, (20.0, 12.5, 7.4, 6.8), _toes(joints[-1], 1.12)))
    return found


def parts():
    """All bodies that are blended with the trunk, in this order."""
    made = [distance.tube(spine(), blend=5.0)]
    for side in (1.0, -1.0):
        y = np.array([1.0, side, 1.0])
        # Breast, shoulder blade and loin under the skin.
        made.append(distance.ball(np.array((30, 9, 94)) * y, (12, 9, 17), 7.0))
        made.append(distance.bone(np.array((-6, 13, 106)) * y, np.array((16, 17, 96)) * y, 7.0, 11.0, 8.0))
        made.append(distance.ball(np.array((-38, 14, 52)) * y, (20, 13, 18), 8.0))
    for k, leg in enumerate(legs()):
        blends = (9.0, 7.0, 5.0) if k < 2 else (10.0, 8.0, 5.0)
        for j in range(3):
            made.append(distance.bone(leg.joints[j], leg.joints[j + 1], leg.radii[j], leg.radii[j + 1], blends[j]))
        if k < 2:  # forearm muscle, elbow
            a, b = leg.joints[1], leg.joints[2]
            made.append(distance.bone(a + 0.1 * (b - a) + (2, 0, 0), a + 0.45 * (b - a) + (2, 0, 0), 8.6, 7.2, 6.0))
            made.append(distance.bone(a + (-4, 0, 2), a + (-8, 0, 5), 4.5, 2.5, 5.0))
        else:  # calf and heel
            a, b = leg.joints[1], leg.joints[2]
            made.append(distance.bone(a + 0.3 * (b - a), a + 0.6 * (b - a) + (0, 0, -2), 10.0, 8.0, 6.0))
            made.append(distance.bone(b, b + (-7, 0, -3), 6.0, 3.6, 4.0))
        for toe in leg.toes:
            made.append(distance.bone(toe[0], toe[1], 4.4, 3.7, 2.2))
            made.append(distance.bone(toe[1], toe[2], 3.7, 2.9, 1.6))
    return made


def claws():
    """A claw for each toe."""
    made = []
    for leg in legs():
        for toe in leg.toes:
            ahead = splines.unit((toe[2] - toe[1]) * (1.0, 1.0, 0.0))
            made.append(shells.spike(toe[2] + (0, 0, 0.8) - 1.5 * ahead, ahead + (0, 0, 0.45), (0, 0, -7.0), 10.5, 2.3,
                                     flat=1.15, fullness=0.8))
    return made


def _toes(foot, size):
    """Three toes ahead and one thumb behind."""
    foot = np.asarray(foot, float)
    outward = np.sign(foot[1])
    made = []
    for angle in (-32.0, -4.0, 24.0, 150.0):
        a = np.radians(angle) * outward
        ahead = np.array([np.cos(a), np.sin(a), 0.0])
        reach = 0.6 if angle > 90 else 1.0
        knuckle = foot * (1, 1, 0) + ahead * 11.0 * size * reach + (0, 0, 7.2)
        tip = foot * (1, 1, 0) + ahead * 19.0 * size * reach + (0, 0, 3.6)
        made.append(np.array([foot * (1, 1, 0) + ahead * 2.0 + (0, 0, 7.0), knuckle, tip]))
    return tuple(made)
