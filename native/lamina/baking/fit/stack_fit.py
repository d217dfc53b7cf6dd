# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixtures of closures fitted to slices of one stack, with closures made for the stack's boundaries.

Row 0 of a varying layer's table is the stack without that layer, as accurate as in a bake of its own. Closures chosen
for the whole material fit the clean stack no better than other rows. Closures for the clean stack are therefore chosen
first. They are part of the choice for all rows, and row 0 has these alone."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace

import numpy as np

from ...closures import narrow_lobes, shaped_lobes
from ...closures.closure_table import LightGrid
from ...common.progress import Progress, portion
from ...material.stack import Stack
from .layered_fit import below_layer
from .mixture import Effort, Mixture, mean_error, mix
from .moving_fit import MovingFit, score
from .slices import Slices, SolvedRows

# Moving lobes are used where they lower the objective below this share, and where the mean error of fixed closures is
# above ACCURATE_ENOUGH.
CLEARLY, ACCURATE_ENOUGH = 0.9, 0.01
# Where moving lobes fit the clean stack and leave a larger mean error in the rows of its layer, these rows are fitted
# without them too: a thick layer hides the lobes, and fixed closures for it need their place.
POOR = 0.04


class StackFit:
    """Fits of one stack. `search`: the effort of the search for closures, see mixture.Effort. `moving`: the number of
    lobes that may move with the view, see moving_fit; they are used where they fit clearly better."""

    def __init__(self, stack: Stack, solved: SolvedRows, grid: LightGrid, pool, search: dict, moving: int = 0):
        self._moving = 0 if solved.is_sheet else moving
        self._solved, self._grid, self._pool, self._search = solved, grid, pool, search
        self._varies, self._retro = stack.varying is not None, narrow_lobes.follow_the_viewer(stack)
        self._made = narrow_lobes.closures(stack)
        clean = [layer for number, layer in enumerate(stack.layers) if number != stack.varying]
        # What narrow_lobes reads of a stack; unlike a Stack it may be empty
        self._made_clean = narrow_lobes.closures(SimpleNamespace(layers=clean, base=stack.base))

    def __call__(self, kind: str, wanted: Slices, counts: tuple[int, int, int], given: list[str], step: Progress,
                 at_boundaries: bool) -> Mixture:
        """`counts`: largest numbers of closures, see bases.job.Basis; `at_boundaries`: with closures made for the
        stack's boundaries. With `given` closures, row 0 has its own choice only if that choice is among them."""
        effort = Effort(*counts, **self._search)
        if self._solved.azimuths is not None:
            fit = MovingFit(self._moving, [], self._grid, effort, self._pool, self._solved.azimuths)
            if self._varies:
                return below_layer(fit, wanted, len(self._solved.rows), given, step)
            oriented = fit(wanted, given, step)
            assert oriented is not None  # no closures of one width serve such a stack
            return oriented
        made, made_clean = (self._made, self._made_clean) if at_boundaries else ([], [])
        may_move = at_boundaries and self._moving > 0

        def best(wanted: Slices, made: list[str], given: list[str], step: Progress,
                 clean: Mixture | None = None) -> Mixture:
            """A mixture with or without moving lobes. `clean`: that of row 0, whose closures are part of the choice."""
            kept = [] if clean is None else clean.closures
            moves = sum(map(shaped_lobes.is_shaped, given or kept))
            moving = None
            if may_move and (moves or not given):
                fit = MovingFit(moves or self._moving, made, self._grid, effort, self._pool, retro=self._retro)
                moving = fit(wanted, given, portion(step, 0.0, 0.5), clean)
                if moves and moving is not None and (given or mean_error(moving.errors) < POOR):
                    return moving
                step = portion(step, 0.5, 1.0)
            fixed = mix(kind, wanted, self._grid, effort, self._pool, step, mixed=self._solved.is_sheet, made=made,
                        given=[] if moves else given,
                        fixed=[name for name in kept if not shaped_lobes.is_shaped(name)])
            if moving is None or mean_error(fixed.errors) < ACCURATE_ENOUGH:
                return fixed
            return moving if score(moving) <= (1.0 if moves else CLEARLY) * score(fixed) else fixed

        if not self._varies or not np.any(wanted.albedo[:, 0]):
            return best(wanted, made, given, step)
        clean = best(wanted.each(lambda part: part[:, :1]), made_clean, [], portion(step, 0.0, 0.3))
        return _with_first_row(best(wanted, made, given, portion(step, 0.3, 1.0), clean), clean, given)


def _with_first_row(whole: Mixture, clean: Mixture, given: Sequence[str]) -> Mixture:
    """The mixture of all rows with row 0 of the clean stack."""
    if given and not set(clean.closures) <= {*whole.closures, *given}:
        return whole
    moving = [name for name in clean.closures if shaped_lobes.is_shaped(name)]
    names = list(dict.fromkeys([*moving, *whole.closures, *clean.closures]))
    names = list(given) if set(names) == set(given) else names
    sides, _, *rest = whole.weights.shape
    weights = np.zeros((sides, len(names), *rest))
    weights[:, [names.index(name) for name in whole.closures]] = whole.weights
    weights[:, :, 0] = 0.0
    weights[:, [names.index(name) for name in clean.closures], 0] = clean.weights[:, :, 0]
    errors, albedo_errors = (np.concatenate([first, every[:, 1:]], axis=1) for first, every in (
        (clean.errors, whole.errors), (clean.albedo_errors, whole.albedo_errors)))
    shapes = whole.shapes
    if clean.shapes is not None:
        # Lobes that only row 0 has keep their shapes in all rows, with weight 0.
        others = np.repeat(clean.shapes, rest[0] - 1, axis=2) if shapes is None else shapes[:, :, 1:]
        shapes = np.concatenate([clean.shapes, others], axis=2)
    return Mixture(names, weights, errors, albedo_errors, shapes)
