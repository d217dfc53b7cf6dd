# SPDX-License-Identifier: GPL-3.0-or-later
"""lamina.fit beside SciPy's least squares over lamina.solve, which solves every stack of every step anew; and how often
the truth lies within two of the standard errors that a fit states."""

import time

import numpy as np
from scipy.optimize import least_squares

import lamina
from lamina import Free, HenyeyGreenstein, Interface, Medium, Stack, Template
from lamina.measurements import Brdf, Btdf, Reflectance, Transmittance

NOISE = 0.02
LIMITS = {"slab, 100 values, 3 parameters": 0.5, "leaf, 264 values, 8 parameters": 10.0}  # seconds


def slab(albedo, g, tau):
    return [Medium(albedo=albedo, tau=tau, phase=HenyeyGreenstein(g))]


def leaf(*values):
    """Two layers in three channels between smooth surfaces: albedos and thickness of each."""
    return [Interface(1.45), Medium(albedo=values[:3], tau=values[3], phase=HenyeyGreenstein(0.6)),
            Medium(albedo=values[4:7], tau=values[7], phase=HenyeyGreenstein(0.3)), Interface(1.0)]


def slab_case(seed):
    """(truth, template, measurements) of a random slab."""
    rng = np.random.default_rng(seed)
    truth = rng.uniform(0.4, 0.97), rng.uniform(0.0, 0.8), float(np.exp(rng.uniform(np.log(0.4), np.log(4.0))))
    free = Free(0.8, 0.0, 1.0, "albedo"), Free(0.3, -0.5, 0.95, "g"), Free(1.0, 0.05, 20.0, "tau")
    where = dict(zip(("mu_o", "mu_i", "dphi"), _directions(rng, 100, 0.1), strict=True))
    exact = lamina.solve(Stack(slab(*truth))).brdf(**where)
    return truth, Template(slab(*free)), [Brdf(values=_noisy(rng, exact), relative=NOISE, **where)]


def leaf_case(seed):
    rng = np.random.default_rng(seed)
    truth = (0.55, 0.8, 0.35, 2.0, 0.8, 0.93, 0.7, 3.0)
    free = [Free(1.5, 0.1, 20.0) if number in (3, 7) else Free(0.7, 0.0, 1.0) for number in range(8)]
    solved = lamina.solve(Stack(leaf(*truth)))
    where = dict(zip(("mu_o", "mu_i", "dphi"), _directions(rng, 40, 0.2), strict=True))
    measured = [kind(values=_noisy(rng, exact), relative=NOISE, **where) for kind, exact in
                ((Brdf, solved.brdf(**where)), (Btdf, solved.btdf(**where)))]
    for side in ("top", "bottom"):
        for kind, exact in ((Reflectance, solved.reflectance), (Transmittance, solved.transmittance)):
            values = exact(0.9, side) + 0.002 * rng.standard_normal(3)
            measured.append(kind(values=values, sigma=0.002, mu_i=0.9, side=side))
    return truth, Template(leaf(*free)), measured


def _directions(rng, count, least):
    return rng.uniform(least, 1.0, count), rng.uniform(least, 1.0, count), rng.uniform(0.0, np.pi, count)


def _noisy(rng, exact):
    return exact * (1.0 + NOISE * rng.standard_normal(exact.shape))


def by_scipy(template, measurements):
    """Seconds of SciPy with checked solves: no work is shared, and relative errors are those of the measured values."""
    calls = {Brdf: lambda s, m: s.brdf(m.mu_o, m.mu_i, m.dphi), Btdf: lambda s, m: s.btdf(m.mu_o, m.mu_i, m.dphi),
             Reflectance: lambda s, m: s.reflectance(m.mu_i, m.side)[None],
             Transmittance: lambda s, m: s.transmittance(m.mu_i, m.side)[None]}
    frees = template.parameters

    def residuals(x):
        solved = lamina.solve(template.stack(dict(zip(frees, x.tolist(), strict=True))))
        return np.concatenate([((calls[type(one)](solved, one) - one.values)
                                / np.hypot(one.sigma, one.relative * one.values)).ravel() for one in measurements])

    began = time.perf_counter()
    least_squares(residuals, [free.start for free in frees.values()], diff_step=1e-4, x_scale="jac", ftol=1e-6,
                  bounds=([free.low for free in frees.values()], [free.high for free in frees.values()]))
    return time.perf_counter() - began


def measure(cases=200, repeats=3):
    """Rows for `cases` slabs and, unless in a hurry, a leaf."""
    slabs = [slab_case(seed) for seed in range(cases)]
    fits = [lamina.fit(measured, template) for _, template, measured in slabs]
    within = np.mean([[abs(fit.values[name] - true) < 2.0 * fit.errors[name] for name, true in
                       zip(fit.names, (truth[0], truth[2], truth[1]), strict=True)]
                      for fit, (truth, _, _) in zip(fits, slabs, strict=True)], axis=0)
    rows = [_row("slab, 100 values, 3 parameters", [fit.seconds for fit in fits],
                 [by_scipy(template, measured) for _, template, measured in slabs[:3 * repeats]])]
    rows[0] |= {f"within 2 errors, {name}": float(share) for name, share in zip(fits[0].names, within, strict=True)}
    if repeats > 1:
        _, template, measured = leaf_case(1)
        seconds = [lamina.fit(measured, template).seconds for _ in range(repeats)]
        rows.append(_row("leaf, 264 values, 8 parameters", seconds, [by_scipy(template, measured)]))
    return rows


def _row(name, seconds, plain):
    own = float(np.median(seconds))
    return {"name": name, "seconds": own, "worst": max(seconds), "limit": LIMITS[name],
            "SciPy over lamina.solve": float(np.median(plain)), "times sooner": float(np.median(plain)) / own}
