# SPDX-License-Identifier: GPL-3.0-or-later
"""Substances that absorb, by name, with their published spectra."""

from __future__ import annotations

from ..common.arguments import check_field
from ..common.errors import unknown
from ..kinds.media import AMOUNT
from ..kinds.pigments import PIGMENT
from ..kinds.spectra import Spectrum
from .spectrum_files import comment, read_spectra


def names() -> list[str]:
    """The names of the pigments."""
    return sorted(PIGMENT.values)


def absorption(name: str, amount: float = 1.0) -> Spectrum:
    """sigma_a in 1/mm of an amount of a pigment, in [0, 1e9], 380 or 400 to 780 nm; amount_of tells what amount 1 is.
    Spectra add up: absorption("melanin", .3) + absorption("oxyhemoglobin", .05). Raises ArgumentError, and
    UnknownName, a KeyError and StackError."""
    return read_spectra("pigment_spectra", _checked(name))[0] * check_field(amount, AMOUNT)


def amount_of(name: str) -> str:
    """What amount 1 of a pigment is, in words. Raises UnknownName, a KeyError and StackError."""
    return comment("pigment_spectra", _checked(name), "Amount 1")


def source(name: str) -> str:
    """Where the spectrum was published. Raises UnknownName, a KeyError and StackError."""
    return comment("pigment_spectra", _checked(name), "Source")


def _checked(name) -> str:
    if not isinstance(name, str) or name not in PIGMENT.values:
        raise unknown("pigment", name, names())
    return name
