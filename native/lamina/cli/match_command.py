# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `match`: a measured material in, the nearest stack out."""

from __future__ import annotations

import argparse
import json
import math
import sys
import warnings
from pathlib import Path

from ..inverse.measured_base import load_base
from ..inverse.nearest import Nearest, nearest
from .arguments import add_threads
from .output import check_suffix, check_writable, progress_of


def add(commands) -> None:
    """Adds the command to a parser."""
    command = commands.add_parser("match", help="find the stack that is nearest to a measured material")
    command.add_argument("file", metavar="FILE", help="a .binary file of MERL or a .bsdf file of RGL")
    command.add_argument("-o", "--output", metavar="STACK.json", help="where the stack is written")
    command.add_argument("--json", action="store_true", help="the result as JSON")
    command.add_argument("--quiet", action="store_true", help="no progress")
    add_threads(command)
    command.set_defaults(run=_match)


def _match(arguments: argparse.Namespace) -> int:
    output = None if arguments.output is None else Path(arguments.output)
    if output is not None:
        check_suffix(output, ".json")
        check_writable(output)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", UserWarning)
        measured = load_base(arguments.file)
    for one in told:
        print(f"lamina: {one.message}", file=sys.stderr)
    progress = progress_of(arguments)
    found = nearest(measured, arguments.threads, progress)
    if progress is not None:
        progress.end()
    if output is not None:
        found.stack.save(output)
    print(json.dumps(_plain(found)) if arguments.json else found)
    return 0


def _plain(found: Nearest) -> dict:
    tried = {kind: None if math.isinf(error) else error for kind, error in found.tried.items()}
    return {"kind": found.kind, "error": found.error, "worst": found.worst, "worst_angle": found.worst_angle,
            "tried": tried, "remarks": list(found.remarks), "stack": found.stack.to_json()}
