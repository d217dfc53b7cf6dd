# SPDX-License-Identifier: GPL-3.0-or-later
"""Thin films on boundaries, whose reflections interfere, and spectra of their refractive index."""

from __future__ import annotations

import bisect
from collections.abc import Sequence
from dataclasses import dataclass

from .errors import StackError, quoted
from .fields import Channels, Field, check_keys, check_table
from .hashable import Hashable
from .panel import Item, Panel

WAVELENGTH = Field("wavelengths", 100.0, 1e5, "nm")
FILM_IOR = Field("ior", 0.01, 10.0, panel=Panel(
    "Film Index", "Refractive index of the film, real part", 1.8, step=1, precision=3, words="film index",
    prop="film_ior"))
EXTINCTION = Field("k", 0.0, 20.0, panel=Panel(
    "Film Extinction", "Imaginary part of the film's refractive index: 0 is clear", 0.0, step=1, precision=3,
    words="film extinction", prop="film_k"))
FILM_THICKNESS = Field("thickness", 0.0, 5000.0, "nm", single=True, panel=Panel(
    "Film Thickness (nm)", "Thickness of the film in nanometres: the colors of the first order lie below about 300",
    100.0, soft_high=1000.0, step=100, precision=1, words="film thickness", prop="film_thickness"))
MOST_SAMPLES = 4096


@dataclass(frozen=True)
class Spectrum(Hashable):
    """A quantity by wavelength: `wavelengths` in nm, ascending, in [100, 1e5], and as many `values`. Linear in between,
    constant beyond the ends. Values of a film's `ior` may be complex, n + ik."""

    wavelengths: Sequence[float]
    values: Sequence[complex]

    def at(self, wavelength: float):
        """The value at a wavelength in nm."""
        place = bisect.bisect_left(self.wavelengths, wavelength)
        if place in (0, len(self.wavelengths)):
            return self.values[min(place, len(self.values) - 1)]
        low, high = self.wavelengths[place - 1:place + 1]
        share = (wavelength - low) / (high - low)
        return self.values[place - 1] * (1.0 - share) + self.values[place] * share

    def checked(self, field: Field, path: str) -> Spectrum:
        """A copy with floats in the range of `field`. Raises StackError, naming `path`."""
        where = f"{path}.wavelengths"
        nm = check_table(self.wavelengths, where, WAVELENGTH.low, WAVELENGTH.high, WAVELENGTH.rule, MOST_SAMPLES)
        if any(not isinstance(one, float) for one in nm) or any(a >= b for a, b in zip(nm, nm[1:], strict=False)):
            raise StackError(f"{where}: must be ascending numbers")
        values = check_table(self.values, f"{path}.values", field.low, field.high, field.rule, MOST_SAMPLES)
        if len(values) != len(nm) or any(not isinstance(one, float) for one in values):
            raise StackError(f"{path}.values has {len(values)} entries: must have {len(nm)} like the wavelengths")
        return Spectrum(nm, values)

    def to_json(self) -> dict:
        """A JSON object; read_spectrum reads it."""
        return {"wavelengths": list(self.wavelengths), "values": list(self.values)}


def read_spectrum(value, path: str):
    """A Spectrum from its JSON object; any other value as it is. Raises StackError."""
    if not isinstance(value, dict):
        return value
    check_keys(value, {"wavelengths", "values"}, path, required={"wavelengths", "values"})
    return Spectrum(value["wavelengths"], value["values"])


@dataclass(frozen=True)
class Film(Hashable):
    """A thin film on the next Interface or on the Conductor below, whose reflections interfere: oxide on steel, oil on
    water, an anti-reflex coating. One or more films, top first, lie between the refractive index above them and that of
    the interface, or the metal, that follows them. They share its facets: each facet reflects and passes light as the
    films do. A film between two media needs the Interface that names the next index: a soap film is
    [Film(1.33, 400), Interface(ior=1)]. Between equal indices the interface must be smooth.

    `ior`: absolute refractive index n, or complex n + ik, of n in [0.01, 10] and k in [0, 20]; a number, one per
    channel, or a Spectrum. `k` may be given apart. `thickness`: in nanometres, [0, 5000].

    Light is coherent in the films, incoherent in the rest of the stack, and unpolarised. In a stack of red, green and
    blue the films' factors are means over the spectrum: reflectance and transmittance at 81 wavelengths from 380 to 780
    nm, as linear Rec. 709 under D65 with the CIE 1931 observer, clipped to [0, 1]. This is right for light reflected
    once from a white surrounding. Indices per channel count for the whole spectrum of their channel. For colours after
    several reflections give the stack its `wavelengths`.

    Facets below an absorbing film on an Interface do not return the energy that shadowing loses (`compensate`)."""

    ior: Channels | complex | Spectrum
    thickness: float
    k: Channels | Spectrum = 0.0
    name: str = ""

    kind = "film"
    fields = (FILM_IOR, EXTINCTION, FILM_THICKNESS)
    options = ()
    rare = ()
    has_phase = False
    item = Item(kind, "Thin Film", "A film of nanometres on the interface or metal below it, whose colors come from "
                "interference: oxide, oil, soap, anti-reflex coating", 2, icon="COLOR")

    def __post_init__(self):
        super().__post_init__()
        if isinstance(self.ior, Spectrum) and any(isinstance(one, complex) for one in self.ior.values):
            real, imaginary = (tuple(getattr(complex(one), part) for one in self.ior.values)
                               for part in ("real", "imag"))
            self._set(Spectrum(self.ior.wavelengths, real), Spectrum(self.ior.wavelengths, imaginary))
        elif isinstance(self.ior, complex):
            self._set(self.ior.real, self.ior.imag)
        elif isinstance(self.ior, tuple) and any(isinstance(one, complex) for one in self.ior):
            self._set(tuple(complex(one).real for one in self.ior), tuple(complex(one).imag for one in self.ior))

    def _set(self, ior, k) -> None:
        if self.k != 0.0:
            raise StackError(f"film.k = {quoted(self.k)}: must be left out beside a complex ior")
        object.__setattr__(self, "ior", ior)
        object.__setattr__(self, "k", k)

    @property
    def absorbs(self) -> bool:
        """True unless k is 0 everywhere."""
        values = self.k.values if isinstance(self.k, Spectrum) else self.k
        return any(values) if isinstance(values, tuple) else values != 0.0
