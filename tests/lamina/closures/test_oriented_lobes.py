# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes of anisotropic stacks: both implementations, their symmetries and their albedo."""

import numpy as np
import pytest

from lamina.closures import lobes, moving_lobes, oriented_lobes
from lamina.closures.closure_table import light_grid

HALF = light_grid(200, 160, 4.0)
MU, DPHI = HALF.mu, np.concatenate([-HALF.dphi[::-1], HALF.dphi])
SOLID_ANGLE = np.concatenate([HALF.solid_angle.reshape(200, 160)[:, ::-1], HALF.solid_angle.reshape(200, 160)], axis=1)


def random_shapes(count, seed):
    """Shapes whose normal is tilted by some .4 rad at most, views and azimuths."""
    rng = np.random.default_rng(seed)
    mu_o, turn = rng.uniform(0.15, 0.98, count), rng.uniform(0.0, np.pi, count)
    anisotropy = rng.uniform(0.0, 0.6, count)
    shapes = np.stack([rng.uniform(0.4, 0.8, count), anisotropy * np.cos(2 * turn), anisotropy * np.sin(2 * turn),
                       rng.uniform(-0.1, 0.3, count), rng.uniform(-0.3, 0.3, count)], axis=1)
    return shapes, mu_o, rng.uniform(0.0, np.pi, count)


def test_both_implementations_agree():
    shapes, mu_o, phi_o = random_shapes(40, 1)
    coarse = light_grid(12, 10)
    dphi = np.concatenate([-coarse.dphi, coarse.dphi])
    for shape, mu, phi in zip(shapes, mu_o, phi_o, strict=True):
        mine = oriented_lobes.sampled(shape[None], np.array([mu]), phi, coarse.mu, dphi)[0]
        theirs = oriented_lobes.values(shape, mu, coarse.mu[:, None], dphi, phi)
        assert mine == pytest.approx(theirs.ravel(), rel=1e-9, abs=1e-9)


def test_the_albedo_is_the_integral_of_the_values():
    shapes, mu_o, phi_o = random_shapes(30, 2)
    values = oriented_lobes.values(shapes[:, None, None], mu_o[:, None, None], MU[:, None], DPHI,
                                   phi_o[:, None, None])
    integral = 0.5 * np.einsum("kij,ij->k", values, SOLID_ANGLE)
    assert oriented_lobes.albedos(shapes, mu_o, phi_o) == pytest.approx(integral, rel=5e-3)


@pytest.mark.parametrize(("anisotropy", "phi_o"), [(0.4, 0.0), (-0.3, 0.0), (0.4, np.pi / 2)])
def test_in_the_plane_of_incidence_it_is_a_moving_lobe(anisotropy, phi_o):
    along = anisotropy if phi_o == 0.0 else -anisotropy  # the lobe's tangent is then across the layer's
    mine = oriented_lobes.values([0.5, along, 0.0, 0.2, 0.0], 0.6, MU[::20, None], DPHI[::20], phi_o)
    theirs = moving_lobes.values([0.5, anisotropy, 0.2], 0.6, MU[::20, None], DPHI[::20])
    assert mine == pytest.approx(theirs, rel=1e-9, abs=1e-12)


def test_half_a_turn_changes_nothing_and_mirrors_change_signs():
    shapes, mu_o, phi_o = random_shapes(10, 3)
    one = oriented_lobes.values(shapes, mu_o, 0.5, 2.0, phi_o)
    assert oriented_lobes.values(shapes, mu_o, 0.5, 2.0, phi_o + np.pi) == pytest.approx(one)
    mirrored = shapes * [1.0, 1.0, -1.0, 1.0, -1.0]
    assert oriented_lobes.values(mirrored, mu_o, 0.5, -2.0, -phi_o) == pytest.approx(one)


def test_the_values_need_a_shape():
    with pytest.raises(ValueError, match="oriented_lobes.values"):
        lobes.by_id("oriented:0").evaluate(0.5, 0.5, 0.0)
