# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities by wavelength."""

from __future__ import annotations

import bisect
import functools
import math
import numbers
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from pathlib import Path

from .errors import StackError, quoted
from .fields import Field, Option, check_keys, check_table
from .hashable import Hashable, as_tuples
from .panel import Item

WAVELENGTH = Field("wavelengths", 100.0, 1e5, "nm")
ANY = Field("values", -1e300, 1e300)
POWER = Field("values", 0.0, 1e300)
MOST_SAMPLES = 4096
# Those of a stack with spectra that names none, in nm. The colours of dyes differ from those by 81 wavelengths by at
# most dE2000 = .6; with sixteen from 380 to 730 nm by .8.
WAVELENGTHS = tuple(410.0 + 280.0 * number / 15 for number in range(16))
D65 = "D65"
ILLUMINANT = Option("illuminant", (D65, "A", "E", "LED"), "Seen Under", "The light under which the colors of pigments "
                    "and metals by their spectrum are taken. Lamps keep their own color; white stays white", (
                        Item(D65, "Daylight", "CIE D65", 0),
                        Item("A", "Light Bulbs", "CIE A, 2856 K", 1),
                        Item("E", "Equal Energy", "The same power at each wavelength", 2),
                        Item("LED", "White LED", "CIE LED-B3, 4103 K", 3)))


def check_wavelengths(given) -> tuple[float, ...]:
    """The wavelengths as a tuple of floats. Raises StackError."""
    values = WAVELENGTH.check(given, WAVELENGTH.name)
    values = values if isinstance(values, tuple) else (values,)
    if len(set(values)) < len(values):
        raise StackError("wavelengths: must differ from one another")
    return values


@dataclass(frozen=True)
class Spectrum(Hashable):
    """A quantity by wavelength: `wavelengths` in nm, ascending, in [100, 1e5], and as many `values`. Linear in between,
    constant beyond the ends. Values of a film's `ior` may be complex, n + ik.

    Any quantity of a stack that may differ between channels may be a Spectrum. Channels are then wavelengths: those of
    `Stack.wavelengths`, by default lamina.WAVELENGTHS."""

    wavelengths: Sequence[float]
    values: Sequence[complex]

    __array_ufunc__ = None  # an array times a spectrum is no array of spectra

    def at(self, wavelength: float):
        """The value at a wavelength in nm. Raises StackError."""
        wavelengths, values = self._knots
        if not isinstance(wavelength, numbers.Real) or math.isnan(wavelength):
            raise StackError(f"wavelength = {quoted(wavelength)}: must be one number, in nm")
        place = bisect.bisect_left(wavelengths, wavelength)
        if place in (0, len(wavelengths)):
            return values[min(place, len(values) - 1)]
        low, high = wavelengths[place - 1:place + 1]
        share = (wavelength - low) / (high - low)
        return values[place - 1] * (1.0 - share) + values[place] * share

    def __mul__(self, factor: float) -> Spectrum:
        """All values times a number. Raises StackError."""
        wavelengths, values = self._knots
        factor = as_tuples(factor)  # an array of one number, without axes, is that number
        if not isinstance(factor, numbers.Complex):
            raise StackError(f"factor = {quoted(factor)}: a spectrum can be multiplied by one number only")
        return Spectrum(wavelengths, tuple(value * factor for value in values))

    __rmul__ = __mul__

    def __add__(self, other: Spectrum) -> Spectrum:
        """The sum of two spectra, at the wavelengths of both. Raises StackError."""
        if not isinstance(other, Spectrum):
            raise StackError(f"summand = {quoted(other)}: only a Spectrum can be added to a spectrum")
        wavelengths = tuple(sorted({*self._knots[0], *other._knots[0]}))
        return Spectrum(wavelengths, tuple(self.at(one) + other.at(one) for one in wavelengths))

    @functools.cached_property
    def _knots(self) -> tuple[Sequence[float], Sequence[complex]]:
        """(wavelengths, values) as given. Raises StackError unless there is one number, real or complex, at each of
        ascending wavelengths."""
        nm, values = self.wavelengths, self.values
        lists = isinstance(nm, tuple) and isinstance(values, tuple) and len(nm) == len(values) > 0
        if not lists or not all(isinstance(one, numbers.Real) for one in nm) or \
                not all(isinstance(one, numbers.Complex) for one in values) or \
                not all(a < b for a, b in zip(nm, nm[1:], strict=False)):
            raise StackError(f"wavelengths = {quoted(nm)}, values = {quoted(values)}: must be ascending wavelengths, "
                             "and a number for each")
        return nm, values

    @classmethod
    def load(cls, path: str | os.PathLike) -> Spectrum:
        """Reads a text file with a wavelength in nm and a value in each line, separated by a comma or spaces; lines
        that begin with # and a first line of words are left out. Raises StackError and OSError."""
        if not isinstance(path, str | os.PathLike):
            raise StackError(f"path = {quoted(path)}: must be a string or a Path")
        try:
            text = Path(path).read_text(encoding="utf-8-sig")  # spreadsheets begin with a byte order mark
        except UnicodeDecodeError:
            raise StackError(f"{path}: must be a text in UTF-8") from None
        rows: list[tuple[float, ...]] = []
        for number, line in enumerate(text.splitlines(), 1):
            cells = line.replace(",", " ").split()
            if not cells or cells[0].startswith("#"):
                continue
            try:
                wavelength, value = map(float, cells)
            except ValueError:
                if not rows and not re.match(r"[-+.\d]", cells[0]):
                    continue  # names of the columns
                raise StackError(f"{path}, line {number}: must hold a wavelength and a value") from None
            rows.append((wavelength, value))
        if not rows:
            raise StackError(f"{path}: holds no wavelengths")
        wavelengths, values = zip(*rows, strict=True)
        return cls(wavelengths, values).checked(ANY, "spectrum")

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
    if not isinstance(value, dict) or "wavelengths" not in value:
        return value
    check_keys(value, {"wavelengths", "values"}, path, required={"wavelengths", "values"})
    return Spectrum(value["wavelengths"], value["values"])


def has_spectrum(thing) -> bool:
    """True if a quantity of a layer, a base or its phase function is a Spectrum, but for films, which keep theirs."""
    return bool(_spectra(thing)) or (_has_phase(thing) and has_spectrum(thing.phase))


def sampled(thing, wavelengths: Sequence[float], path: str):
    """A layer, a base or a phase function with one value per wavelength in place of each Spectrum, but for films.
    Raises StackError, naming `path`."""
    changes: dict = {}
    for name, spectrum in _spectra(thing).items():
        known = spectrum.checked(ANY, f"{path}.{name}")
        changes[name] = tuple(known.at(wavelength) for wavelength in wavelengths)
    if _has_phase(thing) and has_spectrum(thing.phase):
        changes["phase"] = sampled(thing.phase, wavelengths, f"{path}.phase")
    return replace(thing, **changes) if changes else thing


def _spectra(thing) -> dict[str, Spectrum]:
    if not is_dataclass(thing) or isinstance(thing, type) or getattr(thing, "kind", "") == "film":
        return {}
    values = {one.name: getattr(thing, one.name) for one in fields(thing) if one.init}
    return {name: value for name, value in values.items() if isinstance(value, Spectrum)}


def _has_phase(thing) -> bool:
    return is_dataclass(getattr(thing, "phase", None))
