# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: python -m lamina bake | report | export | estimate | estimate-searchlight | merge | match |
presets | dust."""

from __future__ import annotations

import argparse
import errno
import os
import sys

from .. import _core
from ..common.errors import (
    ArgumentError,
    Cancelled,
    DustError,
    DustUnavailable,
    LutError,
    MeasurementError,
    MeshFileError,
    ShardError,
    SolveError,
    StackError,
    clipped,
)
from . import (
    bake_command,
    dust_command,
    estimate_command,
    export_command,
    match_command,
    merge_command,
    presets_command,
    searchlight_command,
)
from .arguments import check
from .output import begin_line

FAILED, BAD_INPUT, INTERRUPTED, BROKEN_PIPE = 1, 2, 130, 141
COMMANDS = (bake_command, presets_command, export_command, estimate_command, searchlight_command, merge_command,
            match_command, dust_command)


def main(argv: list[str] | None = None) -> int:
    """Runs one command. Returns the exit code: 0, 1 if the work failed, 2 for bad input, 130 after Ctrl-C, 141 where
    the reader of standard output has ended. Errors are one sentence on standard error."""
    parser = _parser()
    if not (sys.argv[1:] if argv is None else argv):
        parser.print_help()
        return 0
    arguments = parser.parse_args(argv)
    try:
        check(arguments)
        code = arguments.run(arguments)
        sys.stdout.flush()
        return code
    except BrokenPipeError:  # the reader, such as `head`, has read enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # what Python flushes at exit has no reader
        return BROKEN_PIPE
    except (KeyboardInterrupt, Cancelled):
        return _fail("interrupted; nothing was written", INTERRUPTED)
    except (ArgumentError, StackError, LutError, ShardError, DustError, MeasurementError, MeshFileError) as error:
        return _fail(str(error), BAD_INPUT)
    except (SolveError, DustUnavailable, ValueError) as error:
        return _fail(str(error), FAILED)
    except OSError as error:
        name = str(error.filename or "")
        name = clipped(name) if error.errno == errno.ENAMETOOLONG else name
        return _fail(f"{name}: {error.strerror}" if name else str(error), FAILED)


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one sentence."""

    def error(self, message: str):
        words = " ".join(clipped(word) for word in message.split())
        self.exit(BAD_INPUT, f"lamina: {words}; see {self.prog} --help\n")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="python -m lamina", description="Layered materials as lookup tables.")
    parser.add_argument("--version", action="version", version=f"lamina {_core.__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in COMMANDS:
        command.add(commands)
    return parser


def _fail(sentence: str, code: int) -> int:
    print(f"{begin_line()}lamina: {sentence}", file=sys.stderr)
    return code
