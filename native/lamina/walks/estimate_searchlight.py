# SPDX-License-Identifier: GPL-3.0-or-later
"""Monte Carlo estimates of a stack's response to a pencil beam: walks with positions in millimetres."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .. import _core
from ..common.arguments import LEAST_BEAM_COSINE, check_choice, check_number, check_seed, finite_list
from ..common.by_content import ByContent
from ..common.errors import ArgumentError, StackError
from ..common.progress import Progress, stepper
from ..kinds.bases import HalfSpace
from ..kinds.fields import channel
from ..material.any_stack import AnyStack, as_stack
from ..material.layers import Medium
from ..material.millimetres import depth_knots, require_millimetres
from ..material.stack import Stack
from ..solver.core_calls import thread_pool
from ..solver.core_stack import core_stack
from .estimate import blocks_of, chunks_in, each_chunk, each_problem
from .searchlight_moments import DISTANCE, FIRST_FREQUENCY, SQUARE, WEIGHT, Measured, SideMoments

MOST_RADII, MOST_FREQUENCIES = 4096, 64
WALKS = {"transfer": "photon_walk", "scattering": "plane_scattering_walk"}  # the core's names


@dataclass(frozen=True)
class SearchlightQuery:
    """The estimated quantities for a pencil beam of cosine `mu_i` in air, (0, 1], where less than 1e-4 counts as 1e-4,
    and the `walk` ("transfer" or "scattering"): the flux within the radii `r` (mm) and the transform at the lateral
    frequencies `q` (1/mm), each a number or a list, from 0. Raises ArgumentError, a ValueError."""

    mu_i: float = 1.0
    walk: str = "transfer"
    r: tuple[float, ...] = ()
    q: tuple[float, ...] = ()

    def __post_init__(self):
        check_choice(self.walk, "walk", WALKS)
        cosine = check_number(self.mu_i, "mu_i", "must be one number in (0, 1]", lambda mu: 0.0 < mu <= 1.0)
        object.__setattr__(self, "mu_i", max(cosine, LEAST_BEAM_COSINE))
        for name, most, unit in (("r", MOST_RADII, "mm"), ("q", MOST_FREQUENCIES, "1/mm")):
            values = finite_list(getattr(self, name), name)
            if values.size > most:
                raise ArgumentError(f"{name} has {values.size} values: must be at most {most}")
            if np.any(values < 0.0):
                raise ArgumentError(f"{name} = {values[values < 0.0][0]:g}: must be at least 0 {unit}")
            object.__setattr__(self, name, tuple(map(float, values)))

    @property
    def radii(self) -> list[float]:
        """The radii in ascending order, without duplicates."""
        return sorted(set(self.r))


@dataclass(frozen=True, eq=False)
class SearchlightEstimate(ByContent):
    """Estimates for a pencil beam of unit flux, each with `value` and `stderr`. Fluxes and mean distances have the
    shape (channels,). Functions of distance or frequency have the shape of `r` or `q`, with a last axis of channels if
    there are several. For an oblique beam all values are means over azimuths about the point of entry.

    `reflectance` and `transmittance`: the flux that leaves above and below, unscattered light included; `mirrored` and
    `unscattered`: unscattered light alone, exact. `reflected_inside`, `transmitted_inside`: the flux that leaves within
    each radius `r` (mm) of the point where the beam enters. `reflected_at`, `transmitted_at`: the integral of the flux
    density times J0(q r) for each `q` (1/mm). `mean_distance` (mm) and `mean_square_distance` (mm^2) of all reflected
    light; infinite for a conservative half-space, NaN where nothing is reflected. `reflected_covariance`,
    `transmitted_covariance`: of (the flux, the transform at each q), two axes. `seconds` in total; `samples` and
    scattering `events` of each channel."""

    r: np.ndarray
    q: np.ndarray
    reflectance: Measured
    transmittance: Measured
    mirrored: Measured
    unscattered: Measured
    reflected_inside: Measured
    transmitted_inside: Measured
    reflected_at: Measured
    transmitted_at: Measured
    mean_distance: Measured
    mean_square_distance: Measured
    reflected_covariance: np.ndarray
    transmitted_covariance: np.ndarray
    seconds: float = field(compare=False)
    samples: np.ndarray
    events: np.ndarray


def estimate_searchlight(stack: AnyStack, mu_i: float = 1.0, samples: int | None = None, seed: int = 0,
                         threads: int = 0, walk: str = "transfer", r=(), q=(), *, progress: Progress | None = None,
                         cancel: Callable[[], bool] | None = None) -> SearchlightEstimate:
    """The response of a stack to a pencil beam that enters from above at one point, at the cosine `mu_i` in air: how
    much light leaves above and below, and at which distance from that point, in millimetres.

    Every medium must be given by sigma_s and sigma_a (1/mm) and a thickness (mm), a half-space by the first two.
    `walk`: "transfer", photons of the equation of transfer, for any stack; "scattering", the walk of the integral
    scattering equation, for media, homogeneous or with profiles, over nothing, black, a Lambert surface or an absorbing
    half-space; rare bright paths of this walk make its standard errors too small (docs/study-3d.md). The two walks
    share only random numbers, phase functions and the media.
    `r` (mm): up to 4096 radii; `q` (1/mm): up to 64 lateral frequencies. `samples` are rounded up to blocks of 4096;
    default 2^20. The same seed gives the same numbers for any number of `threads` (0: all).
    A conservative half-space is walked to a depth of 30 transport lengths. Below, a surface replaces it that returns
    light according to the P1 equations, with an error of the transform below 1e-5.
    `progress(fraction, text)` is called with the completed share. `cancel()` is called often; Cancelled is raised if it
    returns true. Raises ValueError, StackError, Cancelled.
    Source: Pharr and Hanrahan (2000) for the scattering equation."""
    started = time.perf_counter()
    stack = as_stack(stack)
    query = SearchlightQuery(mu_i, walk, r, q)
    blocks = blocks_of(samples)
    check_seed(seed)
    pool = thread_pool(threads)
    step = stepper("the estimate", progress, cancel)
    channels = run_beams(stack, query, seed, range(chunks_in(blocks)), blocks, pool, step)
    step(1.0, "Done")
    return summary(query, channels, time.perf_counter() - started)


def run_beams(stack: Stack, query: SearchlightQuery, seed: int, chunks: range, blocks: int, pool,
              step: Progress) -> list[dict]:
    """For each channel the tallies (above, below, count, events) of the `chunks` of a run of `blocks` blocks; above and
    below are (within, within_squares, moments, products). Also the flux of `mirrored` and of `unscattered` light, and
    `endless`: true for a conservative half-space. Raises as estimate_searchlight does."""
    stack.require_isotropic("a searchlight")
    stack.require_no_flakes("a searchlight")
    require_millimetres(stack)

    def problem(index):
        key, layers, base = core_stack(stack, index)
        knots = depth_knots(stack, index)
        return (key, tuple(knots)), layers, base, knots, _is_endless(stack, index)

    def run(layers, base, knots, endless, within):
        try:
            walk = getattr(_core, WALKS[query.walk])(_core.Stack(layers, base), knots, query.mu_i)
        except ValueError as error:
            raise StackError(f"walk = {query.walk!r}: {error}") from None
        tallies = each_chunk(lambda start, end: _core.run_lateral_walk(
            walk, query.radii, list(query.q), seed, start, end, pool), chunks.start, chunks.stop, blocks, within)
        return {"mirrored": walk.mirrored, "unscattered": walk.unscattered, "endless": endless, "tallies": tallies}

    return each_problem(stack.channels, step, problem, run)


def _is_endless(stack: Stack, index: int) -> bool:
    """True if the stack ends in a half-space that absorbs nothing."""
    media = [layer for layer in (*stack.layers, stack.base) if isinstance(layer, Medium | HalfSpace)]
    ends = [m for m in media if isinstance(m, HalfSpace) or channel(m.thickness, index) == math.inf]
    return bool(ends) and channel(ends[0].sigma_a, index) == 0.0 < channel(ends[0].sigma_s, index)


def summary(query: SearchlightQuery, channels: list[dict], seconds: float) -> SearchlightEstimate:
    """The estimate from the results of run_beams, with tallies in any order."""
    found: dict[str, list] = {}
    for one in channels:
        for name, value in _of_channel(query, one).items():
            found.setdefault(name, []).append(value)

    def columns(values):
        return values[0] if len(values) == 1 and np.ndim(values[0]) else np.stack(values, axis=-1)

    measured: dict[str, Any] = {}
    for name, values in found.items():
        measured[name] = Measured(*map(columns, zip(*values, strict=True))) if isinstance(values[0], tuple) else \
            columns(values)
    counts: dict[str, Any] = {name: np.array([sum(tally[place] for tally in one["tallies"]) for one in channels])
              for name, place in (("samples", 2), ("events", 3))}
    return SearchlightEstimate(np.array(query.r), np.array(query.q), **measured, seconds=seconds, **counts)


def _of_channel(query: SearchlightQuery, one: dict) -> dict:
    """(value, stderr) of every quantity in one channel, and the covariances."""
    tallies = one["tallies"]
    samples = sum(tally[2] for tally in tallies)
    above, below = (SideMoments.of([tally[side] for tally in tallies], samples) for side in (0, 1))
    within = [query.radii.index(radius) for radius in query.r]
    scores = [WEIGHT, *range(FIRST_FREQUENCY, FIRST_FREQUENCY + len(query.q))]
    found: dict[str, Any] = {}
    for side, flux, word in ((above, "reflectance", "reflected"), (below, "transmittance", "transmitted")):
        found[flux] = side.mean[WEIGHT], side.error[WEIGHT]
        found[f"{word}_inside"] = side.inside[within], side.inside_error[within]
        found[f"{word}_at"] = side.mean[FIRST_FREQUENCY:], side.error[FIRST_FREQUENCY:]
        found[f"{word}_covariance"] = side.covariance[np.ix_(scores, scores)]
    for name in ("mirrored", "unscattered"):
        found[name] = np.float64(one[name]), np.float64(0.0)
    for name, power in (("mean_distance", DISTANCE), ("mean_square_distance", SQUARE)):
        found[name] = (np.float64(math.inf), np.float64(0.0)) if one["endless"] else above.mean_power(power)
    return found
