# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals by name, with their two colours in `lamina`."""

from ..base import decimals, native
from ..base.messages import RefusedError
from ..kinds.metals import METAL


def names():
    """All metals of `lamina` by name. Raises NativeMissingError."""
    return list(native.part("metals").names())


def fill(base, name):
    """Make the base this metal, in all forms; its roughness stays. Raises ValueError, NativeMissingError."""
    if name not in names():
        raise RefusedError(f"metal = {name}: must be one of {', '.join(names())}")
    numbers = _numbers(name)
    base.kind, base.metal_form = "conductor", "colours"
    if name in METAL.values:
        base.metal = name
    for key, values in numbers.items():
        setattr(base, key, values)


def name_of(base):
    """The name of the metal that a base is, in the base's own form, or ''. Raises NativeMissingError."""
    if base.metal_form == "spectrum":
        return base.metal
    keys = ("facing", "grazing") if base.metal_form == "colours" else ("eta", "k")
    for name in names():
        numbers = _numbers(name)
        if all(decimals.same(numbers[key], getattr(base, key)) for key in keys):
            return name
    return ""


def source(name):
    """The source of a metal's numbers, or ''. Raises NativeMissingError."""
    return native.part("metals").source(name) if name in names() else ""


def label(name):
    """The name as the menu shows it."""
    return name.replace("-", " ").replace("_", " ").capitalize()


def _numbers(name):
    """{property of the base: R, G, B}: the metal in both forms."""
    library = native.part("metals")
    metal = library.conductor(name)
    eta, k = library.indices_of(metal, 3, "base")
    return {"facing": metal.facing, "grazing": metal.grazing, "eta": eta, "k": k}
