# SPDX-License-Identifier: GPL-3.0-or-later
"""The albedo of a medium given by its colour, and the colour of a medium given by its albedo.

Both need a solve, and so does the check of a stack with colours. The panel asks while it is drawn and gets a
known answer or None. Unknown answers are computed in a thread, and then the panel is redrawn. Nothing is
written to the .blend.
"""

import json
import logging
import math
import threading

from ..base import messages, native, redraw, timers
from ..kinds.limits import STACK_SCHEMA
from . import stack_check, stack_write

log = logging.getLogger(__name__)

LOOK = 0.03  # seconds between two checks of the worker
KEPT = 256  # answers

_answers = {}  # (what, JSON) -> the result of `answer`
_latest = {}  # the last answer for each layer, shown until the new one is known, to avoid flicker
_wanted = {}  # layer -> its newest question
_worker = None


def albedo(end):
    """The albedo of a medium, or of its bottom, that is given by its colour: three numbers, () if no albedo
    gives this colour, None while unknown."""
    return _ask("albedo", _text(end, "albedo"), (end.id_data.session_uid, end.path_from_id()))


def thick_colour(end):
    """The colour of a medium, or of its bottom, when infinitely thick, under diffuse light; returned like
    `albedo`."""
    return _ask("colour", _text(end, "colour"), (end.id_data.session_uid, end.path_from_id()))


def is_checked(material, text):
    """True if `lamina` has checked the material's stack, this JSON, or can do so at once."""
    if stack_check.is_quick(text):
        return True
    if _answers.get(("stack", text)):
        del _answers["stack", text]  # computed long ago, and no longer in the cache of stack_check
    _ask("stack", text, material.session_uid)
    return False


def answer(what, text):
    """Computes one answer: the 'albedo' or 'colour' of the layer with this JSON, () for an invalid layer; or
    True once the 'stack' with this JSON has been checked."""
    if what == "stack":
        stack_check.of(text)
        return True
    lamina, colours = native.require(), native.part("colours")
    try:
        stack = lamina.Stack.from_json({"schema": STACK_SCHEMA, "layers": [json.loads(text)]})
        albedos = tuple(stack.optics(0, channel)[0] for channel in range(stack.channels))
        if what == "albedo":
            return _triple(albedos)
        thick = lamina.Medium(albedo=albedos, tau=math.inf, phase=stack.layers[0].phase)
        return _triple(stack.seen(colours.shown(thick)))
    except (lamina.StackError, lamina.SolveError):
        return ()


def look():
    """The timer's function: takes a finished answer, starts the next. Returns the seconds until the next
    call."""
    global _worker
    if _worker is not None:
        if _worker.is_alive():
            return LOOK
        _worker = None
        redraw.properties()
    if not _wanted:
        return None
    question = _wanted.pop(next(iter(_wanted)))
    if question not in _answers:
        while len(_answers) >= KEPT:
            del _answers[next(iter(_answers))]
        _worker = threading.Thread(target=_work, args=(question,), name="lamina colours", daemon=True)
        _worker.start()
    return LOOK


def _ask(what, text, place):
    """The answer if known, else the last one for the same place, or None."""
    if not native.available():
        return None
    question, place = (what, text), (what, place)
    known = _answers.get(question)
    if known is None:
        _wanted[place] = question
        timers.start(look, LOOK)
        return _latest.get(place)
    _wanted.pop(place, None)
    _latest[place] = known
    return known


def _text(end, what):
    """The medium of a layer or of its bottom, as a layer of its own."""
    path = end.path_from_id()
    layer = end.id_data.path_resolve(path.removesuffix(".bottom"))
    entry = stack_write.homogeneous(layer, end)
    if what == "colour":
        entry["thickness" if "thickness" in entry else "tau"] = 1.0
    return json.dumps(entry)


def _work(question):
    try:
        _answers[question] = answer(*question)
    except Exception as error:  # The panel then shows no number.
        log.warning("no colour for a layer", exc_info=None if messages.expected(error) else error)
        _answers[question] = ()


def _triple(values):
    values = tuple(float(value) for value in values)
    return values * 3 if len(values) == 1 else values


def register():
    pass


def unregister():
    global _worker
    timers.end(look)
    if _worker is not None:
        _worker.join()
        _worker = None
    for kept in (_answers, _latest, _wanted):
        kept.clear()
    stack_check.forget()
