# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of a stack as JSON, as they were given, and in the canonical form of hashes."""

from __future__ import annotations

import math

from ..kinds.boundaries import is_oriented
from ..kinds.fields import all_fields, channel, to_plain
from ..kinds.spectra import Spectrum


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
    chosen = {one.name: getattr(thing, one.name) for one in thing.options}
    return {one.name: list(chosen[one.name]) if one.several else chosen[one.name]
            for one in thing.options if chosen[one.name] != one.usual}


def canonical(thing, channels: int) -> dict:
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
