# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake is asked for: the stack, the effort, and closures of an earlier table."""

from __future__ import annotations

import collections
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from ... import _core
from ...closures import lobes
from ...common.errors import ArgumentError, quoted
from ...common.progress import Progress
from ...kinds.table import OWN, Strip
from ...material.stack import Stack
from ..fit.slices import SolvedRows, solve_rows


@dataclass(frozen=True)
class Basis:
    """Largest numbers of closures in a table: (for lobes of rough boundaries, for other light, for both together); of
    a Principled base, beside the BSDF: (for a fixed color; for a color as an input: for the light over black, for the
    light that the color adds to a dielectric, and to a metal); of a Principled base below an interface: (for diffuse
    light of the base, for all its light). `moving`: the number of lobes that may move with the view, which Blender 5.0
    and newer sample rightly."""

    reflected: tuple[int, int, int]
    transmitted: tuple[int, int, int]
    textured_base: tuple[int, int, int]
    principled: tuple[int, int, int, int]
    covered: tuple[int, int]
    moving: int = 0


_STANDARD = Basis((5, 5, 8), (4, 4, 4), (0, 2, 2), (5, 3, 2, 4), (2, 9))
_ACCURATE = Basis((12, 13, 20), (8, 8, 8), (0, 4, 4), (14, 9, 6, 6), (4, 18))
CLOSURE_BASES = {
    "standard": _STANDARD,
    "moving": replace(_STANDARD, moving=2),
    "accurate": _ACCURATE,
    "moving-accurate": replace(_ACCURATE, moving=2),
}
# Effort of the search for closures: see mixture.Effort.
SEARCH = {"preview": {"overshoot": 0, "exchanges": 1, "column_stride": 6, "row_stride": 16},
          "final": {"overshoot": 2, "exchanges": 2, "column_stride": 4, "row_stride": 8}}


@dataclass(frozen=True)
class Job:
    """The arguments of lamina.bake, checked. `given`: strips whose closures are fitted without a choice; `measures`:
    errors over the ranges of the base's inputs are measured."""

    stack: Stack
    quality: str
    basis: str
    threads: int
    row_stride: int
    nodes: int | None
    given: Sequence[Strip]
    measures: bool
    step: Progress

    def solved(self, stack: Stack, step: Progress, stride: int | None = None,
               only: Collection[int] | None = None) -> SolvedRows:
        """Rows of a stack, by default every `row_stride`-th: see slices.solve_rows."""
        return solve_rows(stack, self.quality, self.threads, step, stride or self.row_stride, self.nodes, only)

    def closures(self, role: str = OWN, metal: bool = False, side: str = "reflection") -> list[str]:
        """The given closures of one role and side."""
        return [strip.closure for strip in self.given
                if (strip.role, strip.metal, lobes.by_id(strip.closure).side) == (role, metal, side)]


def given_strips(names: Sequence[str] | None) -> list[Strip]:
    """The strips with these names whose closures a bake can choose, none for None. Raises ArgumentError for no name,
    one that is unknown or given twice, and for too many."""
    if names is None:
        return []
    if isinstance(names, str) or not isinstance(names, Sequence) or not all(isinstance(name, str) for name in names):
        raise ArgumentError(f"closures = {quoted(names)}: must be a list of lobe ids")
    if not names:
        raise ArgumentError("closures = []: must hold a lobe id, or be None for a choice by the bake")
    # Unscattered light, mirrors and what is no closure are always in the table
    strips = [strip for strip in map(Strip.of, names)
              if strip.is_weight and strip.closure != "transparent" and not strip.closure.startswith("mirror:")]
    counts: collections.Counter[str] = collections.Counter()
    for strip in strips:
        try:
            side = lobes.by_id(strip.closure).side
        except KeyError:
            raise ArgumentError(f"closures: {quoted(strip.name)} is not in the dictionary") from None
        counts[strip.name.removesuffix(strip.closure) or side] += 1
    if len(set(strips)) < len(strips):
        raise ArgumentError(f"closures = {quoted(list(names))}: one is given twice")
    for kind, count in counts.items():
        if count > _core.MAX_CLOSURES:
            raise ArgumentError(f"closures: {count} for {kind}, at most {_core.MAX_CLOSURES} can be fitted")
    return strips
