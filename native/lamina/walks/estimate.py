# SPDX-License-Identifier: GPL-3.0-or-later
"""Monte Carlo estimates of single values of a stack's scattering function, by random walks of three equations."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .. import _core
from ..common.arguments import LEAST_COSINE, check_choice, check_number, check_seed, check_whole
from ..common.by_content import ByContent
from ..common.errors import SolveError, StackError
from ..common.progress import Progress, portion, stepper
from ..material.any_stack import AnyStack, as_stack
from ..material.stack import Stack
from ..solver.core_calls import path_of, side_of, thread_pool
from ..solver.core_stack import core_stack

SAMPLES = 1 << 20
MOST_SAMPLES = 1 << 40
BLOCK = _core.WALK_BLOCK
CHUNK = 16  # blocks with a common sum: a shard consists of whole chunks


@dataclass(frozen=True)
class Query:
    """The estimated quantity: BRDF or BTDF for cosines in air and an azimuth; with `mu_o` None, the hemispherical
    reflectance or transmittance of a beam. Cosines lie in (0, 1], and below 1e-9 count as 1e-9; `dphi` is in radians.
    `side` "bottom", and a BTDF, need a sheet that ends in air, see ScatteringFunction. `phi_o`: the azimuth of the
    outgoing light from the tangent in radians, with `mu_o` None that of the beam; only anisotropic facets depend on it.
    Raises ArgumentError, a ValueError."""

    mu_o: float | None
    mu_i: float
    dphi: float = 0.0
    side: str = "top"
    path: str = "reflect"
    phi_o: float = 0.0

    def __post_init__(self):
        side_of(self.side)
        path_of(self.path)
        for name, value in (("mu_o", self.mu_o), ("mu_i", self.mu_i)):
            if name == "mu_o" and value is None:
                continue
            cosine = check_number(value, name, "must be one number in (0, 1]", lambda mu: 0.0 < mu <= 1.0)
            object.__setattr__(self, name, max(cosine, LEAST_COSINE))
        for name in ("dphi", "phi_o"):
            angle = check_number(getattr(self, name), name, "must be one finite number", math.isfinite)
            object.__setattr__(self, name, angle)

    def check(self, stack: Stack) -> None:
        """Raises StackError for a direction below a sheet that does not end in air."""
        if self.side == "bottom" or (self.path == "transmit" and self.mu_o is not None):
            stack.require_air_below()

    def target(self) -> _core.WalkTarget:
        """The same quantity for the core."""
        mu_o = self.mu_i if self.mu_o is None else self.mu_o
        return _core.WalkTarget(mu_o, self.mu_i, self.dphi, side_of(self.side), path_of(self.path), self.mu_o is None,
                                self.phi_o)


@dataclass(frozen=True, eq=False)
class Estimate(ByContent):
    """Estimates, one per channel, with their standard errors; the total seconds; and the number of samples and
    scattering events of each channel. `table_error`: relative error of the layer tables that the walk uses; 0 for a
    walk without tables."""

    value: np.ndarray
    stderr: np.ndarray
    seconds: float = field(compare=False)
    samples: np.ndarray
    events: np.ndarray
    table_error: float = 0.0

    @property
    def looked_up(self) -> np.ndarray:
        """True for each channel whose value needed no walk. The method "adding" reads the value of a single layer from
        the solver's table of that layer: `stderr` is 0, and `table_error` is the whole error."""
        return self.events == 0


def _transfer(core, query: Query, pool):
    return _core.transfer_walk(core, query.target()), 0.0


def _adding(core, query: Query, pool):
    return _core.adding_walk(core, query.target(), pool)


def _scattering(core, query: Query, pool):
    return _core.scattering_walk(core, query.target()), 0.0


METHODS = {"scattering": _scattering, "transfer": _transfer, "adding": _adding}


def estimate(stack: AnyStack, mu_o: float | None, mu_i: float, dphi: float = 0.0, method: str = "transfer",
             samples: int | None = None, target_error: float | None = None, seed: int = 0, *,
             progress: Progress | None = None, cancel: Callable[[], bool] | None = None, threads: int = 0,
             side: str = "top", path: str = "reflect", phi_o: float = 0.0) -> Estimate:
    """BRDF (`path` "reflect") or BTDF ("transmit") in 1/sr of a stack for one pair of directions, as defined by
    ScatteringFunction.brdf and btdf; or with `mu_o` None the directional albedo or the transmittance, specular and
    unscattered light included. Light enters on `side`. Values of stacks with anisotropic facets also depend on `phi_o`,
    see Query, and only the method "transfer" takes such stacks.

    `method`: "transfer", the photon walk of the equation of transfer with next-event estimation; "adding", the adding
    series as a walk between solved layers (biased by the error of their tables, which is reported; the BRDF or BTDF of
    a single layer is read from its table without a walk: see Estimate.looked_up); "scattering", for the BRDF from above
    of media, homogeneous or with profiles, over nothing, black or a Lambert surface: a walk guided by coarse tables, of
    the integral scattering equation for isotropic scattering, else of the equation of transfer, which is then more
    efficient. `samples` are rounded up to blocks of 4096; default 2^20 without a target. With `target_error`, a
    standard error relative to the value, the number of samples of a channel is doubled until the error is reached, or
    until it is `samples`. Stopping at a favourable error biases the value by a small part of that error.
    The same seed gives the same numbers for any number of `threads` (0: all). `progress(fraction, text)` is called with
    the completed share. `cancel()` is called often; Cancelled is raised if it returns true.
    Raises ValueError, StackError, SolveError."""
    started = time.perf_counter()
    stack = as_stack(stack)
    query = Query(mu_o, mu_i, dphi, side, path, phi_o)
    blocks = blocks_of(samples, target_error)
    check_seed(seed)
    pool = thread_pool(threads)
    step = stepper("the estimate", progress, cancel)
    channels, error = run_channels(stack, query, method, pool, step, lambda walk, within: _run(
        walk, seed, blocks, target_error, pool, within))
    return summary(channels, time.perf_counter() - started, error)


def run_channels(stack: Stack, query: Query, method: str, pool, step: Progress, run) -> tuple[list, float]:
    """(result of `run(walk, step)` for each channel, the largest error of the walks' tables); equal channels share one
    run. Raises as estimate does."""
    query.check(stack)
    stack.require_walked_base()
    if method in ("adding", "scattering"):
        stack.require_isotropic(f"method {method!r}")
        stack.require_no_flakes(f"method {method!r}")

    def walked(layers, base, within):
        walk, off = make_walk(_core.Stack(layers, base), query, method, pool)
        return run(walk, within), off

    found = each_problem(stack.channels, step, lambda index: core_stack(stack, index), walked)
    return [tallies for tallies, _ in found], max(off for _, off in found)


def each_problem(channels: int, step: Progress, problem, run) -> list:
    """The result of `run(*given, step)` for each channel, where `problem(index)` is (key, *given); channels with equal
    keys share one run."""
    done: dict = {}
    found = []
    for index in range(channels):
        key, *given = problem(index)
        if key not in done:
            done[key] = run(*given, portion(step, index / channels, (index + 1) / channels))
        found.append(done[key])
    return found


def make_walk(core, query: Query, method: str, pool):
    """(walk, error of its tables) of one channel. Raises as estimate does."""
    walk = METHODS[check_choice(method, "method", METHODS)]
    try:
        return walk(core, query, pool)
    except RuntimeError as error:
        raise SolveError(str(error)) from None
    except ValueError as error:
        raise StackError(str(error)) from None


def blocks_of(samples: int | None, target_error: float | None = None) -> int:
    """The number of blocks for `samples` samples. Raises ValueError."""
    if target_error is not None:
        check_number(target_error, "target_error", "must lie in (0, 1)", lambda error: 0.0 < error < 1.0)
    if samples is None:
        samples = SAMPLES if target_error is None else MOST_SAMPLES
    return -(-check_whole(samples, "samples", 1, MOST_SAMPLES, "must be a whole number from 1 to 2^40") // BLOCK)


def run_chunks(walk, seed: int, first: int, last: int, blocks: int, pool, step) -> list:
    """Tallies (sum, squares, largest, count, events) of chunks [first, last) of a run of `blocks` blocks."""
    return each_chunk(lambda start, end: _core.run_walk(walk, seed, start, end, pool), first, last, blocks, step)


def each_chunk(tally, first: int, last: int, blocks: int, step: Progress) -> list:
    """The results of `tally(first block, last block)` for chunks [first, last) of a run of `blocks` blocks."""
    tallies = []
    for chunk in range(first, last):
        step((chunk - first) / (last - first), f"{(chunk - first) * CHUNK * BLOCK:,} samples")
        tallies.append(tally(chunk * CHUNK, min((chunk + 1) * CHUNK, blocks)))
    return tallies


def chunks_in(blocks: int) -> int:
    return -(-blocks // CHUNK)


def summary(channels: list, seconds: float, table_error: float) -> Estimate:
    """The Estimate from the tallies of each channel's chunks, in any order: the sum by math.fsum does not depend on the
    order."""
    columns = zip(*(_total(tallies) for tallies in channels), strict=True)
    value, stderr, samples, events = (np.array(column) for column in columns)
    return Estimate(value, stderr, seconds, samples, events, table_error)


def _total(tallies: list) -> tuple[float, float, int, int]:
    """(value, standard error, samples, events)."""
    count = sum(tally[3] for tally in tallies)
    events = sum(tally[4] for tally in tallies)
    mean = math.fsum(tally[0] for tally in tallies) / count
    squares = math.fsum(tally[1] for tally in tallies) / count
    # Without scattering events all samples are equal, and the variance is only rounding.
    variance = max(0.0, squares - mean * mean) if events > 0 else 0.0
    return mean, math.sqrt(variance / (count - 1)), count, events


def _run(walk, seed: int, blocks: int, target_error: float | None, pool, step) -> list:
    """Tallies of all chunks; with a target error, in rounds that double the samples."""
    last = chunks_in(blocks)
    if target_error is None:
        return run_chunks(walk, seed, 0, last, blocks, pool, step)
    tallies: list = []
    until, reached = 1, 0.0
    while True:
        def within(_, text, reached=reached):
            step(reached, text)

        tallies += run_chunks(walk, seed, len(tallies), min(until, last), blocks, pool, within)
        value, error, _, _ = _total(tallies)
        if len(tallies) == last or error <= target_error * abs(value):
            return tallies
        until *= 2
        reached = (target_error * abs(value) / error) ** 2
