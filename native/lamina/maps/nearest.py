# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolation between scattered places, and with it a coarse preview of a map."""

from __future__ import annotations

import dataclasses

import numpy as np

from ..interior.estimates import ExitEstimate, LightEstimate
from ..settling.mesh import Points
from ..walks.searchlight_moments import Measured
from .noise import Trial

BLOCK = 1 << 10  # positions at a time, to limit memory
NEIGHBOURS = 3
TURN = 0.25  # normals one radian apart count like this share of the mesh's size: thin walls have two sides


def everywhere(trial: Trial, points: Points) -> ExitEstimate | LightEstimate:
    """The estimates of a trial at all points, each interpolated between the trial's nearest points. Light by photons is
    first averaged over the points around each of the trial's."""
    size = float(np.linalg.norm(np.ptp(points.positions, axis=0)))
    lengths = np.linalg.norm(points.normals, axis=1, keepdims=True)
    found = np.concatenate([points.positions, TURN * size * points.normals / lengths], axis=1)
    blocks = [nearest(found[trial.chosen], found[first:first + BLOCK], NEIGHBOURS)
              for first in range(0, len(found), BLOCK)]
    near, weights = (np.concatenate(one) for one in zip(*blocks, strict=True))

    def interpolated(values):
        if isinstance(values, Measured):
            return Measured(interpolated(values.value), interpolated(values.stderr))
        return np.einsum("pk,pk...->p...", weights, np.nan_to_num(values)[near])

    estimate = trial.estimate
    if trial.photons is not None:
        around = near[np.arange(len(near)), weights.argmax(axis=1)]
        lamps, moments = (_means(measured, around, len(trial.chosen))
                         for measured in (trial.photons.lamps, trial.photons.lamp_moments))
        estimate = dataclasses.replace(trial.photons, lamps=lamps, lamp_moments=moments)
    fields = (one.name for one in dataclasses.fields(estimate))
    changed = {name: getattr(estimate, name) for name in fields if name not in ("count", "lamps_used")}
    return dataclasses.replace(estimate, **{name: interpolated(value) for name, value in changed.items()})


def _means(measured: Measured, group: np.ndarray, count: int) -> Measured:
    """The mean of each group of points."""
    value, variance = (np.zeros((count, *measured.value.shape[1:])) for _ in range(2))
    np.add.at(value, group, measured.value)
    np.add.at(variance, group, measured.stderr**2)
    size = np.bincount(group, minlength=count).reshape(-1, *(1,) * (value.ndim - 1))
    return Measured(value / size, np.sqrt(variance) / size)


def nearest(places: np.ndarray, positions: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """(indices, weights), (positions, count), of the nearest of the `places`, which may have any number of coordinates.
    A weight falls with the squared distance."""
    squares = sum((positions[:, axis, None] - places[:, axis]) ** 2 for axis in range(places.shape[1]))
    count = min(count, len(places))
    near = np.argpartition(squares, count - 1, axis=1)[:, :count]
    near.sort(axis=1)
    away = np.take_along_axis(squares, near, axis=1)
    weights = 1.0 / (away + away.mean(axis=1, keepdims=True) + 1e-30)
    return near, weights / weights.sum(axis=1, keepdims=True)
