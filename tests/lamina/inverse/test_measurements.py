# SPDX-License-Identifier: GPL-3.0-or-later
"""Measurements: shapes, standard errors, and what is refused."""

import numpy as np
import pytest

import lamina
from lamina.measurements import Brdf, Profile, Reflectance, Transmittance


def test_shapes_and_errors():
    one = Brdf(values=[[1.0, 2.0, 3.0]] * 2, sigma=0.1, relative=[[0.1], [0.2]], mu_o=[0.5, 0.6], mu_i=1.0, dphi=0.0)
    assert one.values.shape == one.sigma.shape == (2, 3) and one.channels == 3 and one.mu_i.shape == (2,)
    assert one.relative.tolist() == [[0.1] * 3, [0.2] * 3]
    by_place = Reflectance(values=[0.1, 0.2], sigma=[0.01, 0.02], mu_i=[0.5, 1.0])
    assert by_place.sigma.tolist() == [[0.01], [0.02]] and by_place.label == "Reflectance, 2 values"
    diffuse = Transmittance(values=[0.1, 0.2, 0.3], sigma=[0.01, 0.02, 0.03], mu_i="diffuse")
    assert diffuse.values.shape == (1, 3) and diffuse.sigma.tolist() == [[0.01, 0.02, 0.03]]
    noise = Reflectance(values=[-0.001, 1.001], sigma=0.001, mu_i=[0.5, 1.0])  # dark and white, with noise
    assert noise.values[0, 0] == -0.001


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("sigma", [1e-100, 1e100])
def test_extreme_errors_can_be_fitted(sigma):
    """Errors further out gave warnings and errors of NumPy and SciPy."""
    fit = lamina.fit(Reflectance(values=[0.2, 0.3], sigma=sigma, mu_i=[0.5, 0.9]),
                     lamina.Template([], lamina.Lambert(lamina.Free(0.5, 0.0, 1.0, "r"))))
    assert np.isfinite(fit.chi_squared) and fit.errors["r"] == pytest.approx(sigma / 2**0.5)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("make", "message"), [
    (lambda: Reflectance(values=45.0, relative=0.01, mu_i=1.0), "must be at most 1; shares are not given in percent"),
    (lambda: Reflectance(values=-0.1, sigma=0.01, mu_i=1.0), "values hold -0.1 with sigma 0.01: must not be negative"),
    (lambda: Reflectance(values=np.nan, sigma=0.01, mu_i=1.0), "values holds a value that is not finite"),
    (lambda: Reflectance(values=0.1, mu_i=1.0), "sigma = 0: the standard error must be positive"),
    (lambda: Reflectance(values=[0.1, 0.0], relative=0.1, mu_i=[0.5, 1.0]), "sigma of the value 0 = 0"),
    (lambda: Reflectance(values=0.1, sigma=-1.0, mu_i=1.0), "sigma = -1: must not be negative"),
    (lambda: Reflectance(values=0.1, sigma=[0.1, 0.2], mu_i=1.0), "sigma has the shape"),
    (lambda: Reflectance(values=0.1, sigma=0.1, mu_i=45.0), "mu_i = 45: must be a cosine in"),
    (lambda: Reflectance(values=0.1, sigma=0.1, mu_i=0.0), "mu_i = 0: must lie in"),
    (lambda: Reflectance(values=0.1, sigma=0.1, mu_i="lambert"), "mu_i = 'lambert': must be a cosine"),
    (lambda: Reflectance(values=0.1, sigma=0.1, mu_i=1.0, part="all"), "part = 'all': must be one of total"),
    (lambda: Reflectance(values=0.1, sigma=0.1, mu_i=1.0, side="left"), "side = 'left'"),
    (lambda: Brdf(values=0.1, sigma=0.1, mu_o=1.0, mu_i=1.0, dphi=90.0), r"dphi = 90: .* are these degrees\?"),
    (lambda: Brdf(values=[0.1] * 3, sigma=0.1, mu_o=[1.0] * 2, mu_i=1.0, dphi=0.0), "values have the shape"),
    (lambda: Brdf(values=[0.1] * 3, sigma=0.1, mu_o=[1.0] * 2, mu_i=[1.0] * 3, dphi=0.0), "shapes must be equal"),
    (lambda: Reflectance(values=np.array([0.1 + 0.2j]), sigma=0.1, mu_i=[1.0]), "values = .*: must be a number or an"),
    (lambda: Reflectance(values=np.ma.array([0.1, 0.2], mask=[0, 1]), sigma=0.1, mu_i=[1.0, 0.5]),
     "values holds masked values: leave these out"),
    (lambda: Reflectance(values=[0.1, 0.2], sigma=[0.1, 1e-320], mu_i=[1.0, 0.5]),
     r"sigma of the value 0.2 = 9.*e-321: must lie in \[1e-100, 1e\+100\]"),
    (lambda: Reflectance(values=0.1, sigma=1e300, mu_i=1.0), r"sigma of the value 0.1 = 1e\+300: must lie in"),
    (lambda: Profile(values=0.1, sigma=0.1, r=0.0), "r = 0: must be larger than 0"),
    (lambda: Profile(values=[0.1] * 2, sigma=0.1, r=[1.0, 2.0], mu_i=[1.0, 1.0]), "mu_i has the shape"),
    (lambda: Profile(values=0.1, sigma=0.1, r=1.0, path="up"), "path = 'up'"),
    (lambda: Brdf(values=0.1, sigma=0.1, mu_o=1.0, mu_i=1.0, dphi=0.0, changes=3), "changes = 3: must be a dict of"),
])
def test_bad_input_gets_one_sentence(make, message):
    with pytest.raises(lamina.ArgumentError, match=message) as error:
        make()
    assert "\n" not in str(error.value)
