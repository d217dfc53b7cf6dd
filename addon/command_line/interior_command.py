# SPDX-License-Identifier: GPL-3.0-or-later
"""`--command lamina interior OBJECT ...`: the light inside objects, as the panel Interior computes it."""

import time
from dataclasses import replace

import bpy

from ..base import messages, native
from ..interior import interior_job
from ..kinds import interiors
from ..kinds.limits import MOST_THREADS
from . import selection, waiting
from .argument_types import number, whole
from .exit_codes import FAILED, OK
from .saved import saved

KINDS = {"relightable": "RELIGHTABLE", "lit": "LIT"}


def add(commands):
    """Add the command's parser. Returns the parser."""
    command = commands.add_parser("interior", help="compute the light inside objects", allow_abbrev=False)
    command.add_argument("objects", nargs="+", metavar="OBJECT", help="names or patterns such as 'bust_*'")
    command.add_argument("--kind", choices=list(KINDS), help="default: each material's own output")
    size, noise = interiors.SIZE.panel, interiors.NOISE
    command.add_argument(
        "--size",
        type=whole(size.low, size.high),
        metavar="N",
        help="texels; default: each material's own",
    )
    command.add_argument(
        "--noise",
        type=number(100.0 * noise.panel.low, 100.0 * noise.high),
        metavar="PERCENT",
        help="default: each material's own",
    )
    command.add_argument(
        "--threads", type=whole(0, MOST_THREADS), metavar="N", help="0 is all; default: the preferences'"
    )
    return command


def run(arguments):
    """Compute the objects' light, print one line for each, and save. Returns the exit code. Raises
    UsageError, SaveError, NativeMissingError, KeyboardInterrupt."""
    lamina, failed = native.require(), False
    objects = selection.objects(arguments.objects)
    with saved(arguments):
        for obj in objects:
            try:
                print(f"{obj.name}: {_compute(obj, arguments)}", flush=True)
            except lamina.Cancelled:
                raise KeyboardInterrupt from None
            except Exception as error:  # the other objects go on
                failed = True
                print(f"{obj.name}: failed: {messages.sentence(error, obj.active_material)}", flush=True)
    return FAILED if failed else OK


def _compute(obj, arguments):
    """The light inside one object, in a worker, so that Ctrl-C is noticed at once. Returns the line to print.
    Finished parts are kept: after an interruption the same command continues there."""
    material, began = obj.active_material, time.perf_counter()
    if material is None:
        raise messages.RefusedError("has no material")
    settings = material.lamina.interior
    before = {name: getattr(settings, name) for name in ("output", "size", "noise")}
    try:
        wanted = {"output": KINDS.get(arguments.kind), "size": arguments.size, "noise": arguments.noise}
        for name, value in wanted.items():
            if value is not None:
                setattr(settings, name, value)
        task = interior_job.gather(bpy.context, obj, material)
        if arguments.threads is not None:
            task = replace(task, threads=arguments.threads)
        job = interior_job.InteriorJob(task)
        waiting.for_job(job)
        job.finish()
    except BaseException:
        for name, value in before.items():
            setattr(settings, name, value)
        raise
    return f"{settings.report} {time.perf_counter() - began:.1f} s"
