# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `estimate-searchlight`: where the light of a pencil beam leaves a stack."""

from __future__ import annotations

import argparse
import json
import math

import numpy as np

from ..material.any_stack import as_stack
from ..walks.estimate import SAMPLES
from ..walks.estimate_searchlight import WALKS, SearchlightEstimate, SearchlightQuery, estimate_searchlight
from ..walks.searchlight_moments import Measured
from ..walks.searchlight_shards import run_searchlight_shard
from .arguments import add_drawing, add_stack, numbers
from .drawing import draw

# Values for all light, then values at each radius and at each frequency.
TOTALS = ("reflectance", "transmittance", "mirrored", "unscattered", "mean_distance", "mean_square_distance")
AT_RADII = ("reflected_inside", "transmitted_inside")
AT_FREQUENCIES = ("reflected_at", "transmitted_at")


def add(commands) -> None:
    """Adds the command to a parser."""
    command = commands.add_parser("estimate-searchlight", help="estimate by Monte Carlo where a pencil beam's light "
                                                               "leaves a stack with lengths in millimetres")
    add_stack(command)
    command.add_argument("--mu-i", type=float, default=1.0, metavar="MU", help="cosine of the beam (1)")
    command.add_argument("--walk", choices=tuple(WALKS), default="transfer")
    command.add_argument("--r", type=numbers, default=[], metavar="MM,...", help="radii, for the flux within each")
    command.add_argument("--q", type=numbers, default=[], metavar="1/MM,...",
                         help="lateral frequencies, for the flux density's integral times J0(q r)")
    add_drawing(command)
    command.set_defaults(run=_run)


def _run(arguments: argparse.Namespace) -> int:
    return draw(arguments, lambda progress: _estimated(arguments, progress), show)


def _estimated(arguments: argparse.Namespace, progress) -> SearchlightEstimate | dict:
    """The estimate, or with --shard the part. Raises ValueError, OSError."""
    stack = as_stack(arguments.stack)
    samples = SAMPLES if arguments.samples is None else arguments.samples
    query = SearchlightQuery(arguments.mu_i, arguments.walk, arguments.r, arguments.q)
    if arguments.shard is not None:
        return run_searchlight_shard(stack, query, samples, arguments.seed, arguments.shard, progress,
                                     threads=arguments.threads)
    return estimate_searchlight(stack, query.mu_i, samples, arguments.seed, arguments.threads, query.walk, query.r,
                                query.q, progress=progress)


def show(found: SearchlightEstimate, as_json: bool) -> None:
    """Prints an estimate without times, so equal samples print equal bytes."""
    if as_json:
        rows = {name: {"value": _plain(getattr(found, name).value), "stderr": _plain(getattr(found, name).stderr)}
                for name in (*TOTALS, *AT_RADII, *AT_FREQUENCIES)}
        print(json.dumps({"r": found.r.tolist(), "q": found.q.tolist(), **rows, "samples": found.samples.tolist(),
                          "events": found.events.tolist()}))
        return
    for name in TOTALS:
        print(f"{name}: {_text(getattr(found, name))}")
    for places, unit, names in ((found.r, "mm", AT_RADII), (found.q, "1/mm", AT_FREQUENCIES)):
        for name in names:
            measured = getattr(found, name)
            for index, place in enumerate(places):
                print(f"{name} {place:g} {unit}: {_text(Measured(measured.value[index], measured.stderr[index]))}")
    print(f"samples: {', '.join(map(str, found.samples))}; events: {', '.join(map(str, found.events))}")


def _text(measured: Measured) -> str:
    pairs = zip(np.atleast_1d(measured.value), np.atleast_1d(measured.stderr), strict=True)
    return ", ".join(f"{value:.8g} +- {error:.2g}" for value, error in pairs)


def _plain(values):
    """The values in JSON types, with None for NaN and infinities."""
    if isinstance(values, np.ndarray) and values.ndim:
        return [_plain(value) for value in values]
    number = float(values)
    return number if math.isfinite(number) else ("inf" if number > 0.0 else None)
