# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: python -m lamina bake | report | export | estimate | estimate-searchlight | merge | presets |
dust."""

from __future__ import annotations

import argparse
import errno
import json
import os
import sys
import time
from pathlib import Path

from ..baking.bake import CLOSURE_BASES, bake
from ..baking.lut import Lut
from ..baking.report import describe
from ..common.errors import (
    ArgumentError,
    Cancelled,
    DustError,
    DustUnavailable,
    LutError,
    MeshFileError,
    ShardError,
    SolveError,
    StackError,
    clipped,
)
from ..exchange.export import save_npz
from ..exchange.rgl import check_wavelengths, save_bsdf
from ..material import presets
from ..material.stack import Stack
from ..solver.solve import TOLERANCE, solve
from ..walks.estimate import METHODS, SAMPLES, Estimate, Query, estimate
from ..walks.estimate_searchlight import SearchlightEstimate
from ..walks.shards import load_part, merge, run_shard, save_part
from . import dust_command, searchlight_command
from .arguments import add_drawing, add_threads, check, numbers

FAILED, BAD_INPUT, INTERRUPTED = 1, 2, 130


def main(argv: list[str] | None = None) -> int:
    """Runs one command. Returns the exit code: 0, 1 if the work failed, 2 for bad input, 130 after Ctrl-C. Errors are
    one sentence on standard error."""
    arguments = _parser().parse_args(argv)
    try:
        check(arguments)
        return arguments.run(arguments)
    except (KeyboardInterrupt, Cancelled):
        return _fail("interrupted; nothing was written", INTERRUPTED)
    except (ArgumentError, StackError, LutError, ShardError, DustError, MeshFileError) as error:
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
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    command = commands.add_parser("bake", help="bake a stack's JSON file into a lookup table")
    command.add_argument("stack", metavar="STACK.json")
    command.add_argument("-o", "--output", required=True, metavar="OUT", help="the table to write (.npz)")
    command.add_argument("--quality", choices=tuple(TOLERANCE), default="final")
    command.add_argument("--basis", choices=tuple(CLOSURE_BASES), default="standard",
                         help="standard: few closures, about as quick to render as a Principled BSDF; accurate: "
                              "some twenty")
    add_threads(command)
    command.add_argument("--quiet", action="store_true", help="no progress, no report")
    command.set_defaults(run=_bake)
    command = commands.add_parser("report", help="say what a lookup table holds and how good it is")
    command.add_argument("lut", metavar="LUT.npz")
    command.set_defaults(run=_report)
    command = commands.add_parser("presets", help="list the library of stacks, or print one as JSON")
    command.add_argument("id", nargs="?", metavar="ID", help="the preset to print")
    command.add_argument("--json", action="store_true", help="the list as JSON")
    command.set_defaults(run=_presets)
    _add_export(commands)
    _add_estimate(commands)
    dust_command.add(commands, _dust)
    return parser


def _add_export(commands) -> None:
    command = commands.add_parser("export", help="write a stack's full scattering function")
    command.add_argument("stack", metavar="STACK.json")
    command.add_argument("-o", "--output", required=True, metavar="OUT",
                         help=".npz: arrays with axes; .bsdf: reflection for Mitsuba 3's plugin `measured`")
    command.add_argument("--quality", choices=tuple(TOLERANCE), default="final")
    command.add_argument("--wavelengths", type=numbers, metavar="NM,...",
                         help=".bsdf: the channels' wavelengths, for spectral renderers; without them, RGB or grey")
    add_threads(command)
    command.add_argument("--quiet", action="store_true", help="no progress, no report")
    command.set_defaults(run=_export)


def _add_estimate(commands) -> None:
    command = commands.add_parser("estimate", help="estimate one value of a stack by Monte Carlo")
    command.add_argument("stack", metavar="STACK.json")
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
    searchlight_command.add(commands, _estimate_searchlight)
    command = commands.add_parser("merge", help="add up the parts of an estimate")
    command.add_argument("parts", nargs="+", metavar="PART.json")
    command.add_argument("--json", action="store_true", help="the estimate as JSON")
    command.set_defaults(run=_merge)


def _estimate(arguments: argparse.Namespace) -> int:
    if arguments.shard is not None and arguments.target_error is not None:
        return _fail("--target-error: parts have a fixed number of samples", BAD_INPUT)
    return _draw(arguments, lambda progress: _estimated(arguments, progress))


def _estimated(arguments: argparse.Namespace, progress) -> Estimate | dict:
    """Runs the estimate, or with --shard one part. Raises ValueError, SolveError, OSError."""
    stack = Stack.load(arguments.stack)
    where = (arguments.mu_o, arguments.mu_i, arguments.dphi)
    if arguments.shard is None:
        return estimate(stack, *where, arguments.method, arguments.samples, arguments.target_error, arguments.seed,
                        progress, threads=arguments.threads, side=arguments.side, path=arguments.path)
    samples = SAMPLES if arguments.samples is None else arguments.samples
    return run_shard(stack, Query(*where, arguments.side, arguments.path), arguments.method, samples, arguments.seed,
                     arguments.shard, progress, threads=arguments.threads)


def _estimate_searchlight(arguments: argparse.Namespace) -> int:
    return _draw(arguments, lambda progress: searchlight_command.estimated(arguments, progress))


def _draw(arguments: argparse.Namespace, run) -> int:
    """Prints the estimate that `run(progress)` returns, or writes the part."""
    if (arguments.shard is None) != (arguments.output is None):
        return _fail("--shard and -o go together", BAD_INPUT)
    problem = "" if arguments.output is None else _unwritable(Path(arguments.output))
    if problem:
        return _fail(problem, BAD_INPUT)
    progress = None if arguments.quiet else _Progress()
    found = run(progress)
    if arguments.shard is not None:
        save_part(found, arguments.output)
    if progress is not None:
        progress.end()
    if arguments.shard is None:
        _print_estimate(found, arguments.json)
    return 0


def _merge(arguments: argparse.Namespace) -> int:
    _print_estimate(merge([load_part(path) for path in arguments.parts], arguments.parts), arguments.json)
    return 0


def _print_estimate(found: Estimate | SearchlightEstimate, as_json: bool) -> None:
    """Prints no times, so equal estimates print equal bytes."""
    if isinstance(found, SearchlightEstimate):
        searchlight_command.show(found, as_json)
        return
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


def _bake(arguments: argparse.Namespace) -> int:
    stack = Stack.load(arguments.stack)
    output = Path(arguments.output)
    problem = _unwritable(output)
    if problem:
        return _fail(problem, BAD_INPUT)
    progress = None if arguments.quiet else _Progress()
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


def _presets(arguments: argparse.Namespace) -> int:
    if arguments.id is not None:
        print(json.dumps(presets.load(arguments.id).to_json(), indent=2))
        return 0
    entries = presets.entries()
    if arguments.json:
        rows = [{"id": entry.id, "name": entry.name, "category": entry.category, "source": entry.source,
                 "stack": entry.stack.to_json()} for entry in entries]
        print(json.dumps(rows, indent=2))
        return 0
    lines = [(entry.id, entry.name, entry.category, _layers(entry.stack)) for entry in entries]
    widths = [max(len(line[column]) for line in lines) for column in range(3)]
    for *texts, layers in lines:
        print("  ".join(text.ljust(width) for text, width in zip(texts, widths, strict=True)) + "  " + layers)
    return 0


def _layers(stack: Stack) -> str:
    """Names of the layers and the base, top first."""
    words = [layer.name or layer.kind for layer in stack.layers]
    words.append("sheet" if stack.base is None else stack.base.kind)
    return " / ".join(words)


def _export(arguments: argparse.Namespace) -> int:
    stack = Stack.load(arguments.stack)
    output = Path(arguments.output)
    problem = _unwritable(output)
    if not problem and output.suffix not in (".npz", ".bsdf"):
        problem = f"{output}: must end with .npz or .bsdf"
    if not problem and arguments.wavelengths and output.suffix != ".bsdf":
        problem = "--wavelengths: only a .bsdf file has them"
    if not problem and output.suffix == ".bsdf":
        try:
            check_wavelengths(arguments.wavelengths, stack.channels)
        except ValueError as error:
            problem = str(error)
    if problem:
        return _fail(problem, BAD_INPUT)
    start = time.monotonic()
    progress = None if arguments.quiet else _Progress()
    if progress is not None:
        progress(0.0, "solving")
    solved = solve(stack, arguments.quality, arguments.threads)
    lost = []
    if output.suffix == ".npz":
        save_npz(solved, output, progress=progress)
    else:
        mirrored = save_bsdf(solved, output, wavelengths=arguments.wavelengths, progress=progress)
        lost += [f"mirror reflection (up to {mirrored:.3g} of a beam)"] if mirrored > 0.0 else []
        lost += ["transmission"] if stack.base is None else []
    if progress is not None:
        progress.end()
        print(f"{arguments.stack}: exported in {time.monotonic() - start:.2f} s to {output}")
        if lost:
            print(f"{output}: the format has no place for {' and '.join(lost)}")
    return 0


def _dust(arguments: argparse.Namespace) -> int:
    output = Path(arguments.output)
    problem = _unwritable(output)
    if problem:
        return _fail(problem, BAD_INPUT)
    progress = None if arguments.quiet else _Progress()
    found = dust_command.settled(arguments, progress)
    if progress is not None:
        progress.end()
    dust_command.save(found, output)
    if not arguments.quiet:
        print(f"{arguments.mesh}: {found.statistics}")
        for note in found.statistics.notes:
            print(note)
    return 0


def _unwritable(output: Path) -> str:
    """The reason why a file cannot be written there, or ''; checked before the work starts."""
    if output.is_dir():
        return f"{output}: is a folder, must be a file's name"
    if not os.access(output.parent, os.W_OK):
        return f"{output.parent}: not a folder that can be written to"
    return ""


def _fail(sentence: str, code: int) -> int:
    print(f"lamina: {sentence}", file=sys.stderr)
    return code


class _Progress:
    """A line of progress on standard error: rewritten on a terminal, otherwise repeated every two seconds."""

    EVERY = 2.0

    def __init__(self):
        self._live = sys.stderr.isatty()
        self._last = time.monotonic()

    def __call__(self, fraction: float, text: str) -> None:
        now = time.monotonic()
        if self._live:
            print(f"\r\033[K{fraction:4.0%} {text}", end="", file=sys.stderr, flush=True)
        elif now - self._last >= self.EVERY:
            print(f"{fraction:4.0%} {text}", file=sys.stderr, flush=True)
            self._last = now

    def end(self) -> None:
        if self._live:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
