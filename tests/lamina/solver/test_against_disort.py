# SPDX-License-Identifier: GPL-3.0-or-later
"""Random stacks against PythonicDISORT, and the standard slab against CDISORT: solvers by other people."""

import math

import numpy as np
import pytest
from disort_oracle import cdisort, pythonic, stack
from hypothesis import given, settings
from hypothesis import strategies as st

import lamina

# Fluxes differ by the errors of both discretisations, most for cosines below .1.
FLUX = 1e-5
# The solver's tolerance for cosines >= .05.
POINTWISE = 1e-3


def log_uniform(low, high):
    return st.floats(math.log(low), math.log(high)).map(math.exp)


PHASES = st.one_of(
    st.just(lamina.Isotropic()),
    st.just(lamina.Rayleigh()),
    st.floats(-0.6, 0.8).map(lamina.HenyeyGreenstein),
)
# PythonicDISORT takes albedos below 1 only.
ALBEDOS = st.one_of(st.floats(0.01, 0.99), log_uniform(1e-5, 1e-2).map(lambda x: 1.0 - x))
MEDIA = st.lists(st.tuples(ALBEDOS, log_uniform(1e-2, 20.0), PHASES), min_size=1, max_size=3)
BASES = st.one_of(st.none(), st.floats(0.0, 1.0))

reproducible = settings(max_examples=25, derandomize=True, deadline=None, database=None)


@reproducible
@given(media=MEDIA, reflectance=BASES, mu0=st.floats(0.1, 1.0))
def test_fluxes_of_random_stacks(media, reflectance, mu0):
    truth = pythonic(media, mu0, reflectance)
    solved = lamina.solve(stack(media, reflectance))
    assert solved.reflectance(mu0)[0] == pytest.approx(truth.reflectance, abs=FLUX)
    if reflectance is None:
        diffuse, direct = solved.transmittance(mu0, parts=True)
        assert diffuse[0] == pytest.approx(truth.diffuse, abs=FLUX)
        assert direct[0] == pytest.approx(truth.direct, rel=1e-9, abs=1e-300)


@reproducible
@given(media=MEDIA, reflectance=BASES, mu0=st.floats(0.05, 1.0), dphi=st.floats(0.0, math.pi))
def test_radiance_of_random_stacks(media, reflectance, mu0, dphi):
    # Viewed at the oracle's own nodes: it would have to interpolate between them.
    truth = pythonic(media, mu0, reflectance, streams=80)
    solved = lamina.solve(stack(media, reflectance))
    seen = truth.mu >= 0.05
    mu_o = truth.mu[seen]
    assert solved.brdf(mu_o, mu0, dphi)[:, 0] == pytest.approx(truth.brdf(dphi)[seen], rel=POINTWISE)
    if reflectance is None:
        expected = truth.btdf(dphi)[seen]
        assert solved.btdf(mu_o, mu0, dphi)[:, 0] == pytest.approx(expected, rel=POINTWISE, abs=1e-15)


@pytest.mark.parametrize("mu0", [0.1, 0.5, 0.95])
@pytest.mark.parametrize("reflectance", [None, 0.6])
def test_the_standard_slab_by_cdisort(mu0, reflectance):
    media = [(0.9, 2.0, lamina.HenyeyGreenstein(0.75))]
    mu, dphi = np.array([0.05, 0.2, 0.45, 0.7, 0.99]), np.array([0.0, 0.6, 2.0, math.pi])
    reflected, diffuse, brdf, btdf = cdisort(media, mu0, mu, dphi, streams=128, reflectance=reflectance)
    solved = lamina.solve(stack(media, reflectance))
    assert solved.reflectance(mu0)[0] == pytest.approx(reflected, abs=FLUX)
    assert solved.brdf(mu[:, None], mu0, dphi)[..., 0] == pytest.approx(brdf, rel=POINTWISE)
    if reflectance is None:
        assert solved.transmittance(mu0, parts=True)[0][0] == pytest.approx(diffuse, abs=FLUX)
        assert solved.btdf(mu[:, None], mu0, dphi)[..., 0] == pytest.approx(btdf, rel=POINTWISE)
