# SPDX-License-Identifier: GPL-3.0-or-later
"""The number of walks for a wanted noise, from a short trial."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import cast

import numpy as np

from ..common.progress import Progress
from ..interior.estimates import ExitEstimate, LightEstimate, with_photons, without_lamps
from ..interior.parts import merge_walks, part_of
from ..interior.problem import Samples
from ..interior.walk import Walker
from ..walks.searchlight_moments import Measured

TRIAL_POINTS, TRIAL_SAMPLES = 512, 24
LEAST_SAMPLES, MOST_SAMPLES = 16, 1 << 20
OTHER_SEED = 0x9E3779B97F4A7C15  # the trial must not share random numbers with the run


@dataclass(frozen=True, eq=False)
class Trial:
    """Walks at few of the points of a map. `chosen`: their indices; `estimate`: at these points, where photons have the
    light of the lamps at all points. `seconds` and `work`, in samples per point of the map: that both took."""

    chosen: np.ndarray
    estimate: ExitEstimate | LightEstimate
    photons: LightEstimate | None
    seconds: float
    work: float

    def samples_for(self, noise: float) -> tuple[int, int]:
        """Walks and photons per point, 16 to 2^20, for which `noise_of` the run is about `noise`."""
        if self.photons is None:
            walks = _samples_for(noise, noise_of(self.estimate), TRIAL_SAMPLES)
            return walks, walks
        found = cast(LightEstimate, self.estimate)
        lamps = self.photons.lamps
        # What walks find of the light of lamps is a part of it.
        part = Measured(lamps.value[self.chosen], found.lamps.stderr) if found.lamps_used else None
        walked = max(relative_noise(found.sky), 0.0 if part is None else _of_worst_lamp(part))
        sent = self.photons.count.photons / len(lamps.value)
        return _samples_for(noise, walked, TRIAL_SAMPLES), _samples_for(noise, _of_worst_lamp(lamps), sent)


def _samples_for(noise: float, found: float, samples: float) -> int:
    """Samples for a wanted noise, if so many samples have another one."""
    return int(min(max(LEAST_SAMPLES, math.ceil(samples * (found / noise) ** 2)), MOST_SAMPLES))


def trial(walker: Walker, seed: int, step: Progress) -> Trial:
    """A Trial at up to 512 points, for a run with this seed."""
    count = len(walker.problem.points.positions)
    chosen = np.unique(np.linspace(0, count - 1, min(count, TRIAL_POINTS)).astype(int))
    samples, began = Samples(TRIAL_SAMPLES, (seed ^ OTHER_SEED) % 2**64), time.perf_counter()
    part = part_of(walker.only(chosen), samples, (1, 1), lambda fraction, _: step(0.5 * fraction, "Noise"))
    found, photons, work = merge_walks([part]), None, TRIAL_SAMPLES * len(chosen) / count
    if walker.problem.image is not None:
        lamps = tuple(walker.problem.lights.lamps)  # type: ignore[union-attr]  # an image has lamps
        sent = TRIAL_SAMPLES * len(chosen)
        sums = walker.photons(Samples(1, samples.seed), lambda fraction, _: step(0.5 + 0.5 * fraction, "Noise"),
                              range(sent))
        sky = without_lamps(cast(LightEstimate, found))
        photons, work = with_photons(sky, sums, sent, lamps), work * (1 + len(lamps))
    return Trial(chosen, found, photons, time.perf_counter() - began, work)


def noise_of(estimate: ExitEstimate | LightEstimate) -> float:
    """The relative noise of a map: of the exit albedo, or of the light of the worst lamp or of the sky."""
    if isinstance(estimate, ExitEstimate):
        return relative_noise(estimate.albedo)
    return max(_of_worst_lamp(estimate.lamps), relative_noise(estimate.sky))


def _of_worst_lamp(lamps: Measured) -> float:
    value, stderr = lamps.value, lamps.stderr
    return max((relative_noise(Measured(value[:, k], stderr[:, k])) for k in range(value.shape[1])), default=0.0)


def relative_noise(measured: Measured) -> float:
    """The root mean square of the standard error over the mean value, both over all points and channels; 0 without
    light."""
    mean = float(measured.value.mean())
    return float(np.sqrt((measured.stderr**2).mean())) / mean if mean > 0.0 else 0.0


def preview_report(name: str, done: float) -> str:
    """What a preview is, as one sentence. `done`: share of the samples. Few walks miss rare bright ones and would tell
    too small a standard error."""
    what = f"{100.0 * done:.0f} % of the samples" if done > 0.0 else "a trial at few points"
    return f"{name}, preview from {what}."
