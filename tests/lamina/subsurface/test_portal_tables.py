# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of the portal: rays sampled from the tables reproduce the searchlight's profile on a plane."""

import functools
import math

import numpy as np
import pytest
import sphere_photons
from half_space_photons import flights, turned_cosine
from portal_rays import COUNT, drawn
from z_limit import z_limit

import lamina
from lamina import HalfSpace, HenyeyGreenstein, Interface, Isotropic, Lambert, Medium, Stack, lobes
from lamina.common.errors import ArgumentError, StackError
from lamina.subsurface import entry_lobes, exit_tilt, first_orders, plane_rings, single_scattering, source_depths
from lamina.subsurface.portal import DEPTHS, NODES, VIEWS


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


@pytest.mark.parametrize("name", STACKS)
def test_profile_on_a_plane(name):
    stack = STACKS[name]
    tables = tables_of(name)
    beam = lamina.searchlight(stack, quality="preview")
    r, weights, _ = drawn(tables, 1)
    through = tables.views[-1] * (1.0 - beam.mirrored)
    limit = z_limit(24)
    for radius in np.quantile(r, [0.1, 0.4, 0.7, 0.95]):
        values = np.where((r < radius)[:, None], weights, 0.0)
        flux, error = through * values.mean(axis=0), through * values.std(axis=0) / math.sqrt(COUNT)
        exact = beam.reflected_inside(radius) - beam.mirrored
        if tables.first is not None:
            exact = exact - inside(tables.first, radius)
        allowed = tables.profile_error * (beam.reflectance - beam.mirrored)
        # At quality "preview" the searchlight errs by up to 1e-4 of the incident flux.
        assert np.all(np.abs(flux - exact) < limit * error + allowed + 1e-4)
    # After many scatterings hardly any light leaves near the entry, which no mixture of sources can show.
    assert tables.profile_error < (0.012 if name == "forward" else 0.002)


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
    assert counts == [1, 1, 2, 4, 14, 14, 1]


def test_the_furnace():
    """The orders of the volume and the light through the portal are the searchlight's, and the density of the orders
    has their flux."""
    for name in ("isotropic", "forward"):
        tables, beam = tables_of(name), lamina.searchlight(STACKS[name], quality="preview")
        orders = tables.first.reflectance(np.ones(1))[0]
        assert tables.views[-1] + orders == pytest.approx(beam.reflectance, rel=2e-3)
        assert inside(tables.first, 60.0 / tables.first.medium.extinction.min()) == pytest.approx(orders, rel=2e-3)
        # Without the ends, where a profile is inexact.
        r = plane_rings.distances(float(np.median(tables.distance)), 2000)[100:1700:100]
        through = beam.profile(r) - np.stack([tables.first.density(r, c) for c in range(3)], axis=1)
        assert np.all(through > -0.03 * beam.profile(r))  # the error of a profile at quality "preview"


def test_views():
    """Portal, first orders and boundary add up to the directional albedo."""
    for name, stack in STACKS.items():
        tables = tables_of(name)
        cosines = np.linspace(0.0, 1.0, VIEWS)[[10, 32, 63]]
        orders = 0.0 if tables.first is None else tables.first.reflectance(cosines)
        exact = lamina.solve(stack).reflectance(cosines)
        mirrored = lamina.solve(Stack(stack.layers[:1])).reflectance(cosines) if tables.has_boundary else 0.0
        assert mirrored + (1.0 - mirrored) * (tables.views[[10, 32, 63]] + orders) == pytest.approx(exact, rel=2e-3)


def test_directions_of_entry():
    """The closures follow the light that enters by direction, and reflect all light together. The Toon closure is left
    out where the error of the Diffuse closure alone is less than 2 % of all light."""
    for name, stack in STACKS.items():
        tables, mu = tables_of(name), entry_lobes.COSINES
        entering = everything = lamina.solve(stack).reflectance(mu)
        if tables.has_boundary:
            entering = entering - lamina.solve(Stack(stack.layers[:1])).reflectance(mu)
        if tables.first is not None:
            entering = entering - tables.first.reflectance(mu)
        weights = 0.5 * np.polynomial.legendre.leggauss(len(mu))[1]
        flat = tilted(tables, mu)
        cone = lobes.toon(tables.entry.size, tables.entry.smooth).evaluate(np.ones_like(mu), mu, np.zeros_like(mu))
        found = tables.entry.diffuse * flat + tables.entry.toon * cone[:, None]
        noise = 1e-9 if tables.tilt == 0.0 else 2e-3  # of the rays whose directions tilt the closure
        assert 2.0 * math.pi * weights @ found == pytest.approx(np.ones(3), abs=noise)
        lit = entering.mean(axis=0) > 1e-4  # the albedo of .5 sends hardly any light through the portal after 14 orders
        assert np.array_equal(lit, [name != "forward", True, True])
        found, entering = found[:, lit], entering[:, lit]
        wanted = entering * mu[:, None] / (2.0 * math.pi * weights @ (entering * mu[:, None]))
        error = np.sqrt(np.max(weights @ (found - wanted) ** 2 / (weights @ wanted**2)))
        flat /= 2.0 * math.pi * weights @ flat
        alone = np.sqrt(weights @ (flat[:, lit] - wanted) ** 2 / (weights @ wanted**2))
        share = (weights * mu) @ entering / ((weights * mu) @ everything[:, lit])
        assert np.any(tables.entry.toon) == (np.max(alone * share) > 0.02)
        assert error < max(0.6 * alone.max(), 0.01), name
        assert error == pytest.approx(tables.entry.error, abs=1e-3)


def tilted(tables, mu):
    """The Diffuse closure times the cosine, for light at the cosines `mu`, shape (mu, channels): its normal leans along
    the rays. The mean over rays that hit a plane, and over azimuths."""
    _, weights, sine = (values[:20000] for values in drawn(tables, 2))
    lean = tables.tilt * sine[:, None] * np.cos((np.arange(16) + 0.5) * math.pi / 16)
    over = weights / weights.sum(axis=0) / (math.pi * np.sqrt(1.0 + (tables.tilt * sine[:, None]) ** 2))
    return np.array([np.mean(np.maximum(m + lean * math.sqrt(1.0 - m * m), 0.0), axis=1) @ over for m in mu])


@pytest.mark.parametrize("g", [0.0, 0.8])
def test_light_leans_away_from_its_entry(g):
    """The mean direction of photons by the number of scatterings, in a sphere as wide as a plane. The formula is
    within 9 %; for g .8 within 25 %."""
    radius, off = 1e4, 0.09 if g == 0.0 else 0.25
    for order, (place, way) in enumerate(sphere_photons.exits(radius, g, COUNT, 60, np.random.default_rng(6))):
        if order in (1, 4, 12, 30, 60) and order * (1.0 - g) > 1.0 - 1e-9:
            outwards = np.sum(place[:, :2] * way[:, :2], axis=1) / np.hypot(place[:, 0], place[:, 1])
            found = outwards.mean() / way[:, 2].mean()
            error = outwards.std() / way[:, 2].mean() / math.sqrt(len(way))
            assert abs(found - exit_tilt.tangent(np.array([order]), g)[0]) < off * found + z_limit(9) * error


@pytest.mark.parametrize(("radius", "off"), [(33.0, 0.015), (10.0, 0.095)])
def test_a_sphere_under_a_white_sky(radius, off):
    """Light that was scattered more than once, seen along the normal, by photons and by rays of the portal. A sphere of
    ten mean free paths is 17 % brighter than a plane, of which the portal shows 6 %."""
    albedo = 0.9
    tables = lamina.portal_tables(Stack([deep([albedo], Isotropic())]), "preview")
    sky = [len(way) * albedo**order / COUNT for order, (_, way) in
           enumerate(sphere_photons.exits(radius, 0.0, COUNT, 150, np.random.default_rng(7)))]
    _, weights, _ = drawn(tables, 3, radius)
    portal, error = tables.views[-1, 0] * weights.mean(), tables.views[-1, 0] * weights.std() / math.sqrt(COUNT)
    photons = sum(sky[2:])
    assert photons > 1.03 * tables.views[-1, 0]  # brighter than a plane
    assert abs(portal - photons) < off * photons + z_limit(2) * (error + math.sqrt(photons / COUNT))


def test_light_of_a_source_in_a_sphere():
    """The density that the rays show follows the series for a source in a sphere with an absorbing surface: exact
    without absorption, else within 10 %, for half of the light."""
    z, radius = 0.2, 1.0
    for decay in (0.0, 3.0, 8.0):
        angle = np.array([0.02, 0.1, 0.2, 0.3])
        t = np.sqrt(z * z + (1.0 - z) * 4.0 * np.sin(0.5 * angle) ** 2)
        u, h = z * (1.0 - 0.5 * z), 0.5 * (t * t + z * (2.0 - z))
        shown = (u + decay * t * np.sqrt(u * h)) * np.exp(-decay * (t - z)) / (2.0 * math.pi * t**3)
        exact = source_in_a_sphere(radius - z, decay, angle) * math.exp(decay * z)
        assert shown == pytest.approx(exact, rel=0.1 if decay else 1e-6), decay


def source_in_a_sphere(rho, decay, angle):
    """Flux density on a sphere of radius 1, from a unit source at the distance `rho` from the centre, in a diffusing
    medium: sum over l of (2 l + 1) / (4 pi) times i_l(k rho) / i_l(k) P_l. The ratio by downward recurrence of
    i_(l + 1) / i_l."""
    count = 400

    def growth(x):
        ratios, ratio = np.zeros(count), 0.0
        for order in range(count + 100, -1, -1):
            ratio = 1.0 / ((2.0 * order + 3.0) / x + ratio)
            if order < count:
                ratios[order] = ratio
        return ratios

    if decay == 0.0:
        parts = rho ** np.arange(count + 1)
    else:
        first = math.sinh(decay * rho) / rho / math.sinh(decay)
        parts = first * np.cumprod(np.concatenate([[1.0], growth(decay * rho) / growth(decay)]))
    return np.polynomial.legendre.legval(np.cos(angle), (2 * np.arange(count + 1) + 1) / (4.0 * math.pi) * parts)


def test_what_the_volume_scatters():
    assert tables_of("skin").first is None
    for name, g, count in (("isotropic", 0.0, 1), ("forward", 0.8, 14)):
        first = tables_of(name).first
        medium = first.medium
        assert medium.sigma_s == pytest.approx([0.5, 0.9, 0.99]) and medium.sigma_a == pytest.approx([0.5, 0.1, 0.01])
        assert medium.g == g and first.count == count
        times = "once" if count == 1 else f"up to {count} times"
        assert f"scattered {times} in the volume" in tables_of(name).report
    thin = Medium(sigma_s=1.0, sigma_a=0.1, thickness=2.0)
    colourful = deep([0.9, 0.9, 0.8], HenyeyGreenstein([0.1, 0.2, 0.3]))
    for stack in (Stack([thin], base=lamina.Lambert(0.5)), Stack([colourful])):
        assert first_orders.of_stack(stack) is None


def test_a_chosen_number_of_scatterings():
    """What the volume no longer computes goes through the portal: the sum is the same for each number."""
    stack, cosines = Stack([deep([0.9], HenyeyGreenstein(0.5), 1.0)]), np.linspace(0.0, 1.0, VIEWS)[16:]
    sums = []
    for count in (1, 3):
        tables = lamina.portal_tables(stack, "preview", scatterings=count)
        assert tables.first.count == count
        sums.append(tables.views[16:] + tables.first.reflectance(cosines))
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
    r = plane_rings.distances(1.0, NODES)
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
    """A channel without reflected light has views of 0, and no effect on the others."""
    tables = lamina.portal_tables(Stack([Interface(1.4), deep([0.9, 0.9, 0.0], Isotropic())]), "preview")
    assert np.all(np.isfinite(tables.depths)) and np.all(np.isfinite(tables.shares))
    assert not np.any(tables.views[:, 2]) and not tables.decay[2]
    assert tables.shares[..., 0] == pytest.approx(tables.shares[..., 1])
    assert tables.entry.diffuse[2] == pytest.approx(1.0) and np.all(np.isfinite(tables.entry.toon))


@pytest.mark.parametrize(("stack", "words"), [
    (Stack([], HalfSpace(albedo=0.9)), "base: has no lengths"),
    (Stack([], HalfSpace(sigma_s=0.0, sigma_a=1.0)), "no light travels sideways"),
    (Stack([Interface(1.4)], Lambert(0.5)), "no light travels sideways"),
])
def test_nothing_sideways(stack, words):
    with pytest.raises(StackError, match=words):
        lamina.portal_tables(stack, "preview")
