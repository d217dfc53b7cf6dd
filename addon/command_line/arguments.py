# SPDX-License-Identifier: GPL-3.0-or-later
"""The arguments of `--command lamina`."""

import argparse
from pathlib import Path

import bpy

from ..base import native, preferences
from ..kinds.limits import MOST_THREADS
from . import dust_command, interior_command
from .argument_types import whole
from .exit_codes import UsageError

MOST_JOBS = 256


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise UsageError(message)


def parse(argv):
    """The arguments after `--command lamina`. Raises UsageError; SystemExit after --help and --version."""
    parser = _Parser(prog="lamina", description="Bake the Lamina layers of materials.", allow_abbrev=False)
    parser.add_argument("--version", action="version", version=_versions())
    commands = parser.add_subparsers(dest="command", metavar="bake|dust|interior|list", required=True)
    _add_list(commands)
    for command in (_add_bake(commands), dust_command.add(commands), interior_command.add(commands)):
        where = command.add_mutually_exclusive_group()
        where.add_argument("--save", action="store_true", help="save each .blend over itself")
        where.add_argument(
            "--output",
            type=Path,
            metavar="FILE.blend",
            help="save to another .blend; with several files, to this folder",
        )
    return parser.parse_args(list(argv))


def _versions():
    lamina = (
        native.require().__version__ if native.available() else f"of an unknown version ({native.reason()})"
    )
    return f"lamina {lamina}, Blender {bpy.app.version_string}"


def _add_list(commands):
    command = commands.add_parser(
        "list",
        help="the materials that have layers, and whether their bake is up to date",
        allow_abbrev=False,
    )
    command.add_argument(
        "names", nargs="*", metavar="FILE.blend", help="files or patterns; default: the open file"
    )
    command.add_argument("--json", action="store_true", help="print one line of JSON")


def _add_bake(commands):
    command = commands.add_parser("bake", help="bake materials", allow_abbrev=False)
    command.add_argument(
        "names",
        nargs="*",
        metavar="FILE.blend|MATERIAL",
        help="files, and names or patterns of materials such as 'wall_*'; what ends in .blend is a file or a "
        "pattern of files; default: all materials with layers, in the open file",
    )
    command.add_argument(
        "--materials",
        nargs="+",
        action="extend",
        default=[],
        metavar="MATERIAL",
        help="names or patterns of materials",
    )
    command.add_argument(
        "--stack", type=Path, metavar="JSON", help="give the materials this layer stack first"
    )
    command.add_argument(
        "--over",
        action="store_true",
        help="put layers over the materials as they are: those of --stack, or dust",
    )
    command.add_argument(
        "--quality", choices=[key for key, *_ in preferences.QUALITIES], help="default: each material's own"
    )
    command.add_argument(
        "--basis", choices=[key for key, *_ in preferences.CLOSURE_BASES], help="default: each material's own"
    )
    command.add_argument(
        "--threads",
        type=whole(0, MOST_THREADS),
        metavar="N",
        help="of each process; 0 is all; default: the preferences', shared among the processes",
    )
    command.add_argument(
        "--jobs",
        type=whole(1, MOST_JOBS),
        default=1,
        metavar="N",
        help="processes that bake at the same time; default 1",
    )
    command.add_argument("--force", action="store_true", help="bake again what is up to date or in the cache")
    command.add_argument("--dry-run", action="store_true", help="say what would be done, and change nothing")
    command.add_argument("--cache", type=Path, metavar="DIR", help="keep finished bakes in this folder")
    command.add_argument("--manifest", type=Path, metavar="OUT.json", help="write what was done as JSON")
    command.add_argument("--log", type=Path, metavar="FILE", help="append all lines to this file, with times")
    return command
