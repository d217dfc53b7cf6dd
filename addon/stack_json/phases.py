# SPDX-License-Identifier: GPL-3.0-or-later
"""Phase functions: properties <-> JSON, and what the panel says of one that it cannot edit.

Such a one (a table, a mixture, an anisotropy per channel) is kept word for word as text, so nothing is lost.
"""

import json

from ..base.decimals import shortest
from ..base.messages import RefusedError, unusual_channels
from . import kept_json

# kind -> {name in the JSON: property}
FIELDS = {
    "isotropic": {},
    "hg": {"g": "g"},
    "rayleigh": {},
    "double-hg": {"g1": "g1", "g2": "g2", "weight": "weight"},
    "draine": {"g": "g", "alpha": "draine_alpha"},
    "cornette-shanks": {"g": "g"},
}
WORDS = {"hg": "Henyey-Greenstein", "double-hg": "double Henyey-Greenstein", "draine": "Draine",
         "cornette-shanks": "Cornette-Shanks"}  # fmt: skip
LARGEST = 0.99  # anisotropy that the panel's sliders reach
TABLES = ("moments", "values", "cosines")


def to_json(owner):
    """The phase function of a layer or base. A damaged text gives a kind that `lamina` refuses."""
    if owner.phase_text:
        return kept_json.parsed(owner.phase_text, dict)
    numbers = {name: shortest(getattr(owner, prop)) for name, prop in FIELDS[owner.phase].items()}
    return {"kind": owner.phase, **numbers}


def values(phase, where):
    """Property values that hold the JSON of a valid phase function. Raises RefusedError."""
    phase = phase or {"kind": "isotropic"}
    fields = FIELDS.get(phase["kind"])
    if fields is not None:
        numbers = {name: _single(phase[name]) for name in fields}
        if all(_has_slider(name, number) for name, number in numbers.items()):
            return {"phase": phase["kind"], "phase_text": "", **{fields[n]: v for n, v in numbers.items()}}
    _check_channels(phase, where)
    return {"phase_text": json.dumps(phase)}


def imported(owner):
    """'mixture of 2': what the text holds, in a few words; '' when the panel edits the phase function."""
    if not owner.phase_text:
        return ""
    try:
        return _words(kept_json.parsed(owner.phase_text, dict))
    except (LookupError, TypeError, AttributeError):
        return kept_json.UNREADABLE


def replace(owner):
    """Let go of an imported phase function: the panel's own takes its place."""
    owner.phase_text = ""


def _words(data):
    if data["kind"] == "mixture":
        return f"mixture of {len(data['parts'])}"
    if data["kind"] == "tabulated":
        name, unit = ("moments", "moments") if "moments" in data else ("values", "samples")
        rows = data[name]
        return f"table of {len(rows[0] if isinstance(rows[0], list) else rows)} {unit}"
    name = WORDS.get(data["kind"], data["kind"])
    return f"{name} per channel" if any(isinstance(value, list) for value in data.values()) else name


def _single(value):
    """The number that all channels share, or None."""
    if not isinstance(value, list | tuple):
        return value
    return value[0] if all(other == value[0] for other in value) else None


def _has_slider(name, number):
    return number is not None and (name not in ("g", "g1", "g2") or abs(number) <= LARGEST)


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
