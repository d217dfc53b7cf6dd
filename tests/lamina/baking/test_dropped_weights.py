# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles drops closures whose weight has an RGB mean below 1e-5: tables have no such weights, and dark albedos stay
exact."""

import math

import numpy as np
import pytest

import lamina
from lamina import Black, HenyeyGreenstein, Lambert, Medium, Stack, lobes

CUTOFF = 1e-5
STACKS = {
    "dark": Stack([Medium(1e-3, tau=1.0)], Black()),
    "dark, forward": Stack([Medium([4e-3, 2e-3, 1e-3], tau=2.0, phase=HenyeyGreenstein(0.3))], Black()),
    "dark, of three colours": Stack([Medium([1e-2, 1e-3, 1e-4], tau=1.0, phase=HenyeyGreenstein(0.6))], Black()),
    "thin film": Stack([Medium(0.9, tau=1e-3, phase=HenyeyGreenstein(0.7))], Black()),
    "thin sheet": Stack([Medium(0.9, tau=1e-3, phase=HenyeyGreenstein(0.7))]),
    "dark, varying": Stack([Medium(3e-3, tau=1.0, varying=True)], Black()),
    "dark base": Stack([Medium(2e-3, tau=2.0)], Lambert(0.02, textured=True)),
}


@pytest.fixture(scope="module", params=STACKS)
def baked(request):
    return STACKS[request.param], lamina.bake(STACKS[request.param], "preview")


def _gain(lut):
    """The node group's factor of the base's closures, at the stack's own reflectance [row, column, RGB]."""
    colour = np.array(lut.header["stack"]["base"]["reflectance"])
    return colour / (1.0 - colour * lut.weights[0, lut.closures.index("base/thrown back")])


def _shown(lut):
    """(names, weights [side, closure, row, column, RGB] as in Cycles) of closures with a shape; closures of a textured
    base keep their prefix."""
    names, weights = [], []
    for k, name in enumerate(lut.closures):
        if name != "transparent" and not name.startswith("mirror:") and name != "base/thrown back":
            names.append(name)
            weights.append(lut.weights[:, k] * (_gain(lut) if name.startswith("base/") else 1.0))
    return names, np.stack(weights, axis=1).astype(float)


def test_no_weight_is_dropped(baked):
    _, lut = baked
    names, weights = _shown(lut)
    for of_base in (False, True):
        mean = weights[:, [name.startswith("base/") == of_base for name in names]].mean(axis=-1)
        dropped = (mean > 0.0) & (mean < CUTOFF)
        alone = (mean > 0.0).sum(axis=1, keepdims=True) == 1  # the only closure: less than 1e-5 of the light
        assert not np.any(dropped & ~alone)


def test_what_is_left_has_the_exact_albedo(baked):
    """On a separate grid, for reflected light; views with a tiny total albedo are left out."""
    stack, lut = baked
    if stack.varying is not None:
        stack = Stack([Medium(3e-3, tau=1.0)], Black())
    names, weights = _shown(lut)
    x, wx = np.polynomial.legendre.leggauss(200)
    mu, dphi = 0.5 * (x + 1.0), (np.arange(160) + 0.5) * math.pi / 160
    columns = np.array([3, 20, 29, 34, 45])
    mu_o = np.cos(columns / 63 * math.pi / 2)
    reached = np.zeros((len(columns), 3))
    for k, name in enumerate(name.removeprefix("base/") for name in names):
        if lobes.by_id(name).side == "reflection":
            shape = lobes.by_id(name).evaluate(mu_o[:, None, None], mu[:, None], dphi).mean(axis=2)
            weight = weights[0, k, -1, columns]
            kept = weight.mean(axis=1, keepdims=True) >= CUTOFF
            reached += kept * weight * (math.pi * shape @ wx)[:, None]
    exact = np.broadcast_to(lamina.solve(stack).reflectance(mu_o), reached.shape)
    assert reached == pytest.approx(exact, rel=2e-3)
