# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of tables whose base has inputs: the report, Lut.compare, and values of the fitted function on a grid of their
own must agree."""

import functools
from dataclasses import replace

import numpy as np
import pytest

import lamina
from lamina import HenyeyGreenstein, Interface, Lambert, Lut, Medium, PrincipledBase, Stack
from lamina.baking.report import words

DUST = Medium(albedo=0.9, tau=0.3, phase=HenyeyGreenstein(0.6))
STACKS = {
    "varnish": Stack([Interface(ior=1.5)], PrincipledBase(color=0.8, roughness=0.4, inputs=("color", "metallic"))),
    "roughness": Stack([Interface(ior=1.5)],
                       PrincipledBase(color=0.8, metallic=1.0, roughness=0.4, inputs=("roughness",))),
    "dust": Stack([DUST], PrincipledBase(color=0.8, roughness=0.6, inputs=("color", "metallic"))),
    "textured": Stack([DUST], Lambert(0.8, textured=True)),
}
DARK, METAL, HALF = {"color": 0.02}, {"color": 0.5, "metallic": 1.0}, {"color": 0.3, "metallic": 0.5}
VALUES = {
    "varnish": (DARK, METAL, HALF),
    "roughness": ({"roughness": 0.25}, {"roughness": 0.8}),
    "dust": (DARK, METAL, HALF),
    "textured": ({"reflectance": 0.02}, {"reflectance": 0.5}),
}
# The report measures every third view.
BETWEEN = 1.05


@functools.cache
def baked(name):
    return lamina.bake(STACKS[name], "preview")


def over(name, values):
    """The stack with fixed values in place of the inputs."""
    stack = STACKS[name]
    fixed = {"textured": False} if isinstance(stack.base, Lambert) else {"inputs": ()}
    return Stack(stack.layers, replace(stack.base, **values, **fixed))


def inputs_of(values):
    return {"color" if name == "reflectance" else name: value for name, value in values.items()}


@pytest.mark.parametrize("name", STACKS)
def test_errors_lie_within_those_of_the_report(name):
    lut = baked(name)
    stated = lut.report["input_error"]
    for values in VALUES[name]:
        compared = lut.compare(over(name, values))
        assert 0.0 < compared.mean <= BETWEEN * max(one["mean"] for one in stated["values"]), values
        assert compared.worst["error"] <= BETWEEN * stated["worst"]["error"], values


@pytest.mark.parametrize("name", STACKS)
def test_the_base_itself_has_the_errors_of_the_report(name, tmp_path):
    baked(name).save(tmp_path / "table.npz")
    lut = Lut.load(tmp_path / "table.npz")
    compared = lut.compare()
    assert compared.mean == pytest.approx(lut.report["fit_error"], abs=1e-6) and 0.0 < compared.mean < 0.1
    assert np.array(compared.report["slice_errors"]) == pytest.approx(np.array(lut.report["slice_errors"]), abs=3e-6)
    assert words.describe(lut).count("with inputs") == 1


@pytest.mark.parametrize(("name", "values"), [("varnish", HALF), ("dust", DARK)])
def test_a_comparison_is_that_of_values_on_another_grid(name, values):
    """Both functions by their public calls, on a midpoint grid of light in place of the bake's."""
    lut, stack = baked(name), over(name, values)
    mu_i, dphi = (np.arange(40) + 0.5)[:, None] / 40, (np.arange(60) + 0.5) * np.pi / 60
    compared, exact = lut.compare(stack), lamina.solve(stack, "preview")
    for column in (0, 30):
        mu_o = float(compared.mu_o[column])
        wanted = exact.brdf(mu_o, mu_i, dphi)[..., 0]
        off = lut.evaluate(mu_o, mu_i, dphi, **values)[..., 0] - wanted
        error = np.sqrt(((off * mu_i)**2).sum() / ((wanted * mu_i)**2).sum())
        assert error == pytest.approx(compared.errors["reflection"][0, 0, 0, column], rel=0.08, abs=1e-3)


@pytest.mark.parametrize("name", STACKS)
def test_albedos_are_off_by_no_more_than_the_report_says(name):
    lut = baked(name)
    mu = np.cos(np.radians(np.linspace(0.0, 85.0, 18)))
    for values in VALUES[name]:
        exact = lamina.solve(over(name, values), "preview").reflectance(mu)[:, 0]
        found = lut.reflectance(mu, **inputs_of(values))[:, 0]
        assert np.abs(found / exact - 1.0).max() <= lut.report["input_error"]["albedo"]["error"] + 0.002, values


def test_the_report_is_found_again_at_its_values():
    """Lut.compare at some of the values that the report names; it measures more views."""
    lut = baked("varnish")
    for stated in lut.report["input_error"]["values"][1::3]:
        base = replace(STACKS["varnish"].base, color=stated["color"], metallic=stated["metallic"], inputs=())
        compared = lut.compare(Stack(STACKS["varnish"].layers, base))
        assert compared.mean == pytest.approx(stated["mean"], rel=0.05)
        assert stated["worst"] <= compared.worst["error"] + 1e-6 <= BETWEEN * stated["worst"] + 1e-6


def test_bakes_while_a_slider_moves_leave_the_ranges_out():
    lut = baked("textured")
    again = lamina.bake(STACKS["textured"], "preview", closures=lut.closures)
    assert "input_error" not in again.report and again.report["fit_error"] == lut.report["fit_error"]


def test_progress_never_falls():
    said = []
    lamina.bake(Stack([Medium(0.9, 0.3)], Lambert(0.5, textured=True)), "preview",
                progress=lambda share, _: said.append(share))
    assert said == sorted(said) and said[-1] == 1.0
