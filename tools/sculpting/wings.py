# SPDX-License-Identifier: GPL-3.0-or-later
"""Half-spread wings: an arm that is blended with the trunk, fingers, and the skin between them (mm, left side)."""

import numpy as np

from . import distance, shells, splines

SHOULDER, ELBOW, WRIST = np.array((2.0, 17, 112)), np.array((-38.0, 44, 136)), np.array((-12.0, 70, 196))
# Each finger from the wrist to its tip.
FINGERS = (
    ((-12, 70, 196), (-22, 98, 226), (-44, 128, 232), (-66, 150, 218)),
    ((-12, 70, 196), (-36, 100, 204), (-66, 122, 186), (-88, 130, 156)),
    ((-12, 70, 196), (-44, 88, 182), (-76, 98, 150), (-94, 98, 112)),
    ((-12, 70, 196), (-46, 76, 164), (-74, 74, 124), (-88, 66, 82)),
)
FLANK = ((-38, 44, 136), (-46, 36, 112), (-54, 26, 86), (-60, 18, 66))
THICKNESS = 1.1
# Rotation of each wing ahead, about the vertical through its shoulder: the left wing opens to a viewer in front.
TURNED = {1.0: np.radians(24.0), -1.0: np.radians(4.0)}


def arm(side):
    """Shoulder, elbow and wrist (3, 3); side: 1 is left, -1 right."""
    return _posed(np.stack([SHOULDER, ELBOW, WRIST]), side) * (1.0, side, 1.0)


def arm_parts():
    """Both arms, to be blended with the trunk."""
    made = []
    for side in (1.0, -1.0):
        shoulder, elbow, wrist = arm(side)
        made.append(distance.bone(shoulder, elbow, 9.0, 5.6, 8.0))
        made.append(distance.bone(shoulder, 0.5 * (shoulder + elbow), 8.0, 7.4, 5.0))
        made.append(distance.bone(elbow, wrist, 5.4, 4.0, 4.0))
        made.append(distance.bone(elbow + 0.15 * (wrist - elbow), 0.5 * (elbow + wrist), 6.2, 5.0, 4.0))
        made.append(distance.ball(wrist, 5.0, 3.0))
    return made


def made():
    """Fingers, thumbs and skin of both wings: shells."""
    found = _wing(1.0)
    for points, quads, triangles in _wing(-1.0):
        found.append((splines.mirrored(points), quads[:, ::-1], triangles[:, ::-1]))
    return found


def _posed(points, side):
    """Points of a left wing turned ahead; the angle grows with the distance from the trunk."""
    points = np.asarray(points, float)
    angle = TURNED[side] * np.clip((points[..., 1] - 20.0) / 45.0, 0.0, 1.0)
    x, y = points[..., 0] - SHOULDER[0], points[..., 1] - SHOULDER[1]
    return np.stack([SHOULDER[0] + x * np.cos(angle) + y * np.sin(angle),
                     SHOULDER[1] - x * np.sin(angle) + y * np.cos(angle), points[..., 2]], axis=-1)


def _wing(side):
    """Shells of a wing in the pose of `side`, on the left."""
    shoulder, elbow, wrist = _posed(np.stack([SHOULDER, ELBOW, WRIST]), side)
    curves = [_finger(_posed(points, side), k) for k, points in enumerate(FINGERS)]
    flank = splines.curve(_posed(FLANK, side), (0, 1, 0), np.full((len(FLANK), 2), 1.0))
    parts = [shells.swept(curve, 14) for curve in curves]
    parts.append(shells.spike(wrist + (1, 2, 3), (0.35, 0.25, 1.0), (5.0, 2.0, 0.0), 17.0, 3.0, fullness=0.8))
    parts += [shells.spike(c.points[-1] - 2 * c.tangent[-1], c.tangent[-1], (0, 0, -3.0), 8.0, 1.5) for c in curves]
    for a, b, depth in zip(curves[:-1], curves[1:], (0.20, 0.20, 0.22), strict=True):
        parts.append(_skin(a, b, depth))
    parts.append(_skin(curves[-1], flank, 0.16))
    parts.append(_front(shoulder, elbow, wrist))
    return parts


def _finger(points, number):
    t = np.linspace(0.0, 1.0, len(points))
    size = np.interp(t, (0.0, 0.33, 1.0), (3.6 - 0.3 * number, 2.7 - 0.2 * number, 1.0))
    return splines.curve(points, (0.3, 0.2, 1.0), np.stack([size, size], axis=1), step=1.5)


def _skin(a, b, depth, rows=72, columns=40):
    """Skin between fingers a and b: hollow, with its free edge cut in by `depth` of its length."""
    u = np.linspace(0.0, 1.0, columns)[None, :]
    v = np.linspace(0.0, 1.0, rows)[:, None] * (0.985 - depth * (4.0 * u * (1.0 - u)) ** 0.8)
    first, second = (
        np.stack([np.interp(v * c.length, c.along, column) for column in c.points.T], axis=-1) for c in (a, b)
    )
    points = first + u[..., None] * (second - first)
    normal = splines.unit(np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1)))
    span = np.linalg.norm(second - first, axis=-1)
    # Skin sags between fingers, with folds along them.
    sag = 0.16 * span * np.sin(np.pi * u) - 0.012 * span * np.sin(5.0 * np.pi * u) * v
    backwards = np.sign(normal[rows // 2, columns // 2] @ np.array([-1.0, -0.2, -0.3]))
    points = points + (backwards * sag)[..., None] * normal
    return shells.sheet(points, THICKNESS)


def _front(shoulder, elbow, wrist, rows=40, columns=24):
    """The small skin in front of the elbow, from the shoulder to the wrist."""
    t = np.linspace(0.0, 1.0, rows)[:, None]
    bones = np.where(t < 0.5, shoulder + 2 * t * (elbow - shoulder), elbow + (2 * t - 1) * (wrist - elbow))
    start = shoulder + (6, 2, 4)
    free = start + t * (wrist - start) + np.sin(np.pi * t) * np.array([-9.0, 4.0, -4.0])
    u = np.linspace(0.0, 1.0, columns)[None, :, None]
    points = bones[:, None] + u * (free - bones)[:, None]
    points[:, :, 0] -= 3.0 * np.sin(np.pi * u[..., 0]) * np.sin(np.pi * t)
    return shells.sheet(points, THICKNESS)
