# SPDX-License-Identifier: GPL-3.0-or-later
"""Solutions beside random walks, for tests of layers and bases that walks sample by other means than the solver."""

import math

import numpy as np

import lamina

DPHI = np.array([0.0, 0.5, 2.0, math.pi])


def compared(stack, points, cosines, is_sheet, samples=1 << 17):
    """(solver, walk, standard error) of values at `points` (mu_o, mu_i, dphi) and of albedos at `cosines`, all channels
    in one row; of a sheet by reflection and transmission."""
    solved = lamina.solve(stack)
    found = []
    for path in ("reflect", "transmit")[:1 + is_sheet]:
        of = solved.brdf if path == "reflect" else solved.btdf
        whole = solved.reflectance if path == "reflect" else solved.transmittance
        for seed, (o, i, dphi) in enumerate(points):
            walk = lamina.estimate(stack, o, i, dphi, samples=samples, seed=seed, path=path)
            found.append((of(o, i, dphi), walk.value, walk.stderr))
        for seed, mu in enumerate(cosines):
            walk = lamina.estimate(stack, None, mu, samples=samples, seed=seed, path=path)
            found.append((whole(mu), walk.value, walk.stderr))
    return tuple(np.concatenate([np.ravel(one) for one in column]) for column in zip(*found, strict=True))


def z_scores(value, walk, error):
    """Of what `compared` returns."""
    return (value - walk) / np.maximum(error, 1e-12)


def beyond_the_first(stack, once, points, samples):
    """(light beyond the first reflection or scattering, its distance from the walk, the walk's noise), L2 norms over
    `points` in the first channel. `once(mu_o, mu_i, dphi)`: what is reflected or scattered once at most."""
    solved = lamina.solve(stack)
    beyond, off, noise = [], [], []
    for seed, point in enumerate(points):
        walk = lamina.estimate(stack, *point, samples=samples, seed=seed)
        value = solved.brdf(*point)[0]
        beyond.append(value - once(*point))
        off.append(value - walk.value[0])
        noise.append(walk.stderr[0])
    return tuple(map(np.linalg.norm, (beyond, off, noise)))


def exchanged(stack, cosines):
    """(values of the reflection, the same with view and light exchanged)."""
    values = lamina.solve(stack).grid("reflect", cosines, cosines, DPHI)
    return values, np.moveaxis(values, 0, 1)
