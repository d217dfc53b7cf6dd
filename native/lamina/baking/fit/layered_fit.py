# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixtures for a layer of varying thickness on anisotropic facets.

The layer dims the lobes of the facets, and barely changes their shape. All thicknesses therefore have the lobes of row
0, the stack without the layer, beside LOBES more for what the layer scatters to and from the facets. Shapes do not
depend on the thickness, only weights do: all thicknesses are fitted like channels of one stack."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...closures import shaped_lobes
from ...common.progress import Progress, portion
from .mixture import Mixture, mean_error
from .moving_fit import MovingFit
from .slices import Slices

LOBES = 2
# Solved thicknesses to which the shapes of these lobes are fitted, in one channel.
SHAPED = (2, 4, 6)
# Azimuths in a quarter turn to which they are fitted, at least.
FEWEST_AZIMUTHS = 3
# One lobe is enough for the stack without the layer if its slices have this mean error before the lobes for the layer.
ENOUGH = 0.02


def below_layer(fit: MovingFit, wanted: Slices, thicknesses: int, given: Sequence[str], step: Progress) -> Mixture:
    """The mixture of the slices `wanted`, with so many thicknesses of each azimuth, the first of them 0. `given`:
    closures of an earlier table."""
    clean = _clean(fit, wanted.each(lambda part: np.ascontiguousarray(part[:, ::thicknesses])), given,
                   portion(step, 0.0, 0.3))
    assert clean.shapes is not None
    own = np.moveaxis(clean.shapes[0], (0, 1, 2, 3), (2, 0, 3, 1))  # [azimuth, view, lobe, numbers]

    step(0.3, "Fitting lobes that move with the view")
    azimuths, channels = own.shape[0], wanted.albedo.shape[2]
    every = wanted.each(lambda part: part.reshape(1, azimuths, thicknesses * channels, *part.shape[3:]))
    shaped = [channels * row + channels // 2 for row in SHAPED]
    more = replace(fit, count=LOBES).shapes(every.each(lambda part: part[:, :, shaped]),
                                            stride=max(1, (azimuths - 1) // FEWEST_AZIMUTHS))
    shapes = np.concatenate([own, more], axis=2)
    whole = replace(fit, count=shapes.shape[2])
    found = whole.mixture(every, shapes, given, portion(step, 0.3, 1.0), clean)
    assert found is not None

    def by_thickness(part: np.ndarray) -> np.ndarray:
        return part.reshape(*part.shape[:-3], azimuths * thicknesses, channels, part.shape[-1])

    return replace(found, weights=by_thickness(found.weights), errors=by_thickness(found.errors),
                   albedo_errors=by_thickness(found.albedo_errors), thicknesses=thicknesses)


def _clean(fit: MovingFit, wanted: Slices, given: Sequence[str], step: Progress) -> Mixture:
    """The mixture of the stack without the layer, by as many lobes as the `given` closures have, or by a choice."""
    lobes = sum(map(shaped_lobes.is_shaped, given)) - LOBES
    fixed = [name for name in given if not shaped_lobes.is_shaped(name)]
    for count in [lobes] if lobes > 0 else [1, fit.count]:
        names = [*shaped_lobes.ids(count, True), *fixed] if lobes > 0 else []
        found = replace(fit, count=count)(wanted, names, step)
        if found is not None and mean_error(found.errors) < ENOUGH:
            break
    assert found is not None
    return found
