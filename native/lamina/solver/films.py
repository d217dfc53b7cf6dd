# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin films as the core takes them: their indices and thicknesses by wavelength, and the weights of a channel."""

from __future__ import annotations

import functools

from .. import _core
from ..common.observer import rec709_under
from ..kinds.fields import channel
from ..kinds.films import Film
from ..kinds.flakes import Flakes
from ..kinds.spectra import Spectrum
from ..material.stack import Stack

Sheet = tuple  # (ior, k, thickness in nm); index and k a number or a Spectrum


def core_film(stack: Stack, position: int, index: int, above: float, below: complex) -> _core.Film | None:
    """The films on the layer at `position`, or on the base at len(layers), in one channel; None if there are none.
    Equal films are one object. `above`, `below`: the indices around the films; below a base, that of the metal."""
    films = stack.films(position)
    if not films:
        return None
    band = index if stack.wavelengths is None else stack.wavelengths[index]
    return _made(_sheets(films, index), band, above, below, "metal" if position == len(stack.layers) else "medium")


def core_flakes(stack: Stack, flakes: Flakes, index: int, above: float, below: complex) -> _core.FilmedFlakes:
    """Flakes with films, or clear platelets, in one channel, for the index of their binder and that of the metal or the
    platelets. Equal flakes are one object."""
    assert isinstance(flakes.film, tuple)
    band = 1.0 if stack.wavelengths is None else stack.wavelengths[index]  # no films without wavelengths
    return _filmed(_sheets(flakes.film, index), band, above, below, "metal" if flakes.is_metal else "platelet",
                   flakes.alpha)


def _sheets(films: tuple[Film, ...], index: int) -> tuple[Sheet, ...]:
    return tuple((_in_channel(film.ior, index), _in_channel(film.k, index), film.thickness) for film in films)


@functools.lru_cache(maxsize=512)
def _filmed(sheets: tuple[Sheet, ...], band: float, above: float, below: complex, kind: str,
            alpha: float) -> _core.FilmedFlakes:
    return _core.FilmedFlakes(_made(sheets, band, above, below, kind), alpha)


# More than the films of a stack of 81 wavelengths: channels share a solution only if they share the film.
@functools.lru_cache(maxsize=512)
def _made(sheets: tuple[Sheet, ...], band: int | float, above: float, below: complex, kind: str) -> _core.Film:
    """`band`: a whole number is the channel red, green or blue, another number a wavelength in nm."""
    if isinstance(band, int):
        wavelengths, rows = rec709_under()
        weighted = list(zip(wavelengths.tolist(), rows[band].tolist(), strict=True))
    else:
        weighted = [(band, 1.0)]
    return _core.Film(above, kind, [
        (weight, below, [(complex(_at(ior, nm), _at(k, nm)), thickness / nm) for ior, k, thickness in sheets])
        for nm, weight in weighted])


def _in_channel(value, index: int):
    return value if isinstance(value, Spectrum) else channel(value, index)


def _at(value, wavelength: float) -> float:
    return value.at(wavelength) if isinstance(value, Spectrum) else value
