# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of stacks with flakes: errors of their fits, and a thickness that varies."""

import numpy as np
import pytest

import lamina
from lamina import Flakes, Interface, Lambert, Stack

BELOW = Lambert([0.02, 0.02, 0.05])


def car_paint(alpha):
    return Stack([Interface(1.5), lamina.metals.flakes("aluminium", 0.8, alpha)], BELOW)


@pytest.mark.parametrize(("basis", "alpha", "mean", "worst"), [
    ("standard", 0.15, 0.07, 0.13), ("standard", 0.3, 0.055, 0.11),
    ("moving", 0.15, 0.02, 0.045), ("moving", 0.3, 0.025, 0.045),
])
def test_fit_under_a_coat(basis, alpha, mean, worst):
    """The bar of lobes that move with the view is 5.5 % on average and 11 % at worst."""
    report = lamina.bake(car_paint(alpha), quality="preview", basis=basis).report
    assert report["fit_error"] < mean
    assert report["worst_slice"]["error"] < worst
    assert report["albedo_error"] < 1e-6


def test_varying_thickness():
    """Row 0 is the stack without flakes, the last row that with all of them."""
    whole = Stack([Interface(1.5), Flakes(1.5, 0.2, reflectance=0.8, binder=0.2, varying=True)], Lambert(0.3))
    lut = lamina.bake(whole, quality="final")
    assert lut.weights.shape[2] > 1
    rows = lut.report["row_errors"]
    assert rows["tau"][0] == 0.0
    assert rows["tau"][-1] == pytest.approx(1.7)
    assert max(rows["mean"]) < 0.08
    assert lut.report["tau_error"]["worst"] < 0.01
    mu = np.array([0.4, 0.9])
    solved = lamina.solve(whole)
    assert np.all(solved.with_thickness(1, 0.0).reflectance(mu) < solved.reflectance(mu))
