# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals by name: `lamina` knows their refractive indices."""

from . import decimals, native
from .messages import RefusedError


def names():
    """All metals that `lamina` knows. Raises NativeMissingError."""
    return list(native.part("metals").names())


def fill(base, name):
    """Make the base this metal; its roughness stays. Raises RefusedError, NativeMissingError."""
    if name not in names():
        raise RefusedError(f"metal = {name}: must be one of {', '.join(names())}")
    eta, k = _indices(name)
    base.kind, base.metal_form = "conductor", "indices"
    base.eta, base.k = eta, k


def name_of(base):
    """The metal whose indices the base has, or ''. Raises NativeMissingError."""
    if base.metal_form != "indices":
        return ""
    for name in names():
        eta, k = _indices(name)
        if decimals.same(eta, base.eta) and decimals.same(k, base.k):
            return name
    return ""


def label(name):
    return name.replace("-", " ").replace("_", " ").capitalize()


def _indices(name):
    metal = native.part("metals").conductor(name)
    return _triple(metal.eta), _triple(metal.k)


def _triple(value):
    values = list(value) if isinstance(value, list | tuple) else [value]
    return values if len(values) == 3 else values * 3
