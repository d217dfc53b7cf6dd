# SPDX-License-Identifier: GPL-3.0-or-later
"""Phase functions: conversion of properties and JSON, and a short text for one that the panel cannot edit.

Such a phase function (a table, a mixture, an anisotropy per channel) is stored unchanged as text.
"""

import json

from ..base.decimals import shortest
from ..base.messages import RefusedError, unusual_channels
from ..kinds import phases as kinds
from . import kept_json

KINDS = {cls.kind: cls for cls in kinds.IN_PANEL}
TABLES = ("moments", "values", "cosines")


def to_json(owner):
    """The phase function of a layer or base. A damaged text gives a kind that `lamina` refuses."""
    if owner.phase_text:
        return kept_json.parsed(owner.phase_text, dict)
    fields = KINDS[owner.phase].fields
    return {"kind": owner.phase, **{field.name: shortest(getattr(owner, field.prop)) for field in fields}}


def values(phase, where):
    """Property values that hold the JSON of a valid phase function. Raises RefusedError."""
    phase = phase or {"kind": "isotropic"}
    if phase["kind"] in KINDS:
        fields = KINDS[phase["kind"]].fields
        numbers = {field.prop: _single(phase[field.name]) for field in fields}
        if None not in numbers.values():
            return {"phase": phase["kind"], "phase_text": "", **numbers}
    _check_channels(phase, where)
    return {"phase_text": json.dumps(phase)}


def imported(owner):
    """The stored phase function in a few words, such as 'mixture of 2'; '' if the panel edits the phase
    function."""
    if not owner.phase_text:
        return ""
    try:
        return _words(kept_json.parsed(owner.phase_text, dict))
    except (LookupError, TypeError, AttributeError):
        return kept_json.UNREADABLE


def replace(owner):
    """Discard an imported phase function; the panel's own replaces it."""
    owner.phase_text = ""


def _words(data):
    if data["kind"] == "mixture":
        return f"mixture of {len(data['parts'])}"
    if data["kind"] == "tabulated":
        name, unit = ("moments", "moments") if "moments" in data else ("values", "samples")
        rows = data[name]
        return f"table of {len(rows[0] if isinstance(rows[0], list) else rows)} {unit}"
    item = KINDS[data["kind"]].item if data["kind"] in KINDS else None
    name = data["kind"] if item is None else item.words or item.label
    return f"{name} per channel" if any(isinstance(value, list) for value in data.values()) else name


def _single(value):
    """The number that all channels share, or None."""
    if not isinstance(value, list | tuple):
        return value
    return value[0] if all(other == value[0] for other in value) else None


def _check_channels(phase, where):
    for name, value in phase.items():
        if name == "parts":
            for index, part in enumerate(value):
                here = f"{where}.parts[{index}]"
                _check_channels({"share": part["share"]}, here)
                _check_channels(part["phase"], f"{here}.phase")
        elif isinstance(value, list | tuple) and (name not in TABLES or isinstance(value[0], list | tuple)):
            unusual = unusual_channels(value, f"{where}.{name}")
            if unusual:
                raise RefusedError(unusual)
