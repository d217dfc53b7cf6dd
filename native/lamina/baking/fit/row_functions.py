# SPDX-License-Identifier: GPL-3.0-or-later
"""The scattering functions of the rows of a table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, overload

from ...solver.solve import ScatteringFunction


class SolverNumbers(NamedTuple):
    """What the report tells of a solve."""

    nodes: int
    orders: int
    checks: dict[str, float]


class SolvedAgain(Sequence[ScatteringFunction]):
    """Functions that are solved each time that they are used: those of all rows and many wavelengths together take
    gigabytes. `made(row)` solves one; the last one is kept. `numbers`: of all that have been solved, by row."""

    def __init__(self, made: Callable[[int], ScatteringFunction], rows: Sequence[int],
                 numbers: dict[int, SolverNumbers] | None = None):
        self._made, self._rows = made, rows
        self.numbers: dict[int, SolverNumbers] = {} if numbers is None else numbers
        self._last: tuple[int, ScatteringFunction] | None = None

    def __len__(self) -> int:
        return len(self._rows)

    def at(self, places: Sequence[int]) -> SolvedAgain:
        """Those at these places of the sequence."""
        return SolvedAgain(self._made, [self._rows[place] for place in places], self.numbers)

    @overload
    def __getitem__(self, index: int) -> ScatteringFunction: ...

    @overload
    def __getitem__(self, index: slice) -> SolvedAgain: ...

    def __getitem__(self, index):
        if isinstance(index, slice):
            return self.at(range(len(self))[index])
        row = self._rows[index]
        if self._last is None or self._last[0] != row:
            self._last = None  # frees its memory before the next is solved
            function = self._made(row)
            self._last = row, function
            self.numbers[row] = _numbers(function)
        return self._last[1]


def each(change: Callable[[ScatteringFunction], ScatteringFunction],
         functions: Sequence[ScatteringFunction]) -> Sequence[ScatteringFunction]:
    """`change` of each function."""
    if isinstance(functions, SolvedAgain):
        return SolvedAgain(lambda place: change(functions[place]), range(len(functions)))
    return [change(function) for function in functions]


def some(functions: Sequence[ScatteringFunction], places: Sequence[int]) -> Sequence[ScatteringFunction]:
    """The functions at these places."""
    return functions.at(places) if isinstance(functions, SolvedAgain) else [functions[place] for place in places]


def numbers_of(functions: Sequence[ScatteringFunction]) -> list[SolverNumbers]:
    """The numbers of functions that have been solved."""
    return list(functions.numbers.values()) if isinstance(functions, SolvedAgain) else list(map(_numbers, functions))


def _numbers(function: ScatteringFunction) -> SolverNumbers:
    return SolverNumbers(function.nodes, function.orders, function.checks)
