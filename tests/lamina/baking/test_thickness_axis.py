# SPDX-License-Identifier: GPL-3.0-or-later
"""The thickness axis of a varying layer's table: errors by row and between rows, and its clean end."""

import numpy as np
import pytest

import lamina
from lamina import Black, Conductor, HenyeyGreenstein, Lambert, Medium, Stack
from lamina.baking.report.words import describe
from lamina.closures.axes import tau_at, tau_rows
from lamina.closures.closure_table import grid_for, view_cosines

DUST = Medium(albedo=[0.9, 0.8, 0.6], tau=[4.0, 3.0, 2.0], phase=HenyeyGreenstein(0.5), varying=True)
BASES = {"lambert": Lambert([0.6, 0.3, 0.05]), "metal": Conductor(eta=0.3, k=3.0), "black": Black()}
STATED = 61  # columns with view cosines of .05 and more


@pytest.fixture(scope="module", params=BASES)
def baked(request):
    stack = Stack([DUST], BASES[request.param])
    return stack, lamina.bake(stack, "final", threads=1)


def test_rows_between_rows():
    rows = tau_rows(4.0)
    assert tau_at(4.0, np.arange(33)) == pytest.approx(rows)
    middle = tau_at(4.0, np.array([0.5]))[0]
    t = middle / (middle + 0.5)
    assert t == pytest.approx(0.5 * rows[1] / (rows[1] + 0.5))


def test_errors_by_row_are_those_of_the_slices(baked):
    _, lut = baked
    slices = np.array(lut.report["slice_errors"])[0, :, :, :STATED]
    rows = lut.report["row_errors"]
    assert rows["tau"] == lut.header["axes"]["tau"]["values"]
    assert rows["mean"] == pytest.approx(slices.mean(axis=(1, 2)), abs=1e-5)
    assert rows["worst"] == pytest.approx(slices.max(axis=(1, 2)), abs=1e-5)
    text = describe(lut)
    for mean, worst in zip(rows["mean"], rows["worst"], strict=True):
        assert f"{mean:.2%} mean, {worst:.2%} worst" in text
    assert "between rows" in text


def test_the_error_between_rows_is_what_direct_solves_say(baked):
    stack, lut = baked
    told = lut.report["tau_error"]
    exact, grid = lamina.solve(stack, threads=1), grid_for("final", None)
    axis = tau_rows(4.0)
    place = told["rows"][0]
    mu_o = view_cosines()[4:STATED:8]

    def slices(tau):
        share = tau / 4.0
        function = exact.with_thickness(0, [share * t for t in DUST.tau])
        values = function.grid("reflect", mu_o, grid.mu, grid.dphi) * grid.mu[:, None, None]
        return np.moveaxis(values, -1, 0).reshape(3, len(mu_o), -1)

    middle = tau_at(4.0, np.array([0.5]))[0]
    assert place[0] == pytest.approx(middle)
    wanted = slices(middle)
    error = 0.5 * (slices(axis[0]) + slices(axis[1])) - wanted
    relative = np.sqrt((error**2) @ grid.solid_angle / ((wanted**2) @ grid.solid_angle))
    assert place[1] == pytest.approx(relative.mean(), rel=0.01) and place[2] == pytest.approx(relative.max(), rel=0.01)


def test_less_is_lost_between_rows_than_in_the_fit(baked):
    """On average, and half-way after each row where it was looked at."""
    _, lut = baked
    told, rows = lut.report["tau_error"], lut.report["row_errors"]
    assert told["mean"] < 0.2 * lut.report["fit_error"]
    for tau, mean, _ in told["rows"]:
        assert mean < np.interp(tau, rows["tau"][1:], rows["mean"][1:]), tau
    assert told["mirror"] < 0.03


@pytest.mark.parametrize("name", ["lambert", "metal"])
def test_thickness_0_is_the_clean_stack(name):
    lut = lamina.bake(Stack([DUST], BASES[name]), "preview", threads=1)
    clean = Stack([Medium(albedo=0.5, tau=0.0)], BASES[name])
    alone = lamina.bake(clean, "preview", threads=1)
    row = dict(zip(lut.closures, lut.weights[0, :, 0], strict=True))
    for closure, weights in zip(alone.closures, alone.weights[0, :, 0], strict=True):
        assert row.pop(closure, np.zeros_like(weights)) == pytest.approx(weights, rel=1e-6, abs=1e-7), closure
    assert not any(np.any(weights) for weights in row.values())
    assert max(lut.report["row_errors"]["worst"][:1]) < 1e-6


def test_previews_and_single_thicknesses_are_not_measured_between_rows():
    assert "tau_error" not in lamina.bake(Stack([DUST], Black()), "preview", threads=1).report
    single = Stack([Medium(albedo=0.9, tau=1.0)], Black())
    report = lamina.bake(single, "final", threads=1).report
    assert "tau_error" not in report and "row_errors" not in report
