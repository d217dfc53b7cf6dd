# SPDX-License-Identifier: GPL-3.0-or-later
"""The distribution of scales: sizes and directions along the limbs, bare skin, plates below."""

import numpy as np

from . import body, head, scales, splines, wings

ALONG_SPINE = ((60.0, 190.0, 12), (190.0, 300.0, 16), (300.0, 470.0, 24), (470.0, 640.0, 18))


def of_trunk(vertices, normals, seed):
    """Heights (n,) of the relief over the trunk's vertices."""
    spine = body.spine()
    plate, share = scales.plates(vertices, spine, 0.44)
    bare = np.ones(len(vertices))
    for leg in body.legs():
        for toe in leg.toes:  # soles
            near = np.linalg.norm(vertices - toe[2], axis=1)
            bare *= splines.smoothstep(1.0, 4.5, near)
    height = scales.relief(vertices, normals, _grain(spine), scales.rows_along(spine, ALONG_SPINE),
                           bare * (1.0 - share), seed)
    return np.maximum(height, plate)


def of_head(vertices, normals, seed):
    """Heights (n,) of the relief over the head's vertices."""
    local = (vertices - head.ORIGIN) @ head.FRAME.T
    in_jaw = (vertices - head.place(head.HINGE)) @ head.JAW_FRAME.T
    x = np.clip(local[:, 0], -12.0, 46.0)
    along = head.place(np.stack([np.linspace(-14.0, 48.0, 80), np.zeros(80), np.full(80, 4.0)], axis=1))
    sizes = np.interp(np.linspace(-14.0, 48.0, 80), (-14, 0, 12, 30, 48), (3.0, 2.9, 2.3, 2.0, 1.5))
    grain = scales.Grain(along, np.broadcast_to(-head.FRAME[0] + 0.15 * head.FRAME[2], (80, 3)), sizes)
    bare = np.ones(len(vertices))
    for side in (1.0, -1.0):
        eye = head.EYE * (1.0, side, 1.0)
        bare *= splines.smoothstep(4.4, 6.4, np.linalg.norm(local - eye, axis=1))
        bare *= splines.smoothstep(2.0, 3.6, np.linalg.norm(local - (47.0, 5.6 * side, 8.0), axis=1))
    # No scales in the mouth, nor on the lips.
    upper_mouth = (local[:, 2] < 0.6) & (in_jaw[:, 2] > -0.4) & (x > 2.0)
    bare[upper_mouth] = 0.0
    rows = (np.empty((0, 3)), np.empty(0))
    return 0.85 * scales.relief(vertices, normals, grain, rows, bare, seed)


def _grain(spine):
    """The Grain of the trunk with neck and tail, of the legs and of the arms."""
    step = slice(None, None, 4)
    around = np.array([n for _, _, n in ALONG_SPINE], float)
    ends = np.array([end for _, end, _ in ALONG_SPINE])
    count = around[np.clip(np.searchsorted(ends, spine.along), 0, len(ends) - 1)]
    sizes = np.maximum(np.pi * (spine.values[:, 0] + spine.values[:, 1]) / count, 1.2)
    found = [(spine.points[step], -spine.tangent[step], sizes[step])]
    for leg in body.legs():
        found.append(_limb(leg.joints, np.array(leg.radii)))
        found += [_limb(toe, np.array((7.0, 6.4, 5.6))) for toe in leg.toes]
    for side in (1.0, -1.0):
        found.append(_limb(wings.arm(side), np.array((12.0, 9.0, 7.0))))
    return scales.Grain(*(np.concatenate([part[k] for part in found]) for k in range(3)))


def _limb(joints, radii):
    curve = splines.curve(joints, (0.2, 0.9, 0.3), radii, step=2.0)
    return curve.points, curve.tangent, np.clip(0.36 * curve.values[:, 0], 2.0, 5.2)
