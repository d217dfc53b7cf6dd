# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion of a valid stack's JSON to property values. Values that no property can hold are refused with a
sentence.

Needs no native module and changes nothing: stack_io writes the values after all have been read.
"""

import json
import math

from ..base.messages import RefusedError, unusual_channels
from ..kinds import boundaries, media
from ..kinds.bases import BASES, Measured
from ..kinds.fields import Option
from ..kinds.flakes import COATS
from ..kinds.layers import DESCRIBED
from ..kinds.measured import TableText
from ..kinds.spectra import ILLUMINANT
from . import coats, phases

NEWER = "this version of the add-on does not know it"
FIRST_NAMES = {"medium": "Layer", "interface": "Interface",
               **{kind: cls.item.label for kind, cls in DESCRIBED.items()}}


def about(data):
    """The texts of the stack as JSON: name, category, source. Raises RefusedError."""
    if data.get("wavelengths") is not None:
        raise RefusedError("wavelengths: in Blender the channels of a stack are red, green and blue")
    own = ("schema", "layers", "base", ILLUMINANT.name)
    others = {key: value for key, value in data.items() if key not in own}
    return json.dumps(others) if others else ""


def illuminant(data):
    """The value of the property of this name. Raises RefusedError."""
    value = data.get(ILLUMINANT.name, ILLUMINANT.usual)
    if isinstance(value, dict):
        raise RefusedError("illuminant: in Blender it is one of the list, not a spectrum")
    return _option(ILLUMINANT, value, ILLUMINANT.name)


def layer(layer, where):
    """Values of a LaminaLayer. Raises RefusedError."""
    kind = layer.get("kind", "medium")
    if kind == "interface":
        values = _interface(layer, where)
    elif kind == "medium":
        values = _medium(layer, where)
    elif kind in DESCRIBED:
        values = _described(DESCRIBED[kind], layer, where)
    else:
        raise RefusedError(f"{where}.kind = {kind}: {NEWER}")
    return {"kind": kind, "name": layer.get("name") or FIRST_NAMES[kind], **values}


def base(base):
    """Values of the LaminaBase. Raises RefusedError."""
    if base is None:
        return {"kind": "none"}
    cls = BASES.get(base["kind"])
    if cls is None:
        raise RefusedError(f"base.kind = {base['kind']}: {NEWER}")
    values = {"kind": base["kind"], **_described(cls, base, "base"), **_orientation(cls, base, "base")}
    if cls.has_phase:
        values |= phases.values(base.get("phase"), "base.phase")
    if cls is Measured:
        values["measured_name"] = base.get("name", "")
    return values


def _described(cls, entry, where):
    """Values of the form, the quantities and the options of a kind."""
    values, fields = {}, cls.fields
    if forms := getattr(cls, "forms", ()):
        form = next(form for form in forms if form.fields[0].name in entry)
        values[cls.form_prop] = form.item.id
        fields = (*form, *fields)
    values |= {field.prop: _value(field, entry, where) for field in fields}
    if COATS in cls.options:
        values |= coats.values(entry.get(COATS.name), values[cls.form_prop])
    return values | _options(cls, entry, where)


def _interface(layer, where):
    ior = _triple(layer["ior"], f"{where}.ior")
    values = {"ior": ior[0], "ior_per_channel": len(set(ior)) > 1, "ior_rgb": ior}
    values["alpha"] = _value(boundaries.ALPHA, layer, where)
    values |= _orientation(boundaries.Interface, layer, where)
    return values | _options(boundaries.Interface, layer, where)


def _orientation(cls, entry, where):
    """Values of the anisotropy of facets; none for surfaces that know none."""
    if not cls.rare:
        return {}
    if entry.get("alpha_v") is None:
        return {"anisotropic": False}
    values = {one.name: _single(entry.get(one.name, one.usual), f"{where}.{one.name}") for one in cls.rare}
    return {"anisotropic": True, **values}


def _value(quantity, entry, where):
    """The value of a quantity's property; the default if the entry lacks the quantity."""
    path = f"{where}.{quantity.name}"
    if isinstance(quantity, Option):
        return _option(quantity, entry.get(quantity.name, quantity.usual), path)
    value = entry.get(quantity.name, quantity.panel.default)
    return (_triple if quantity.panel.rgb else _single)(value, path)


def _options(cls, entry, where):
    """Values of the options of a kind; the usual value if the entry lacks an option."""
    return {option.name: _option(option, entry.get(option.name, option.usual), f"{where}.{option.name}")
            for option in cls.options if option is not COATS}


def _option(option, value, where):
    """The value of an option's property: a set of names if the option takes several, the text of a table."""
    if isinstance(option, TableText):
        return value
    if option.several:
        value = set(value)
        known = value <= {item.id for item in option.items}
    else:
        known = value in option.values
    if not known:
        raise RefusedError(f"{where} = {value}: {NEWER}")
    return value


def _medium(layer, where):
    values = {"varying": bool(layer.get("varying", False)), **_amount(layer, where)}
    if "profile" in layer:
        return values | _profile(layer, where)
    return values | {"mode": _mode(layer), **_medium_at(layer, layer, where)}


def _profile(layer, where):
    """A profile with two knots of one form becomes properties; any other is stored unchanged."""
    knots = layer["profile"]
    mode = _mode(knots[0])
    all_values = [_medium_at(knot, layer, f"{where}.profile[{index}]") for index, knot in enumerate(knots)]
    ends = {"mode": mode, "graded": True, **all_values[0], "bottom": all_values[-1]}
    if len(knots) == 2 and _mode(knots[1]) == mode:
        return ends
    phase = {"phase": layer["phase"]} if "phase" in layer else {}
    return {**ends, "profile_text": json.dumps([{**phase, **knot} for knot in knots])}


def _mode(entry):
    """The form in which a medium, or a knot, is given."""
    return next(form.item.id for form in media.FORMS if form.local[0].name in entry)


def _medium_at(entry, layer, where):
    """The scattering quantities of a medium, or of a knot."""
    form = next(form for form in media.FORMS if form.item.id == _mode(entry))
    values = {quantity.prop: _value(quantity, entry, where) for quantity in form.local}
    return values | phases.values(entry.get("phase", layer.get("phase")), f"{where}.phase")


def _amount(layer, where):
    if "thickness" in layer:
        thickness, infinite = _finite(_single(layer["thickness"], f"{where}.thickness"))
        return {"infinite": True} if infinite else {"infinite": False, "thickness": thickness}
    values = _tau(layer.get("tau", "inf"), f"{where}.tau")
    if layer.get("over") is not None:
        values |= {"over_given": True, "over": _triple(layer["over"], f"{where}.over")}
    return values


def _tau(tau, where):
    each = [_finite(value) for value in (tau if isinstance(tau, list | tuple) else [tau])]
    if all(infinite for _, infinite in each):
        return {"infinite": True}
    if any(infinite for _, infinite in each):
        raise RefusedError(f"{where} = {tau}: in Blender all channels are infinite, or none")
    numbers = _triple([number for number, _ in each], where)
    if len(set(numbers)) == 1:
        return {"infinite": False, "tau_per_channel": False, "tau": numbers[0]}
    return {"infinite": False, "tau_per_channel": True, "tau_rgb": numbers, "tau": max(numbers)}


def _triple(value, where):
    values = list(value) if isinstance(value, list | tuple) else [value]
    if len(values) == 1:
        return values * 3
    unusual = unusual_channels(values, where)
    if unusual:
        raise RefusedError(unusual)
    return values


def _single(value, where):
    if isinstance(value, dict):
        raise RefusedError(f"{where}: in Blender it is one number for all wavelengths")
    values = list(value) if isinstance(value, list | tuple) else [value]
    if any(other != values[0] for other in values):
        raise RefusedError(f"{where} = {value}: in Blender it is one number for all channels")
    return values[0]


def _finite(value):
    """(number or None, is infinite)."""
    infinite = value in ("inf", "Infinity") or (isinstance(value, float) and math.isinf(value))
    return (None if infinite else value), infinite
