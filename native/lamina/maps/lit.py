# SPDX-License-Identifier: GPL-3.0-or-later
"""Lit maps: the radiance that leaves each point of an interior, for each lamp and for the sky."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from ..common.progress import Progress
from ..interior.estimates import LightEstimate
from ..interior.grid import Interior
from ..interior.lamps import AnyLamp, Surroundings
from ..interior.occluders import Occluders
from ..interior.problem import Lights, Problem, Run, Surface
from ..interior.solid import Solid
from ..walks.searchlight_moments import Measured
from .exponential import even_moments, exponential
from .map_walk import MapWalk, Target, map_of
from .noise import noise_of, preview_report
from .places import Places
from .smoothing import smoothed


@dataclass(frozen=True, eq=False)
class LitImages:
    """Radiance after transport inside, float32. `lamps`: for each lamp of unit strength, shape (lamps, height, width,
    3) or (lamps, vertices, 3); `sky`: for the surroundings, shape (height, width, 3) or (vertices, 3). Images have
    their rows from the bottom, as in Blender. The picture under lamps of other strengths is the sum of these arrays,
    each times its strength and colour. The boundary's reflection is not included.

    `lamp_changes`, `sky_change`: how radiance changes with the view, in arrays of the same shapes but for a last axis
    of 9. In the direction w, a unit vector to the eye, the radiance is that of the image times exp of the sum of these
    numbers times x, y, z, x^2, y^2, xy, yz and zx of w, and 1; behind a smooth boundary also times 1 - Fresnel's
    reflectance, see lamina.maps.exponential. Both arrays are None if directions are given.

    `mask`: the texels, or the vertices, with a value of their own; those of the margin have copies. `estimate`: values
    and standard errors at the points of the mask, in sequence. `noise`: standard error relative to the mean, of the
    worst lamp or the sky. `notes`: parts of the surface without texels. `done`: share of the samples, below 1 in a
    preview; 0 in the first preview, which is interpolated between few points."""

    lamps: np.ndarray
    sky: np.ndarray
    lamp_changes: np.ndarray | None
    sky_change: np.ndarray | None
    mask: np.ndarray
    estimate: LightEstimate
    noise: float
    seconds: float
    notes: tuple[str, ...]
    done: float = 1.0

    @property
    def report(self) -> str:
        """Size and noise, as one sentence."""
        if self.done < 1.0:
            return preview_report("Light", self.done)
        photons = self.estimate.count.photons
        sent = f"{photons:,} photons of each lamp, " if photons else ""
        return (f"Light: {int(self.mask.sum()):,} points with {self.estimate.count.samples:,} samples each, {sent}"
                f"standard error {100.0 * self.noise:.2g} %.")


def lit_images(solid: Solid, interior: Interior, lamps: Sequence[AnyLamp] = (), uvs=None, size=None,
               surface: Surface | None = None, view=None, eye=None, *, noise: float = 0.02, samples: int | None = None,
               seed: int = 0, margin: int = 4, normals=None, folder: str | os.PathLike | None = None, threads: int = 0,
               progress: Progress | None = None, cancel: Callable[[], bool] | None = None,
               surroundings: Surroundings | None = None,
               preview: Callable[[LitImages], None] | None = None, spread: Executor | None = None,
               occluders: Occluders | None = None) -> LitImages:
    """The light that leaves an interior at each texel of a UV map, or at each vertex, under each of the `lamps` and
    under the `surroundings`, by default a sky of radiance 1 from all directions, among the `occluders`.

    `view`: direction to the eye, (3,), or `eye`: its position in mm, (3,). Points that face away are not in the mask;
    within the margin they have copies, beyond it they are black. By default the light is the cosine-weighted mean over
    directions, with its change by direction. In an image of that mean the light of lamps is by photons, as a mean
    over the texel's surface: each lamp sends `samples` photons per point, or as many as `noise` asks for. The images
    have less noise than the estimates, see lamina.maps.smoothing. Other arguments and errors are those of
    relightable_images; `noise` is that of the estimates and concerns the worst lamp or the sky. Lamps are those of
    light_in_mesh."""
    problem = Problem(solid, interior, surface, Lights(lamps, surroundings, occluders))
    target = Target(uvs, size, normals, margin, folder, view, eye)
    run = Run(samples, noise, seed, threads, progress, cancel, spread)
    return map_of(problem, target, run, _images, preview)


def _images(walked: MapWalk, margin: int) -> LitImages:
    found: LightEstimate = walked.estimate  # type: ignore[assignment]  # of this kind
    places, problem = walked.places, walked.walker.problem
    by_view = problem.points.views is None
    # One pass for light and moments, because the regression's matrices are the same
    measured = _joined(found.lamps, found.sky)
    if by_view:
        moments = _joined(found.lamp_moments, found.sky_moments)
        excess = _excess(measured, moments, even_moments(problem.points.normals, problem.boundary)[:, None])
        measured = Measured(*(np.concatenate([getattr(one, part) for one in (measured, excess)], axis=-1)
                              for part in ("value", "stderr")))
    if walked.done:
        measured = smoothed(places, problem.interior, measured, is_light=True, threads=walked.walker.threads)
    light = np.maximum(measured.value[..., :3], 0.0)
    lamps, sky = _filled(places, light, margin)
    changes: tuple[np.ndarray | None, np.ndarray | None] = None, None
    if by_view:
        excess = Measured(measured.value[..., 3:], measured.stderr[..., 3:])
        change = exponential(light.mean(axis=-1), excess, problem.points.normals, problem.boundary)
        changes = _filled(places, change, margin)
    return LitImages(lamps, sky, *changes, places.mask, found, noise_of(found), time.perf_counter() - walked.began,
                     places.notes, walked.done)


def _joined(lamps: Measured, sky: Measured) -> Measured:
    """(points, sources, numbers), the surroundings last."""
    return Measured(np.concatenate([lamps.value, sky.value[:, None]], axis=1),
                    np.concatenate([lamps.stderr, sky.stderr[:, None]], axis=1))


def _excess(light: Measured, moments: Measured, even: np.ndarray) -> Measured:
    """The moments less those of the same light in all directions, which have less noise. `even`: moments of such light
    of mean 1.

    A path brings the light L along a direction with the term t. If e is the term's mean, the variance of L (t - e) is
    that of L t less (2 e E[t] - e^2) times that of L."""
    gray = light.value.mean(axis=-1, keepdims=True)
    ratio = np.divide(moments.value, gray, out=np.zeros_like(moments.value), where=gray > 0.0)
    common = (2.0 * even * ratio - even**2) * (light.stderr**2).mean(axis=-1, keepdims=True)
    stderr = np.sqrt(np.maximum(moments.stderr**2 - common, 0.0))
    return Measured(moments.value - even * gray, np.maximum(stderr, 0.1 * moments.stderr))


def _filled(places: Places, values: np.ndarray, margin: int) -> tuple[np.ndarray, np.ndarray]:
    """(images of the lamps, image of the sky) of values (points, sources, n)."""
    *lamps, sky = (places.filled(values[:, k], margin) for k in range(values.shape[1]))
    return np.stack(lamps) if lamps else np.zeros((0, *sky.shape), np.float32), sky
