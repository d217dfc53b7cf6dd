# SPDX-License-Identifier: GPL-3.0-or-later
"""Stacks with anisotropic facets, for tests."""

from dataclasses import replace

from lamina import Conductor, HenyeyGreenstein, Interface, Lambert, Medium, Stack

GLASS = 1.5


def metal(alpha, alpha_v, angle=0.0, **more):
    return Conductor(eta=0.2, k=3.0, alpha=alpha, alpha_v=alpha_v, angle=angle, **more)


def medium(albedo, tau, g):
    return Medium(albedo=albedo, tau=tau, phase=HenyeyGreenstein(g))


STACKS = {
    "bare": Stack([], metal(0.1, 0.3)),
    "smooth lacquer on brushed metal": Stack([Interface(GLASS)], metal(0.08, 0.35)),
    "brushed coat on medium on metal": Stack([Interface(GLASS, 0.1, alpha_v=0.3), medium(0.8, 0.3, 0.5)],
                                             metal(0.08, 0.35)),
    "brushed coat on paint": Stack([Interface(GLASS, 0.1, alpha_v=0.4), medium(0.9, 0.5, 0.6)], Lambert(0.5)),
    "crossed": Stack([Interface(GLASS, 0.1, alpha_v=0.3, angle=0.5), medium(0.8, 0.3, 0.0)],
                     metal(0.1, 0.35, angle=-0.4)),
    "dust on brushed metal": Stack([medium(0.9, 0.3, 0.7)], metal(0.1, 0.3)),
    "isotropic coat on brushed metal": Stack([Interface(GLASS, 0.15), medium(0.9, 0.2, 0.3)], metal(0.1, 0.3)),
    "Beckmann": Stack([Interface(GLASS, 0.2, "beckmann", alpha_v=0.1), medium(0.8, 0.3, 0.5)],
                      metal(0.1, 0.3, distribution="beckmann", compensate=False)),
    "sheet": Stack([Interface(GLASS, 0.1, alpha_v=0.3), medium(0.9, 0.5, 0.0),
                    Interface(1.0, 0.3, alpha_v=0.15, angle=0.3)]),
}
CLEAR = Stack([Interface(GLASS, 0.1, alpha_v=0.3), medium(1.0, 0.5, 0.3),
               Interface(1.0, 0.3, alpha_v=0.15, angle=0.3)])
LOSSLESS = {"sheet": CLEAR, "paint": Stack(CLEAR.layers[:2], Lambert(1.0))}


def turned(stack, by):
    """The stack with all tangents turned, in radians."""
    layers = [replace(one, angle=one.angle + by) if getattr(one, "alpha_v", None) else one for one in stack.layers]
    base = replace(stack.base, angle=stack.base.angle + by) if getattr(stack.base, "alpha_v", None) else stack.base
    return Stack(layers, base)


def crossed(stack):
    """The stack with both widths of all facets exchanged."""
    def swapped(one):
        return replace(one, alpha=one.alpha_v, alpha_v=one.alpha) if getattr(one, "alpha_v", None) else one

    return Stack([swapped(one) for one in stack.layers], swapped(stack.base))
