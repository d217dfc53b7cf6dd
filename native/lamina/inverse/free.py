# SPDX-License-Identifier: GPL-3.0-or-later
"""Free parameters of a template, and sums of them with known coefficients."""

from __future__ import annotations

import math
import numbers
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..common.arguments import check_kind, check_number, finite_list
from ..common.errors import ArgumentError, quoted
from ..kinds.fields import Channels, as_channels


class Linear:
    """A quantity that is linear in free parameters: `constant` plus the sum of parameters times coefficients, each a
    number or an array with one number per channel."""

    __array_ufunc__ = None  # an array times a parameter is one Linear, not an array of them

    @property
    def terms(self) -> dict[Free, float | np.ndarray]:
        raise NotImplementedError

    @property
    def constant(self) -> float | np.ndarray:
        raise NotImplementedError

    def value(self, values: Mapping[Free, float]) -> Channels:
        """The quantity where the parameters have these values: a number, or one per channel."""
        total = self.constant + sum(coefficient * values[free] for free, coefficient in self.terms.items())
        return as_channels(np.atleast_1d(total).tolist())

    def __add__(self, other):
        other = other if isinstance(other, Linear) else Sum({}, _coefficient(other))
        _check_channels([*self.terms.values(), self.constant, *other.terms.values(), other.constant])
        terms = dict(self.terms)
        for free, coefficient in other.terms.items():
            terms[free] = terms.get(free, 0.0) + coefficient
        return Sum(terms, self.constant + other.constant)

    def __mul__(self, other):
        if isinstance(other, Linear):
            raise ArgumentError("a product of two free quantities: must be a product with numbers")
        factor = _coefficient(other)
        return Sum({free: one * factor for free, one in self.terms.items()}, self.constant * factor)

    def __neg__(self):
        return self * -1.0

    def __sub__(self, other):
        return self + (-other if isinstance(other, Linear) else -_coefficient(other))

    def __rsub__(self, other):
        return -self + other

    def __truediv__(self, other):
        if isinstance(other, Linear):
            raise ArgumentError("a quotient by a free quantity: must be a quotient by numbers")
        divisor = _coefficient(other)
        if np.any(np.equal(divisor, 0.0)):
            raise ArgumentError(f"a quotient by {quoted(other)}: must be a quotient by numbers other than 0")
        return self * (1.0 / divisor)

    __radd__, __rmul__ = __add__, __mul__


@dataclass(frozen=True, eq=False)
class Free(Linear):
    """A free parameter of a Template: a value in [`low`, `high`], from which `start` the fit begins.

    It may stand for any number of a layer or base, also for one of several channels. The same object in two places is
    one shared parameter; two objects are two. Sums and products with numbers or arrays (one number per channel) are
    quantities too: `chlorophyll * spectrum + 0.01`. `name` is its name in the result, by default the place where it
    first stands, such as "layers[0].albedo". Raises ArgumentError."""

    start: float
    low: float
    high: float
    name: str = ""

    def __post_init__(self):
        for name in ("start", "low", "high"):
            value = check_number(getattr(self, name), name, "must be a finite number", math.isfinite)
            object.__setattr__(self, name, value)
        if not self.low < self.high:
            raise ArgumentError(f"low = {self.low:g}: must be less than high = {self.high:g}")
        if not self.low <= self.start <= self.high:
            raise ArgumentError(f"start = {self.start:g}: must lie in [{self.low:g}, {self.high:g}]")
        check_kind(self.name, "name", str, "a text")

    @property
    def terms(self):
        return {self: 1.0}

    @property
    def constant(self):
        return 0.0


class Sum(Linear):
    """A sum of free parameters with coefficients."""

    def __init__(self, terms: Mapping[Free, float | np.ndarray], constant: float | np.ndarray):
        self._terms, self._constant = dict(terms), constant

    @property
    def terms(self):
        return self._terms

    @property
    def constant(self):
        return self._constant

    def __repr__(self) -> str:
        return " + ".join([*(f"{coefficient} {free!r}" for free, coefficient in self._terms.items()),
                           f"{self._constant}"])


def _coefficient(given) -> float | np.ndarray:
    """A number, or an array with one number per channel. Raises ArgumentError."""
    if isinstance(given, numbers.Real) and not isinstance(given, bool):
        return check_number(given, "coefficient", "must be a finite number", math.isfinite)
    return finite_list(given, "coefficients")


def _check_channels(values: list) -> None:
    """Raises ArgumentError if the arrays among the values differ in length."""
    counts = {len(value) for value in values if isinstance(value, np.ndarray)}
    if len(counts) > 1:
        raise ArgumentError(f"coefficients have {quoted(sorted(counts))} channels: must have equal numbers")
