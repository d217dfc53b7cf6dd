# SPDX-License-Identifier: GPL-3.0-or-later
"""Stacks and directions on which walks are compared with the solver: (name, stack, query)."""

import math
import random

from drawn_kinds import drawn

from lamina import (
    Black,
    Conductor,
    DoubleHenyeyGreenstein,
    HenyeyGreenstein,
    Interface,
    Lambert,
    Medium,
    Rayleigh,
    Stack,
)
from lamina.kinds import phases
from lamina.walks.estimate import Query


def hg(albedo, tau, g):
    return Medium(albedo=albedo, tau=tau, phase=HenyeyGreenstein(g))


SLAB = Stack([hg(0.9, 2.0, 0.75)])
VARNISH = Stack([Interface(1.5), hg(0.8, 1.0, 0.6)], Lambert(0.5))
ROUGH_VARNISH = Stack([Interface(1.5, 0.3, compensate=False), hg(0.8, 1.0, 0.5)], Lambert(0.5))
ROUGH_BECKMANN = Stack([Interface(1.4, 0.35, "beckmann"), hg(0.95, 0.7, 0.3)], Lambert(0.8))
BRONZE = Stack([hg(0.9, 0.3, 0.4)], Conductor(0.4, 2.5, alpha=0.3))
POLISHED = Stack([Interface(1.5), hg(0.7, 0.5, 0.2)], Conductor(0.2, 3.5))
ROUGH_OVER_MIRROR = Stack([Interface(1.5, 0.3), hg(0.7, 0.5, 0.2)], Conductor(0.2, 3.5))
GLASS = Stack([Interface(1.5), hg(0.95, 1.0, 0.5), Interface(1.0)])
FROSTED = Stack([Interface(1.5, 0.3), hg(0.9, 0.8, 0.3), Interface(1.0)])
THREE = Stack([hg(0.9, 0.5, 0.6), hg(0.7, 1.0, -0.3), Medium(albedo=0.99, tau=2.0, phase=Rayleigh())])
TWO_INDICES = Stack([Interface(1.33), hg(0.9, 0.5, 0.6), Interface(1.6), hg(0.8, 1.5, 0.0), Interface(1.0)])
DEEP = Stack([hg(0.95, math.inf, 0.5)])
IN_GLASS = Stack([Interface(1.5), hg(0.9, 1.0, 0.3)])
DOUBLE = Stack([Medium(albedo=0.85, tau=1.0, phase=DoubleHenyeyGreenstein(0.7, -0.4, 0.8))], Black())

CASES = [
    ("slab", SLAB, Query(0.5, 0.5, math.pi / 2)),
    ("slab through", SLAB, Query(0.7, 0.4, 2.0, path="transmit")),
    ("slab albedo", SLAB, Query(None, 0.5)),
    ("slab transmittance", SLAB, Query(None, 0.3, path="transmit")),
    ("varnish", VARNISH, Query(0.6, 0.8, 2.5)),
    ("varnish albedo", VARNISH, Query(None, 0.4)),
    ("rough varnish", ROUGH_VARNISH, Query(0.7, 0.5, 1.0)),
    ("rough Beckmann, compensated", ROUGH_BECKMANN, Query(0.3, 0.8, 2.0)),
    ("rough Beckmann albedo", ROUGH_BECKMANN, Query(None, 0.6)),
    ("bronze", BRONZE, Query(0.8, 0.6, 0.4)),
    ("polished", POLISHED, Query(0.9, 0.5, 1.5)),
    ("rough over mirror", ROUGH_OVER_MIRROR, Query(0.8, 0.6, 1.0)),
    ("glass through", GLASS, Query(0.5, 0.9, 0.7, path="transmit")),
    ("glass transmittance", GLASS, Query(None, 0.6, path="transmit")),
    ("frosted through", FROSTED, Query(0.6, 0.7, 0.8, path="transmit")),
    ("three layers", THREE, Query(0.4, 0.9, 3.0)),
    ("three layers from below", THREE, Query(0.4, 0.9, 1.0, "bottom")),
    ("two indices through", TWO_INDICES, Query(0.8, 0.5, 1.0, "bottom", "transmit")),
    ("half-space", DEEP, Query(0.3, 0.6, 1.2)),
    ("into glass", IN_GLASS, Query(None, 0.7, path="transmit")),
    ("over glass", IN_GLASS, Query(0.5, 0.7, 1.0)),
    ("double peak", DOUBLE, Query(0.2, 0.3, 2.8)),
]
# Each kind of phase function that no stack above has, below a boundary and over a base.
_USED = {type(layer.phase) for _, stack, _ in CASES for layer in stack.layers if isinstance(layer, Medium)}
CASES += [(cls.kind, Stack([Interface(1.4), Medium(albedo=0.9, tau=1.0, phase=drawn(cls, random.Random(1)))],
                           Lambert(0.4)), Query(0.6, 0.7, 1.0)) for cls in phases.KINDS if cls not in _USED]


def solved_value(solved, query):
    """The deterministic value of channel 0."""
    if query.mu_o is None:
        flux = solved.reflectance if query.path == "reflect" else solved.transmittance
        return flux(query.mu_i, side=query.side)[0]
    f = solved.brdf if query.path == "reflect" else solved.btdf
    return f(query.mu_o, query.mu_i, query.dphi, query.side)[0]
