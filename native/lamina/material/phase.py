# SPDX-License-Identifier: GPL-3.0-or-later
"""Tabulated phase functions and mixtures; reading and checking of all phase functions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..common.errors import StackError, quoted
from ..kinds import phases
from ..kinds.fields import Channels, Field, channel, check_keys, check_table, read_kind, to_plain
from ..kinds.phases import PhaseFunction

Phase = PhaseFunction


@dataclass(frozen=True)
class Tabulated(PhaseFunction):
    """A phase function as a table, for example from a Mie code. Lists, or one list per channel.

    Either `moments`, the Legendre moments chi_0 = 1, chi_1 (the mean cosine) ... without the factor 2 l + 1, each in
    [-1, 1], at most 2048, of a function without negative values; or samples: `values` (any unit, not negative) at
    `cosines` of the scattering angle, from -1 to 1 or from 1 to -1, 2 to 20000, joined by monotone cubics (Fritsch and
    Butland 1984) and normalised. All channels share `cosines`."""

    moments: Sequence[float] | Sequence[Sequence[float]] | None = None
    cosines: Sequence[float] | None = None
    values: Sequence[float] | Sequence[Sequence[float]] | None = None

    kind = "tabulated"
    names = ("moments", "cosines", "values")
    NEGATIVE = 1e-3  # the most negative value that rounded moments may cause, relative to the mean
    MOST_MOMENTS, MOST_SAMPLES = 2048, 20000

    def checked(self, path: str) -> Tabulated:
        given = tuple(name for name in self.names if getattr(self, name) is not None)
        if given == ("moments",):
            rows = check_table(self.moments, f"{path}.moments", -1.0, 1.0, "must lie in [-1, 1]", self.MOST_MOMENTS)
            for where, chi in _rows(rows, f"{path}.moments"):
                self._check_moments(chi, where)
            return Tabulated(moments=rows)
        if given == ("cosines", "values"):
            return self._checked_samples(path)
        has = " and ".join(given) or "no numbers"
        raise StackError(f"{path} has {has}: must have either moments, or cosines and values")

    @classmethod
    def _check_moments(cls, chi: tuple[float, ...], path: str) -> None:
        if abs(chi[0] - 1.0) > 1e-6:
            raise StackError(f"{path}[0] = {chi[0]:g}: must be 1")
        angles = np.linspace(0.0, np.pi, 4 * len(chi) + 5)
        series = np.polynomial.legendre.legval(np.cos(angles), (2.0 * np.arange(len(chi)) + 1.0) * chi)
        worst = int(series.argmin())
        if series[worst] < -cls.NEGATIVE:
            raise StackError(f"{path}: their series is {series[worst]:.3g} at {np.degrees(angles[worst]):.1f} degrees: "
                             "must not be negative")

    def _checked_samples(self, path: str) -> Tabulated:
        cosines = check_table(self.cosines, f"{path}.cosines", -1.0, 1.0, "must lie in [-1, 1]", self.MOST_SAMPLES)
        if isinstance(cosines[0], tuple):
            raise StackError(f"{path}.cosines[0] is a list: must be a number")
        values = check_table(self.values, f"{path}.values", 0.0, 1e12, "must lie in [0, 1e12]", self.MOST_SAMPLES)
        backwards = cosines[0] > cosines[-1]
        ascending = cosines[::-1] if backwards else cosines
        for before, after in zip(ascending, ascending[1:], strict=False):
            if not before < after:
                raise StackError(f"{path}.cosines hold {before:g} next to {after:g}: must rise or fall throughout")
        if len(cosines) < 2 or abs(ascending[0] + 1.0) > 1e-9 or abs(ascending[-1] - 1.0) > 1e-9:
            raise StackError(f"{path}.cosines run from {cosines[0]:g} to {cosines[-1]:g}: must reach from -1 to 1")
        for where, row in _rows(values, f"{path}.values"):
            if len(row) != len(cosines):
                raise StackError(f"{where} has {len(row)} values: must have {len(cosines)}, one per cosine")
            if not sum(row) > 0.0:
                raise StackError(f"{where}: all values are 0: one must be positive")
        if backwards:
            values = tuple(row[::-1] for row in values) if isinstance(values[0], tuple) else values[::-1]
        return Tabulated(cosines=(-1.0, *ascending[1:-1], 1.0), values=values)

    def quantities(self, path: str):
        for name in ("moments", "values"):
            rows = getattr(self, name)
            if rows is not None and isinstance(rows[0], tuple):
                yield f"{path}.{name}", rows

    def in_channel(self, index: int) -> tuple:
        if self.moments is not None:
            return "moments", _row(self.moments, index)
        return "samples", self.cosines, _row(self.values, index)

    def to_json(self) -> dict:
        given = {name: getattr(self, name) for name in self.names}
        return {"kind": self.kind, **{name: to_plain(rows) for name, rows in given.items() if rows is not None}}

    def canonical(self, channels: int) -> dict:
        entry = self.to_json()
        name = "values" if self.moments is None else "moments"
        entry[name] = [list(_row(getattr(self, name), c)) for c in range(channels)]
        return entry

    @classmethod
    def read(cls, entry, path: str) -> Tabulated:
        check_keys(entry, {"kind", *cls.names}, path)
        return cls(**{name: entry[name] for name in cls.names if name in entry})


@dataclass(frozen=True)
class Mixture(PhaseFunction):
    """The phase function of several kinds of particles: `parts` are pairs (share, phase function). A share is the
    kind's part of the scattering coefficient, in [0, 1], a number or one per channel; shares sum to 1."""

    parts: Sequence[tuple[Channels, Phase]]

    kind = "mixture"
    share = Field("share", 0.0, 1.0)

    def checked(self, path: str) -> Mixture:
        if not isinstance(self.parts, list | tuple) or not self.parts:
            raise StackError(f"{path}.parts = {quoted(self.parts)}: must be a list of pairs (share, phase function)")
        parts = []
        for index, part in enumerate(self.parts):
            here = f"{path}.parts[{index}]"
            if not isinstance(part, list | tuple) or len(part) != 2:
                raise StackError(f"{here} = {quoted(part)}: must be a pair (share, phase function)")
            if isinstance(part[1], Mixture):
                raise StackError(f"{here}.phase.kind = 'mixture': must not be a mixture itself")
            parts.append((self.share.check(part[0], f"{here}.share"), check_phase(part[1], f"{here}.phase")))
        mixture = Mixture(tuple(parts))
        for c in range(max(len(share) if isinstance(share, tuple) else 1 for share, _ in parts)):
            whole = sum(share[min(c, len(share) - 1)] if isinstance(share, tuple) else share for share, _ in parts)
            if abs(whole - 1.0) > 1e-6:
                raise StackError(f"{path}.parts have shares that sum to {whole:g}: must sum to 1")
        return mixture

    def quantities(self, path: str):
        for index, (share, phase) in enumerate(self.parts):
            yield f"{path}.parts[{index}].share", share
            yield from phase.quantities(f"{path}.parts[{index}].phase")

    def in_channel(self, index: int) -> tuple:
        return self.kind, *((channel(share, index), phase.in_channel(index)) for share, phase in self.parts)

    def to_json(self) -> dict:
        parts = [{"share": to_plain(share), "phase": phase.to_json()} for share, phase in self.parts]
        return {"kind": self.kind, "parts": parts}

    def canonical(self, channels: int) -> dict:
        parts = [{"share": [channel(share, c) for c in range(channels)], "phase": phase.canonical(channels)}
                 for share, phase in self.parts]
        return {"kind": self.kind, "parts": parts}

    @classmethod
    def read(cls, entry, path: str) -> Mixture:
        check_keys(entry, {"kind", "parts"}, path, required={"parts"})
        if not isinstance(entry["parts"], list):
            raise StackError(f"{path}.parts = {quoted(entry['parts'])}: must be a list")
        parts = []
        for index, part in enumerate(entry["parts"]):
            here = f"{path}.parts[{index}]"
            check_keys(part, {"share", "phase"}, here, required={"share", "phase"})
            parts.append((part["share"], read_phase(part["phase"], f"{here}.phase")))
        return cls(parts)


KINDS = (*phases.KINDS, Tabulated, Mixture)
PHASES = {cls.kind: cls for cls in KINDS}


def check_phase(phase, path: str) -> Phase:
    """The phase function with its quantities checked. Raises StackError."""
    if not isinstance(phase, KINDS):
        raise StackError(f"{path} = {quoted(phase)}: must be a phase function")
    return phase.checked(path)


def read_phase(entry, path: str) -> Phase:
    """A phase function from its JSON object. Raises StackError."""
    kind = read_kind(entry, path)
    if not isinstance(kind, str) or kind not in PHASES:
        raise StackError(f"{path}.kind = {quoted(kind)}: must be one of {', '.join(PHASES)}")
    return PHASES[kind].read(entry, path)


def _row(rows, index: int) -> tuple[float, ...]:
    """One channel's list."""
    return rows[index] if isinstance(rows[0], tuple) else rows


def _rows(rows, path: str):
    """(path, list) of each channel that has its own."""
    return [(f"{path}[{i}]", row) for i, row in enumerate(rows)] if isinstance(rows[0], tuple) else [(path, rows)]
