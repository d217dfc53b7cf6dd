# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake: a pure function from a stack to a lookup table of closure weights."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from ..common.arguments import check_choice, check_whole
from ..common.errors import ArgumentError, StackError, quoted
from ..common.progress import Progress, portion, stepper
from ..kinds.table import TAU_ROWS, Strip
from ..material.any_stack import AnyStack, as_stack
from ..material.stack import Stack
from ..solver.core_calls import check_nodes, tolerance_of
from .bases.choice import kind_of
from .bases.job import CLOSURE_BASES, Job, given_strips
from .fit.slices import require_table
from .table.header import new_header, with_uncovered
from .table.lut import Lut


def bake(stack: AnyStack, quality: str = "final", progress: Progress | None = None,
         cancel: Callable[[], bool] | None = None, threads: int = 0, closures: Sequence[str] | None = None,
         row_stride: int = 1, nodes: int | None = None, *, basis: str = "standard") -> Lut:
    """Bakes a stack into a lookup table for Cycles. The same arguments give the same bytes for any number of `threads`
    (0: all hardware threads).

    `progress(fraction, text)` is called with the completed share of the work, from 0 to 1. `cancel()` is called often;
    the bake raises Cancelled if it returns true.
    `closures`: lobe ids, such as those of an earlier table, that are fitted in this order instead of a new choice. All
    tables then have the same layout while a stack is edited. Closures are still chosen for a kind of light (reflection
    or transmission) without a closure in the list, or with one that a sheet must not mix.
    `row_stride`: with n > 1 only every n-th row of a varying layer's thickness is solved, and the others are
    interpolated. This is for previews while a slider moves; errors are some per cent, more for dark bases at grazing
    views.
    `nodes` replaces the solver's choice of nodes per hemisphere, without its guarantee of accuracy; also for previews,
    and not for anisotropic facets.
    A stack with anisotropic facets has rows for azimuths of the view from the tangent; with a varying layer, as many
    thicknesses for each azimuth. Such a layer is a homogeneous medium on top of the stack, eight of its thicknesses are
    solved whatever `row_stride` is, and `tau_error` is left out. The stack needs an opaque base and a basis with lobes
    that move.
    `basis`: "standard" takes 1.1 to 2.1 times as long to render as a Principled BSDF, see docs/figures.md; "moving" may
    replace some of its closures by two lobes whose width, anisotropy and tilt follow the view, for Blender 5.0 and
    newer, on opaque bases; "accurate" takes some twenty closures, and "moving-accurate" does so with such lobes.
    Smooth boundaries are exact, with a closure of their own, "mirror:ALPHA". Facets narrower than alpha .03 are solved
    as mirrors with the energy of the facets, and only this closure has their width.
    The report: `fit_error` and `fit_error_transmission`, means over slices with view cosine >= .05 of the L2 error over
    solid angle relative to the slice's norm, in a channel below a fiftieth of the brightest one relative to a fiftieth
    of that one; `worst_slice` and `worst_slice_transmission`, the largest of these errors and where it is (`mu_o`,
    `channel`, `side` of the viewer, `tau` of a varying layer); those of transmission are None for a stack on a base;
    `albedo_error`, the worst relative error of a fitted directional albedo; `faded` of a stack with wavelengths, the
    largest share by which a colour outside of the gamut is moved towards gray, see observer.fading; `strayed_light` of
    a sheet, see strayed_light.strayed_report, None for a stack on a base; `energy_error`, the solver's; `slice_errors`,
    of each slice; `row_errors`, by thickness of a varying layer: lists `tau`, `mean` and `worst`; `tau_error`, the
    error of interpolation between rows, measured at quality "final" when every row is solved, see tau_error.tau_error;
    `base_error` of a stack on a ShaderBase, see bases.shader.Shader.
    All errors of a base with inputs hold for the base's own values, and are relative to the light over this base.
    `input_error` states the errors over the ranges of the inputs: for colors 0, .5 and .95 (one in each channel, below
    pigments gray), metallic 0, .5 and 1, and roughness .15 and .25, at quality "final" also .45 and .85; of a varying
    layer, for three thicknesses. `values`: a list with the values of the inputs, and for these `mean` and `worst`,
    errors of slices, and `albedo`, the largest relative error of the directional albedo; `mean` over all values;
    `worst` and `albedo`: the largest errors and where they are. `input_error` is left out if `row_stride` is above 1 or
    `closures` are given, that is in bakes while a slider moves.
    The table of a stack with a varying interface also holds that of the stack without the film, `uncovered`, with a
    report of its own; all other entries of the report, and `closures`, are those with the film.
    Raises SolveError, StackError (channels) and ArgumentError, a ValueError: `row_stride` lies in [1, 33], `nodes` in
    [8, 160], `threads` in [0, 1024]."""
    stack = as_stack(stack)
    tolerance_of(quality)
    nodes = check_nodes(nodes)
    row_stride = check_whole(row_stride, "row_stride", 1, TAU_ROWS)
    check_choice(basis, "basis", CLOSURE_BASES)
    given = given_strips(closures)
    require_table(stack)
    if stack.is_oriented:
        if CLOSURE_BASES[basis].moving == 0:
            raise ArgumentError("anisotropic facets need Blender 5.0 or newer, with basis = 'moving' or "
                                f"'moving-accurate' in place of {quoted(basis)}")
        nodes = None
    bare = _bare(stack)
    started = time.perf_counter()
    step = stepper("the bake", progress, cancel)
    measures = row_stride == 1 and closures is None

    def made(stack: Stack, given: Sequence[Strip], step: Progress) -> tuple[dict, np.ndarray]:
        return _table(Job(stack, quality, basis, threads, row_stride, nodes, given, measures, step))

    header, weights = made(stack, given, step if bare is None else portion(step, 0.0, 0.5))
    without = None
    if bare is not None:
        inner, without = made(bare, [], portion(step, 0.5, 1.0))
        header = with_uncovered(header, inner)
    step(1.0, "Done")
    return Lut(header, weights, time.perf_counter() - started, without)


def _table(job: Job) -> tuple[dict, np.ndarray]:
    """(header, weights) of the table of one stack."""
    base = kind_of(job.stack)(job)
    parts = base.parts()
    header = new_header(job.stack, job.quality, job.basis, base.solved, base.roughnesses,
                        [strip for part in parts for strip in part.strips])
    weights = base.weights(parts)
    return {**header, "report": base.errors(header, weights)}, weights


def _bare(stack: Stack) -> Stack | None:
    """The stack without the film of its varying interface, if it has one. Raises StackError if no table holds it."""
    bare = stack.uncovered
    if bare is not None:
        try:
            require_table(bare)
        except StackError as error:
            raise StackError(f"layers[{stack.covering}].varying = true: without its film, {error}") from None
    return bare
