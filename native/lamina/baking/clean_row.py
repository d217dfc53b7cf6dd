# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 0 of a varying layer's table: the stack without that layer, as accurate as in a bake of its own.

Closures chosen for the whole material fit the clean stack no better than other rows. Closures for the clean stack are
therefore chosen first. They are part of the choice for all rows, and row 0 has these alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..closures.closure_table import LightGrid
from ..common.progress import Progress, portion
from ..material.stack import Stack
from .mixture import Effort, FittedMixture, mix
from .slices import Slices


@dataclass(frozen=True)
class Boundaries:
    """The layers and base from which narrow_lobes.closures makes closures; unlike a Stack it may be empty."""

    layers: tuple
    base: object


def without_varying(stack: Stack) -> Boundaries:
    layers = [layer for number, layer in enumerate(stack.layers) if number != stack.varying]
    return Boundaries(tuple(layers), stack.base)


def mix_rows(kind: str, wanted: Slices, grid: LightGrid, effort: Effort, pool, step: Progress, *,
             made: Sequence[str], made_clean: Sequence[str], given: Sequence[str], mixed: bool) -> FittedMixture:
    """Like mixture.mix, for slices whose row 0 is the clean stack; `made_clean`: closures made for the clean stack.
    With `given` closures, row 0 has its own choice only if that choice is among them."""
    if not np.any(wanted.albedo[:, 0]):
        return mix(kind, wanted, grid, effort, pool, step, made=made, given=given, mixed=mixed)
    clean = mix(kind, _first_row(wanted), grid, effort, pool, portion(step, 0.0, 0.3), made=made_clean, mixed=mixed)
    whole = mix(kind, wanted, grid, effort, pool, portion(step, 0.3, 1.0), made=made, given=given,
                mixed=mixed, fixed=clean.closures)
    if given and not set(clean.closures) <= {*whole.closures, *given}:
        return whole
    names = [*whole.closures, *(name for name in clean.closures if name not in whole.closures)]
    names = list(given) if set(names) == set(given) else names
    sides, _, *rest = whole.weights.shape
    weights = np.zeros((sides, len(names), *rest))
    weights[:, [names.index(name) for name in whole.closures]] = whole.weights
    weights[:, :, 0] = 0.0
    weights[:, [names.index(name) for name in clean.closures], 0] = clean.weights[:, :, 0]
    return FittedMixture(names, weights, _with_first_row(whole.errors, clean.errors),
                         _with_first_row(whole.albedo_errors, clean.albedo_errors))


def _first_row(wanted: Slices) -> Slices:
    lobes = None if wanted.lobes is None else wanted.lobes[:, :1]
    return Slices(wanted.values[:, :1], wanted.albedo[:, :1], lobes, wanted.direct[:, :1])


def _with_first_row(whole: np.ndarray, clean: np.ndarray) -> np.ndarray:
    return np.concatenate([clean, whole[:, 1:]], axis=1)
