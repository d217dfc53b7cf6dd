# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of measured bases: how well closures fit them, and peaks that are narrower than a table's lobes."""

import numpy as np
import pytest
from measured_tables import facets, measured

import lamina
from lamina import HenyeyGreenstein, Interface, Medium, Stack
from lamina.kinds.bases import LEAST_ALPHA
from lamina.solver.sharp_facets import as_mirrors, peak_alpha

DUST = Medium(albedo=[0.9, 0.85, 0.7], tau=0.3, phase=HenyeyGreenstein(0.5))


def car_paint(wi, wo):
    """A clear coat's lobe, the broad one of flakes, and a diffuse part."""
    return facets(0.04, 0.04, 0.0)(wi, wo) + facets(0.25, 0.15, 0.05)(wi, wo)


# Largest mean errors with fixed and with moving lobes; measured: .022 .007, .043 .025, .053 .016, .027 .001, .002 .002
CASES = {
    "car paint": ([], car_paint, 0.03, 0.01), "dusty": ([DUST], car_paint, 0.06, 0.035),
    "coated": ([Interface(1.5)], car_paint, 0.07, 0.025), "metal": ([], facets(0.3, 0.9, 0.0), 0.04, 0.003),
    "matt": ([], facets(1.0, 0.0, 0.4), 0.005, 0.005),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_fit_errors(case):
    layers, function, fixed, moving = case
    stack = Stack(layers, measured(function))
    for basis, most in (("standard", fixed), ("moving", moving)):
        report = lamina.bake(stack, "final", basis=basis).report
        assert report["fit_error"] < most and report["albedo_error"] < 1e-3


def test_a_narrow_peak_is_solved_wider_with_its_flux():
    narrow = measured(facets(0.01, 0.05, 0.2))
    shown = as_mirrors(Stack([], narrow)).base
    assert peak_alpha(narrow) == pytest.approx(0.01, rel=0.02)
    assert peak_alpha(shown) == pytest.approx(LEAST_ALPHA, rel=0.02)
    mu = np.array([0.4, 0.7, 1.0])
    shares = [lamina.solve(Stack([], base)).reflectance(mu) for base in (narrow, shown)]
    assert shares[1] == pytest.approx(shares[0], rel=4e-3)
    # Away from the peak the values stay.
    values = [lamina.solve(Stack([], base)).brdf(0.9, 0.5, 1.5) for base in (narrow, shown)]
    assert values[1] == pytest.approx(values[0], rel=0.02)
    assert as_mirrors(Stack([], measured(facets(0.1, 0.05, 0.2)))).base.table == measured(facets(0.1, 0.05, 0.2)).table


def test_a_table_of_varying_dust_is_read_back(tmp_path):
    dust = Medium(albedo=0.8, tau=1.0, varying=True)
    base = measured(facets(0.2, 0.04, 0.1), facets(0.2, 0.04, 0.2), facets(0.2, 0.04, 0.4))
    lut = lamina.bake(Stack([dust], base), "preview")
    lut.save(tmp_path / "lut.npz")
    again = lamina.Lut.load(tmp_path / "lut.npz")
    assert again == lut and again.stack.hash == Stack([dust], base).hash
    assert lut.report["fit_error"] < 0.06
