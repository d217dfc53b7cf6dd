# SPDX-License-Identifier: GPL-3.0-or-later
"""The way back for published values: inverse adding-doubling's own cases, van de Hulst, Giovanelli.

IAD: the files basic-B.rxt and basic-C.rxt in the tests of github.com/scottprahl/iadpython (S. Prahl, 2026; its results
in the .txt files beside them). They hold total reflectance, total transmittance and unscattered transmittance for a
beam along the normal of a sample of index 1.4, 1 mm thick, between glass slides of index 1.5. There, IAD itself finds
sigma_a and sigma_s (1 - g) within 1.2 % and g within .001."""

import math

import pytest

import lamina
from lamina import Free, HalfSpace, HenyeyGreenstein, Interface, Medium, Template
from lamina.measurements import Reflectance, Transmittance

# (reflectance, transmittance, sigma_s, sigma_a) with g = 0, coefficients in 1/mm
ISOTROPIC = [
    (0.5148573445, 0.1959644572, 5, 0.1),
    (0.2252300673, 0.0217065282, 5, 0.9),
    (0.3990923512, 0.0156151639, 10, 0.5),
    (0.3137489626, 0.0043656791, 10, 0.9),
    (0.5367154511, 0.0166095575, 15, 0.3),
    (0.3720173012, 0.0013001216, 15, 0.9),
    (0.5037690166, 0.0028359058, 20, 0.5),
    (0.7412266710, 0.0279131919, 25, 0.1),
    (0.6094283922, 0.0051087136, 25, 0.3),
]
# (reflectance, transmittance, unscattered transmittance, sigma_s, sigma_a) with g = .9
FORWARD = [
    (0.1874440456, 0.5762005444, 0.005605926311, 5, 0.1),
    (0.0847130558, 0.3300887418, 0.003757762135, 5, 0.5),
    (0.0613533378, 0.2084620482, 0.002518901296, 5, 0.9),
    (0.1633374780, 0.2987243441, 3.092536535e-05, 10, 0.3),
    (0.0804450369, 0.1253744404, 1.69721833e-05, 10, 0.9),
    (0.1470102720, 0.1601621830, 1.706019072e-07, 15, 0.5),
    (0.3645806240, 0.3378902576, 1.714852987e-09, 20, 0.1),
]


def between_slides(medium):
    return Template([Interface(1.5), Interface(1.4), medium, Interface(1.5), Interface(1.0)])


def fluxes(reflectance, transmittance):
    return [Reflectance(values=reflectance, sigma=1e-4, mu_i=1.0), Transmittance(values=transmittance, sigma=1e-4,
                                                                                 mu_i=1.0)]


@pytest.mark.parametrize("case", ISOTROPIC)
def test_isotropic_samples_between_slides(case):
    """The values have errors of 3e-5, those of their quadrature."""
    reflectance, transmittance, sigma_s, sigma_a = case
    medium = Medium(sigma_s=Free(5.0, 0.01, 200.0, "s"), sigma_a=Free(0.5, 0.0, 20.0, "a"), thickness=1.0)
    fit = lamina.fit(fluxes(reflectance, transmittance), between_slides(medium))
    assert fit.values["s"] == pytest.approx(sigma_s, rel=3e-4)
    assert fit.values["a"] == pytest.approx(sigma_a, rel=3e-4)
    assert fit.chi_squared < 0.1


@pytest.mark.parametrize("case", FORWARD)
def test_forward_samples_between_slides(case):
    reflectance, transmittance, unscattered, sigma_s, sigma_a = case
    medium = Medium(sigma_s=Free(10.0, 0.01, 200.0, "s"), sigma_a=Free(0.5, 0.0, 20.0, "a"), thickness=1.0,
                    phase=HenyeyGreenstein(Free(0.7, -0.5, 0.96, "g")))
    measured = [*fluxes(reflectance, transmittance), Transmittance(values=unscattered, sigma=1e-7, relative=1e-3,
                                                                   mu_i=1.0, part="direct")]
    fit = lamina.fit(measured, between_slides(medium))
    assert fit.values["s"] == pytest.approx(sigma_s, rel=1e-3)
    assert fit.values["a"] == pytest.approx(sigma_a, rel=1e-3)
    assert fit.values["g"] == pytest.approx(0.9, abs=2e-4)


@pytest.mark.parametrize(("albedo", "g", "tau", "mu", "reflectance", "transmittance"), [
    (0.9, 0.75, 2.0, 1.0, 0.09739, 0.66096),
    (0.99, 0.0, 1.0, 0.5, 0.48652, 0.49163),
])
def test_slabs_of_van_de_hulst(albedo, g, tau, mu, reflectance, transmittance):
    """Multiple Light Scattering (1980) prints five digits: the answers are right within the errors of rounding."""
    rounding = 0.5e-5
    fit = lamina.fit(
        [Reflectance(values=reflectance, sigma=rounding, mu_i=mu), Transmittance(values=transmittance, sigma=rounding,
                                                                                 mu_i=mu)],
        Template([Medium(albedo=Free(0.5, 0.0, 1.0, "a"), tau=Free(5.0, 0.1, 50.0, "t"), phase=HenyeyGreenstein(g))]))
    assert abs(fit.values["a"] - albedo) < 3.0 * fit.errors["a"] < 1e-3
    assert abs(fit.values["t"] - tau) < 3.0 * fit.errors["t"] < 5e-3


def test_half_space_of_giovanelli():
    """Giovanelli (1955) prints .2600 for albedo .9 below an index of 1.5, specular reflection included."""
    fit = lamina.fit(Reflectance(values=0.2600, sigma=0.5e-4, mu_i=1.0),
                     Template([Interface(1.5)], HalfSpace(albedo=Free(0.5, 0.0, 1.0, "a"))))
    assert abs(fit.values["a"] - 0.9) < 3.0 * fit.errors["a"] < 1e-3
    assert math.isnan(fit.probability)
