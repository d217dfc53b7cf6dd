# SPDX-License-Identifier: GPL-3.0-or-later
"""Invariances: exchanged directions, reversed stacks, split layers, other descriptions of the same medium."""

import math

import numpy as np
import pytest

import lamina
from lamina import Black, HalfSpace, HenyeyGreenstein, Isotropic, Lambert, Medium, Rayleigh, Stack

MU = np.array([0.05, 0.0713, 0.2, 0.45, 0.7, 0.95, 1.0])
DPHI = np.array([0.0, 0.3, 1.4, 2.6, math.pi])
COAT = Medium(albedo=[0.95, 0.6, 1.0], tau=0.5, phase=HenyeyGreenstein(0.75))
MIST = Medium(albedo=0.8, tau=0.02, phase=Rayleigh())
BODY = Medium(albedo=0.99, tau=[1.0, 8.0, 3.0], phase=HenyeyGreenstein(-0.4))
SHEET = Stack([COAT, MIST, BODY])


def grids(stack, side="top"):
    solved = lamina.solve(stack)
    return {path: solved.grid(path, MU, MU, DPHI, side=side) for path in ("reflect", "transmit")}


def assert_same(left, right, rel, floor=0.0):
    for path in left:
        assert left[path] == pytest.approx(right[path], rel=rel, abs=floor), path


@pytest.mark.parametrize("stack", [Stack([COAT]), SHEET, Stack([COAT, MIST], base=Lambert(0.5)),
                                   Stack([MIST], base=HalfSpace(0.95, HenyeyGreenstein(0.6)))],
                         ids=["slab", "three layers", "on Lambert", "on a half-space"])
def test_reciprocity(stack):
    solved = lamina.solve(stack)
    sides = ("top", "bottom") if stack.base is None else ("top",)
    for side in sides:
        brdf = solved.grid("reflect", MU, MU, DPHI, side=side)
        assert brdf == pytest.approx(brdf.swapaxes(0, 1), rel=1e-9)
        # Also point by point, for both kinds of lookup.
        assert solved.brdf(0.3, 0.8, 1.0, side) == pytest.approx(solved.brdf(0.8, 0.3, 1.0, side), rel=1e-12)
    if stack.base is None:
        down, up = (solved.grid("transmit", MU, MU, DPHI, side=side) for side in ("top", "bottom"))
        assert down == pytest.approx(up.swapaxes(0, 1), rel=1e-9)


def test_total_fluxes_are_reciprocal():
    """The diffuse transmittance of a sheet is the same both ways, whatever its layers."""
    solved = lamina.solve(SHEET)
    assert solved.transmittance("diffuse") == pytest.approx(solved.transmittance("diffuse", side="bottom"), rel=1e-12)


def test_from_below_is_the_reversed_stack_from_above():
    reversed_stack = Stack(SHEET.layers[::-1])
    assert_same(grids(SHEET, "bottom"), grids(reversed_stack), rel=1e-9)
    here, there = lamina.solve(SHEET), lamina.solve(reversed_stack)
    for mu0 in (MU, "diffuse"):
        assert here.reflectance(mu0, "bottom") == pytest.approx(there.reflectance(mu0), rel=1e-9)
        assert here.transmittance(mu0, "bottom") == pytest.approx(there.transmittance(mu0), rel=1e-9)


@pytest.mark.parametrize("parts", [(1.0, 1.0), (0.3, 1.7), (0.2, 0.5, 1.3), (1e-3, 1.999), (1e-5, 1.99999)], ids=repr)
@pytest.mark.parametrize("phase", [Isotropic(), HenyeyGreenstein(0.75)], ids=repr)
def test_a_split_layer_equals_the_whole(parts, phase):
    whole = Stack([Medium(albedo=0.9, tau=sum(parts), phase=phase)])
    split = Stack([Medium(albedo=0.9, tau=tau, phase=phase) for tau in parts])
    # Thin parts add nodes: these are two discretisations, each far inside the tolerance of .1 %.
    assert_same(grids(split), grids(whole), rel=1e-4)
    assert_same(grids(split, "bottom"), grids(whole), rel=1e-4)


def test_a_split_layer_on_a_base_equals_the_whole():
    whole = Stack([Medium(albedo=0.9, tau=2.0, phase=HenyeyGreenstein(0.6))], base=Lambert(0.7))
    split = Stack([Medium(albedo=0.9, tau=t, phase=HenyeyGreenstein(0.6)) for t in (0.1, 1.0, 0.9)], base=Lambert(0.7))
    assert lamina.solve(split).grid("reflect", MU, MU, DPHI) == pytest.approx(
        lamina.solve(whole).grid("reflect", MU, MU, DPHI), rel=2e-5)


@pytest.mark.parametrize("position", [0, 1, 2])
def test_a_layer_of_no_thickness_is_not_there(position):
    layers = [COAT, BODY]
    layers.insert(position, Medium(albedo=0.7, tau=0.0, phase=HenyeyGreenstein(0.5)))
    assert_same(grids(Stack(layers)), grids(Stack([COAT, BODY])), rel=1e-12)


@pytest.mark.parametrize("alpha", [0.0, 0.3])
@pytest.mark.parametrize("base", [None, lamina.Lambert(0.3), lamina.Conductor(0.2, 3.0, 0.2)])
def test_an_interface_between_media_of_one_index_is_not_there(base, alpha):
    """To the last bit, in values and in a bake: the same work is done with it and without it."""
    dust = Medium(albedo=0.9, tau=0.5, phase=HenyeyGreenstein(0.5))
    nothing = lamina.Interface(1.0, alpha)
    bare, hidden = Stack([dust], base), Stack([nothing, dust, nothing], base)
    with_it, without = lamina.solve(hidden, "preview"), lamina.solve(bare, "preview")
    mu, dphi = np.array([0.1, 0.5, 0.9]), np.array([0.0, 1.0, np.pi])
    assert np.array_equal(with_it.grid("reflect", mu, mu, dphi), without.grid("reflect", mu, mu, dphi))
    thinner, bare_thinner = with_it.with_thickness(1, 0.2), without.with_thickness(0, 0.2)
    assert np.array_equal(thinner.reflectance(mu), bare_thinner.reflectance(mu))
    assert np.array_equal(lamina.bake(hidden, "preview").weights, lamina.bake(bare, "preview").weights)


def test_nothing_at_all_lets_all_through():
    solved = lamina.solve(Stack([Medium(albedo=1.0, tau=0.0)]))
    assert np.all(solved.reflectance(MU) == 0.0) and np.all(solved.transmittance(MU) == 1.0)
    assert np.all(solved.grid("reflect", MU, MU, DPHI) == 0.0) and np.all(solved.grid("transmit", MU, MU, DPHI) == 0.0)


def test_half_space_is_an_infinite_layer():
    phase = HenyeyGreenstein(0.7)
    base = lamina.solve(Stack([COAT], base=HalfSpace([0.9, 0.5, 1.0], phase)))
    layer = lamina.solve(Stack([COAT, Medium(albedo=[0.9, 0.5, 1.0], tau=math.inf, phase=phase)]))
    thick = lamina.solve(Stack([COAT, Medium(albedo=[0.9, 0.5, 1.0], tau=1e6, phase=phase)]))
    brdf = base.grid("reflect", MU, MU, DPHI)
    assert np.array_equal(brdf, layer.grid("reflect", MU, MU, DPHI))
    # The conservative channel still lets a share of 4e-6 through 1e6 (similarity: 4/3 / (.3 tau)).
    assert brdf == pytest.approx(thick.grid("reflect", MU, MU, DPHI), rel=2e-5)
    assert np.all(layer.transmittance(MU) == 0.0)


def test_isotropic_is_henyey_greenstein_of_g_0():
    one, other = (Stack([Medium(albedo=0.9, tau=1.0, phase=p)]) for p in (Isotropic(), HenyeyGreenstein(0.0)))
    assert_same(grids(one), grids(other), rel=1e-12)


def test_coefficients_are_albedo_and_tau():
    one = Stack([Medium(sigma_s=3.0, sigma_a=1.0, thickness=0.5)])
    assert_same(grids(one), grids(Stack([Medium(albedo=0.75, tau=2.0)])), rel=1e-12)


@pytest.mark.parametrize("layers", [[], [Medium(albedo=0.9, tau=2.0)], [COAT, BODY]], ids=["bare", "slab", "two"])
@pytest.mark.parametrize("base", [Black(), Lambert(0.0), Lambert(0.5), HalfSpace(0.9)], ids=repr)
def test_a_base_hides_what_is_below(layers, base):
    """No light comes from below, and none arrives there: all accessors agree."""
    solved = lamina.solve(Stack(layers, base))
    for path in ("reflect", "transmit"):
        assert np.all(solved.grid(path, MU, MU, DPHI, side="bottom") == 0.0), path
    assert np.all(solved.grid("transmit", MU, MU, DPHI) == 0.0)
    assert np.all(solved.brdf(0.5, 0.5, 0.0, side="bottom") == 0.0)
    for side in ("top", "bottom"):
        assert np.all(solved.transmittance(MU, side) == 0.0)
    assert np.all(solved.reflectance(MU, "bottom") == 0.0)


def test_lambert_is_flat():
    solved = lamina.solve(Stack(base=Lambert([0.2, 0.5, 1.0])))
    assert solved.grid("reflect", MU, MU, DPHI) == pytest.approx(
        np.broadcast_to(np.array([0.2, 0.5, 1.0]) / math.pi, (7, 7, 5, 3)), rel=1e-12)


def test_azimuth_is_even_and_periodic():
    solved = lamina.solve(SHEET)
    for look in (solved.brdf, solved.btdf):
        value = look(0.3, 0.7, 1.1)
        assert look(0.3, 0.7, -1.1) == pytest.approx(value, rel=1e-12)
        assert look(0.3, 0.7, 1.1 + 2.0 * math.pi) == pytest.approx(value, rel=1e-10)


def test_azimuth_does_not_matter_at_the_normal():
    solved = lamina.solve(SHEET)
    for look in (solved.brdf, solved.btdf):
        values = look(1.0, 0.4, DPHI)
        assert values == pytest.approx(np.broadcast_to(values[0], values.shape), rel=1e-5)
