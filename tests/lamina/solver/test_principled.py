# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers over a Principled base: against a walk from the viewer that shares no code with the solver's operators, and
limits in closed form. The base itself is compared with Cycles in tests/cycles/test_principled_law.py."""

import numpy as np
import pytest

import lamina
from lamina import HenyeyGreenstein, Interface, Lambert, Medium, PrincipledBase, Stack

PATHS = 120_000
# Two-sided quantile of 1 in 1000 for all comparisons of a case together.
Z = 4.2


class WhiteSky:
    """Walks from the viewer through one layer of medium over a surface under a sky of radiance 1. Their mean score is
    the directional albedo at the viewer's cosine."""

    def __init__(self, albedo, tau, g, surface, seed):
        self.albedo, self.tau, self.g, self.surface = albedo, tau, g, surface
        self.random = np.random.default_rng(seed)

    def albedo_at(self, mu):
        """(mean, standard error)."""
        depth, up = np.zeros(PATHS), np.full(PATHS, -mu)
        score, weight = np.zeros(PATHS), np.ones(PATHS)
        alive = np.arange(PATHS)
        for _ in range(400):
            depth[alive] -= up[alive] * self.random.exponential(size=alive.size)
            out, below = depth[alive] < 0.0, depth[alive] > self.tau
            score[alive[out]] = weight[alive[out]]
            ground = alive[below]
            depth[ground] = self.tau
            cosine, dphi = np.sqrt(self.random.random(ground.size)), self.random.random(ground.size) * 2.0 * np.pi
            weight[ground] *= np.pi * self.surface(-up[ground], np.maximum(cosine, 1e-9), dphi)
            up[ground] = cosine
            inside = alive[~out & ~below]
            weight[inside] *= self.albedo
            up[inside] = self._scattered(up[inside])
            alive = alive[~out]
            if alive.size == 0:
                break
        assert weight[alive].max(initial=0.0) < 1e-6
        return score.mean(), score.std() / np.sqrt(PATHS)

    def _scattered(self, up):
        """The cosine after scattering by Henyey and Greenstein's phase function."""
        x = self.random.random(up.size)
        part = (1.0 - self.g**2) / (1.0 - self.g + 2.0 * self.g * x)
        cosine = (1.0 + self.g**2 - part**2) / (2.0 * self.g)
        sines = np.sqrt(np.maximum(0.0, (1.0 - up**2) * (1.0 - cosine**2)))
        turned = up * cosine + sines * np.cos(2.0 * np.pi * self.random.random(up.size))
        return np.where(np.abs(turned) < 1e-9, 1e-9, turned)


@pytest.mark.parametrize("base", [
    PrincipledBase(color=0.8, metallic=1.0, roughness=0.7),
    PrincipledBase(color=0.6, roughness=0.6),
    PrincipledBase(color=0.9, metallic=0.5, roughness=0.9, specular=0.8),
], ids=["metal", "plastic", "half metal"])
def test_dust_over_the_base_agrees_with_a_walk_from_the_viewer(base):
    dust = {"albedo": 0.9, "tau": 0.6}
    bare = lamina.solve(Stack([], base))
    grid = np.linspace(0.01, 1.0, 48), np.linspace(0.0, np.pi, 33)
    table = bare.grid("reflect", grid[0], grid[0], grid[1])[..., 0]
    sky = WhiteSky(**dust, g=0.6, surface=lambda o, i, dphi: _read(table, grid, o, i, dphi), seed=3)
    solved = lamina.solve(Stack([Medium(**dust, phase=HenyeyGreenstein(0.6))], base))
    # The table of the surface is linear between its entries: its error in albedo is measured without a medium.
    for mu in (0.9, 0.5, 0.2):
        mean, error = sky.albedo_at(mu)
        assert abs(mean - solved.reflectance(mu)[0]) <= Z * error + 3e-3 * mean, (mu, mean, error)


def _read(table, grid, mu_o, mu_i, dphi):
    """Trilinear lookup."""
    places = []
    for axis, values in ((grid[0], mu_o), (grid[0], mu_i), (grid[1], np.pi - np.abs(np.pi - dphi))):
        place = np.clip((values - axis[0]) / (axis[1] - axis[0]), 0.0, len(axis) - 1.001)
        places.append((place.astype(int), place - place.astype(int)))
    total = 0.0
    for corner in np.ndindex(2, 2, 2):
        share = np.prod([part if up else 1.0 - part for up, (_, part) in zip(corner, places, strict=True)], axis=0)
        total = total + share * table[tuple(whole + up for up, (whole, _) in zip(corner, places, strict=True))]
    return total


def test_without_specular_reflection_the_base_is_a_lambert_surface():
    """Below an interface too, and where the indices of base and varnish are equal, which leaves no boundary."""
    dust = Medium(albedo=0.8, tau=0.7, phase=HenyeyGreenstein(0.3))
    for layers, base in (([dust], PrincipledBase(color=0.5, specular=0.0)),
                         ([Interface(ior=1.5), dust], PrincipledBase(color=0.5, ior=1.5))):
        one, other = (lamina.solve(Stack(layers, below)) for below in (base, Lambert(0.5)))
        mu = np.array([0.9, 0.4, 0.1])
        assert one.reflectance(mu) == pytest.approx(other.reflectance(mu), rel=2e-4)
        assert one.brdf(mu, 0.6, 0.4) == pytest.approx(other.brdf(mu, 0.6, 0.4), rel=2e-3)


def test_light_of_a_lobe_that_meets_a_varnish_keeps_its_energy():
    """Albedo from the flux, against the integral of values that hold lobes which meet the varnish and the base."""
    stack = Stack([Interface(ior=1.4, alpha=0.3)], PrincipledBase(color=0.7, metallic=1.0, roughness=0.6))
    solved = lamina.solve(stack)
    x, w = np.polynomial.legendre.leggauss(24)
    mu, weight = 0.5 * (x + 1.0), 0.5 * w
    phi, turns = 0.5 * np.pi * (x + 1.0), 0.5 * np.pi * w
    for mu_o in (0.8, 0.4):
        values = solved.grid("reflect", [mu_o], mu, phi)[0, :, :, 0]
        assert 2.0 * np.einsum("ij,i,i,j", values, mu, weight, turns) == pytest.approx(
            solved.reflectance(mu_o)[0], rel=3e-3)


def test_walks_refuse_the_base():
    stack = Stack([Medium(albedo=0.5, tau=0.5)], PrincipledBase())
    with pytest.raises(lamina.StackError, match="^base.kind = 'principled': must be 'lambert'"):
        lamina.estimate(stack, 0.5, 0.5, samples=10)
    stack = Stack([Medium(sigma_s=1.0, sigma_a=0.1, thickness=0.5)], PrincipledBase())
    for call in (lambda: lamina.searchlight(stack), lambda: lamina.estimate_searchlight(stack, samples=10)):
        with pytest.raises(lamina.StackError, match="^base.kind = 'principled': must be 'lambert'"):
            call()


@pytest.mark.parametrize("ior", [1.0, 1.3, 1.45])
def test_a_base_of_a_lower_index_than_varnish_reflects_no_more_than_it_gets(ior):
    """The law of Cycles would: its diffuse part leaves out the total reflection of the light's direction."""
    base = PrincipledBase(color=1.0, ior=ior, roughness=0.3, coat=0.5, coat_ior=1.2)
    found = lamina.solve(Stack([Interface(ior=1.5)], base), "preview").reflectance([1.0, 0.5, 0.2])
    assert found == pytest.approx(np.ones((3, 1)), abs=1e-3)
