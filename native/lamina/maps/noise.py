# SPDX-License-Identifier: GPL-3.0-or-later
"""The number of walks for a wanted noise, from a short trial."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np

from ..common.progress import Progress
from ..interior.estimates import ExitEstimate, LightEstimate
from ..interior.parts import merge_walks, part_of
from ..interior.problem import Samples
from ..interior.walk import Walker
from ..walks.searchlight_moments import Measured

TRIAL_POINTS, TRIAL_SAMPLES = 512, 24
LEAST_SAMPLES, MOST_SAMPLES = 16, 1 << 20
OTHER_SEED = 0x9E3779B97F4A7C15  # the trial must not share random numbers with the run


@dataclass(frozen=True, eq=False)
class Trial:
    """Walks at few of the points of a map. `chosen`: their indices; `estimate`: at these points; `seconds`: that they
    took."""

    chosen: np.ndarray
    estimate: ExitEstimate | LightEstimate
    seconds: float

    def samples_for(self, noise: float) -> int:
        """Walks per point, 16 to 2^20, for which `noise_of` the run is about `noise`."""
        found = noise_of(self.estimate)
        return int(min(max(LEAST_SAMPLES, math.ceil(TRIAL_SAMPLES * (found / noise) ** 2)), MOST_SAMPLES))


def trial(walker: Walker, seed: int, step: Progress) -> Trial:
    """A Trial at up to 512 points, for a run with this seed."""
    count = len(walker.problem.points.positions)
    chosen = np.unique(np.linspace(0, count - 1, min(count, TRIAL_POINTS)).astype(int))
    samples, began = Samples(TRIAL_SAMPLES, (seed ^ OTHER_SEED) % 2**64), time.perf_counter()
    part = part_of(walker.only(chosen), samples, (1, 1), lambda fraction, _: step(fraction, "Noise"))
    return Trial(chosen, merge_walks([part]), time.perf_counter() - began)


def noise_of(estimate: ExitEstimate | LightEstimate) -> float:
    """The relative noise of a map: of the exit albedo, or of the light of the worst lamp or of the sky."""
    if isinstance(estimate, ExitEstimate):
        return relative_noise(estimate.albedo)
    lamps = [Measured(estimate.lamps.value[:, k], estimate.lamps.stderr[:, k]) for k in range(len(estimate.lamps_used))]
    return max(map(relative_noise, [*lamps, estimate.sky]))


def relative_noise(measured: Measured) -> float:
    """The root mean square of the standard error over the mean value, both over all points and channels; 0 without
    light."""
    mean = float(measured.value.mean())
    return float(np.sqrt((measured.stderr**2).mean())) / mean if mean > 0.0 else 0.0


def preview_report(name: str, done: float, noise: float) -> str:
    """What a preview is, as one sentence. `done`: share of the samples."""
    what = f"{100.0 * done:.0f} % of the samples" if done > 0.0 else "a trial at few points"
    return f"{name}, preview from {what}: standard error {100.0 * noise:.2g} %."
