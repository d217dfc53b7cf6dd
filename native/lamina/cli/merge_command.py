# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `merge`: the parts of an estimate in, the estimate out."""

from __future__ import annotations

import argparse

from ..walks.estimate_searchlight import SearchlightEstimate
from ..walks.shards import load_part, merge
from . import estimate_command, searchlight_command


def add(commands) -> None:
    """Adds the command to a parser."""
    command = commands.add_parser("merge", help="add up the parts of an estimate")
    command.add_argument("parts", nargs="+", metavar="PART.json")
    command.add_argument("--json", action="store_true", help="the estimate as JSON")
    command.set_defaults(run=_merge)


def _merge(arguments: argparse.Namespace) -> int:
    found = merge([load_part(path) for path in arguments.parts], arguments.parts)
    if isinstance(found, SearchlightEstimate):
        searchlight_command.show(found, arguments.json)
    else:
        estimate_command.show(found, arguments.json)
    return 0
