# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands `bake` and `report`: from a stack to a lookup table, and the report that a table holds."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..baking.bake import bake
from ..baking.bases.job import CLOSURE_BASES
from ..baking.report.words import describe
from ..baking.table.lut import Lut
from ..material.any_stack import as_stack
from ..solver.core_calls import TOLERANCE
from .arguments import add_stack, add_threads
from .output import check_suffix, check_writable, progress_of


def add(commands) -> None:
    """Adds the commands to a parser."""
    command = commands.add_parser("bake", help="bake a stack into a lookup table")
    add_stack(command)
    command.add_argument("-o", "--output", required=True, metavar="OUT", help="the table to write (.npz)")
    command.add_argument("--quality", choices=tuple(TOLERANCE), default="final")
    command.add_argument("--basis", choices=tuple(CLOSURE_BASES), default="standard",
                         help="standard: few closures, about as quick to render as a Principled BSDF; moving: some of "
                              "them follow the view, for Blender 5.0 and newer; accurate, moving-accurate: some twenty")
    add_threads(command)
    command.add_argument("--quiet", action="store_true", help="no progress, no report")
    command.set_defaults(run=_bake)
    command = commands.add_parser("report", help="say what a lookup table holds and how good it is")
    command.add_argument("lut", metavar="LUT.npz")
    command.set_defaults(run=_report)


def _bake(arguments: argparse.Namespace) -> int:
    stack = as_stack(arguments.stack)
    output = Path(arguments.output)
    check_suffix(output, ".npz")
    check_writable(output)
    progress = progress_of(arguments)
    lut = bake(stack, arguments.quality, progress, threads=arguments.threads, basis=arguments.basis)
    if progress is not None:
        progress.end()
    lut.save(output)
    if not arguments.quiet:
        print(describe(lut))
        print(f"{arguments.stack}: baked in {lut.seconds:.2f} s to {output}")
    return 0


def _report(arguments: argparse.Namespace) -> int:
    print(describe(Lut.load(arguments.lut)))
    return 0
