# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of the portal: rays sampled from the tables reproduce the searchlight's profile on a plane."""

import functools
import math

import numpy as np
import pytest
from half_space_photons import flights, turned_cosine
from z_limit import z_limit

import lamina
from lamina import HenyeyGreenstein, Interface, Isotropic, Medium, Stack, lobes
from lamina.common.errors import ArgumentError, StackError
from lamina.subsurface import entry_lobes, first_orders, plane_rings, single_scattering, source_depths
from lamina.subsurface.portal import DEPTHS, WEIGHTS

COUNT = 400_000


def deep(albedos, phase, extinction=1.0):
    albedos = np.array(albedos)
    return Medium(sigma_s=extinction * albedos, sigma_a=extinction * (1.0 - albedos), thickness=np.inf, phase=phase)


STACKS = {
    "isotropic": Stack([deep([0.5, 0.9, 0.99], Isotropic())]),
    "forward": Stack([deep([0.5, 0.9, 0.99], HenyeyGreenstein(0.8))]),
    "skin": Stack([Interface(1.4), Medium(sigma_s=[3.0, 5.0, 9.0], sigma_a=[0.05, 0.3, 0.9], thickness=0.2,
                                          phase=HenyeyGreenstein(0.7)),
                   deep([0.98, 0.9, 0.8], HenyeyGreenstein(0.3), 2.0)]),
}


@functools.cache
def tables_of(name):
    return lamina.portal_tables(STACKS[name], "preview")


def drawn(tables, seed):
    """(distances, weights) of rays sampled like in the shader: random source and cosine, weight from the tables. Rays
    below the horizon do not reach the plane."""
    rng = np.random.default_rng(seed)
    source = rng.integers(0, DEPTHS, COUNT)
    depth = tables.depths[source]
    chance = rng.random(COUNT)
    cosine = 1.0 - (1.0 - tables.least_cosine) * chance if tables.weighted_at_exit else np.sqrt(1.0 - chance)
    way = depth / np.where(cosine > 0.0, cosine, 1e-9)
    r = way * np.sqrt(1.0 - cosine**2)
    place = r / (r + tables.scale)
    grid = np.linspace(0.0, 1.0, WEIGHTS)
    weights = np.stack([np.interp(place, grid, column) for column in tables.weights.T], axis=1)
    fall = (1.0 + tables.decay * way[:, None]) * np.exp(-tables.decay * (way - depth)[:, None])
    above = np.where(cosine > 0.0, 1.0 - tables.least_cosine, 0.0)
    return r, weights * tables.shares[source] * fall * above[:, None]


@pytest.mark.parametrize("name", STACKS)
def test_profile_on_a_plane(name):
    stack = STACKS[name]
    tables = tables_of(name)
    beam = lamina.searchlight(stack, quality="preview")
    r, weights = drawn(tables, 1)
    through = tables.views[-1] * (1.0 - beam.mirrored)
    limit = z_limit(24)
    for radius in np.quantile(r, [0.1, 0.4, 0.7, 0.95]):
        values = np.where((r < radius)[:, None], weights, 0.0)
        flux, error = through * values.mean(axis=0), through * values.std(axis=0) / math.sqrt(COUNT)
        exact = beam.reflected_inside(radius) - beam.mirrored
        if tables.first is not None:
            exact = exact - inside(tables.first, radius)
        # At quality "preview" the searchlight errs by up to 1e-4 of the incident flux.
        assert np.all(np.abs(flux - exact) < limit * error + np.minimum(1e-4, 5e-4 * beam.reflectance + 2e-5))


def inside(first, radius):
    """Flux of the first orders within a radius, by quadrature of the density."""
    return quadrature(radius, lambda r: np.stack([first.density(r, c) for c in range(len(first.medium.sigma_s))]))


def once_inside(radius, albedo, g=0.0):
    """Once-scattered flux within a radius, in mean free paths, by quadrature of its density."""
    return quadrature(radius, lambda r: single_scattering.flux_density(r, albedo, g))


def quadrature(radius, density):
    nodes, weights = np.polynomial.legendre.leggauss(400)
    r = 0.5 * radius * (nodes + 1.0)
    return density(r) @ (0.5 * radius * weights * 2.0 * math.pi * r)


@pytest.mark.parametrize("g", [0.0, 0.8, -0.5])
def test_once_scattered_light(g):
    """The density agrees with photons; for isotropic scattering the flux is a / 2 (1 - ln 2)."""
    rng = np.random.default_rng(2)
    depth, cosine = rng.exponential(size=COUNT), -turned_cosine(g, rng.random(COUNT))  # cosine with the way out
    r = depth * np.sqrt(1.0 - cosine**2) / np.abs(cosine)
    left = np.where(cosine > 0.0, 0.8 * np.exp(-depth / np.abs(cosine)), 0.0)
    for radius in (0.2, 1.0, 3.0):
        inside = np.where(r < radius, left, 0.0)
        error = inside.std() / math.sqrt(COUNT)
        assert abs(inside.mean() - once_inside(radius, 0.8, g)) < z_limit(9) * error
    if g == 0.0:
        assert once_inside(60.0, 0.8) == pytest.approx(0.4 * (1.0 - math.log(2.0)), rel=1e-5)


@pytest.mark.parametrize("g", [0.0, 0.8, -0.5])
def test_once_scattered_light_by_angle(g):
    """Against photons that enter at an angle."""
    rng = np.random.default_rng(3)
    for mu in (0.1, 0.5, 1.0):
        turned, azimuth = turned_cosine(g, rng.random(COUNT)), 2.0 * math.pi * rng.random(COUNT)
        up = -mu * turned + math.sqrt(1.0 - mu * mu) * np.sqrt(1.0 - turned**2) * np.cos(azimuth)
        depth = mu * rng.exponential(size=COUNT)
        left = np.where(up > 0.0, np.exp(-depth / np.maximum(up, 1e-12)), 0.0)
        error = left.std() / math.sqrt(COUNT)
        share = single_scattering.reflected_share(np.array([mu]), g)[0]
        assert abs(left.mean() - share) < z_limit(9) * error


@pytest.mark.parametrize(("g", "count"), [(0.0, 4), (0.8, 14), (-0.5, 4)])
def test_first_orders_against_photons(g, count):
    """All orders together within three distances, and each order's flux, at normal and oblique incidence."""
    rng, albedo, limit = np.random.default_rng(4), 0.9, z_limit(9 + 2 * (4 + 14 + 4))
    media = [single_scattering.SingleScattering(np.array([a]), np.array([1.0 - a]), g) for a in (albedo, 1.0)]
    for mu in (0.3, 1.0):
        order, distance = np.zeros(COUNT, int), np.zeros(COUNT)
        for scatterings, (left, way, *_) in enumerate(flights(mu, g, COUNT, count, rng)):
            order[left], distance[left] = scatterings, way
        weight = np.where(order > 0, albedo**order, 0.0)
        if mu == 1.0:
            for radius in (0.3, 2.0, 8.0):
                near = np.where(distance < radius, weight, 0.0)
                flux = inside(first_orders.FirstOrders(media[0], count), radius)[0]
                assert abs(near.mean() - flux) < limit * near.std() / math.sqrt(COUNT) + 1e-4 * weight.mean()
        for n in range(1, count + 1):
            up_to = [first_orders.FirstOrders(media[1], k).reflectance(np.array([mu]))[0, 0] for k in (n, n - 1) if k]
            share = up_to[0] - sum(up_to[1:])
            assert abs(np.mean(order == n) - share) < limit * math.sqrt(share / COUNT) + 1e-5


@pytest.mark.parametrize("g", [0.0, 0.8])
def test_first_orders_of_a_dark_medium(g):
    """Against the solver, where all further orders together are below 1e-5."""
    albedo, mu = 0.3, np.array([0.02, 0.1, 0.5, 1.0])
    medium = single_scattering.SingleScattering(np.array([albedo]), np.array([1.0 - albedo]), g)
    exact = lamina.solve(Stack([deep([albedo], HenyeyGreenstein(g) if g else Isotropic())])).reflectance(mu)
    assert first_orders.FirstOrders(medium, 9).reflectance(mu) == pytest.approx(exact, rel=1e-3, abs=1e-5)


def test_number_of_orders():
    """The number grows with the transport mean free path, up to a limit. Above g = .9 it is 1."""
    counts = [first_orders.count_for(g) for g in (-0.5, 0.0, 0.3, 0.5, 0.8, 0.9, 0.95)]
    assert counts == [2, 2, 4, 6, 14, 14, 1]


def test_the_furnace():
    """The orders of the volume and the light through the portal are the searchlight's, and the density of the orders
    has their flux."""
    for name in ("isotropic", "forward"):
        tables, beam = tables_of(name), lamina.searchlight(STACKS[name], quality="preview")
        orders = tables.first.reflectance(np.ones(1))[0]
        assert tables.views[-1] + orders == pytest.approx(beam.reflectance, rel=2e-3)
        assert inside(tables.first, 60.0 / tables.first.medium.extinction.min()) == pytest.approx(orders, rel=2e-3)
        r = plane_rings.distances(tables.scale, 2000)[100:1700:100]  # without the ends, where a profile is inexact
        through = beam.profile(r) - np.stack([tables.first.density(r, c) for c in range(3)], axis=1)
        assert np.all(through > -0.03 * beam.profile(r))  # the error of a profile at quality "preview"


def test_views():
    """Portal, first orders and boundary add up to the directional albedo."""
    for name, stack in STACKS.items():
        tables = tables_of(name)
        cosines = np.linspace(0.0, 1.0, len(tables.views))[[40, 128, 255]]
        orders = 0.0 if tables.first is None else tables.first.reflectance(cosines)
        exact = lamina.solve(stack).reflectance(cosines)
        mirrored = lamina.solve(Stack(stack.layers[:1])).reflectance(cosines) if tables.has_boundary else 0.0
        assert mirrored + (1.0 - mirrored) * (tables.views[[40, 128, 255]] + orders) == pytest.approx(exact, rel=2e-3)


def test_directions_of_entry():
    """The closures follow the light that enters by direction, and reflect all light together. The Toon closure is left
    out where the error of the Diffuse closure alone is less than 3 % of all light."""
    for name, stack in STACKS.items():
        tables, mu = tables_of(name), entry_lobes.COSINES
        entering = everything = lamina.solve(stack).reflectance(mu)
        if tables.has_boundary:
            entering = entering - lamina.solve(Stack(stack.layers[:1])).reflectance(mu)
        if tables.first is not None:
            entering = entering - tables.first.reflectance(mu)
        weights = 0.5 * np.polynomial.legendre.leggauss(len(mu))[1]
        cone = lobes.toon(tables.entry.size, tables.entry.smooth).evaluate(np.ones_like(mu), mu, np.zeros_like(mu))
        found = tables.entry.diffuse * mu[:, None] / math.pi + tables.entry.toon * cone[:, None]
        assert 2.0 * math.pi * weights @ found == pytest.approx(np.ones(3), abs=1e-9)
        lit = entering.mean(axis=0) > 1e-4  # the albedo of .5 sends hardly any light through the portal after 14 orders
        assert np.array_equal(lit, [name != "forward", True, True])
        assert tables.entry.diffuse[~lit] == pytest.approx(1.0)
        found, entering = found[:, lit], entering[:, lit]
        wanted = entering * mu[:, None] / (2.0 * math.pi * weights @ (entering * mu[:, None]))
        error = np.sqrt(np.max(weights @ (found - wanted) ** 2 / (weights @ wanted**2)))
        lambert = np.sqrt(weights @ (mu[:, None] / math.pi - wanted) ** 2 / (weights @ wanted**2))
        share = (weights * mu) @ entering / ((weights * mu) @ everything[:, lit])
        assert np.any(tables.entry.toon) == (name != "isotropic") == (np.max(lambert * share) > 0.03)
        assert error < max(0.6 * lambert.max(), 0.01) or name == "isotropic", name
        assert error == pytest.approx(tables.entry.error, abs=1e-3)


def test_what_the_volume_scatters():
    assert tables_of("skin").first is None
    for name, g, count in (("isotropic", 0.0, 2), ("forward", 0.8, 14)):
        first = tables_of(name).first
        medium = first.medium
        assert medium.sigma_s == pytest.approx([0.5, 0.9, 0.99]) and medium.sigma_a == pytest.approx([0.5, 0.1, 0.01])
        assert medium.g == g and first.count == count
        assert f"scattered up to {count} times in the volume" in tables_of(name).report
    thin = Medium(sigma_s=1.0, sigma_a=0.1, thickness=2.0)
    colourful = deep([0.9, 0.9, 0.8], HenyeyGreenstein([0.1, 0.2, 0.3]))
    for stack in (Stack([thin], base=lamina.Lambert(0.5)), Stack([colourful])):
        assert first_orders.of_stack(stack) is None


def test_a_chosen_number_of_scatterings():
    """What the volume no longer computes goes through the portal: the sum is the same for each number."""
    stack, cosines = Stack([deep([0.9], HenyeyGreenstein(0.5), 1.0)]), np.linspace(0.0, 1.0, 256)[64:]
    sums = []
    for count in (1, 3):
        tables = lamina.portal_tables(stack, "preview", scatterings=count)
        assert tables.first.count == count
        sums.append(tables.views[64:] + tables.first.reflectance(cosines))
    assert sums[0] == pytest.approx(sums[1], rel=2e-3)
    assert first_orders.of_stack(Stack([deep([0.9], HenyeyGreenstein(0.95), 1.0)]), 5).count == 1
    for bad in (0, 15, 2.5, True):
        with pytest.raises(ArgumentError, match="scatterings = .*: must be a whole number from 1 to 14, or None"):
            lamina.portal_tables(stack, "preview", scatterings=bad)


def test_light_that_nothing_absorbs():
    with pytest.raises(StackError, match="leaves at an infinite mean distance"):
        lamina.portal_tables(Stack([deep([1.0], Isotropic())]), "preview")


def test_sources_of_a_decaying_profile():
    """A mixture of sources in an absorbing medium is found again, with the medium's decay."""
    r = plane_rings.distances(1.0, 8 * WEIGHTS)
    given = np.array([[0.4, 1.5], [0.2, 0.9]])  # depths by channel
    light = np.stack([source_depths.flux_density(z, r, k).mean(axis=1) for z, k in zip(given, (0.5, 1.0), strict=True)],
                     axis=1)
    found = source_depths.fit(r, light, DEPTHS)
    assert found.decay == pytest.approx([0.5, 1.0], rel=0.15)
    assert found.shares.mean(axis=0) == pytest.approx([1.0, 1.0])
    for c in range(2):
        shown = source_depths.flux_density(found.depths, r, found.decay[c]) @ found.shares[:, c] / DEPTHS
        apart = plane_rings.within(r, (shown - light[:, c])[:, None])
        assert np.max(np.abs(apart)) < 0.01


def test_black_channel():
    """A channel without reflected light has weights of 0, and no effect on the others."""
    tables = lamina.portal_tables(Stack([Interface(1.4), deep([0.9, 0.9, 0.0], Isotropic())]), "preview")
    assert np.all(np.isfinite(tables.weights)) and np.all(np.isfinite(tables.shares))
    assert not np.any(tables.weights[:, 2]) and not tables.decay[2]
    assert tables.weights[:, 0] == pytest.approx(tables.weights[:, 1])
    assert tables.entry.diffuse[2] == pytest.approx(1.0) and np.all(np.isfinite(tables.entry.toon))
