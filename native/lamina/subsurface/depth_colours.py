# SPDX-License-Identifier: GPL-3.0-or-later
"""Red, green and blue of light that travels sideways in a stack with wavelengths.

Cycles' nodes and the walks in meshes have three channels. A channel gets the exit albedo of the spectrum, and the mean
exit distance of the light of its wavelengths. A medium that fills a body is represented by three media, one per
channel, which have these exit albedos and distances on a flat surface of a body of THICKNESS. The light that leaves on
the other side counts as absorbed: sigma_a grows by D (pi / THICKNESS)^2 with the diffusion coefficient D. Without this
loss, wavelengths that nothing absorbs would make the media too bright for bodies of finite size."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from .. import _core
from ..common.errors import StackError
from ..common.fresnel import fresnel
from ..common.observer import in_gamut
from ..kinds.bases import Black, HalfSpace, Lambert
from ..kinds.boundaries import Interface
from ..kinds.fields import channel
from ..kinds.phases import HenyeyGreenstein
from ..kinds.spectra import D65
from ..material.layers import Medium
from ..material.stack import Stack
from . import entry_lobes
from .entry_cosines import mean_entry_cosines
from .node_parameters import LEAST_IOR
from .node_response import LARGEST_G
from .response_table import CURVE, distance_per_path, place_of, response_curves

LEAST = 1e-12  # against division by 0
THICKNESS = 16.0  # in transport mean free paths
LOSS = (np.pi / THICKNESS) ** 2 / 3.0  # per reduced scattering coefficient


def exit_colours(stack: Stack, albedo: np.ndarray, distance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(exit albedo, mean exit distance), (3,) each, of values by wavelength, (channels,) each. Colours outside of the
    gamut fade to gray, as in tables. Values of a stack without wavelengths are returned as they are."""
    if stack.wavelengths is None:
        return albedo, distance
    # A channel weighs some wavelengths negatively. The mean of distances leaves them out.
    light = np.maximum(stack.seen(np.eye(stack.channels), 0), 0.0) * albedo
    return np.clip(in_gamut(stack.seen(albedo), -1), 0.0, 1.0), light @ distance / np.maximum(light.sum(axis=1), LEAST)


def in_colours(stack: Stack) -> Stack:
    """The stack with red, green and blue in place of wavelengths: one medium with lengths, below at most one interface,
    over nothing, black or a Lambert surface; what a medium of infinite thickness hides is left out. A stack without
    wavelengths is returned as it is. Raises StackError for other stacks."""
    if stack.wavelengths is None:
        return stack
    top = [_mean_interface(layer, stack) for layer in stack.layers[:1] if isinstance(layer, Interface)]
    media, base = list(stack.layers[len(top):]), stack.base
    if media and getattr(media[0], "thickness", None) == math.inf:
        media, base = media[:1], None
    deep = base if isinstance(base, HalfSpace) else media[0] if media else None
    if len(media) != (deep is not base) or not isinstance(deep, Medium | HalfSpace) or getattr(deep, "profile", None) \
            or not isinstance(base, HalfSpace | Lambert | Black | None):
        raise StackError("layers: must be one homogeneous medium, below at most one interface, where pigments and "
                         "other spectra become red, green and blue")
    shown = _medium_in_colours(deep, stack, channel(top[0].ior, 0) if top else 1.0)
    if isinstance(base, Lambert):
        seen = in_gamut(stack.seen(_by_channel(base.reflectance, stack)), -1)
        base = replace(base, reflectance=tuple(np.clip(seen, 0.0, 1.0).tolist()))
    layers, base = ([], shown) if isinstance(shown, HalfSpace) else ([shown], base)
    return replace(stack, layers=[*top, *layers], base=base, wavelengths=None, illuminant=D65)


def _medium_in_colours(medium: Medium | HalfSpace, stack: Stack, ior: float) -> Medium | HalfSpace:
    """The medium of three channels in a body of the index `ior` that is lit from all directions."""
    sigma_s, sigma_a = (_by_channel(values, stack) for values in (medium.sigma_s, medium.sigma_a))
    if not np.all(sigma_s > 0.0):
        raise StackError("sigma_s = 0: must be above 0 where pigments and other spectra become red, green and blue")
    cosines = [float(_core.PhaseFunction(*medium.phase.in_channel(c)).moment(1)) for c in range(stack.channels)]
    g = sum(cosines) / len(cosines)
    phase = medium.phase if len(set(cosines)) == 1 else HenyeyGreenstein(g)
    near = float(np.clip(g, 0.0, LARGEST_G))
    curves = response_curves(near, *mean_entry_cosines(LEAST_IOR, 0.0))
    # Similarity: a medium of the cosine `near` with the same sigma_a and the same sigma_s (1 - g).
    reduced = sigma_s * (1.0 - np.array(cosines))
    sigma_a = sigma_a + LOSS * reduced
    u = (sigma_a / np.maximum(sigma_a + reduced, LEAST)) ** 0.25
    path = 1.0 / np.maximum(sigma_a + reduced / (1.0 - near), LEAST)
    returned = _returned(ior)
    # Light that a boundary sends back k times walks k + 1 times, over about the square root of as many distances.
    passing = 1.0 - returned * curves.full_albedo
    light = (1.0 - returned) * curves.full_albedo / passing
    way = curves.full_distance / np.sqrt(passing)
    albedo, distance = exit_colours(stack, np.interp(u, CURVE, light), distance_per_path(way, curves, near, u) * path)
    u = place_of(light, albedo)
    sigma_t = distance_per_path(way, curves, near, u) / np.maximum(distance, LEAST)
    single = np.interp(u, CURVE, curves.single)
    reduced = single * sigma_t * (1.0 - near)
    sigma_a = np.maximum((1.0 - single) * sigma_t - LOSS * reduced, 0.0)
    return replace(medium, sigma_s=tuple((reduced / (1.0 - g)).tolist()), sigma_a=tuple(sigma_a.tolist()), phase=phase)


def _mean_interface(interface: Interface, stack: Stack) -> Interface:
    """The interface with the means of its index and width over the wavelengths."""
    ior, alpha = (float(np.mean(_by_channel(values, stack))) for values in (interface.ior, interface.alpha))
    return replace(interface, ior=ior, alpha=alpha)


def _by_channel(values, stack: Stack) -> np.ndarray:
    return np.array([channel(values, c) for c in range(stack.channels)])


def _returned(ior: float) -> float:
    """The share of diffuse light from inside that a smooth boundary reflects."""
    return 1.0 - float(entry_lobes.mean(1.0 - fresnel(entry_lobes.COSINES, ior))) / ior**2
