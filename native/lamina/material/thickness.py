# SPDX-License-Identifier: GPL-3.0-or-later
"""A stack with another optical thickness of one medium."""

from __future__ import annotations

import math
from dataclasses import replace

from ..common.errors import ArgumentError
from ..kinds.fibers import Fibers
from ..kinds.fields import as_channels, channel
from ..kinds.layers import OrientedLayer
from .layers import Medium
from .profile import Knot
from .stack import Stack


def with_thickness(stack: Stack, layer: int, taus: float | tuple[float, ...]) -> Stack:
    """The stack with the optical thickness `taus` along the normal, a number or one per channel, of the medium,
    the flakes with their binder, or the fibers with index `layer`.

    Media in millimetres stay so: their thickness in mm changes. A colour that was meant for a layer of its own
    thickness (`over`) becomes the albedo that gave the colour. A stack of one channel takes any number of channels. A
    varying layer keeps its mark, unless it becomes infinitely thick. Raises ArgumentError for a thickness of a channel
    in which the medium neither scatters nor absorbs."""
    medium = stack.layers[layer]
    assert isinstance(medium, Medium | OrientedLayer)
    varying = medium.varying and not math.isinf(max(taus) if isinstance(taus, tuple) else taus)
    changed: Medium | OrientedLayer
    if isinstance(medium, OrientedLayer):
        changed = replace(medium, varying=varying, **_amounts(stack, medium, taus))
    else:
        changed = replace(_without_own_colour(stack, layer, medium), varying=varying,
                          **_size(stack, layer, medium, taus))
    layers = [changed if number == layer else one for number, one in enumerate(stack.layers)]
    if getattr(medium, "profile", None) is None and _count(stack, taus) == stack.channels:
        return stack.with_sizes(layers)
    return Stack(layers, stack.base, stack.name, stack.category, stack.source, stack.wavelengths, stack.illuminant)


def check_opaque(stack: Stack, layer: int, taus: float | tuple[float, ...]) -> None:
    """Raises ArgumentError for a positive thickness of a channel in which a medium in millimetres is clear."""
    medium = stack.layers[layer]
    if not isinstance(medium, Medium):
        return
    for index in range(_count(stack, taus)):
        own, tau = min(index, stack.channels - 1), channel(taus, index)
        if tau > 0.0 and medium.thickness is not None and _extinction(medium, own) == 0.0:
            where = f"taus[{index}]" if isinstance(taus, tuple) else "taus"
            raise ArgumentError(f"{where} = {tau:g}: must be 0 in a channel where the medium neither scatters nor "
                                "absorbs")


def _count(stack: Stack, taus: float | tuple[float, ...]) -> int:
    return max(stack.channels, len(taus) if isinstance(taus, tuple) else 1)


def _amounts(stack: Stack, flakes: OrientedLayer, taus) -> dict:
    """The new optical thicknesses of flakes and binder, which keep their ratio, or of fibers."""
    if isinstance(flakes, Fibers):
        areas = tuple(channel(taus, index) / flakes.seen_from_above for index in range(_count(stack, taus)))
        return {"tau": areas[0] if len(set(areas)) == 1 else areas}
    shares = [flakes.share(min(index, stack.channels - 1)) for index in range(_count(stack, taus))]
    whole = [channel(taus, index) for index in range(len(shares))]
    taken = [flakes.taken(min(index, stack.channels - 1)) for index in range(len(shares))]
    # Pearl flakes that reflect nothing in a channel have no thickness there.
    shown = [tau if of == 1.0 else tau / of if of > 0.0 else 0.0 for tau, of in zip(whole, taken, strict=True)]
    parts = {"tau": [area if share == 1.0 else share * area for share, area in zip(shares, shown, strict=True)],
             "binder": [0.0 if share == 1.0 else (1.0 - share) * tau for share, tau in zip(shares, whole, strict=True)]}
    return {name: values[0] if len(set(values)) == 1 else tuple(values) for name, values in parts.items()}


def _size(stack: Stack, layer: int, medium: Medium, taus: float | tuple[float, ...]) -> dict:
    """The new tau, or the new thickness in mm."""
    if medium.thickness is None:
        return {"tau": taus}
    check_opaque(stack, layer, taus)
    lengths = []
    for index in range(_count(stack, taus)):
        own, tau = min(index, stack.channels - 1), channel(taus, index)
        extinction = _extinction(medium, own)
        lengths.append(tau / extinction if extinction > 0.0 else channel(medium.thickness, own))
    same = all(math.isclose(length, lengths[0], rel_tol=1e-12) for length in lengths)
    return {"thickness": lengths[0] if same else tuple(lengths)}


def _extinction(medium: Medium, index: int) -> float:
    """Mean sigma_t over the depth in one channel, 1/mm."""
    return replace(medium, thickness=1.0).optics(index)[1]


def _without_own_colour(stack: Stack, layer: int, medium: Medium) -> Medium:
    """The medium with albedos in place of colours that depend on its thickness."""
    if medium.over is None:
        return medium
    if medium.profile is None:
        albedo = [stack.optics(layer, c)[0] for c in range(stack.channels)]
        return replace(medium, color=None, over=None, albedo=as_channels(albedo))
    knots: list[Knot] = []
    for number, knot in enumerate(medium.profile):
        if knot.color is not None:
            albedo = [stack.knots(layer, c)[number][1] for c in range(stack.channels)]
            knot = replace(knot, color=None, albedo=as_channels(albedo))
        knots.append(knot)
    return replace(medium, profile=tuple(knots), over=None)
