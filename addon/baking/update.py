# SPDX-License-Identifier: GPL-3.0-or-later
"""Updates: a material is baked again after each change, coarse while its layers change, and with its own
quality and fit when they rest.

Property callbacks only note which material has changed. A timer reads the notes. It starts one bake at a time
in a worker thread, always of the newest state, and applies a finished one. Typing therefore never waits, and
a slow stack is updated less often. The timer ends some time after the last change. Nothing of this is written
to the .blend, and files that are opened start no bakes.
"""

import time

import bpy
from bpy.app.handlers import persistent

from ..base import changes, editable, handlers, native, preferences, redraw, renders, timers, undo
from ..base.worker import Place, with_uid
from ..editing import stack_io
from ..nodes import node_group
from ..properties import migration
from ..stack_json import stack_check
from . import bake_job

WORKING, WAITING = 0.004, 0.05  # seconds to the timer's next call: while a bake runs, and while editing may
                                # go on
REST = 1.0  # seconds without a change, after which coarse results are refined
PATIENCE = 0.5  # a coarse bake of an outdated state is cancelled after this many seconds
QUALITY, BASIS = "preview", "standard"  # while layers change
# A stack whose bake takes longer than this many seconds is solved with fewer rows and nodes while edited.
SLOW, ROW_STRIDE, NODES = 0.08, 4, 32

_place = Place()
running, running_for, stop = _place.running, _place.running_for, _place.stop
_followed = {}  # uid -> _Material
_looked = 0.0  # when the timer's function was called last; time.monotonic()


class _Material:
    """The state of a material that has changed in this session."""

    def __init__(self):
        self.changed = False  # since the last bake was started
        self.touched = time.monotonic()  # when something last happened
        self.rough = False  # the shown bake is not yet one of the material's own quality and fit
        self.seconds, self.nodes = 0.0, 0  # of the last bake of all rows while layers changed

    def coarse_options(self, material):
        """Options for a coarser bake of this material while it is edited; none if its bakes are quick."""
        options = {}
        if self.seconds > SLOW:
            if any(layer.varying and layer.kind != "interface" for layer in material.lamina.layers):
                options["row_stride"] = ROW_STRIDE
            if self.nodes > NODES:
                options["nodes"] = NODES
        return options


class UpdateJob(bake_job.MaterialJob):
    """A whole bake, with the material's own quality and fit, or a coarse one with the closures of the last
    bake. `options`: of a coarse bake, see coarse_options."""

    def __init__(self, material, is_whole, options=None):
        self.started, self.is_whole, self.options = time.monotonic(), is_whole, options or {}
        how = {"quality": material.lamina.quality} if is_whole else {"quality": QUALITY, "basis": BASIS}
        closures = None if is_whole else _kept(material)
        if closures:
            how["closures"] = closures
        text = stack_io.to_text(material)
        # A colour needs a solve, so the thread makes the stack.
        super().__init__(material, threads=preferences.threads(), stack=lambda: _stack(text), drawn=is_whole,
                         **how, **self.options)

    def show(self, material, followed):
        if self.error is not None:
            raise self.error
        bake_job.apply(material, self.lut, self.curves, in_place=True, coarse=bool(self.options))
        followed.rough = not self.is_whole
        if not self.is_whole and not self.options:
            followed.seconds = self.lut.report["seconds"]
            followed.nodes = self.lut.report["solver"]["nodes"]


def first_settings(material):
    """(quality, basis) of the bake after a click: quick ones where `refine` follows."""
    if _can_follow(material) and not bpy.app.background:
        return QUALITY, preferences.table_basis(BASIS)
    return material.lamina.quality, preferences.table_basis(material.lamina.basis)


def mark(material):
    """`material` has changed: bake it soon. Cheap enough for any callback."""
    if _can_follow(material):
        followed = _follow(material)
        followed.changed, followed.touched = True, time.monotonic()
        timers.start(poll)


def refine(material):
    """Bake `material` soon with its own quality and fit, unless it shows such a bake."""
    if _can_follow(material) and bake_job.difference(material):
        followed = _follow(material)
        followed.rough, followed.touched = True, time.monotonic() - REST
        timers.start(poll)


def leave(material):
    """End the material's running bake and forget its state; the shown bake stays."""
    _place.leave(material)
    _followed.pop(material.session_uid, None)


def is_pending(material):
    """True if `material` will be baked soon, or is being baked."""
    followed = _followed.get(material.session_uid)
    return running_for(material) is not None or followed is not None and (followed.changed or followed.rough)


def are_pending():
    """True if any material will be baked soon, or is being baked. From any thread."""
    jobs = running(), bake_job.running()
    return any(jobs) or any(one.changed or one.rough for one in list(_followed.values()))


def looked():
    """When the timer's function was called last; time.monotonic()."""
    return _looked


def finish():
    """Bake all that is pending, and wait for it. For a render that the main thread starts. Nothing can be
    shown while a preview renders, and Blender notices its end only on this thread: then all waits."""
    while are_pending() and bake_job.running() is None and not renders.is_running():
        poll()
        if running() is not None:
            running().wait()


def poll():
    """The timer's function. Returns the seconds until the next call; None if nothing is left to do."""
    global _looked
    _looked = time.monotonic()
    _finish_job()
    if running() is None and bake_job.running() is None:
        _start_next()
    if running() is not None:
        return WAITING if renders.is_running() else WORKING
    return _tidy()


def _can_follow(material):
    if not (preferences.automatic() and material.lamina.enabled and native.available()):
        return False
    return editable.is_editable(material) and not migration.is_from_the_future(material)


def _follow(material):
    return _followed.setdefault(material.session_uid, _Material())


def _finish_job():
    """Apply the job's result if it is done; cancel the job if it is outdated and slow."""
    job = running()
    if job is None:
        return
    followed = _followed.get(job.uid)
    if not job.done:
        is_late = job.is_whole or time.monotonic() - job.started > PATIENCE
        if followed is None or (followed.changed and is_late):
            job.cancel()
            if followed is not None and not job.is_whole and not job.options:
                followed.seconds = max(followed.seconds, PATIENCE, 2.0 * SLOW)
                followed.nodes = followed.nodes or NODES + 1
        return
    if renders.is_running():
        return
    material = job.material()
    if material is None or followed is None or job.cancelling or not _can_follow(material):
        _place.forget()
        return
    followed.touched = time.monotonic()
    try:
        with undo.recorded("Lamina Update"):
            job.show(material, followed)
    except Exception as error:  # The panel shows one sentence; the last good bake is kept.
        if timers.is_refusal(error):
            raise
        followed.rough = False
        if not followed.changed:
            bake_job.note_failure(material, error)
    _place.forget()
    redraw.properties()


def _start_next():
    """Start a bake of the newest state of a material that has changed."""
    for uid, followed in list(_followed.items()):
        material = with_uid(bpy.data.materials, uid)
        if material is None:
            del _followed[uid]
        elif followed.changed:
            options = followed.coarse_options(material)
            is_started = _can_follow(material) and _start(material, renders.is_held(), options)
            followed.changed = False  # after the start: another thread may ask are_pending() meanwhile
            if is_started:
                return


def _kept(material):
    """The closures of the earlier bake, unless they are too many to be quick."""
    is_few = material.lamina.result.basis in ("", preferences.table_basis(BASIS))
    return node_group.closures(material) if is_few else None


def _start(material, is_whole, options=None):
    """Starts a bake. Returns False if it could not be started; the panel then gives the reason."""
    try:
        _place.take(UpdateJob(material, is_whole, None if is_whole else options))
    except Exception as error:
        bake_job.note_failure(material, error)
        redraw.properties()
        return False
    return True


def _tidy():
    """At rest, or while a render waits for it: bake coarse results with the material's quality and fit."""
    resting = True
    for uid, followed in list(_followed.items()):
        material = with_uid(bpy.data.materials, uid)
        if material is None or not _can_follow(material):
            del _followed[uid]
        elif followed.changed or followed.rough:
            is_due = followed.touched + REST < time.monotonic() or renders.is_held()
            if is_due and not followed.changed and bake_job.running() is None:
                is_started = _start(material, is_whole=True)
                followed.rough = False
                if is_started:
                    return WORKING
            else:
                resting = False
    return None if resting else WAITING


def _stack(text):
    stack, error = stack_check.of(text)
    if error is not None:
        raise error
    return stack


@persistent
def _on_load(*_):
    stop()
    _followed.clear()


@persistent
def _on_undo(*_):
    # Blender makes an undo step when a layer changes, before the bake of that change is applied.
    for uid in list(_followed):
        material = with_uid(bpy.data.materials, uid)
        if material is None:
            continue
        state = bake_job.state(material)
        if state == "stale":
            mark(material)
        elif state == "other":
            refine(material)


def _on_loss(owner):
    for material in bpy.data.materials:
        if material.lamina.node_group == owner:
            mark(material)


HANDLERS = {"load_pre": _on_load, "undo_post": _on_undo, "redo_post": _on_undo}


def register():
    changes.listeners.append(mark)
    changes.refinements.append(refine)
    changes.losses.append(_on_loss)
    handlers.add(HANDLERS)


def unregister():
    stop()
    timers.end(poll)
    changes.listeners.remove(mark)
    changes.refinements.remove(refine)
    changes.losses.remove(_on_loss)
    handlers.remove(HANDLERS)
    _followed.clear()
