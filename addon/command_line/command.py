# SPDX-License-Identifier: GPL-3.0-or-later
"""`blender -b FILE.blend --command lamina bake|interior|list ...`: the batch for scripts and farms.

Prints one line per material or object on standard output. Exit code: 0 if all went well, 1 if one of them
or the save failed, 2 for invalid arguments, 130 if interrupted. `main` can also be called from tests and bpy
scripts.
"""

import argparse
import fnmatch
import signal
import sys
import threading
import time
from contextlib import nullcontext
from pathlib import Path

import bpy

from ..baking import bake_job
from ..base import messages, native, preferences
from ..base.messages import percent
from ..editing import over_material, stack_io
from ..kinds.limits import MOST_THREADS
from ..properties import migration
from . import blend_saving, interior_command

OK, FAILED, USAGE, INTERRUPTED = 0, 1, 2, 130

_handle = None


class UsageError(Exception):
    """str() is one sentence."""


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise UsageError(message)


def main(argv):
    """Run the command with the arguments after `--command lamina`. Returns the exit code."""
    try:
        arguments = _parser().parse_args(list(argv))
    except UsageError as error:
        return _complain(f"{error}; see: --command lamina --help", USAGE)
    except SystemExit as stop:  # --help
        return stop.code or OK
    migration.migrate_all()
    if arguments.command == "list":
        return _list()
    try:
        return _bake(arguments) if arguments.command == "bake" else _interior(arguments)
    except UsageError as error:
        return _complain(error, USAGE)
    except (native.NativeMissingError, blend_saving.SaveError) as error:
        return _complain(error, FAILED)
    except KeyboardInterrupt:
        return _complain("interrupted: nothing was saved", INTERRUPTED)


def _parser():
    parser = _Parser(prog="lamina", description="Bake the Lamina layers of materials.", allow_abbrev=False)
    commands = parser.add_subparsers(dest="command", metavar="bake|interior|list", required=True)
    commands.add_parser("list", help="the materials that have layers, and whether their bake is up to date")
    bake = commands.add_parser("bake", help="bake materials", allow_abbrev=False)
    bake.add_argument(
        "materials",
        nargs="*",
        metavar="MATERIAL",
        help="names or patterns such as 'wall_*'; default: all materials with layers",
    )
    bake.add_argument("--stack", type=Path, metavar="JSON", help="give the materials this layer stack first")
    bake.add_argument("--over", action="store_true",
                      help="put layers over the materials as they are: those of --stack, or dust")
    bake.add_argument(
        "--quality", choices=[key for key, *_ in preferences.QUALITIES], help="default: each material's own"
    )
    bake.add_argument(
        "--basis", choices=[key for key, *_ in preferences.CLOSURE_BASES], help="default: each material's own"
    )
    bake.add_argument("--threads", type=_threads, metavar="N", help="0 is all; default: the preferences'")
    for command in (bake, interior_command.add(commands)):
        where = command.add_mutually_exclusive_group()
        where.add_argument("--save", action="store_true", help="save the .blend over itself")
        where.add_argument("--output", type=Path, metavar="FILE.blend", help="save to another .blend")
    return parser


def _threads(text):
    try:
        number = int(text)
    except ValueError:
        number = -1
    if not 0 <= number <= MOST_THREADS:
        raise argparse.ArgumentTypeError(f"{text!r}: must be a whole number from 0 to {MOST_THREADS}")
    return number


def _list():
    for material in sorted(bpy.data.materials, key=lambda one: one.name):
        if material.lamina.enabled:
            layers = len(material.lamina.layers)
            state = _state(material)
            print(f"{material.name}: {layers} layer{'' if layers == 1 else 's'}, {state}")
    if not native.available():
        return _complain(native.reason(), FAILED)
    return OK


def _state(material):
    if not native.available():
        return "baked" if material.lamina.result.stack_hash else "not baked"
    difference = bake_job.difference(material)
    words = {
        "none": "not baked",
        "fresh": "up to date",
        "stale": "out of date",
        "live": f"live preview, {difference}",
        "other": f"out of date, baked with {difference}",
        "invalid": "cannot be baked",
    }
    return words[bake_job.state(material)]


def _bake(arguments):
    native.require()
    target = _target(arguments)
    stack = _stack(arguments)
    materials = _selected(arguments.materials, with_stack=stack is None and not arguments.over)
    return _each([(one, one) for one in materials], lambda one: _bake_one(one, stack, arguments), target)


def _interior(arguments):
    native.require()
    target = _target(arguments)
    try:
        objects = interior_command.selected(arguments.objects)
    except messages.RefusedError as error:
        raise UsageError(str(error)) from None
    pairs = [(one, one.active_material) for one in objects]
    return _each(pairs, lambda one: interior_command.compute(one, arguments, _wait), target)


def _each(pairs, make, target):
    """Make each of the (item, its material), print one line for each, and save. Returns the exit code."""
    lamina, failed = native.require(), 0
    with _Interruptible(), blend_saving.Saving(target) if target else nullcontext() as saving:
        for item, material in pairs:
            try:
                print(f"{item.name}: {make(item)}", flush=True)
            except lamina.Cancelled:
                raise KeyboardInterrupt from None
            except Exception as error:
                failed += 1
                print(f"{item.name}: failed: {messages.sentence(error, material)}", flush=True)
        if target is not None:
            saving.save()
        elif pairs:
            print("lamina: nothing was saved (give --save or --output FILE.blend)", file=sys.stderr)
    return FAILED if failed else OK


def _bake_one(material, stack, arguments):
    """Bakes one material in a worker, so that Ctrl-C is noticed at once. Returns the line to print."""
    if not material.is_editable:
        raise messages.RefusedError("linked from another file: bake it there")
    before = stack_io.to_dict(material) if material.lamina.enabled else None
    enabled = material.lamina.enabled
    started = time.perf_counter()
    lost = over_material.not_carried(material) if arguments.over and not enabled else []
    try:
        if arguments.over and not over_material.is_over(material):
            over_material.add(material)
        if stack is not None:
            assign = over_material.assign_layers if arguments.over else stack_io.assign_stack
            assign(material, stack)
        if not material.lamina.enabled:
            raise messages.RefusedError("has no Lamina layers (give --stack JSON)")
        threads = preferences.threads() if arguments.threads is None else arguments.threads
        more = {"basis": arguments.basis} if arguments.basis else {}
        job = bake_job.MaterialJob(material, arguments.quality or material.lamina.quality, threads, **more)
        _wait(job)
        job.finish()
    except BaseException:
        if stack is not None or arguments.over:  # the material keeps the layers of its earlier bake
            if before is not None:
                stack_io.assign(material, before)
            elif not enabled:
                material.property_unset("lamina")
        raise
    result = material.lamina.result
    errors = f"fit error {percent(result.fit_error, 2)}, worst slice {percent(result.worst_error)}"
    if result.fit_error_transmission >= 0.0:
        errors += f", transmission {percent(result.fit_error_transmission, 2)}"
        errors += f", worst slice {percent(result.through_worst_error)}"
    how = f"{result.closures} closures, {result.basis}, {result.quality}"
    told = f"; not carried over: {', '.join(lost)}" if lost else ""
    return f"{errors}, {how}, {time.perf_counter() - started:.2f} s{told}"


def _wait(job):
    shown = sys.stderr.isatty()
    try:
        while not job.done:
            job.wait(0.1)
            if shown:
                print(f"\r{job.fraction:4.0%} {job.text:<60.60}", end="", file=sys.stderr, flush=True)
    except KeyboardInterrupt:
        job.cancel()
        job.wait()
        raise
    finally:
        if shown:
            print("\r" + " " * 66 + "\r", end="", file=sys.stderr, flush=True)


class _Interruptible:
    """Ctrl-C raises KeyboardInterrupt in here; Blender itself does not pass it on to Python."""

    def __enter__(self):
        self._before = None
        self._main = threading.current_thread() is threading.main_thread()
        if self._main:
            self._before = signal.signal(signal.SIGINT, signal.default_int_handler)

    def __exit__(self, *_):
        if self._main and self._before is not None:
            signal.signal(signal.SIGINT, self._before)


def _selected(names, with_stack):
    """The materials that the arguments select, without duplicates, in the order of the arguments."""
    everything = list(bpy.data.materials)
    if not names:
        if not with_stack:
            raise UsageError("--stack and --over need names or patterns of the materials that they are for")
        chosen = [one for one in everything if one.lamina.enabled and one.is_editable]
        if not chosen:
            raise UsageError("no material of this file has Lamina layers")
        return chosen
    chosen = []
    for name in names:
        exact = [one for one in everything if one.name == name]
        found = exact or [one for one in everything if fnmatch.fnmatchcase(one.name, name)]
        if not found:
            raise UsageError(f"no material matches {name!r}")
        if not exact:
            found = [one for one in found if one.is_editable and (one.lamina.enabled or not with_stack)]
            if not found:
                raise UsageError(f"no material that matches {name!r} has Lamina layers")
        chosen += [one for one in found if one not in chosen]
    return chosen


def _stack(arguments):
    """The stack of --stack, checked before any material is touched; None without one."""
    if arguments.stack is None:
        return None
    try:
        return native.require().Stack.load(arguments.stack)
    except (ValueError, OSError) as error:
        raise UsageError(f"--stack {arguments.stack}: {messages.sentence(error)}") from error


def _target(arguments):
    """The file to save to, checked before any bake; None for none."""
    if arguments.save:
        if not bpy.data.filepath:
            raise UsageError("--save: no .blend file is open")
        return Path(bpy.data.filepath).resolve()
    if arguments.output is None:
        return None
    if arguments.output.suffix != ".blend":
        raise UsageError(f"--output {arguments.output}: must end in .blend")
    if not arguments.output.resolve().parent.is_dir():
        raise UsageError(f"--output {arguments.output}: there is no such folder")
    return arguments.output.resolve()


def _complain(sentence, code):
    print(f"lamina: {sentence}", file=sys.stderr, flush=True)
    return code


def register():
    global _handle
    _handle = bpy.utils.register_cli_command("lamina", main)


def unregister():
    global _handle
    if _handle is not None:
        bpy.utils.unregister_cli_command(_handle)
        _handle = None
