# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `export`: a stack in, its full scattering function out."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from ..common.errors import ArgumentError
from ..exchange.export import save_npz
from ..exchange.rgl import check_wavelengths, save_bsdf
from ..material.any_stack import as_stack
from ..solver.core_calls import TOLERANCE
from ..solver.solve import solve
from .arguments import add_stack, add_threads, numbers
from .output import check_suffix, check_writable, progress_of


def add(commands) -> None:
    """Adds the command to a parser."""
    command = commands.add_parser("export", help="write a stack's full scattering function")
    add_stack(command)
    command.add_argument("-o", "--output", required=True, metavar="OUT",
                         help=".npz: arrays with axes; .bsdf: reflection for Mitsuba 3's plugin `measured`")
    command.add_argument("--quality", choices=tuple(TOLERANCE), default="final")
    command.add_argument("--wavelengths", type=numbers, metavar="NM,...",
                         help=".bsdf: the channels' wavelengths, for spectral renderers; without them, RGB or grey")
    add_threads(command)
    command.add_argument("--quiet", action="store_true", help="no progress, no report")
    command.set_defaults(run=_export)


def _export(arguments: argparse.Namespace) -> int:
    stack = as_stack(arguments.stack)
    stack.require_isotropic("an export")
    output = Path(arguments.output)
    check_suffix(output, ".npz", ".bsdf")
    check_writable(output)
    is_bsdf = output.suffix.lower() == ".bsdf"
    if arguments.wavelengths and not is_bsdf:
        raise ArgumentError("--wavelengths: only a .bsdf file has them")
    if is_bsdf:
        check_wavelengths(arguments.wavelengths, stack.channels)
    start = time.monotonic()
    progress = progress_of(arguments)
    if progress is not None:
        progress(0.0, "solving")
    solved = solve(stack, arguments.quality, arguments.threads)
    lost = []
    if is_bsdf:
        mirrored = save_bsdf(solved, output, wavelengths=arguments.wavelengths, progress=progress)
        lost += [f"mirror reflection (up to {mirrored:.3g} of a beam)"] if mirrored > 0.0 else []
        lost += ["transmission"] if stack.base is None else []
    else:
        save_npz(solved, output, progress=progress)
    if progress is not None:
        progress.end()
        print(f"{arguments.stack}: exported in {time.monotonic() - start:.2f} s to {output}")
        if lost:
            print(f"{output}: the format has no place for {' and '.join(lost)}")
    return 0
