# SPDX-License-Identifier: GPL-3.0-or-later
"""Live dust: after each change of its settings, dust settles again, with few rays while a slider moves and
with all once it rests.

Property callbacks only note which object has changed. A timer reads the notes and starts one settling at a
time in a worker thread, always with the newest settings; it ends when all is at rest. The object and what
surrounds it are read once for the previews of a slider's movement, and again at rest."""

import logging
import time

import bpy
from bpy.app.handlers import persistent

from ..base import changes, handlers, messages, native, preferences, redraw, renders, timers, undo
from ..base.worker import Place, with_uid
from ..nodes import rest_coordinates
from . import dust_job, dust_settings, object_dust

log = logging.getLogger(__name__)

WORKING, WAITING = 0.02, 0.1  # seconds to the timer's next call: while dust settles, while sliders may move
REST = 0.6  # seconds without a change, after which all rays are used
PATIENCE = 0.5  # a preview of outdated settings is cancelled after this many seconds

_place = Place()
running, stop = _place.running, _place.stop
_followed = {}  # uid -> _Object
_failures = {}  # uid -> sentence


class _Object:
    """The state of an object whose settings change."""

    def __init__(self):
        self.changed = True  # since the last settling was started
        self.touched = time.monotonic()
        self.read = None  # (what was read, the Moment) of the last preview


class LiveJob(dust_job.DustJob):
    """The settling of one object at the present frame."""

    def __init__(self, task, is_preview):
        self.uid, self.is_preview, self.started = task.uid, is_preview, time.monotonic()
        super().__init__([task], preferences.threads())


def mark(obj):
    """The settings of `obj` have changed: settle soon if the object is live. Cheap enough for any callback.
    """
    if obj is None or not obj.lamina_dust.live:
        return
    followed = _followed.setdefault(obj.session_uid, _Object())
    followed.changed, followed.touched = True, time.monotonic()
    timers.start(poll)


def switch(obj):
    """Live has been turned on or off."""
    if not obj.lamina_dust.live:
        leave(obj)
    elif obj.lamina_dust.settled != dust_settings.text(obj.lamina_dust):
        mark(obj)


def leave(obj):
    """End the running settling of an object and forget its state; the shown dust stays."""
    _place.leave(obj)
    _followed.pop(obj.session_uid, None)
    _failures.pop(obj.session_uid, None)


def clear_of(material):
    """Remove the dust, and the rest coordinates, of all objects that show them by this material alone.
    Painted masks stay."""
    for obj in bpy.data.objects:
        if obj.type != "MESH" or not obj.is_editable or not obj.data.is_editable:
            continue
        used = {slot.material for slot in obj.material_slots if slot.material is not None}
        if {one for one in used if one.lamina.enabled} == {material}:
            leave(obj)
            object_dust.clear(obj)
            rest_coordinates.remove(obj.data)


def poll():
    """The timer's function. Returns the seconds until the next call; None if nothing is left to do."""
    _finish_job()
    if running() is None and dust_job.running() is None:
        _start_next()
    if running() is not None:
        return WORKING
    return WAITING if _followed else None


def is_pending(obj):
    """True if the object's dust is about to settle again by itself."""
    return obj.session_uid in _followed


def failure(obj):
    """Why the last live settling of an object failed, or ''."""
    return _failures.get(obj.session_uid, "")


def _finish_job():
    """Apply the job's dust if it is done; cancel the job if its settings are outdated and it is slow."""
    job = running()
    if job is None:
        return
    followed = _followed.get(job.uid)
    if not job.done:
        is_slow = not job.is_preview or time.monotonic() - job.started > PATIENCE
        if followed is None or (followed.changed and is_slow):
            job.cancel()
        return
    if renders.is_running():
        return
    obj = with_uid(bpy.data.objects, job.uid)
    if obj is None or followed is None or job.cancelling:
        _place.forget()
        return
    try:
        with undo.recorded("Lamina Live Dust"):
            job.finish()
        _failures.pop(job.uid, None)
    except Exception as error:  # the panel shows one sentence; the last dust is kept
        if timers.is_refusal(error):
            raise
        _note(obj, error)
    _place.forget()
    if not job.is_preview and not followed.changed:
        _followed.pop(job.uid, None)
    redraw.properties()


def _start_next():
    """Start a preview of an object that has changed, or all rays for an object at rest."""
    for uid, followed in list(_followed.items()):
        obj = with_uid(bpy.data.objects, uid)
        if obj is None or not obj.lamina_dust.live or not native.available():
            del _followed[uid]
            continue
        if not followed.changed and time.monotonic() - followed.touched < REST:
            continue
        is_preview, followed.changed = followed.changed, False
        try:
            _place.take(LiveJob(_task(obj, followed, is_preview), is_preview))
            return
        except Exception as error:
            _note(obj, error)
            del _followed[uid]
            redraw.properties()


def _task(obj, followed, is_preview):
    """The newest settings of an object. At rest the scene is read again."""
    settings = obj.lamina_dust
    wanted = settings.target, settings.uv_map, settings.others
    known = followed.read[1] if is_preview and followed.read and followed.read[0] == wanted else None
    task = object_dust.gather(bpy.context, obj, live=True, preview=is_preview, moment=known)
    followed.read = wanted, task.moments[0]
    return task


def _note(obj, error):
    if not messages.expected(error):
        log.error("live dust on %s failed", obj.name, exc_info=error)
    _failures[obj.session_uid] = messages.sentence(error)


@persistent
def _on_load(*_):
    stop()
    _followed.clear()
    _failures.clear()


@persistent
def _on_undo(*_):
    # Blender makes an undo step when a setting changes, before the dust of that change has settled.
    for obj in bpy.data.objects:
        settings = obj.lamina_dust
        if settings.live and settings.told and settings.settled != dust_settings.text(settings):
            mark(obj)


def _on_loss(owner):
    if isinstance(owner, bpy.types.Object):
        mark(owner)


HANDLERS = {"load_pre": _on_load, "undo_post": _on_undo, "redo_post": _on_undo}


def register():
    changes.dust_listeners.append(mark)
    changes.dust_switches.append(switch)
    changes.losses.append(_on_loss)
    handlers.add(HANDLERS)


def unregister():
    stop()
    timers.end(poll)
    changes.dust_listeners.remove(mark)
    changes.dust_switches.remove(switch)
    changes.losses.remove(_on_loss)
    handlers.remove(HANDLERS)
    _followed.clear()
    _failures.clear()
