# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties -> the stack JSON of DESIGN's contract 1. Needs no native module.

Numbers are written as the shortest decimal that is the same float32, so that .9 typed in the panel, .9 in a
file and .9 in Python make one and the same hash. What has its usual value is left out, as `lamina` does.
"""

import json

from ..base.decimals import shortest
from . import phases, profiles

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
    if layer.profile_text:
        entry |= {"profile": profiles.knots(layer), **_amount(layer)}
    elif layer.graded:
        knots = [{"depth": 0.0, **medium_at(layer, layer)}, {"depth": 1.0, **medium_at(layer, layer.bottom)}]
        entry |= {"profile": knots, **_amount(layer)}
    else:
        entry |= {**medium_at(layer, layer), **_amount(layer)}
    entry["varying"] = layer.varying
    return entry


def homogeneous(layer, end):
    """The medium of a layer as if it were everywhere as at one `end`: the layer itself, or its bottom."""
    return {"kind": "medium", **medium_at(layer, end), **_amount(layer)}


def medium_at(layer, end):
    """What scatters at the top, the layer itself, or at its bottom."""
    if layer.mode == "coefficients":
        numbers = {"sigma_s": _channels(end.sigma_s), "sigma_a": _channels(end.sigma_a)}
    elif layer.mode == "colour":
        numbers = {"color": _channels(end.colour)}
    else:
        numbers = {"albedo": _channels(end.albedo)}
    return {**numbers, "phase": phases.to_json(end)}


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


def _amount(layer):
    """How much of the medium there is."""
    infinite = layer.infinite and not profiles.is_graded(layer)
    if layer.mode == "coefficients":
        return {"thickness": "inf" if infinite else shortest(layer.thickness)}
    if infinite:
        return {"tau": "inf"}
    over = {"over": _channels(layer.over)} if layer.mode == "colour" and layer.over_given else {}
    return over | {"tau": _channels(layer.tau_rgb) if layer.tau_per_channel else shortest(layer.tau)}


def _facets(owner):
    entry = {"alpha": shortest(owner.alpha)}
    if owner.distribution != "ggx":
        entry["distribution"] = owner.distribution
    return entry | {name: False for name in ("compensate", "correlated") if not getattr(owner, name)}


def _channels(values):
    """One number when the channels agree (a grey stack bakes in a third of the time), else three."""
    numbers = [shortest(value) for value in values]
    return numbers[0] if numbers[0] == numbers[1] == numbers[2] else numbers
