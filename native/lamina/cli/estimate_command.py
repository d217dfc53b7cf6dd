# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `estimate`: a stack in, one value of its scattering function out."""

from __future__ import annotations

import argparse
import json

from ..common.errors import ArgumentError
from ..material.any_stack import as_stack
from ..walks.estimate import METHODS, SAMPLES, Estimate, Query, estimate
from ..walks.shards import run_shard
from .arguments import add_drawing, add_stack
from .drawing import draw


def add(commands) -> None:
    """Adds the command to a parser."""
    command = commands.add_parser("estimate", help="estimate one value of a stack by Monte Carlo")
    add_stack(command)
    command.add_argument("--mu-o", type=float, metavar="MU",
                         help="cosine of the viewer; without it, the hemispherical reflectance or transmittance")
    command.add_argument("--mu-i", type=float, required=True, metavar="MU", help="cosine of the light")
    command.add_argument("--dphi", type=float, default=0.0, metavar="RADIANS", help="0: light keeps its azimuth")
    command.add_argument("--side", choices=("top", "bottom"), default="top", help="where light enters")
    command.add_argument("--path", choices=("reflect", "transmit"), default="reflect")
    command.add_argument("--method", choices=tuple(METHODS), default="transfer")
    command.add_argument("--target-error", type=float, metavar="E", help="stop at this relative standard error")
    add_drawing(command)
    command.set_defaults(run=_estimate)


def show(found: Estimate, as_json: bool) -> None:
    """Prints an estimate without times, so that equal estimates print equal bytes."""
    if as_json:
        print(json.dumps({"value": found.value.tolist(), "stderr": found.stderr.tolist(),
                          "samples": found.samples.tolist(), "events": found.events.tolist(),
                          "looked_up": found.looked_up.tolist(), "table_error": found.table_error}))
        return
    for value, error, samples, events, looked_up in zip(
            found.value, found.stderr, found.samples, found.events, found.looked_up, strict=True):
        walked = "no walk: known beforehand" if looked_up else f"{samples} samples, {events} events"
        print(f"{value:.8g} +- {error:.2g} ({walked})")
    if found.table_error > 0.0:
        print(f"the tables of its layers may be off by {found.table_error:.2g}, relative")


def _estimate(arguments: argparse.Namespace) -> int:
    if arguments.shard is not None and arguments.target_error is not None:
        raise ArgumentError("--target-error: parts have a fixed number of samples")
    return draw(arguments, lambda progress: _estimated(arguments, progress), show)


def _estimated(arguments: argparse.Namespace, progress) -> Estimate | dict:
    """Runs the estimate, or with --shard one part. Raises ValueError, SolveError, OSError."""
    stack = as_stack(arguments.stack)
    where = (arguments.mu_o, arguments.mu_i, arguments.dphi)
    if arguments.shard is None:
        return estimate(stack, *where, arguments.method, arguments.samples, arguments.target_error, arguments.seed,
                        progress=progress, threads=arguments.threads, side=arguments.side, path=arguments.path)
    samples = SAMPLES if arguments.samples is None else arguments.samples
    return run_shard(stack, Query(*where, arguments.side, arguments.path), arguments.method, samples, arguments.seed,
                     arguments.shard, progress, threads=arguments.threads)
