# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion of properties to a stack's JSON. Needs no native module.

Numbers are written as the shortest decimal that is the same float32, so that .9 typed in the panel, .9 in a
file and .9 in Python give the same hash. Usual values are left out, as in `lamina`.
"""

import json

from ..base.decimals import shortest
from ..kinds import bases, boundaries, media
from ..kinds.fields import Option, panel_fields
from ..kinds.films import Coats
from ..kinds.flakes import BY_FILM, BY_SPECTRUM
from ..kinds.layers import DESCRIBED
from ..kinds.limits import STACK_SCHEMA
from ..kinds.spectra import ILLUMINANT
from . import coats, phases, profiles


def stack(settings):
    """The stack of a material's settings as plain JSON data, top layer first."""
    return {
        **_about(settings.about),
        "schema": STACK_SCHEMA,
        **_light(settings),
        "layers": [layer(one) for one in settings.layers],
        "base": base(settings.base),
    }


def has_spectra(settings):
    """True if a layer has a pigment or films on flakes, or flakes or the base are a metal by its spectrum."""
    base = settings.base
    by_name = base.kind == bases.Conductor.kind and base.metal_form == "spectrum"
    return by_name or any(_has_spectra(one) for one in settings.layers)


def _has_spectra(layer):
    if layer.kind == "medium":
        return layer.mode == "pigment"
    spectral = layer.flake_form in (BY_FILM.item.id, BY_SPECTRUM.item.id) or bool(coats.imported(layer))
    return layer.kind == "flakes" and spectral


def _light(settings):
    """The illuminant, if it is not the usual one and matters."""
    if settings.illuminant == ILLUMINANT.usual or not has_spectra(settings):
        return {}
    return {ILLUMINANT.name: settings.illuminant}


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
        facets = {"alpha": shortest(layer.alpha)} | _orientation(layer)
        return entry | facets | _options(boundaries.Interface, layer)
    if layer.kind in DESCRIBED:
        return entry | _described(DESCRIBED[layer.kind], layer)
    if layer.profile_text:
        entry |= {"profile": profiles.knots(layer), **_amount(layer)}
    elif profiles.is_graded(layer):
        knots = [{"depth": 0.0, **medium_at(layer, layer)}, {"depth": 1.0, **medium_at(layer, layer.bottom)}]
        entry |= {"profile": knots, **_amount(layer)}
    else:
        entry |= {**medium_at(layer, layer), **_amount(layer)}
    entry["varying"] = layer.varying
    return entry


def homogeneous(layer, end):
    """The layer as a homogeneous medium with the values of one `end`: the layer itself (its top), or its
    bottom."""
    return {"kind": "medium", **medium_at(layer, end), **_amount(layer)}


def medium_at(layer, end):
    """The scattering quantities at one end: the layer itself (its top), or its bottom."""
    form = next(form for form in media.FORMS if form.item.id == layer.mode)
    values = {quantity.name: _value(quantity, end) for quantity in form.local}
    return {**values, "phase": phases.to_json(end)}


def base(base):
    if base.kind == "none":
        return None
    cls = bases.BASES[base.kind]
    entry = {"kind": base.kind, **_described(cls, base)}
    if cls.has_phase:
        entry["phase"] = phases.to_json(base)
    if cls is bases.Measured:
        entry["name"] = base.measured_name
    return entry | (_orientation(base) if cls.rare else {})


def _orientation(owner):
    """The anisotropy of facets, for a surface that is rough and has some."""
    if not (owner.anisotropic and owner.alpha > 0.0):
        return {}
    angle = shortest(owner.angle)
    return {"alpha_v": shortest(owner.alpha_v)} | ({"angle": angle} if angle else {})


def _amount(layer):
    """The thickness of the medium."""
    infinite = layer.infinite and not profiles.is_graded(layer)
    if layer.mode in media.IN_MM:
        return {"thickness": "inf" if infinite else shortest(layer.thickness)}
    if infinite:
        return {"tau": "inf"}
    over = {"over": _channels(layer.over)} if layer.mode == "colour" and layer.over_given else {}
    return over | {"tau": _channels(layer.tau_rgb) if layer.tau_per_channel else shortest(layer.tau)}


def _described(cls, owner):
    """The quantities in the owner's form, and the options, of a kind."""
    return {one.name: _value(one, owner) for one in panel_fields(cls, owner)} | _options(cls, owner)


def _value(quantity, owner):
    value = getattr(owner, quantity.prop)
    if isinstance(quantity, Option):
        return value
    return _channels(value) if quantity.panel.rgb else shortest(value)


def _options(cls, owner):
    """The options without their usual value."""
    chosen = {one.name: _chosen(one, owner) for one in cls.options}
    usual = {one.name: one.plain(one.usual) for one in cls.options}
    return {name: value for name, value in chosen.items() if value != usual[name]}


def _chosen(option, owner):
    """The value of an option; several values as a list in the order of the option's items, films as one."""
    if isinstance(option, Coats):
        return coats.to_json(owner)
    value = getattr(owner, option.name)
    return [item.id for item in option.items if item.id in value] if option.several else value


def _channels(values):
    """One number if the channels are equal (a grey stack bakes in a third of the time), else three."""
    numbers = [shortest(value) for value in values]
    return numbers[0] if numbers[0] == numbers[1] == numbers[2] else numbers
