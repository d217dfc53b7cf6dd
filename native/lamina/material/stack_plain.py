# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of a stack as JSON, as they were given, and in the canonical form of hashes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..kinds.bases import Conductor, HalfSpace
from ..kinds.boundaries import is_oriented
from ..kinds.fields import all_fields, channel, to_plain
from ..kinds.flakes import Flakes
from ..kinds.spectra import Spectrum
from .by_wavelength import RGB
from .layers import Medium

if TYPE_CHECKING:
    from .stack import Stack


def given(thing) -> dict:
    """JSON object of the quantities by which a layer or base is given."""
    values = {quantity.name: getattr(thing, quantity.name) for quantity in all_fields(thing)}
    return {name: _value(value) for name, value in values.items() if value is not None}


def plain(thing) -> dict:
    """JSON object of a base or an interface, without options that have their usual value."""
    entry = {"kind": thing.kind, **given(thing), **_unusual(thing)}
    entry |= {one.name: getattr(thing, one.name) for one in thing.rare if getattr(thing, one.name) != one.usual}
    if thing.has_phase:
        entry["phase"] = thing.phase.to_json()
    return entry


def _unusual(thing) -> dict:
    """Options with an unusual value. Usual values are omitted, so a new option does not change earlier hashes."""
    chosen = {one: getattr(thing, one.name) for one in thing.options}
    return {one.name: one.plain(value) for one, value in chosen.items() if value != one.usual}


def canonical_layer(stack: Stack, index: int, albedos) -> dict:
    """The layer at `index` by albedo and tau of each channel. `albedos`: of its knots or channels, where colours give
    them."""
    layer, channels = stack.layers[index], range(stack.channels)
    if isinstance(layer, Medium):
        if layer.profile is not None:
            return _canonical_profile(layer, albedos, stack.channels)
        optics = [stack.optics(index, c) for c in channels]
        return {
            "kind": layer.kind,
            "albedo": [to_plain(albedo) for albedo, _ in optics],
            "tau": [to_plain(tau) for _, tau in optics],
            "phase": layer.phase.canonical(stack.channels),
            "varying": layer.varying,
        }
    entry = _canonical(layer, stack.channels)
    if isinstance(layer, Flakes):
        form = next(form for form in layer.forms if getattr(layer, form.fields[0].name) is not None)
        entry |= {one.name: [channel(getattr(layer, one.name), c) for c in channels] for one in form}
    return entry


def canonical_base(stack: Stack) -> dict | None:
    """The base by its indices or albedo in each channel; None without one."""
    base, channels = stack.base, range(stack.channels)
    if base is None:
        return None
    entry = _canonical(base, stack.channels)
    if isinstance(base, Conductor):
        indices = [stack.indices(c) for c in channels]
        entry["eta"], entry["k"] = [eta for eta, _ in indices], [k for _, k in indices]
    if stack.wavelengths is not None and base.shown:
        color = getattr(stack.given_base, base.shown)
        entry[base.shown] = [channel(color, index) for index in range(RGB)]
    if isinstance(base, HalfSpace):
        entry["albedo"] = [base.albedo_of(c) for c in channels]
    return entry


def _canonical_profile(layer: Medium, albedos, count: int) -> dict:
    knots, channels = [], range(count)
    for number, knot in enumerate(layer.profile or ()):
        entry = {"depth": knot.depth, "phase": (knot.phase or layer.phase).canonical(count)}
        if knot.has_coefficients:
            entry["sigma_s"] = [channel(knot.sigma_s, c) for c in channels]
            entry["sigma_a"] = [channel(knot.sigma_a, c) for c in channels]
        else:
            entry["albedo"] = [channel(albedos[number] or knot.albedo, c) for c in channels]
        knots.append(entry)
    size = "tau" if layer.thickness is None else "thickness"
    return {"kind": layer.kind, size: [channel(getattr(layer, size), c) for c in channels], "profile": knots,
            "varying": layer.varying}


def _canonical(thing, channels: int) -> dict:
    """The JSON object with every quantity repeated for each channel."""
    entry = {"kind": thing.kind, **_unusual(thing)}
    for quantity in thing.fields:
        value = getattr(thing, quantity.name)
        entry[quantity.name] = (value.to_json() if isinstance(value, Spectrum) else
                                [to_plain(channel(value, c)) for c in range(channels)])
    if is_oriented(thing):
        entry |= {"alpha_v": thing.alpha_v, "angle": thing.angle % math.pi}
    if thing.has_phase:
        entry["phase"] = thing.phase.canonical(channels)
    return entry


def _value(value):
    return value.to_json() if isinstance(value, Spectrum) else to_plain(value)
