# SPDX-License-Identifier: GPL-3.0-or-later
"""Ten stacks with lengths in millimetres on which all methods for the searchlight are compared, with five lateral
frequencies (1/mm) for each, and the walks that support them."""

from typing import NamedTuple

from lamina import (
    Conductor,
    DoubleHenyeyGreenstein,
    HalfSpace,
    HenyeyGreenstein,
    Interface,
    Knot,
    Lambert,
    Medium,
    Rayleigh,
    Stack,
)


class Case(NamedTuple):
    name: str
    stack: Stack
    q: tuple[float, ...]
    walks: tuple[str, ...]


def medium(sigma_s, sigma_a, thickness, g=0.0):
    return Medium(sigma_s=sigma_s, sigma_a=sigma_a, thickness=thickness, phase=HenyeyGreenstein(g))


BOTH, PHOTONS = ("transfer", "scattering"), ("transfer",)
NEAR = (0.1, 0.3, 1.0, 2.0, 5.0)

SLAB = Stack([medium(0.9, 0.1, 2.0, 0.75)])
GRADED = Stack([Medium(thickness=2.0, profile=[Knot(0.0, sigma_s=0.3, sigma_a=0.1), Knot(0.5, sigma_s=2.0, sigma_a=0.1),
                                               Knot(0.5, sigma_s=0.2, sigma_a=0.0), Knot(1.0, sigma_s=1.5, sigma_a=0.5,
                                                                                         phase=HenyeyGreenstein(0.2))])])
VARNISHED = Stack([Interface(1.4), medium(1.6, 0.2, 1.0, 0.5)], Lambert(0.6))
FROSTED = Stack([Interface(1.5, 0.3), medium(1.2, 0.1, 1.0, 0.4), Interface(1.0)])
SKIN = Stack([Interface(1.4), medium((3.0, 4.0, 6.0), (0.05, 0.3, 0.8), 0.2, 0.6)],
             HalfSpace(sigma_s=(2.0, 2.0, 3.0), sigma_a=(0.02, 0.2, 0.5), phase=HenyeyGreenstein(0.5)))

CASES = [
    Case("half-space", Stack(base=HalfSpace(sigma_s=0.9, sigma_a=0.1)), NEAR, BOTH),
    Case("forward half-space", Stack(base=HalfSpace(sigma_s=1.9, sigma_a=0.1, phase=HenyeyGreenstein(0.6))), NEAR,
         PHOTONS),
    Case("slab", SLAB, NEAR, PHOTONS),
    Case("conservative slab", Stack([medium(1.5, 0.0, 2.0)]), NEAR, BOTH),
    Case("graded", GRADED, NEAR, BOTH),
    Case("paint", Stack([Medium(sigma_s=3.0, sigma_a=0.3, thickness=0.4, phase=Rayleigh())], Lambert(0.7)), NEAR, BOTH),
    Case("two media on bronze", Stack([medium(2.0, 0.1, 0.3, -0.3), Medium(
        sigma_s=0.9, sigma_a=0.2, thickness=0.5, phase=DoubleHenyeyGreenstein(0.7, -0.3, 0.8))],
        Conductor(0.4, 2.5, alpha=0.3)), NEAR, PHOTONS),
    Case("varnished", VARNISHED, NEAR, PHOTONS),
    Case("frosted", FROSTED, NEAR, PHOTONS),
    Case("skin", SKIN, NEAR, PHOTONS),
]
