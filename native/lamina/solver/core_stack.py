# SPDX-License-Identifier: GPL-3.0-or-later
"""One channel of a stack as the core takes it."""

from __future__ import annotations

import functools
import math

from .. import _core
from ..kinds.bases import Conductor, HalfSpace, PrincipledBase
from ..kinds.boundaries import Interface, is_oriented
from ..kinds.fibers import Fibers
from ..kinds.fields import channel
from ..kinds.films import Film
from ..kinds.flakes import Flakes
from ..material.stack import Stack
from .films import core_film, core_flakes


def core_stack(stack: Stack, index: int, all_facets: bool = False):
    """(key, layers, base) of one channel, as the core takes them; channels with the same key share one solution.
    `all_facets`: a PrincipledBase keeps facets that are too narrow for a solve of all azimuth orders."""
    entries: list[tuple] = []
    above = 1.0
    for number, layer in enumerate(stack.layers):
        if isinstance(layer, Interface):
            below = channel(layer.ior, index)
            film = core_film(stack, number, index, above, below)
            facets = _facets(layer, index, any(one.absorbs for one in stack.films(number)))
            entries.append((_core.Interface, (below, facets, film)))
            above = below
        elif isinstance(layer, Film):
            # Nothing by itself, so that layers keep their numbers: the boundary below holds the film.
            entries.append((_core.Interface, (above, _core.Facets(), None)))
        elif isinstance(layer, Flakes):
            entries.append((_core.Medium, (*layer.optics(index), Flakes.kind, layer.alpha, layer.share(index),
                                           *_mirror_of(stack, number, index, above))))
        elif isinstance(layer, Fibers):
            entries.append((_core.Medium, (*layer.optics(index), Fibers.kind, layer.alpha, layer.translucency)))
        elif layer.profile is not None and layer.optics(index)[1] > 0.0:
            entries.append((_core.GradedMedium, (tuple(stack.knots(number, index)),)))
        else:
            entries.append((_core.Medium, (*stack.optics(number, index), *layer.phase.in_channel(index))))
    if isinstance(stack.base, HalfSpace):
        endless = (stack.base.albedo_of(index), math.inf, *stack.base.phase.in_channel(index))
        entries.append((_core.Medium, endless))
    base: tuple = ("none",)
    if isinstance(stack.base, Conductor):
        eta, k = stack.indices(index)
        film = core_film(stack, len(stack.layers), index, above, complex(eta, k))
        base = (stack.base.kind, eta, k, _facets(stack.base, index), film)
    elif isinstance(stack.base, PrincipledBase):
        base = stack.base.below(above, index, all_facets)
    elif stack.base is not None:
        base = stack.base.in_channel(index)
    return (tuple(entries), base), [kind(*values) for kind, values in entries], core_base(base)


def _mirror_of(stack: Stack, number: int, index: int, ior: float) -> tuple:
    """What flakes in a binder of this index reflect by the angle in one channel: the index of metal flakes, relative to
    the binder, or flakes with films; nothing for flakes that reflect the same at all angles."""
    layer = stack.layers[number]
    assert isinstance(layer, Flakes)
    if layer.reflectance is not None:
        return ()
    if not layer.is_metal:
        return (core_flakes(stack, layer, index, ior, channel(layer.ior, index)),)
    eta, k = stack.flake_indices(number)
    metal = complex(channel(eta, index), channel(k, index))
    return (core_flakes(stack, layer, index, ior, metal),) if layer.film else (metal / ior,)


@functools.lru_cache(maxsize=16)
def core_base(base: tuple) -> _core.Base:
    """The core's base of the (name, parameters...) in the key of core_stack. Channels of equal color share one: the
    albedos of a Principled base take longer than the solve."""
    name, *parameters = base
    return getattr(_core.Base, name)(*parameters)


def _facets(surface: Interface | Conductor, index: int, absorbing: bool = False) -> _core.Facets:
    """The surface's facets in one channel; `absorbing`: below films that absorb, see Film."""
    oriented = (surface.alpha_v, surface.angle) if is_oriented(surface) else ()
    return _core.Facets(channel(surface.alpha, index), surface.distribution, surface.correlated,
                        surface.compensate and not absorbing, *oriented)
