# SPDX-License-Identifier: GPL-3.0-or-later
"""The 1D answer: each pixel sees a column that continues to all sides without end, as a stack of layers.

The column runs from the point against its normal to the other side of the body. Its sublayers grow with depth, since
the uppermost mean free path decides most of the light. The share of veins is averaged over each sublayer and rounded;
equal columns are solved once.
"""

import numpy as np

from . import light, veins

FIRST, GROWTH = 0.12, 1.4  # mm: the first sublayer, and the ratio of each to the one above
LEVELS = 32  # of the share of veins
FINE = 0.05  # mm between samples of the column
THICKNESS_STEP = 0.02  # relative: thicknesses are rounded to multiples of this ratio
LEAST_COSINE = 0.02


def radiance(interior, thickness, points, normals, towards_eye, lit):
    """(radiance towards the eye, (n, 3), of the columns below `points`; the number of columns solved).

    interior: lamina.Interior. thickness: (n,) in mm. normals: (n, 3). lit: (n,) whether the sun reaches the column's
    upper end (if the sun is above the surface) or lower end (if below).
    """
    import lamina  # the extension's wheel: not there before the extension is installed

    mu_eye, mu_sun = normals @ np.array(towards_eye), normals @ np.array(light.TOWARDS_SUN)
    steps = np.rint(np.log(thickness) / np.log1p(THICKNESS_STEP)).astype(int)
    of_sun, of_sky = np.zeros((len(points), 3)), np.zeros((len(points), 3))
    groups = {}
    for k in range(len(points)):
        edges = sublayers((1.0 + THICKNESS_STEP) ** steps[k])
        shares = _shares(interior, points[k], normals[k], edges, thickness[k])
        groups.setdefault((steps[k], tuple(np.rint(shares * LEVELS).astype(int))), []).append(k)
    for (step, levels), members in groups.items():
        edges = sublayers((1.0 + THICKNESS_STEP) ** step)
        solved = lamina.solve(stack(np.diff(edges), np.array(levels) / LEVELS), quality="preview")
        at = np.array(members)
        mu, mu0 = np.clip(mu_eye[at], LEAST_COSINE, 1.0), np.clip(np.abs(mu_sun[at]), LEAST_COSINE, 1.0)
        for function, side in ((solved.brdf, mu_sun[at] > 0.0), (solved.btdf, mu_sun[at] < 0.0)):
            chosen = side & lit[at]
            if chosen.any():
                # Isotropic phase functions: the azimuth does not matter.
                value = function(mu[chosen], mu0[chosen], np.zeros(np.count_nonzero(chosen)))
                of_sun[at[chosen]] = value * mu0[chosen, None]
        # By reciprocity a sky of radiance 1 on both sides gives what leaves of light from the eye's direction.
        values, place = np.unique(mu, return_inverse=True)
        of_sky[at] = np.array([solved.reflectance(m) + solved.transmittance(m) for m in values])[place]
    return light.radiance(of_sun, of_sky), len(groups)


def sublayers(thickness):
    """Depths (mm) of the sublayers' edges, from 0 to `thickness`."""
    edges = [0.0]
    step = FIRST
    while edges[-1] + 1.5 * step < thickness:
        edges.append(edges[-1] + step)
        step *= GROWTH
    return np.array([*edges, thickness])


def stack(heights, shares):
    """A lamina.Stack of mixtures: heights in mm, shares of the vein, top first."""
    import lamina

    (s0, a0), (s1, a1) = np.array(veins.WHITE), np.array(veins.VEIN)
    return lamina.Stack([
        lamina.Medium(sigma_s=(s0 + u * (s1 - s0)).tolist(), sigma_a=(a0 + u * (a1 - a0)).tolist(), thickness=float(h))
        for h, u in zip(heights, shares, strict=True)
    ])


def _shares(interior, point, normal, edges, thickness):
    """Mean share of the vein in each sublayer, 0 to 1; `edges` are scaled to the column's true thickness."""
    ends = edges * (thickness / edges[-1])
    counts = np.maximum(np.rint(np.diff(ends) / FINE).astype(int), 1)
    depths = np.concatenate([np.linspace(a, b, 2 * n + 1)[1::2]
                             for a, b, n in zip(ends[:-1], ends[1:], counts, strict=True)])
    low, high = veins.WHITE[1][0], veins.VEIN[1][0]
    share = (interior.at(point - depths[:, None] * normal)[1][:, 0] - low) / (high - low)
    return np.array([part.mean() for part in np.split(share, np.cumsum(counts)[:-1])])
