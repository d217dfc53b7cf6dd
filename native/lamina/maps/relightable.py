# SPDX-License-Identifier: GPL-3.0-or-later
"""Relightable maps: inputs of Cycles' Subsurface Scattering node at each point of an interior."""

from __future__ import annotations

import dataclasses
import functools
import os
import time
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from ..common.progress import Progress, silent
from ..interior.estimates import ExitEstimate
from ..interior.grid import Interior
from ..interior.problem import Problem, Run, Samples, Surface
from ..interior.solid import Solid
from ..kinds.limits import MOST_NODE_IOR
from ..subsurface.node_inputs import Closure, SubsurfaceInputs, checked_version, inputs_of_closures
from ..subsurface.node_parameters import LEAST_IOR
from ..subsurface.node_response import LARGEST_G
from ..subsurface.unscattered import MOST_UNSCATTERED
from ..walks.searchlight_moments import Measured
from .body_response import closures_in_body
from .map_walk import MapWalk, Target, map_of
from .noise import noise_of, preview_report
from .smoothing import smoothed

FEW_POINTS, FEW_SAMPLES = 256, 32  # for the share of light that crosses a body without scattering
WALKING = 0.8  # share of the progress: the walks of the map
_ARRAYS = ("color", "radius", "extra_color", "extra_radius", "albedo", "distance", "albedo_error", "distance_error")


@dataclass(frozen=True, eq=False)
class RelightableImages:
    """Inputs of Cycles' Subsurface Scattering node. `inputs`: a lamina.SubsurfaceInputs whose arrays have the shape
    (height, width, 3) or (vertices, 3), float32, lengths in mm. Images have their rows from the bottom, as in Blender.
    Its `albedo` and `distance` are those of the node's medium in a flat and infinitely thick body, without Cycles'
    limit of flights; in the mesh, the node has those of `estimate`. A second closure replaces the light that the limit
    loses in the mesh.

    `mask`: the texels, or the vertices, with a value of their own; texels of the margin have copies. `estimate`: exit
    albedo and distance with standard errors, at the points of the mask in sequence. `noise`: standard error of the exit
    albedo relative to the mean over points and channels. `notes`: parts of the surface without texels. `done`: share of
    the samples, below 1 in a preview; 0 in the first preview, which is interpolated between few points."""

    inputs: SubsurfaceInputs
    mask: np.ndarray
    estimate: ExitEstimate
    noise: float
    seconds: float
    notes: tuple[str, ...]
    done: float = 1.0

    @property
    def report(self) -> str:
        """Size, noise and the nodes' errors, as two sentences."""
        if self.done < 1.0:
            return preview_report("Colors and radii", self.done)
        return (f"Colors and radii: {int(self.mask.sum()):,} points with {self.estimate.count.samples:,} samples each, "
                f"standard error {100.0 * self.noise:.2g} %. {self.inputs.report}")


def relightable_images(solid: Solid, interior: Interior, uvs=None, size=None, surface: Surface | None = None,
                       version: tuple[int, int] = (4, 5), noise: float = 0.02, samples: int | None = None,
                       *, seed: int = 0, margin: int = 4, normals=None, folder: str | os.PathLike | None = None,
                       threads: int = 0, progress: Progress | None = None,
                       cancel: Callable[[], bool] | None = None,
                       preview: Callable[[RelightableImages], None] | None = None,
                       spread: Executor | None = None) -> RelightableImages:
    """Color and Radius, for each texel of a UV map or each vertex, with which Cycles' Subsurface Scattering node has
    the exit albedo and the mean exit distance of an interior.

    `solid`, `interior`, `surface`: as for walk_in_mesh, lengths in mm. `uvs`: (triangles, 3, 2) by corner, without
    overlaps, and `size`: of a square image or (width, height), each 1 to 16384; without both, values of vertices.
    `normals`: shading normals, (vertices, 3) or (triangles, 3, 3); by default of the faces, smooth across edges up to
    30 degrees. `version`: the release of Blender. `noise`: wanted standard error of the exit albedo relative to its
    mean, (0, 1]; a short trial finds the number of samples. `samples`: samples per point instead. `margin`: texels by
    which islands are extended, 0 to 64; on vertices, edges.

    `folder`: keeps finished parts of the walks, so that the same call after an interruption continues, and returns the
    same bytes. A folder with parts of another call is refused; damaged parts are computed again. The folder is not
    deleted at the end. The same seed gives the same bytes for any number of `threads` (0: all).

    `preview(images)` is called from time to time with the images so far: first with coarse ones from the trial, later
    each time the number of samples has doubled. Previews lack the correction for thin parts and the second closure. A
    run with previews has other parts in its folder than one without. `spread`: an executor of concurrent.futures that
    computes the parts, such as that of lamina.distributed.spread; the bytes are the same.

    The images have less noise than the estimates: a regression on the coefficients below the texels, see
    lamina.maps.smoothing. A boundary is shown by a Glossy closure above the node, see SubsurfaceInputs. Light enters
    from all directions with the flux of a uniform sky, so the node's mean over views matches. Walks in uniform
    media in the same mesh correct for thin parts. Raises InteriorError, ArgumentError, ShardError, Cancelled, OSError
    with the number of finished parts when the folder cannot be written, and DustUnavailable without a working
    Embree."""
    checked_version(version)
    problem, target = Problem(solid, interior, surface), Target(uvs, size, normals, margin, folder)
    run = Run(samples, noise, seed, threads, progress, cancel, spread)
    return map_of(problem, target, run, functools.partial(_images, version), preview, WALKING)


def _images(version: tuple[int, int], walked: MapWalk, margin: int) -> RelightableImages:
    found: ExitEstimate = walked.estimate  # type: ignore[assignment]  # of this kind
    inputs = _inputs(found, walked, version)
    images = {name: walked.places.filled(getattr(inputs, name), margin) for name in _ARRAYS}
    in_images = dataclasses.replace(inputs, **images)  # type: ignore[arg-type]  # fields that are arrays
    notes = (*walked.places.notes, *_crossing(walked)) if walked.done == 1.0 else walked.places.notes
    return RelightableImages(in_images, walked.places.mask, found, noise_of(found),
                             time.perf_counter() - walked.began, notes, walked.done)


def _crossing(walked: MapWalk) -> tuple[str, ...]:
    """A note if much of the light that leaves has not scattered: Cycles' node shows this light as scattered."""
    count = len(walked.places.points.positions)
    few = np.unique(np.linspace(0, count - 1, min(count, FEW_POINTS)).astype(int))
    samples = Samples(FEW_SAMPLES, walked.samples.seed)
    moments, _, _, scattered = walked.walker.only(few).exits(samples, silent, late_after=(0.0,) * 3)
    leaving = moments[..., 0].sum()
    share = 1.0 - scattered[..., 0].sum() / leaving if leaving > 0.0 else 0.0
    if share <= MOST_UNSCATTERED:
        return ()
    return (f"{100.0 * share:.0f} % of the light that leaves has crossed the body without scattering, and Relightable "
            "shows this light as scattered: use Lit",)


def _inputs(found: ExitEstimate, walked: MapWalk, version: tuple[int, int]) -> SubsurfaceInputs:
    """The node's inputs at each point."""
    interior, surface = walked.walker.problem.interior, walked.walker.problem.boundary
    entered = 1.0 - float(found.mirrored.mean())  # the same at each point, except for noise
    # One pass for both, because the regression's matrices are the same
    both = Measured(np.stack([found.albedo.value, found.mean_distance.value], axis=1),
                    np.stack([found.albedo.stderr, found.mean_distance.stderr], axis=1))
    if walked.done:
        both = smoothed(walked.places, interior, both, is_light=False, threads=walked.walker.threads)
    albedo, distance = np.moveaxis(both.value, 1, 0)
    albedo = np.clip(albedo / entered, 0.0, 1.0)
    distance = np.maximum(np.nan_to_num(distance), 0.0)
    ior = min(max(surface.ior, LEAST_IOR), MOST_NODE_IOR)
    g, roughness = mean_anisotropy(interior), surface.alpha if surface.ior > 1.0 else 0.0
    first, second = Closure(1.0, albedo, distance), None
    if walked.done == 1.0:
        first, second = closures_in_body(albedo, distance, walked, g, ior, roughness)
    return inputs_of_closures(first, second, g, version, ior, roughness)


def mean_anisotropy(interior: Interior) -> float:
    """Mean cosine of the phase function, weighted by the scattering of the end materials, in the node's range."""
    if not interior.palette:
        return float(np.clip(interior.g, 0.0, LARGEST_G))
    weights = np.array([sum(one.sigma_s) for one in interior.palette])  # type: ignore[arg-type]
    if not weights.any():
        return 0.0
    return float(np.clip(np.average([one.g for one in interior.palette], weights=weights), 0.0, LARGEST_G))
