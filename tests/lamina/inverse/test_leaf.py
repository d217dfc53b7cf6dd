# SPDX-License-Identifier: GPL-3.0-or-later
"""A leaf of two layers in three channels, eight parameters, from values on both sides."""

import numpy as np

import lamina
from lamina import Free, HenyeyGreenstein, Interface, Medium, Stack, Template
from lamina.measurements import Brdf, Btdf, Reflectance, Transmittance

TRUTH = (0.55, 0.8, 0.35, 2.0, 0.8, 0.93, 0.7, 3.0)
NOISE = 0.02


def leaf(values):
    upper, lower = values[:3], values[4:7]
    return [Interface(1.45), Medium(albedo=upper, tau=values[3], phase=HenyeyGreenstein(0.6)),
            Medium(albedo=lower, tau=values[7], phase=HenyeyGreenstein(0.3)), Interface(1.0)]


def test_eight_parameters():
    rng = np.random.default_rng(11)
    solved = lamina.solve(Stack(leaf(TRUTH)))
    mu_o, mu_i, dphi = rng.uniform(0.2, 1.0, 40), rng.uniform(0.2, 1.0, 40), rng.uniform(0.0, np.pi, 40)
    measured = []
    for kind, exact in ((Brdf, solved.brdf(mu_o, mu_i, dphi)), (Btdf, solved.btdf(mu_o, mu_i, dphi))):
        noisy = exact * (1.0 + NOISE * rng.standard_normal(exact.shape))
        measured.append(kind(values=noisy, relative=NOISE, mu_o=mu_o, mu_i=mu_i, dphi=dphi))
    for side in ("top", "bottom"):
        both = (Reflectance, solved.reflectance(0.9, side)), (Transmittance, solved.transmittance(0.9, side))
        for kind, exact in both:
            measured.append(kind(values=exact + 0.002 * rng.standard_normal(3), sigma=0.002, mu_i=0.9, side=side))
    free = [Free(1.5, 0.1, 20.0) if number in (3, 7) else Free(0.7, 0.0, 1.0) for number in range(8)]
    fit = lamina.fit(measured, Template(leaf(free)))
    # The sum of squares in the metric of the stated errors follows chi-squared with eight degrees of freedom
    away = np.array(list(fit.values.values())) - TRUTH
    errors = np.array(list(fit.errors.values()))
    squares = away @ np.linalg.solve(fit.correlations * np.outer(errors, errors), away)
    assert squares < 26.1  # exceeded by chance in one of a thousand
    assert fit.probability > 1e-3 and fit.degrees == 244
