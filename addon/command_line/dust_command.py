# SPDX-License-Identifier: GPL-3.0-or-later
"""`--command lamina dust [OBJECT ...]`: dust on objects, as Dust These Objects puts it."""

import bpy

from ..base import preferences
from ..kinds.dust import OPTIONS
from ..kinds.limits import MOST_THREADS
from ..scene import dusting
from . import selection, waiting
from .argument_types import number, whole
from .exit_codes import FAILED, OK
from .saved import saved

AMOUNT = next(one for one in OPTIONS if one.name == "amount")


def add(commands):
    """Add the command's parser. Returns the parser."""
    command = commands.add_parser("dust", help="put dust on objects", allow_abbrev=False)
    command.add_argument(
        "objects",
        nargs="*",
        metavar="OBJECT",
        help="names or patterns such as 'chair_*'; default: all meshes that renders show",
    )
    command.add_argument("--remove", action="store_true", help="take the dust away instead")
    command.add_argument(
        "--amount",
        type=number(AMOUNT.low, AMOUNT.high),
        metavar="TAU",
        help="optical thickness on an open horizontal plate; default: each object's own",
    )
    command.add_argument(
        "--threads", type=whole(0, MOST_THREADS), metavar="N", help="0 is all; default: the preferences'"
    )
    return command


def run(arguments):
    """Dust the objects, print one line, and save. Returns the exit code. Raises UsageError, RefusedError,
    SaveError, NativeMissingError, KeyboardInterrupt."""
    objects = selection.objects(arguments.objects)
    with saved(arguments):
        if arguments.remove:
            print(f"dust removed from {dusting.remove(objects)} objects", flush=True)
            return OK
        for obj in objects if arguments.amount is not None else ():
            obj.lamina_dust.form, obj.lamina_dust.amount = "tau", arguments.amount
        threads = preferences.threads() if arguments.threads is None else arguments.threads
        job = dusting.DustingJob(dusting.gather(bpy.context, objects), threads)
        waiting.for_job(job)
        done = job.finish()
        print(done, flush=True)
    return FAILED if done.notes else OK
