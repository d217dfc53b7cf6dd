# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a stack with wavelengths: named substances, spectra and colours become one value per wavelength."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple, TypeVar

from ..common.errors import StackError, quoted
from ..common.observer import checked_illuminant
from ..kinds.bases import Base
from ..kinds.fields import Field, all_fields, check_forms
from ..kinds.spectra import D65, WAVELENGTHS, Spectrum, check_wavelengths, has_spectrum, sampled
from .layers import Medium
from .metals import spectral_indices
from .pigments import absorption
from .smooth_spectra import smoothest
from .stack_checks import Layer

RGB = 3

Part = TypeVar("Part", bound=Layer | Base | None)


def names_a_substance(thing) -> bool:
    """True for a medium given by a pigment, and for a metal given by its name."""
    return getattr(thing, "pigment", None) is not None or getattr(thing, "metal", None) is not None


def is_spectral(thing) -> bool:
    """True for a part of a stack that needs wavelengths."""
    return names_a_substance(thing) or has_spectrum(thing) or bool(getattr(thing, "film", ()))


class SpectralParts(NamedTuple):
    """The parts of a stack by wavelength. For JSON, `given`: parts that were given by names or colours, by their
    position; `implied`: these parts imply the wavelengths."""

    layers: list
    base: Base | None
    wavelengths: tuple[float, ...] | None
    given: dict
    implied: bool


def parts_by_wavelength(layers: list, base: Base | None, wavelengths: Sequence[float] | None) -> SpectralParts:
    """The parts of a stack with one value per wavelength, if it has wavelengths or needs some. Raises StackError."""
    parts = (*layers, base)
    implied = wavelengths is None and any(map(is_spectral, parts))
    if wavelengths is None and not implied:
        return SpectralParts(layers, base, None, {}, False)
    nm = check_wavelengths(WAVELENGTHS if wavelengths is None else wavelengths)
    layers = [by_wavelength(layer, nm, f"layers[{number}]") for number, layer in enumerate(layers)]
    base = by_wavelength(base, nm, "base")
    given = {number: part for number, (part, new) in enumerate(zip(parts, (*layers, base), strict=True))
             if part is not new and not has_spectrum(part)}
    return SpectralParts(layers, base, nm, given, implied and not any(map(has_spectrum, parts)))


def by_wavelength(thing: Part, wavelengths: Sequence[float], path: str) -> Part:
    """A part with one value per wavelength in place of a pigment, a metal's name, a Spectrum, or red, green and blue,
    which become the smoothest spectrum of this colour. Films keep spectra. Raises StackError, naming `path`."""
    if names_a_substance(thing):
        thing = _with_spectra(thing, path)
    thing = sampled(thing, wavelengths, path)
    return thing if len(wavelengths) == RGB else _uplifted(thing, wavelengths, path)


def _with_spectra(thing, path: str):
    """A medium with the absorption of its pigment, or a metal with its indices."""
    values: dict = check_forms(thing, path)
    if isinstance(thing, Medium):
        values |= {"pigment": None, "amount": None, "sigma_a": absorption(values["pigment"], values["amount"])}
    else:
        values = {"metal": None, **dict(zip(("eta", "k"), spectral_indices(values["metal"]), strict=True))}
    return replace(thing, **values)


def _uplifted(thing, wavelengths: Sequence[float], path: str):
    """A part, and its phase function, with a spectrum in place of each quantity that is red, green and blue."""
    changes: dict = {}
    for quantity in all_fields(thing) if hasattr(thing, "fields") else ():
        value = getattr(thing, quantity.name)
        if isinstance(quantity, Field) and not quantity.single and isinstance(value, tuple) and len(value) == RGB:
            rgb = quantity.check(value, f"{path}.{quantity.name}")
            assert isinstance(rgb, tuple)
            changes[quantity.name] = smoothest(rgb, wavelengths, quantity)
    if hasattr(getattr(thing, "phase", None), "fields"):
        changes["phase"] = _uplifted(thing.phase, wavelengths, f"{path}.phase")
    return replace(thing, **changes) if changes else thing


def check_illuminant(given, wavelengths: Sequence[float] | None) -> str | Spectrum:
    """The illuminant, checked. Raises StackError."""
    light = checked_illuminant(given)
    if light != D65 and wavelengths is None:
        raise StackError(f"illuminant = {quoted(given)}: must be left out of a stack without wavelengths")
    return light
