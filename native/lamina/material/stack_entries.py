# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers and bases from the entries of a stack's JSON. Unknown and missing members are refused."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import MISSING, fields, replace

from ..common.errors import StackError, quoted
from ..kinds.bases import BASES, Base, Measured
from ..kinds.boundaries import Interface
from ..kinds.fields import all_fields, check_keys, read_kind
from ..kinds.layers import DESCRIBED
from ..kinds.spectra import read_spectrum
from .layers import Medium
from .phase import read_phase
from .profile import read_profile
from .stack_checks import Layer

PLAIN = {Interface.kind: Interface, **DESCRIBED}  # layers without a phase function


def read_parts(entries: list, base) -> tuple[list[Layer], Base | None]:
    """(layers, base) from the members `layers` and `base`. If `base` is None, the last layer may be the base. Raises
    StackError."""
    layers: list[Layer] = []
    bottom = None
    for index, entry in enumerate(entries):
        path = f"layers[{index}]"
        kind = read_kind(entry, path)
        is_text = isinstance(kind, str)
        is_base = is_text and kind in BASES
        if is_base and base is None and index == len(entries) - 1:
            bottom = _read_base(entry, path)
        elif is_base:
            raise StackError(f"{path}.kind = '{kind}': a base can only stand at the bottom")
        elif is_text and kind == Medium.kind:
            layers.append(_read_medium(entry, path))
        elif is_text and kind in PLAIN:
            layers.append(_read(PLAIN[kind], entry, path, {"name"}))
        else:
            raise StackError(f"{path}.kind = {quoted(kind)}: must be 'medium', 'interface', 'film', 'flakes', "
                             "'fibers', or a base at the bottom")
    return layers, bottom if base is None else _read_base(base, "base")


def _read_base(entry, path: str) -> Base:
    kind = read_kind(entry, path)
    if not isinstance(kind, str) or kind not in BASES:
        raise StackError(f"{path}.kind = {quoted(kind)}: must be one of {', '.join(BASES)}")
    values = dict(entry)
    phase = values.pop("phase", None) if BASES[kind].has_phase else None
    base = _read(BASES[kind], values, path, {"name"} if BASES[kind] is Measured else ())
    return base if phase is None else replace(base, phase=read_phase(phase, f"{path}.phase"))


def _read_medium(entry, path: str) -> Medium:
    names = {quantity.name for quantity in all_fields(Medium)}
    check_keys(entry, {"kind", "name", "phase", "profile", "varying", *names}, path)
    values = {key: read_spectrum(value, f"{path}.{key}") for key, value in entry.items()
              if key not in ("kind", "phase", "profile")}
    if "profile" in entry:
        values["profile"] = read_profile(entry["profile"], f"{path}.profile")
    if "phase" in entry:
        values["phase"] = read_phase(entry["phase"], f"{path}.phase")
    return Medium(**values)


def _read(cls, entry, path: str, optional: Collection[str] = ()):
    """An interface or a base from its JSON object; members with a default may be missing."""
    names = {quantity.name for quantity in all_fields(cls)}
    usual = {field.name for field in fields(cls) if field.default is not MISSING}
    allowed = {"kind", *names, *(one.name for one in (*cls.options, *cls.rare)), *optional}
    check_keys(entry, allowed, path, required=names - usual)
    return cls(**{key: read_spectrum(value, f"{path}.{key}") for key, value in entry.items() if key != "kind"})
