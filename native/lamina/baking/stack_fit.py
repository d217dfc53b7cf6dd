# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixtures of closures fitted to slices of one stack, with closures made for the stack's boundaries."""

from __future__ import annotations

from ..closures import narrow_lobes
from ..closures.closure_table import LightGrid
from ..common.progress import Progress
from ..material.stack import Stack
from .clean_row import mix_rows, without_varying
from .mixture import Effort, FittedMixture, mix
from .slices import Slices, SolvedRows


class StackFit:
    """Fits of one stack. `search`: the effort of the search for closures, see mixture.Effort."""

    def __init__(self, stack: Stack, solved: SolvedRows, grid: LightGrid, pool, search: dict):
        self._solved, self._grid, self._pool, self._search = solved, grid, pool, search
        self._varies = stack.varying is not None
        self._made = narrow_lobes.closures(stack)
        self._made_clean = narrow_lobes.closures(without_varying(stack)) if self._varies else []

    def __call__(self, kind: str, wanted: Slices, counts: tuple[int, int, int], given: list[str], step: Progress,
                 at_boundaries: bool) -> FittedMixture:
        """`counts`: largest numbers of closures, see bake.Basis; `at_boundaries`: with closures made for the stack's
        boundaries."""
        effort = Effort(*counts, **self._search)
        made, made_clean = (self._made, self._made_clean) if at_boundaries else ((), ())
        mixed = self._solved.is_sheet
        if not self._varies:
            return mix(kind, wanted, self._grid, effort, self._pool, step, made=made, given=given, mixed=mixed)
        return mix_rows(kind, wanted, self._grid, effort, self._pool, step, made=made, made_clean=made_clean,
                        given=given, mixed=mixed)
