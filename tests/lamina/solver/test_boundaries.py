# SPDX-License-Identifier: GPL-3.0-or-later
"""Dielectric boundaries and metals: published values, energy, reciprocity, closed forms."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import Conductor, HenyeyGreenstein, Interface, Lambert, Medium, Stack, StackError

CASES = json.loads((Path(__file__).parents[2] / "data/reference_cases.json").read_text(encoding="utf-8"))["cases"]
MU = np.array([0.05, 0.1, 0.3, 0.7, 1.0])


def of_case(case):
    layers = [{"kind": "medium", **layer} for layer in case["layers"]]
    return Stack([Interface(case["ior"]), *Stack.from_json({"schema": 1, "layers": layers}).layers, Interface(1.0)])


@pytest.mark.parametrize("case", [c for c in CASES if "ior" in c], ids=lambda c: c["id"])
def test_published_slabs(case):
    solved = lamina.solve(of_case(case))
    assert solved.reflectance(case["mu0"])[0] == pytest.approx(case["R"], abs=case["tol"])
    assert solved.transmittance(case["mu0"])[0] == pytest.approx(case["T"], abs=case["tol"])


def test_the_rough_stack():
    """Against 1.7e7 paths an angle, facets that scatter once: Z-scores."""
    case = next(c for c in CASES if c["kind"] == "flux-stack")
    stack = Stack([Interface(1.5, 0.1, "beckmann", compensate=False),
                   Medium(albedo=0.8, tau=1.0, phase=HenyeyGreenstein(0.5))], Lambert(0.5))
    solved = lamina.solve(stack)
    for mu0, (value, sigma) in case["albedo"].items():
        assert abs(solved.reflectance(float(mu0))[0] - value) < z_limit(len(case["albedo"])) * sigma


CONSERVATIVE = {
    "slab": [Interface(1.5), Medium(albedo=1.0, tau=3.0, phase=HenyeyGreenstein(0.6)), Interface(1.0)],
    "three media": [Medium(albedo=1.0, tau=0.5, phase=HenyeyGreenstein(0.3)), Interface(1.33),
                    Medium(albedo=1.0, tau=1.0), Interface(1.5), Medium(albedo=1.0, tau=2.0), Interface(1.0)],
    "thin film": [Interface(1.5), Medium(albedo=1.0, tau=0.1), Interface(1.0)],
    "plate without a medium": [Interface(1.5), Interface(1.0)],
    "air gap": [Interface(1.5), Medium(albedo=1.0, tau=1.0), Interface(1.0), Interface(1.5),
                Medium(albedo=1.0, tau=1.0), Interface(1.0)],
}


@pytest.mark.parametrize("layers", CONSERVATIVE.values(), ids=CONSERVATIVE)
@pytest.mark.parametrize("side", ["top", "bottom"])
def test_smooth_boundaries_keep_all_energy(layers, side):
    assert lamina.solve(Stack(layers)).absorption(MU, side) == pytest.approx(0.0, abs=1e-5)


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("alpha, ior", [(0.1, 1.5), (0.3, 1.1), (0.6, 1.5), (1.0, 1.5)])
def test_rough_boundaries_keep_all_energy(alpha, ior, distribution):
    layers = [Interface(ior, alpha, distribution), Medium(albedo=1.0, tau=1.0), Interface(1.0, alpha, distribution)]
    assert lamina.solve(Stack(layers)).absorption(MU) == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("alpha", [0.0, 0.3])
def test_reciprocity(alpha):
    layers = [Medium(albedo=0.9, tau=0.3), Interface(1.5, alpha),
              Medium(albedo=0.8, tau=1.0, phase=HenyeyGreenstein(0.7)), Interface(1.0, alpha)]
    solved = lamina.solve(Stack(layers))
    dphi = np.array([0.0, 1.0, math.pi])
    brdf = solved.brdf(MU[:, None, None], MU[None, :, None], dphi)
    assert brdf == pytest.approx(brdf.swapaxes(0, 1), rel=1e-6)
    down = solved.btdf(MU[:, None, None], MU[None, :, None], dphi)
    up = solved.btdf(MU[:, None, None], MU[None, :, None], dphi, side="bottom")
    assert down == pytest.approx(up.swapaxes(0, 1), rel=1e-6)


def fresnel(mu, ratio):
    """Unpolarised, by complex amplitudes."""
    t = np.sqrt(1.0 - (1.0 - mu**2) / ratio**2 + 0j)
    s = (mu - ratio * t) / (mu + ratio * t)
    p = (ratio * mu - t) / (ratio * mu + t)
    return 0.5 * (abs(s) ** 2 + abs(p) ** 2)


def test_a_polished_metal_is_fresnels():
    gold = Conductor([0.18, 0.42, 1.37], [3.42, 2.35, 1.77])
    solved = lamina.solve(Stack([], gold))
    for channel in range(3):
        expected = fresnel(MU, gold.eta[channel] + 1j * gold.k[channel])
        assert solved.reflectance(MU)[:, channel] == pytest.approx(expected, rel=1e-9)
    assert solved.brdf(0.5, 0.5, 0.0) == pytest.approx(0.0, abs=1e-12)


def test_a_clear_coat_over_metal_is_the_geometric_series():
    solved = lamina.solve(Stack([Interface(1.5), Medium(albedo=0.0, tau=0.4)], Conductor(0.2, 3.9)))
    coat = fresnel(MU, 1.5)
    inside = np.sqrt(1.0 - (1.0 - MU**2) / 1.5**2)
    pass_ = np.exp(-0.8 / inside) * fresnel(inside, (0.2 + 3.9j) / 1.5)
    expected = coat + (1.0 - coat) ** 2 * pass_ / (1.0 - coat * pass_)
    assert solved.reflectance(MU)[:, 0] == pytest.approx(expected, rel=1e-9)


def test_a_rough_metal_is_its_facets():
    """GGX with height-correlated masking in closed form, pointwise."""
    alpha, ratio = 0.25, 0.2 + 3.9j
    solved = lamina.solve(Stack([], Conductor(0.2, 3.9, alpha, compensate=False)))
    mu_o, mu_i, dphi = 0.8, 0.6, 0.3
    so, si = math.sqrt(1 - mu_o**2), math.sqrt(1 - mu_i**2)
    o = np.array([so * math.cos(dphi), so * math.sin(dphi), mu_o])
    half = o + np.array([-si, 0.0, mu_i])
    half /= np.linalg.norm(half)
    density = alpha**2 / (math.pi * (half[2] ** 2 * (alpha**2 - 1) + 1) ** 2)
    smith = [0.5 * (math.sqrt(1 + alpha**2 * (1 / mu**2 - 1)) - 1) for mu in (mu_o, mu_i)]
    expected = density * fresnel(float(o @ half), ratio) / (4 * mu_o * mu_i * (1 + sum(smith)))
    assert solved.brdf(mu_o, mu_i, dphi)[0] == pytest.approx(expected, rel=1e-9)


def test_a_perfect_rough_metal_reflects_everything_when_compensated():
    solved = lamina.solve(Stack([], Conductor(1e-3, 100.0, 0.6)))
    assert solved.reflectance(MU)[:, 0] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("layer, sentence", [
    (Interface(0.5), "layers[0].ior = 0.5: must lie in [1, 4]"),
    (Interface(1.5, 2.0), "layers[0].alpha = 2: must lie in [0, 1]"),
    (Interface(1.5, distribution="phong"), 'layers[0].distribution = \'phong\': must be "ggx" or "beckmann"'),
    (Interface(1.5, compensate=1), "layers[0].compensate = 1: must be true or false"),
])
def test_bad_interfaces(layer, sentence):
    with pytest.raises(StackError) as caught:
        Stack([layer], Lambert(0.5))
    assert str(caught.value) == sentence


def test_json_and_the_bakes_refusal():
    stack = Stack([Interface([1.5, 1.51, 1.52], 0.1, "beckmann", False, name="varnish"), Medium(albedo=0.9, tau=1.0)],
                  Conductor([0.2, 0.9, 1.3], [3.9, 2.4, 2.0], 0.2))
    again = Stack.from_json(stack.to_json())
    assert again.to_json() == stack.to_json() and again.hash == stack.hash
    assert Stack.from_json({"schema": 1, "layers": [{"kind": "interface", "ior": 1.5}]}).layers[0] == Interface(1.5)
