# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties -> the stack JSON of DESIGN's contract 1. Needs no native module.

Numbers are written as the shortest decimal that is the same float32, so that .9 typed in the panel, .9 in a
file and .9 in Python make one and the same hash. What has its usual value is left out, as `lamina` does.
"""

import json

from . import phases
from .decimals import shortest

JSON_SCHEMA = 1


def stack(settings):
    """The stack of a material's settings as plain JSON data, top layer first."""
    return {
        **_about(settings.about),
        "schema": JSON_SCHEMA,
        "layers": [layer(one) for one in settings.layers],
        "base": base(settings.base),
    }


def _about(text):
    try:
        about = json.loads(text) if text else {}
    except (ValueError, RecursionError):
        about = {}
    return about if isinstance(about, dict) else {}


def layer(layer):
    entry = {"kind": layer.kind, "name": layer.name}
    if layer.kind == "interface":
        entry["ior"] = _channels(layer.ior_rgb) if layer.ior_per_channel else shortest(layer.ior)
        return entry | _facets(layer)
    entry |= _by_coefficients(layer) if layer.mode == "coefficients" else _by_thickness(layer)
    entry["phase"] = phases.to_json(layer)
    entry["varying"] = layer.varying
    return entry


def base(base):
    if base.kind == "none":
        return None
    entry = {"kind": base.kind}
    if base.kind == "lambert":
        entry["reflectance"] = _channels(base.reflectance)
        if base.textured:
            entry["textured"] = True
    elif base.kind == "half-space":
        entry["albedo"] = _channels(base.albedo)
        entry["phase"] = phases.to_json(base)
    elif base.kind == "conductor":
        names = ("facing", "grazing") if base.metal_form == "colours" else ("eta", "k")
        entry |= {name: _channels(getattr(base, name)) for name in names}
        entry |= _facets(base)
    return entry


def _by_coefficients(layer):
    return {
        "sigma_s": _channels(layer.sigma_s),
        "sigma_a": _channels(layer.sigma_a),
        "thickness": "inf" if layer.infinite else shortest(layer.thickness),
    }


def _by_thickness(layer):
    if layer.mode == "colour":
        entry = {"color": _channels(layer.colour)}
        if layer.over_given and not layer.infinite:
            entry["over"] = _channels(layer.over)
    else:
        entry = {"albedo": _channels(layer.albedo)}
    if layer.infinite:
        return entry | {"tau": "inf"}
    return entry | {"tau": _channels(layer.tau_rgb) if layer.tau_per_channel else shortest(layer.tau)}


def _facets(owner):
    entry = {"alpha": shortest(owner.alpha)}
    if owner.distribution != "ggx":
        entry["distribution"] = owner.distribution
    return entry | {name: False for name in ("compensate", "correlated") if not getattr(owner, name)}


def _channels(values):
    """One number when the channels agree (a grey stack bakes in a third of the time), else three."""
    numbers = [shortest(value) for value in values]
    return numbers[0] if numbers[0] == numbers[1] == numbers[2] else numbers
