# SPDX-License-Identifier: GPL-3.0-or-later
"""The JSON of a valid stack -> property values. What the panel cannot hold is refused in a sentence.

Needs no native module, and changes nothing: the values are written by stack_io once all have been read.
"""

import json
import math

from . import phases
from .messages import RefusedError, unusual_channels

NEWER = "this version of the add-on does not know it"
FIRST_NAMES = {"medium": "Layer", "interface": "Interface"}
FACETS = {"alpha": 0.0, "distribution": "ggx", "compensate": True, "correlated": True}


def about(data):
    """What the stack says of itself: its name, category, source."""
    others = {key: value for key, value in data.items() if key not in ("schema", "layers", "base")}
    return json.dumps(others) if others else ""


def layer(layer, where):
    """Values of a LaminaLayer. Raises RefusedError."""
    kind = layer.get("kind", "medium")
    if kind == "interface":
        values = _interface(layer, where)
    elif kind == "medium":
        values = _medium(layer, where)
    else:
        raise RefusedError(f"{where}.kind = {kind}: {NEWER}")
    return {"kind": kind, "name": layer.get("name") or FIRST_NAMES[kind], **values}


def base(base):
    """Values of the LaminaBase. Raises RefusedError."""
    if base is None:
        return {"kind": "none"}
    values = {"kind": base["kind"]}
    if base["kind"] == "lambert":
        values["reflectance"] = _triple(base["reflectance"], "base.reflectance")
        values["textured"] = bool(base.get("textured", False))
    elif base["kind"] == "half-space":
        if "albedo" not in base:
            raise RefusedError("base.sigma_s: the panel's half-space must be given by its albedo")
        values["albedo"] = _triple(base["albedo"], "base.albedo")
        values |= phases.values(base.get("phase"), "base.phase")
    elif base["kind"] == "conductor":
        by_colours = "facing" in base
        values["metal_form"] = "colours" if by_colours else "indices"
        for name in ("facing", "grazing") if by_colours else ("eta", "k"):
            values[name] = _triple(base[name], f"base.{name}")
        values |= _facets(base, "base")
    elif base["kind"] != "black":
        raise RefusedError(f"base.kind = {base['kind']}: {NEWER}")
    return values


def _interface(layer, where):
    ior = _triple(layer["ior"], f"{where}.ior")
    values = {"ior": ior[0], "ior_per_channel": len(set(ior)) > 1, "ior_rgb": ior}
    return values | _facets(layer, where)


def _facets(entry, where):
    values = {name: entry.get(name, usual) for name, usual in FACETS.items()}
    values["alpha"] = _single(values["alpha"], f"{where}.alpha")
    if values["distribution"] not in ("ggx", "beckmann"):
        raise RefusedError(f"{where}.distribution = {values['distribution']}: {NEWER}")
    return values


def _medium(layer, where):
    values = {"varying": bool(layer.get("varying", False)), **_amount(layer, where)}
    if "profile" in layer:
        return values | _profile(layer, where)
    return values | {"mode": _mode(layer), **_medium_at(layer, layer, where)}


def _profile(layer, where):
    """One from top to bottom has numbers in the panel; any other is kept word for word."""
    knots = layer["profile"]
    mode = _mode(knots[0])
    all_values = [_medium_at(knot, layer, f"{where}.profile[{index}]") for index, knot in enumerate(knots)]
    ends = {"mode": mode, "graded": True, **all_values[0], "bottom": all_values[-1]}
    if len(knots) == 2 and _mode(knots[1]) == mode:
        return ends
    phase = {"phase": layer["phase"]} if "phase" in layer else {}
    return {**ends, "profile_text": json.dumps([{**phase, **knot} for knot in knots])}


def _mode(entry):
    return "coefficients" if "sigma_s" in entry else "colour" if "color" in entry else "optical"


def _medium_at(entry, layer, where):
    """What scatters in a medium, or at a knot of its profile."""
    if "sigma_s" in entry:
        values = {"sigma_s": _triple(entry["sigma_s"], f"{where}.sigma_s")}
        values["sigma_a"] = _triple(entry.get("sigma_a", 0.0), f"{where}.sigma_a")
    elif "color" in entry:
        values = {"colour": _triple(entry["color"], f"{where}.color")}
    else:
        values = {"albedo": _triple(entry["albedo"], f"{where}.albedo")}
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
    values = list(value) if isinstance(value, list | tuple) else [value]
    if any(other != values[0] for other in values):
        raise RefusedError(f"{where} = {value}: in Blender it is one number for all channels")
    return values[0]


def _finite(value):
    """(number or None, is infinite)."""
    infinite = value in ("inf", "Infinity") or (isinstance(value, float) and math.isinf(value))
    return (None if infinite else value), infinite
