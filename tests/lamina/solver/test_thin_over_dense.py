# SPDX-License-Identifier: GPL-3.0-or-later
"""Grazing directions for a very thin layer above a boundary coincide in the denser medium below."""

import numpy as np
import pytest

import lamina
from lamina import Conductor, Interface, Medium, SolveError, Stack

MU = np.array([0.05, 0.3, 0.7, 1.0])


@pytest.mark.parametrize("thin", [3e-9, 1e-6, 1e-4])
@pytest.mark.parametrize("base", [None, Conductor(1.57, 1.67)], ids=["black", "metal"])
def test_a_hardly_visible_layer_above_a_boundary_changes_nothing_below(thin, base):
    below = [Interface(1.7), Medium(albedo=0.99, tau=0.025), Medium(albedo=0.5, tau=1.0)]
    base = base or lamina.Black()
    plain = lamina.solve(Stack(below, base), "preview")
    covered = lamina.solve(Stack([Medium(albedo=0.66, tau=thin), *below], base), "preview")
    assert covered.orders <= 2 * plain.orders
    assert covered.nodes == plain.nodes
    dphi = [0.0, 1.0, 3.0]
    # Light that the layer scatters and removes, relative to the light without it: a few times tau / mu.
    expected = plain.grid("reflect", MU[1:], MU[1:], dphi)
    assert covered.grid("reflect", MU[1:], MU[1:], dphi) == pytest.approx(expected, rel=1e-4, abs=2.0 * thin)


@pytest.mark.parametrize("stack", [
    Stack([Interface(1.5, 0.002)], Conductor(0.2, 3.0)),
    Stack([Interface(1.5, 0.003), Interface(1.0)]),
    Stack([Interface(1.3), Interface(1.5, 0.001), Medium(albedo=0.9, tau=0.5)], Conductor(0.2, 3.0, 0.01)),
], ids=["coat", "sheet", "two coats"])
def test_needles_are_refused_before_the_attempt(stack):
    with pytest.raises(SolveError, match=r"facets of alpha 0\.00\d send narrow lobes .* orders \(at most 200\)"):
        lamina.solve(stack, "preview")


def test_needles_that_nothing_mirrors_are_solved():
    coats = [Interface(1.5, 0.002), Medium(albedo=0.9, tau=20.0)]
    thick = lamina.solve(Stack(coats, Conductor(0.2, 3.0)), "preview")
    alone = lamina.solve(Stack(coats, lamina.Lambert(0.5)), "preview")
    assert thick.reflectance(MU) == pytest.approx(alone.reflectance(MU), rel=1e-4)
