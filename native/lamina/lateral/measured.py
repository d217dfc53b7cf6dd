# SPDX-License-Identifier: GPL-3.0-or-later
"""Stacks with lengths in millimetres: the core's input for one channel, for light that travels sideways."""

from __future__ import annotations

import itertools
import math

from .. import _core
from ..kinds.bases import HalfSpace
from ..kinds.fields import channel
from ..material.layers import Medium
from ..material.millimetres import require_millimetres, sigma_t
from ..material.profile import coefficients_at, mixed
from ..material.stack import Stack
from ..solver.core_stack import core_base, core_stack

# Length of an interval of a graded medium relative to its distance from the nearer face; and the optical distance from
# a face below which intervals no longer shrink.
COARSENESS = {"final": 0.5, "preview": 1.0}
FACE = 0.05


def measured_layers(stack: Stack, index: int, quality: str) -> tuple[tuple, tuple]:
    """(layers, base) of one channel, hashable. A layer is (kind, arguments, extinction, thickness, whole_tau), with the
    arguments of the core's type; media with a profile become homogeneous slices, and whole_tau is their sum. A base is
    (name, parameters...).

    Raises StackError for a medium without lengths."""
    require_millimetres(stack)
    (entries, base), _, _ = core_stack(stack, index)
    layers = []
    for number, layer in enumerate(stack.layers):
        kind, arguments = entries[number]
        if not isinstance(layer, Medium):
            layers.append((kind, arguments, 0.0, 0.0, 0.0))
            continue
        thickness = channel(layer.thickness, index)
        if layer.profile is not None:
            layers += _slices(layer, index, thickness, COARSENESS[quality])
            continue
        extinction = sigma_t(layer, index)
        layers.append((kind, arguments, extinction, thickness, extinction * thickness))
    if isinstance(stack.base, HalfSpace):
        layers.append((*entries[-1], sigma_t(stack.base, index), math.inf, math.inf))
    return tuple(layers), base


def measured_stack(layers: tuple, base: tuple) -> _core.MeasuredStack:
    """The core's stack from the result of measured_layers."""
    kinds, arguments, *lengths = zip(*layers, strict=True) if layers else ((),) * 5
    core = _core.Stack([kind(*values) for kind, values in zip(kinds, arguments, strict=True)], core_base(base))
    return _core.MeasuredStack(core, *lengths)


def _slices(medium: Medium, index: int, thickness: float, coarseness: float) -> list[tuple]:
    """Homogeneous slices that replace a medium whose coefficients are linear in depth between knots.

    Over an interval of depth, two slices of half its length, with the coefficients at 1/6 and 5/6 of the interval, are
    accurate to fourth order (commutator-free Magnus integrators: Blanes and Moan 2006). Intervals grow with the
    distance from the nearer face."""
    whole = medium.optics(index)[1]
    slices = []
    before = 0.0
    for above, below in itertools.pairwise(medium.profile or ()):
        length = (below.depth - above.depth) * thickness
        first, last = (coefficients_at(knot, medium, index) for knot in (above, below))
        tau = 0.5 * length * (first[1] + last[1])
        if length == 0.0:
            continue
        constant = first == last
        count = 1 if constant else max(1, math.ceil((_steps(before + tau, whole) - _steps(before, whole)) / coarseness))
        before += tau
        for k in range(count):
            for place in (0.5,) if constant else (1.0 / 6.0, 5.0 / 6.0):
                scattering, extinction, phase = _between(first, last, (k + place) / count)
                share = length / count * (1.0 if constant else 0.5)
                albedo = scattering / extinction if extinction > 0.0 else 0.0
                slices.append((_core.Medium, (albedo, extinction * share, *phase), extinction, share, whole))
    return slices


def _steps(tau: float, whole: float) -> float:
    """Number of intervals of coarseness 1 above the optical depth tau."""
    half = math.log1p(0.5 * whole / FACE)
    upper = math.log1p(max(0.0, min(tau, whole - tau)) / FACE)
    return upper if tau <= 0.5 * whole else 2.0 * half - upper


def _between(above: tuple, below: tuple, way: float) -> tuple[float, float, tuple]:
    (s0, e0, p0), (s1, e1, p1) = above, below
    part0, part1 = (1.0 - way) * s0, way * s1
    return part0 + part1, (1.0 - way) * e0 + way * e1, mixed(p0, part0, p1, part1)
