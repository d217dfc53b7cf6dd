# SPDX-License-Identifier: GPL-3.0-or-later
"""Live editing: after each change of a layer, the material is baked again at preview quality.

Property callbacks only note which material has changed. A timer reads the notes. It starts one bake at a time
in a worker thread, always of the newest state, and applies a finished one. Typing therefore never waits, and
a slow stack is updated less often. The timer ends some time after the last change. Nothing of this is written
to the .blend.
"""

import time

import bpy
from bpy.app.handlers import persistent

from ..base import changes, handlers, native, preferences, redraw, renders, timers, undo
from ..base.worker import OfMaterial, Place, Worker, with_uid
from ..editing import stack_io
from ..nodes import node_group
from ..properties import migration
from ..stack_json import stack_check
from . import bake_job

WORKING, WAITING = 0.004, 0.05  # seconds to the timer's next call: while a bake runs, and while editing may
                                # go on
REST = 1.0  # seconds without a change, after which coarse results are refined
PATIENCE = 0.5  # a bake of an outdated state is cancelled after this many seconds
# A stack whose bake takes longer than this many seconds is solved with fewer rows and nodes while edited.
SLOW, ROW_STRIDE, NODES = 0.08, 4, 32
# Closures are kept while editing. At rest others are chosen if the fit error has grown by the factor WORSE
# and is above NOTICED.
WORSE, NOTICED = 1.5, 0.02

_place = Place()
running, stop = _place.running, _place.stop
_followed = {}  # uid -> _Material


class _Material:
    """The state of a material that is edited live."""

    def __init__(self, material):
        self.changed = False  # since the last bake was started
        self.touched = time.monotonic()  # when something last happened
        self.seconds, self.nodes = 0.0, 0  # of the last complete bake
        self.coarse = False  # the shown bake is coarse
        self.error = 0.0  # the fit error now, and when the closures were chosen
        self.chosen_error = material.lamina.result.report.get("fit_error", 0.0)
        self.undrawn = None  # (stack, LUT) of a whole bake that the result's picture does not show

    def coarse_options(self, material):
        """Options for a coarser bake of this material while it is edited; none if its bakes are quick."""
        options = {}
        if self.seconds > SLOW:
            if any(layer.varying for layer in material.lamina.layers):
                options["row_stride"] = ROW_STRIDE
            if self.nodes > NODES:
                options["nodes"] = NODES
        return options


class LiveJob(bake_job.MaterialJob):
    """A bake with the closures of the last one, or with a new choice."""

    def __init__(self, material, closures, coarse):
        self.started, self.kept, self.coarse = time.monotonic(), bool(closures), bool(coarse)
        more = {"closures": closures} if closures else {}
        text = stack_io.to_text(material)
        # A colour needs a solve, so the thread makes the stack.
        super().__init__(material, bake_job.LIVE_QUALITY, preferences.threads(), lambda: _stack(text),
                         drawn=False, basis=bake_job.LIVE_BASIS, **more, **coarse)

    def show(self, material, followed):
        if self.error is not None:
            raise self.error
        bake_job.apply(material, self.lut, in_place=True, coarse=self.coarse)
        followed.error, followed.coarse = self.lut.report["fit_error"], self.coarse
        if not self.coarse:
            report = self.lut.report
            followed.seconds, followed.nodes = report["seconds"], report["solver"]["nodes"]
            followed.undrawn = self.stack, self.lut
        if not self.kept:
            followed.chosen_error = followed.error


class CurvesJob(OfMaterial, Worker):
    """The curves of the result's picture, which are left out while layers change."""

    coarse = True  # its time says nothing on the next bake's

    def __init__(self, material, stack, lut):
        self.uid, self.started = material.session_uid, time.monotonic()
        threads = preferences.threads()
        super().__init__(lambda _progress, _cancel: bake_job.curves_of(stack, lut, threads), "lamina curves")

    def show(self, material, _followed):
        if self.error is not None:
            raise self.error
        material.lamina.result.curves = self.result


def mark(material):
    """`material` has changed: bake it soon if it is live. Cheap enough for any callback."""
    if _can_follow(material):
        followed = _follow(material)
        followed.changed, followed.touched = True, time.monotonic()
        timers.start(poll)


def switch(material):
    """Live has been turned on or off."""
    if not material.lamina.live:
        leave(material)
    elif native.available() and _needs_bake(material):
        mark(material)


def leave(material):
    """End the material's running bake and forget its state; the shown bake stays."""
    _place.leave(material)
    _followed.pop(material.session_uid, None)


def poll():
    """The timer's function. Returns the seconds until the next call; None if nothing is left to do."""
    _finish_job()
    if running() is None and bake_job.running() is None:
        _start_next()
    if running() is not None:
        return WAITING if renders.is_running() else WORKING
    return _tidy()


def _can_follow(material):
    settings = material.lamina
    if not (settings.live and settings.enabled and native.available()):
        return False
    return material.is_editable and not migration.is_from_the_future(material)


def _needs_bake(material):
    """True if the last bake is not of the present layers, or is coarse."""
    state = bake_job.state(material)
    return state in ("none", "stale", "invalid") or material.lamina.result.quality == bake_job.COARSE


def _follow(material):
    if material.session_uid not in _followed:
        _followed[material.session_uid] = _Material(material)
    return _followed[material.session_uid]


def _finish_job():
    """Apply the job's result if it is done; cancel the job if it is outdated and slow."""
    job = running()
    if job is None:
        return
    followed = _followed.get(job.uid)
    if not job.done:
        if followed is None or (followed.changed and time.monotonic() - job.started > PATIENCE):
            job.cancel()
            if followed is not None and not job.coarse:  # a complete bake takes even longer
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
        with undo.recorded("Lamina Live"):
            job.show(material, followed)
    except Exception as error:  # The panel shows one sentence; the last good bake is kept.
        if timers.is_refusal(error):
            raise
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
            followed.changed = False
            coarse = followed.coarse_options(material)
            if _can_follow(material) and _start(material, _kept(material), coarse):
                return


def _kept(material):
    """The closures of the earlier bake, unless they are too many to be quick."""
    is_few = material.lamina.result.basis in ("", bake_job.LIVE_BASIS)
    return node_group.closures(material) if is_few else None


def _start(material, closures, coarse=None):
    """Starts a bake. Returns False if it could not be started; the panel then gives the reason."""
    try:
        _place.take(LiveJob(material, closures, coarse or {}))
    except Exception as error:
        bake_job.note_failure(material, error)
        redraw.properties()
        return False
    return True


def _tidy():
    """At rest: bake with all rows, and with new closures where the kept ones fit badly; then make the curves
    of the result's picture."""
    resting = True
    for uid, followed in list(_followed.items()):
        material = with_uid(bpy.data.materials, uid)
        if material is None:
            del _followed[uid]
            continue
        worse = followed.error > max(NOTICED, WORSE * followed.chosen_error)
        if not (followed.changed or followed.coarse or worse or followed.undrawn):
            continue
        if not followed.changed and followed.touched + REST < time.monotonic() and bake_job.running() is None:
            if not (followed.coarse or worse):
                undrawn, followed.undrawn = followed.undrawn, None
                _place.take(CurvesJob(material, *undrawn))
                return WORKING
            followed.coarse, followed.chosen_error = False, max(followed.chosen_error, followed.error)
            if _start(material, None if worse else _kept(material)):
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
    for material in bpy.data.materials:
        if _can_follow(material) and bake_job.state(material) == "stale":
            mark(material)


def _on_loss(owner):
    for material in bpy.data.materials:
        if material.lamina.node_group == owner:
            mark(material)


HANDLERS = {"load_pre": _on_load, "undo_post": _on_undo, "redo_post": _on_undo}


def register():
    changes.listeners.append(mark)
    changes.switches.append(switch)
    changes.losses.append(_on_loss)
    handlers.add(HANDLERS)


def unregister():
    stop()
    timers.end(poll)
    changes.listeners.remove(mark)
    changes.switches.remove(switch)
    changes.losses.remove(_on_loss)
    handlers.remove(HANDLERS)
    _followed.clear()
