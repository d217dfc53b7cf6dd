# SPDX-License-Identifier: GPL-3.0-or-later
"""`--command lamina interior OBJECT ...`: the light inside objects, as the panel Depth computes it."""

import os
import time
from dataclasses import replace

import bpy

from ..base import messages, native
from ..interior import interior_job
from ..kinds import interiors
from ..kinds.limits import MOST_THREADS
from ..properties import migration
from . import selection, waiting
from .argument_types import number, whole
from .exit_codes import FAILED, OK, UsageError
from .saved import saved

MOST_FRAME = 1048574  # Blender's last frame
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
    command.add_argument(
        "--frames",
        nargs=2,
        type=whole(0, MOST_FRAME),
        metavar=("FIRST", "LAST"),
        help="compute each frame and render it to the scene's output path",
    )
    return command


def run(arguments):
    """Compute the objects' light, print one line for each, and save or render. Returns the exit code. Raises
    UsageError, SaveError, RefusedError, NativeMissingError, KeyboardInterrupt."""
    native.require()
    objects = selection.objects(arguments.objects)
    if arguments.frames is not None:
        return _render(objects, arguments)
    with saved(arguments):
        return OK if _computed(objects, arguments) else FAILED


def _render(objects, arguments):
    """Compute and render frame by frame. As in Blender, pictures that exist stay if the scene does not
    overwrite them, so an interrupted command continues."""
    scene, (first, last) = bpy.context.scene, arguments.frames
    if first > last:
        raise UsageError(f"--frames {first} {last}: the first frame comes after the last one")
    if arguments.save or arguments.output is not None:
        raise UsageError("--frames saves no images, which differ by frame: leave out --save and --output")
    if scene.render.is_movie_format:
        raise UsageError("--frames: the scene's output is a movie: choose a format of single images")
    is_complete, count = True, 0
    try:
        with waiting.Interruptible():
            for frame in range(first, last + 1, scene.frame_step):
                path = scene.render.frame_path(frame=frame)
                if os.path.exists(path) and not scene.render.use_overwrite:
                    continue
                scene.frame_set(frame)
                if scene.camera is None:
                    raise messages.RefusedError(f"frame {frame} cannot be rendered: the scene has no camera")
                if not _computed(objects, arguments):
                    is_complete = False
                    continue
                _render_frame(scene, frame, path)
                count += 1
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"frames rendered: {count}") from None
    return OK if is_complete else FAILED


def _render_frame(scene, frame, path):
    """Render the current frame to a file, and print one line. Raises RefusedError."""
    output, scene.render.filepath = scene.render.filepath, path
    try:
        bpy.ops.render.render(write_still=True)
    except RuntimeError as error:
        told = messages.reported(error)
        raise messages.RefusedError(f"frame {frame} cannot be rendered: {told}") from None
    finally:
        scene.render.filepath = output
    print(f"frame {frame}: {path}", flush=True)


def _computed(objects, arguments):
    """Compute the objects' light, and print one line for each. False if one failed."""
    failed = False
    for obj in objects:
        waiting.check()
        try:
            print(f"{obj.name}: {_compute(obj, arguments)}", flush=True)
        except native.require().Cancelled:
            raise KeyboardInterrupt from None
        except Exception as error:  # the other objects go on
            failed = True
            print(f"{obj.name}: failed: {messages.sentence(error, obj.active_material)}", flush=True)
    return not failed


def _compute(obj, arguments):
    """The light inside one object, in a worker, so that Ctrl-C is noticed at once. Returns the line to print.
    Finished parts are kept: after an interruption the same command continues there."""
    material, began = obj.active_material, time.perf_counter()
    if material is None:
        raise messages.RefusedError("has no material")
    problem = migration.problem(material)
    if problem:
        raise messages.RefusedError(f"{material.name} is {problem}")
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
