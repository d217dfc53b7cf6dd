# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals by name: `lamina` knows their refractive indices."""

from . import decimals, native
from .messages import RefusedError


def names():
    """All metals that `lamina` knows. Raises NativeMissingError."""
    return list(native.part("metals").names())


def fill(base, name):
    """Make the base this metal, in both forms; its roughness stays. Raises ValueError, NativeMissingError."""
    if name not in names():
        raise RefusedError(f"metal = {name}: must be one of {', '.join(names())}")
    eta, k = _indices(name)
    library = native.part("metals")
    facing, grazing = library.colours_of(library.conductor(name))
    base.kind, base.metal_form = "conductor", "indices"
    base.eta, base.k, base.facing, base.grazing = eta, k, facing, grazing


def name_of(base):
    """The metal whose indices the base has, or ''. Raises NativeMissingError."""
    if base.metal_form != "indices":
        return ""
    for name in names():
        eta, k = _indices(name)
        if decimals.same(eta, base.eta) and decimals.same(k, base.k):
            return name
    return ""


def source(name):
    """Where the numbers come from, or ''. Raises NativeMissingError."""
    return native.part("metals").source(name) if name in names() else ""


def label(name):
    """The name as the menu shows it."""
    return name.replace("-", " ").replace("_", " ").capitalize()


def _indices(name):
    metal = native.part("metals").conductor(name)
    return _triple(metal.eta), _triple(metal.k)


def _triple(value):
    values = list(value) if isinstance(value, list | tuple) else [value]
    return values if len(values) == 3 else values * 3
