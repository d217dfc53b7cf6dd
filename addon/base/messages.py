# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors as one sentence that an artist can act on."""

import re

from ..kinds import bases, boundaries, films, media, phases
from ..kinds.fields import Option, all_fields
from ..kinds.layers import DESCRIBED
from . import native

_FIELDS = (
    *(field for form in media.FORMS for field in form),
    *boundaries.Interface.fields,
    *films.Film.fields,
    *(field for cls in bases.IN_PANEL for form in (cls.fields, *cls.forms) for field in form),
)
# Names of fields in messages of `lamina`, and the panel's names for them. The first field of a name counts.
WORDS = {
    "phase": "phase function",
    "phase.kind": "phase function",
    "table": "measured file",
    **{field.name: field.panel.words for field in reversed(_FIELDS) if not isinstance(field, Option)},
    **{f"phase.{field.name}": field.panel.words for cls in phases.IN_PANEL for field in cls.fields},
}
# Of layers whose fields have other names in the panel than those of media and facets
OWN_WORDS = {kind: {field.name: field.panel.words for field in all_fields(cls)
                    if not isinstance(field, Option)}
             for kind, cls in DESCRIBED.items()}

_FIELD = r"(?:\.((?:[\w.]|\[\d+\](?=\.))+))?(\[(\d)\])?(.*)$"
_LAYER = re.compile(r"^layers\[(\d+)\]" + _FIELD, re.DOTALL)
_BASE = re.compile(r"^base" + _FIELD, re.DOTALL)
_UNSOLVED = re.compile(r"^the stack cannot be resolved with \d+ nodes per hemisphere: (.*)$")
_KNOT = re.compile(r"profile\[(\d+)\]\.?(.*)$")
_ENDS = {"0": "top", "1": "bottom"}  # of the panel's profiles; imported ones are valid
CHANNELS = ("red", "green", "blue")


class RefusedError(ValueError):
    """A request that Lamina refuses; str() is one sentence for the user."""


def expected(error):
    """True if the text of `error` is already a sentence for the user."""
    if isinstance(error, RefusedError | native.NativeMissingError | OSError):
        return True
    if not native.available():
        return False
    lamina = native.require()
    solver = lamina.StackError | lamina.LutError | lamina.SolveError
    others = lamina.ArgumentError | lamina.DustError | lamina.DustUnavailable | lamina.InteriorError
    others |= lamina.MeasurementError
    return isinstance(error, solver | others)


def sentence(error, material=None):
    """One line for the panel or the terminal; a layer is named as the panel names it."""
    text = " ".join(str(error).split())
    if isinstance(error, OSError) and error.strerror:
        text = f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    if not expected(error):
        return f"{type(error).__name__}: {text}" if text else type(error).__name__
    return text if material is None else in_panel_words(text, material)


def reported(error):
    """The sentence of a RuntimeError that an operator raises for its report when a script calls it; '' if the
    report has no text."""
    return " ".join(str(error).split()).removeprefix("Error: ")


def in_panel_words(text, material):
    """'layers[2].phase.g = 1.2: ...' -> 'Layer 3 "Varnish", anisotropy = 1.2: ...'."""
    match = _LAYER.match(text)
    if match:
        number, field, _, channel, rest = match.groups()
        index, layers = int(number), material.lamina.layers
        words = WORDS | OWN_WORDS.get(layers[index].kind, {}) if index < len(layers) else WORDS
        return f"Layer {index + 1}{_layer_name(material, index)}{_field(field, channel, words)}{rest}"
    match = _BASE.match(text)
    if match and match.group(0)[4:5] in ("", ".", "[", " ", ":"):
        field, _, channel, rest = match.groups()
        return f"Base{_field(field, channel, WORDS)}{rest}"
    return _UNSOLVED.sub(r"These layers cannot be solved precisely enough: rougher surfaces help (\1)", text)


def unusual_channels(values, where):
    """The fault in the length of a list of channels, as a sentence, or ''."""
    if len(values) in (1, 3):
        return ""
    return f"{where} has {len(values)} channels: a Blender material takes 1 or 3"


def percent(share, digits=1):
    """'4.1 %', or '< 0.1 %' for a value that would be rounded to 0."""
    number = 100.0 * share
    smallest = 10.0**-digits
    return f"< {smallest:g} %" if 0.0 < number < 0.5 * smallest else f"{number:.{digits}f} %"


def layer_index(text):
    """Index of the layer that a message of lamina names, or None."""
    match = _LAYER.match(text)
    return int(match.group(1)) if match else None


def wrapped(text, width):
    """Lines of at most `width` characters: Blender's labels do not wrap."""
    lines, line = [], ""
    for word in text.split():
        if line and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = word
        else:
            line = f"{line} {word}".strip()
    return [*lines, line] if line else lines


def _layer_name(material, index):
    layers = material.lamina.layers
    return f" “{layers[index].name}”" if index < len(layers) else ""


def _field(field, channel, known):
    if not field:
        return ""
    knot = _KNOT.match(field)
    if knot:
        return f", {_ENDS.get(knot.group(1), 'profile')}{_field(knot.group(2), channel, known)}"
    words = known.get(field) or field.replace("phase.", "phase function ", 1).replace("_", " ")
    return f", {words}" + (f" ({CHANNELS[int(channel)]})" if channel and int(channel) < 3 else "")
