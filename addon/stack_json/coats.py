# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin films on flakes.

The panel edits one film on both faces of clear platelets. Other films are stored unchanged as text; of one
with an index by wavelength on platelets, the panel edits the thickness.
"""

import json

from ..base.decimals import shortest
from ..kinds.flakes import BY_COLOUR, BY_FILM, COAT, COAT_THICKNESS
from . import kept_json


def to_json(layer):
    """The films, outermost first, as JSON data. Damaged JSON gives a value that `lamina` refuses."""
    if layer.flake_form == BY_COLOUR.item.id:
        return []
    thickness = shortest(getattr(layer, COAT_THICKNESS.prop))
    if layer.coats_text:
        films = kept_json.parsed(layer.coats_text, list)
        return [{**films[0], COAT_THICKNESS.name: thickness}] if has_own_thickness(layer) else films
    if layer.flake_form != BY_FILM.item.id or thickness == 0.0:
        return []
    numbers = {field.name: shortest(getattr(layer, field.prop)) for field in COAT}
    return [{name: value for name, value in numbers.items() if name != "k" or value != 0.0}]


def has_own_thickness(layer):
    """True if the panel edits the thickness of the film."""
    if layer.flake_form != BY_FILM.item.id:
        return False
    films = kept_json.parsed(layer.coats_text, list) if layer.coats_text else [{}]
    return len(films) == 1 and isinstance(films[0], dict)


def values(films, form):
    """Property values that hold the films of a valid entry in this form, as JSON data."""
    films = [films] if isinstance(films, dict) else films
    if form != BY_FILM.item.id or len(films or ()) > 1:
        return {"coats_text": json.dumps(films) if films else ""}
    if not films:
        return {"coats_text": "", COAT_THICKNESS.prop: 0.0}
    numbers = {field.prop: films[0].get(field.name, 0.0) for field in COAT}
    if any(isinstance(value, dict) for value in numbers.values()):
        return {"coats_text": json.dumps(films), COAT_THICKNESS.prop: numbers[COAT_THICKNESS.prop]}
    return {"coats_text": "", **numbers}


def imported(layer):
    """The stored films in short, such as '2 films'; '' if the panel edits the film."""
    if not layer.coats_text or layer.flake_form == BY_COLOUR.item.id:
        return ""
    held = kept_json.parsed(layer.coats_text, list)
    if held == kept_json.UNREADABLE:
        return held
    if has_own_thickness(layer):
        return "index by wavelength"
    return "1 film" if len(held) == 1 else f"{len(held)} films"


def replace(layer):
    """Discard the imported films; the panel's own film replaces them."""
    layer.coats_text = ""
