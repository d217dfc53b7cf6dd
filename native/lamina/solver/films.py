# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin films as the core takes them: their indices and thicknesses by wavelength, and the weights of a channel."""

from __future__ import annotations

import functools

from .. import _core
from ..common.observer import rec709_under
from ..kinds.fields import channel
from ..kinds.spectra import Spectrum
from ..material.stack import Stack

Sheet = tuple  # (ior, k, thickness in nm); index and k a number or a Spectrum


def core_film(stack: Stack, position: int, index: int, above: float, below: complex) -> _core.Film | None:
    """The films on the layer at `position`, or on the base at len(layers), in one channel; None if there are none.
    Equal films are one object. `above`, `below`: the indices around the films; below a base, that of the metal."""
    films = stack.films(position)
    if not films:
        return None
    sheets = tuple((_in_channel(film.ior, index), _in_channel(film.k, index), film.thickness) for film in films)
    band = index if stack.wavelengths is None else stack.wavelengths[index]
    return _made(sheets, band, above, below, position == len(stack.layers))


# More than the films of a stack of 81 wavelengths: channels share a solution only if they share the film.
@functools.lru_cache(maxsize=512)
def _made(sheets: tuple[Sheet, ...], band: int | float, above: float, below: complex, opaque: bool) -> _core.Film:
    """`band`: a whole number is the channel red, green or blue, another number a wavelength in nm."""
    if isinstance(band, int):
        wavelengths, rows = rec709_under()
        weighted = list(zip(wavelengths.tolist(), rows[band].tolist(), strict=True))
    else:
        weighted = [(band, 1.0)]
    return _core.Film(above, opaque, [
        (weight, below, [(complex(_at(ior, nm), _at(k, nm)), thickness / nm) for ior, k, thickness in sheets])
        for nm, weight in weighted])


def _in_channel(value, index: int):
    return value if isinstance(value, Spectrum) else channel(value, index)


def _at(value, wavelength: float) -> float:
    return value.at(wavelength) if isinstance(value, Spectrum) else value
