# SPDX-License-Identifier: GPL-3.0-or-later
"""Slabs with known parameters, and noisy values of their BRDF."""

import numpy as np

import lamina
from lamina import Free, HenyeyGreenstein, Medium, Stack, Template, measurements

NAMES = ("albedo", "g", "tau")


def slab(albedo, g, tau):
    return [Medium(albedo=albedo, tau=tau, phase=HenyeyGreenstein(g))]


def free_slab():
    return Template(slab(Free(0.8, 0.0, 1.0, "albedo"), Free(0.3, -0.5, 0.95, "g"), Free(1.0, 0.05, 20.0, "tau")))


def noisy_case(seed, count=100, noise=0.02):
    """(true albedo, g and tau; a measurement of `count` values with relative noise)."""
    rng = np.random.default_rng(seed)
    truth = rng.uniform(0.4, 0.97), rng.uniform(0.0, 0.8), float(np.exp(rng.uniform(np.log(0.4), np.log(4.0))))
    mu_o, mu_i, dphi = rng.uniform(0.1, 1.0, count), rng.uniform(0.1, 1.0, count), rng.uniform(0.0, np.pi, count)
    exact = lamina.solve(Stack(slab(*truth))).brdf(mu_o, mu_i, dphi)[:, 0]
    values = exact * (1.0 + noise * rng.standard_normal(count))
    return truth, measurements.Brdf(values=values, relative=noise, mu_o=mu_o, mu_i=mu_i, dphi=dphi)
