# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin films on flakes.

The panel edits one film on both faces of clear platelets. Other films are stored unchanged as text.
"""

import json

from ..base.decimals import shortest
from ..kinds.flakes import BY_COLOUR, BY_FILM, COAT, COAT_THICKNESS
from . import kept_json


def to_json(layer):
    """The films, outermost first, as JSON data. Damaged JSON gives a value that `lamina` refuses."""
    if layer.flake_form == BY_COLOUR.item.id:
        return []
    if layer.coats_text:
        return kept_json.parsed(layer.coats_text, list)
    if layer.flake_form != BY_FILM.item.id or layer.coat_film_thickness == 0.0:
        return []
    numbers = {field.name: shortest(getattr(layer, field.prop)) for field in COAT}
    return [{name: value for name, value in numbers.items() if name != "k" or value != 0.0}]


def values(films, form):
    """Property values that hold the films of a valid entry in this form, as JSON data."""
    films = [films] if isinstance(films, dict) else films
    is_edited = form == BY_FILM.item.id
    if not films:
        return {"coats_text": "", **({COAT_THICKNESS.prop: 0.0} if is_edited else {})}
    numbers = {field.prop: films[0].get(field.name, 0.0) for field in COAT}
    has_spectrum = any(isinstance(value, dict) for value in numbers.values())
    if is_edited and len(films) == 1 and not has_spectrum:
        return {"coats_text": "", **numbers}
    return {"coats_text": json.dumps(films)}


def imported(layer):
    """The stored films in short, such as '2 films'; '' if the panel edits the film."""
    if not layer.coats_text or layer.flake_form == BY_COLOUR.item.id:
        return ""
    held = kept_json.parsed(layer.coats_text, list)
    if held == kept_json.UNREADABLE:
        return held
    return "1 film" if len(held) == 1 else f"{len(held)} films"


def replace(layer):
    """Discard the imported films; the panel's own film replaces them."""
    layer.coats_text = ""
