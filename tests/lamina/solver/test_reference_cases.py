# SPDX-License-Identifier: GPL-3.0-or-later
"""Every reference case without refractive indices, within its stated tolerance."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import lamina

CASES = json.loads((Path(__file__).parents[2] / "data" / "reference_cases.json").read_text(encoding="utf-8"))["cases"]


def of_kind(kind):
    chosen = [case for case in CASES if case["kind"] == kind and "ior" not in case]
    assert chosen, f"no case of kind {kind}"
    return pytest.mark.parametrize("case", chosen, ids=lambda case: case["id"])


def stack(case, tau=None):
    layers = [{"kind": "medium", **layer} for layer in case["layers"]]
    if tau is not None:
        layers[0]["tau"] = tau
    return lamina.Stack.from_json({"schema": 1, "layers": layers})


def test_the_file_holds_the_kinds_that_are_tested():
    counts = {kind: sum(c["kind"] == kind and "ior" not in c for c in CASES) for kind in {c["kind"] for c in CASES}}
    assert counts == {"flux": 16, "directional-azimuth-mean": 3, "H-function": 1, "directional": 1, "S": 1,
                      "searchlight": 2, "flux-stack": 1}


@of_kind("flux")
def test_fluxes(case):
    solved = lamina.solve(stack(case))
    mu0 = "diffuse" if case["mu0"] == "lambert" else case["mu0"]
    assert solved.reflectance(mu0)[0] == pytest.approx(case["R"], abs=case["tol"])
    if case["T"] is not None:
        diffuse, direct = solved.transmittance(mu0, parts=True)
        through = diffuse if case.get("T_is") == "diffuse" else diffuse + direct
        assert through[0] == pytest.approx(case["T"], abs=case["tol"])


@of_kind("directional-azimuth-mean")
def test_azimuth_means(case):
    solved = lamina.solve(stack(case))
    # Equidistant azimuths integrate a cosine series exactly.
    dphi = np.arange(64) * 2.0 * math.pi / 64
    for mu_o, mu_i, reflected, transmitted in case["points"]:
        assert math.pi * solved.brdf(mu_o, mu_i, dphi).mean() == pytest.approx(reflected, abs=case["tol"])
        through = math.pi * solved.btdf(mu_o, mu_i, dphi).mean()
        assert through == pytest.approx(transmitted or 0.0, abs=case["tol"])


@of_kind("directional")
def test_pointwise(case):
    solved = lamina.solve(stack(case))
    dphi = np.radians([0.0, 90.0, 180.0])
    for point in case["points"]:
        where = (point["mu_o"], point["mu_i"], dphi)
        assert solved.brdf(*where)[:, 0] == pytest.approx(point["f_r"], rel=case["rel_tol"])
        assert solved.btdf(*where)[:, 0] == pytest.approx(point["f_t"], rel=case["rel_tol"])


@of_kind("H-function")
@pytest.mark.parametrize("albedo", ["0.5", "0.9", "1"])
def test_h_function(case, albedo):
    """UR(mu0) = 1 - sqrt(1-a) H(mu0), BRDF = a H(mu) H(mu0) / (4 pi (mu + mu0))."""
    a, mu, h = float(albedo), np.array(case["mu"]), np.array(case["H"][albedo])
    solved = lamina.solve(lamina.Stack(base=lamina.HalfSpace(a)))
    assert 1.0 - solved.reflectance(mu)[:, 0] == pytest.approx(math.sqrt(1.0 - a) * h, abs=case["tol"])
    brdf = solved.brdf(mu[:, None], mu[None, :], 1.0)[..., 0]
    expected = a * np.outer(h, h) / (4.0 * math.pi * (mu[:, None] + mu[None, :]))
    # H is given to 1e-5 absolute: so is H H' divided by the smaller one.
    assert brdf == pytest.approx(expected, rel=2.0 * case["tol"])


@of_kind("S")
def test_scattering_equation(case):
    """S and its growth with thickness; a central difference of step 1e-3 errs by 2e-7 here."""
    mu, mu0, step = case["mu"], case["mu0"], 1e-3

    def s(tau):
        return 4.0 * math.pi * mu * mu0 * lamina.solve(stack(case, tau)).brdf(mu, mu0, 0.0)[0]

    tau = case["layers"][0]["tau"]
    assert s(tau) == pytest.approx(case["S"], abs=case["tol"])
    assert (s(tau + step) - s(tau - step)) / (2.0 * step) == pytest.approx(case["dS_dtau"], abs=case["tol"])


@of_kind("S")
def test_scattering_equation_balances(case):
    """dS/dtau = -(1/mu + 1/mu0) S + k + kS + Sk + SkS with integrals by our own quadrature: k = a, isotropic."""
    albedo, tau, mu, mu0 = case["layers"][0]["albedo"], case["layers"][0]["tau"], case["mu"], case["mu0"]
    solved = lamina.solve(stack(case))
    # (1/4pi) int S dw'/mu' over a hemisphere = 2 pi mu0 int BRDF dmu'; the grading tames mu ln mu at grazing.
    t, w = np.polynomial.legendre.leggauss(64)
    nodes, weights = (0.5 * (t + 1.0)) ** 2, w * 0.5 * (t + 1.0)

    def total(direction):
        return 2.0 * math.pi * direction * float(weights @ solved.brdf(direction, nodes, 0.0)[:, 0])

    s = 4.0 * math.pi * mu * mu0 * solved.brdf(mu, mu0, 0.0)[0]
    growth = -(1.0 / mu + 1.0 / mu0) * s + albedo * (1.0 + total(mu0)) * (1.0 + total(mu))
    assert tau == 1 and growth == pytest.approx(case["dS_dtau"], abs=case["tol"])
