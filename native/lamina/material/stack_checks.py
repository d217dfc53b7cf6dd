# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of the parts of a stack, which become floats in their ranges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..common.errors import StackError, quoted
from ..kinds.bases import Base, Conductor, Measured
from ..kinds.boundaries import Interface
from ..kinds.fields import Channels, channel, check_forms
from ..kinds.films import Film
from ..kinds.flakes import Flakes
from ..kinds.layers import OrientedLayer
from ..kinds.spectra import Spectrum
from .layers import Medium
from .phase import check_phase

Layer = Medium | Interface | Film | OrientedLayer


def _checked(thing, path):
    values = {q.name: _checked_value(thing, q, f"{path}.{q.name}") for q in thing.fields}
    values |= {one.name: one.check(getattr(thing, one.name), f"{path}.{one.name}") for one in thing.options}
    values |= {one.name: one.check(getattr(thing, one.name), f"{path}.{one.name}") for one in thing.rare}
    if getattr(thing, "forms", ()):
        values.update(check_forms(thing, path))
    checked = replace(thing, **values)
    if values.get("alpha_v") is not None and values["alpha"] == 0.0:
        raise StackError(f"{path}.alpha_v = {values['alpha_v']:g}: needs an alpha above 0, the width along the tangent")
    if values.get("angle") and values["alpha_v"] is None:
        raise StackError(f"{path}.angle = {values['angle']:g}: needs an alpha_v, the width across the tangent")
    return checked


def _checked_value(thing, quantity, path):
    value = getattr(thing, quantity.name)
    if isinstance(value, Spectrum) and isinstance(thing, Film) and not quantity.single:
        return value.checked(quantity, path)
    return quantity.check(value, path)


def check_layer(layer, path: str) -> Layer:
    """A copy of a layer with every quantity as floats. Raises StackError, naming `path`."""
    if isinstance(layer, Base):
        raise StackError(f"{path}.kind = '{layer.kind}': a base can only stand at the bottom")
    if not isinstance(layer, Layer):
        raise StackError(f"{path} = {quoted(layer)}: must be a layer")
    if not isinstance(layer.name, str):
        raise StackError(f"{path}.name = {quoted(layer.name)}: must be a text")
    return layer.checked(path) if isinstance(layer, Medium) else _checked(layer, path)


def check_base(base):
    """A copy of a base with every quantity as floats. Raises StackError."""
    if base is None:
        return None
    if not isinstance(base, Base):
        raise StackError(f"base = {quoted(base)}: must be a base or none")
    base = _checked(base, "base")
    if isinstance(base, Measured) and not isinstance(base.name, str):
        raise StackError(f"base.name = {quoted(base.name)}: must be a text")
    if base.has_phase:
        base = replace(base, phase=check_phase(base.phase, "base.phase"))
    return base


def check_films(layers: Sequence[Layer], base: Base | None, channels: int) -> None:
    """Raises StackError unless films lie on what can carry them."""
    above: Channels = 1.0
    for number, layer in enumerate(layers):
        if isinstance(layer, Film):
            below = layers[number + 1] if number + 1 < len(layers) else base
            if not isinstance(below, Film | Interface | Conductor):
                kind = "nothing" if below is None else below.kind
                raise StackError(f"layers[{number}].kind = 'film': must lie on an interface or on a conductor, not on "
                                 f"{kind}; an interface below it states the next ior")
            if isinstance(below, Interface) and below.alpha > 0.0 and any(
                    channel(below.ior, c) == channel(above, c) for c in range(channels)):
                raise StackError(f"layers[{number + 1}].alpha = {below.alpha:g}: must be 0 below a film between equal "
                                 "indices")
        elif isinstance(layer, Interface):
            above = layer.ior
        elif isinstance(layer, Flakes) and layer.film and layer.reflectance is not None:
            raise StackError(f"layers[{number}].film: must be left out beside a reflectance; films lie on metals and "
                             "on platelets of an ior")
