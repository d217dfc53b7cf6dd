# SPDX-License-Identifier: GPL-3.0-or-later
"""The layers and bases of a stack from their JSON objects."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import MISSING, fields, replace

from ..common.errors import StackError, quoted
from ..kinds.bases import BASES
from ..kinds.fields import all_fields, check_keys, read_kind
from .layers import Medium
from .phase import read_phase
from .profile import read_profile


def read_medium(entry, path: str) -> Medium:
    """A medium from its JSON object. Raises StackError for missing and unknown keys; values are checked later."""
    names = {quantity.name for quantity in all_fields(Medium)}
    check_keys(entry, {"kind", "name", "phase", "profile", "varying", *names}, path)
    values = {key: value for key, value in entry.items() if key not in ("kind", "phase", "profile")}
    if "profile" in entry:
        values["profile"] = read_profile(entry["profile"], f"{path}.profile")
    if "phase" in entry:
        values["phase"] = read_phase(entry["phase"], f"{path}.phase")
    return Medium(**values)


def read_base(entry, path: str):
    """A base from its JSON object. Raises StackError as read_medium does."""
    kind = read_kind(entry, path)
    if not isinstance(kind, str) or kind not in BASES:
        raise StackError(f"{path}.kind = {quoted(kind)}: must be one of {', '.join(BASES)}")
    values = dict(entry)
    phase = values.pop("phase", None) if BASES[kind].has_phase else None
    base = read_part(BASES[kind], values, path)
    return base if phase is None else replace(base, phase=read_phase(phase, f"{path}.phase"))


def read_part(cls, entry, path: str, optional: Collection[str] = ()):
    """An interface or a base from its JSON object; members with a default may be missing."""
    names = {quantity.name for quantity in all_fields(cls)}
    usual = {field.name for field in fields(cls) if field.default is not MISSING}
    allowed = {"kind", *names, *(option.name for option in cls.options), *optional}
    check_keys(entry, allowed, path, required=names - usual)
    return cls(**{key: value for key, value in entry.items() if key != "kind"})
