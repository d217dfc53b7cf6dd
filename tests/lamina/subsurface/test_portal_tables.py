# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of the portal: rays sampled from the tables reproduce the searchlight's profile on a plane."""

import functools
import math

import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import HenyeyGreenstein, Interface, Isotropic, Medium, Stack
from lamina.common.errors import StackError
from lamina.subsurface.portal import DEPTHS, WEIGHTS, once_scattered

COUNT = 400_000


def deep(albedos, phase, extinction=1.0):
    albedos = np.array(albedos)
    return Medium(sigma_s=extinction * albedos, sigma_a=extinction * (1.0 - albedos), thickness=np.inf, phase=phase)


STACKS = {
    "isotropic": Stack([deep([0.5, 0.9, 0.99], Isotropic())]),
    "skin": Stack([Interface(1.4), Medium(sigma_s=[3.0, 5.0, 9.0], sigma_a=[0.05, 0.3, 0.9], thickness=0.2,
                                          phase=HenyeyGreenstein(0.7)),
                   deep([0.98, 0.9, 0.8], HenyeyGreenstein(0.3), 2.0)]),
}


@functools.cache
def tables_of(name):
    return lamina.portal_tables(STACKS[name], "preview")


def drawn(tables, seed):
    """(distances, weights) of rays sampled like in the shader: random source and cosine, weight from the table."""
    rng = np.random.default_rng(seed)
    depth = tables.depths[rng.integers(0, DEPTHS, COUNT)]
    cosine = 1.0 - rng.random(COUNT)
    r = depth * np.sqrt(1.0 - cosine**2) / cosine
    place = r / (r + tables.scale)
    grid = np.linspace(0.0, 1.0, WEIGHTS)
    return r, np.stack([np.interp(place, grid, column) for column in tables.weights.T], axis=1)


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
        if name == "isotropic":
            exact = exact - [once_inside(radius, albedo) for albedo in (0.5, 0.9, 0.99)]
        assert np.all(np.abs(flux - exact) < limit * error + 5e-4 * beam.reflectance)


def once_inside(radius, albedo):
    """Once-scattered flux within a radius, in mean free paths, by quadrature of its density."""
    nodes, weights = np.polynomial.legendre.leggauss(400)
    r = 0.5 * radius * (nodes + 1.0)
    return np.sum(0.5 * radius * weights * 2.0 * math.pi * r * once_scattered(r, albedo))


def test_once_scattered_light():
    """The flux is a / 2 (1 - ln 2), and the density agrees with photons."""
    assert once_inside(60.0, 0.8) == pytest.approx(0.4 * (1.0 - math.log(2.0)), rel=1e-5)
    rng = np.random.default_rng(2)
    depth, cosine = rng.exponential(size=COUNT), 2.0 * rng.random(COUNT) - 1.0
    r = depth * np.sqrt(1.0 - cosine**2) / np.abs(cosine)
    left = np.where(cosine > 0.0, 0.8 * np.exp(-depth / np.abs(cosine)), 0.0)
    for radius in (0.2, 1.0, 3.0):
        inside = np.where(r < radius, left, 0.0)
        error = inside.std() / math.sqrt(COUNT)
        assert abs(inside.mean() - once_inside(radius, 0.8)) < z_limit(3) * error


def test_views():
    """Portal, single scattering and boundary add up to the directional albedo."""
    for name, stack in STACKS.items():
        tables = tables_of(name)
        cosines = np.linspace(0.0, 1.0, len(tables.views))[[40, 128, 255]]
        once = (1.0 - cosines * np.log1p(1.0 / cosines))[:, None] * tables.once
        exact = lamina.solve(stack).reflectance(cosines)
        mirrored = lamina.solve(Stack(stack.layers[:1])).reflectance(cosines) if tables.has_boundary else 0.0
        assert mirrored + (1.0 - mirrored) * (tables.views[[40, 128, 255]] + once) == pytest.approx(exact, rel=2e-3)


def test_which_light_stays_local():
    assert np.all(tables_of("skin").once == 0.0)
    assert tables_of("isotropic").once == pytest.approx([0.25, 0.45, 0.495])


def test_light_that_nothing_absorbs():
    with pytest.raises(StackError, match="leaves at an infinite mean distance"):
        lamina.portal_tables(Stack([deep([1.0], Isotropic())]), "preview")
