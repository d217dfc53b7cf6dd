# SPDX-License-Identifier: GPL-3.0-or-later
"""The stack that is nearest to a measured material: in a blocking function, or in a worker thread that is
polled."""

import logging
import warnings

from ..base import messages, native, preferences
from ..base.worker import OfMaterial, Place, Worker
from . import stack_io

log = logging.getLogger(__name__)

_place = Place()
running, forget, stop = _place.running, _place.forget, _place.stop
running_for, register, unregister = _place.running_for, _place.register, _place.unregister


class MatchJob(OfMaterial, Worker):
    """The search for one material. `sentence`: the result in words, after apply()."""

    def __init__(self, material, path):
        self.uid, self.sentence = material.session_uid, ""
        search = native.require().nearest
        threads = preferences.threads()
        super().__init__(lambda progress, cancel: search(path, threads, progress, cancel), "lamina match")

    def apply(self, material):
        self.sentence = show(material, self.result)


def match(material, path):
    """Replace the layers and base of `material` by the nearest stack to a measured material, in a file of
    MERL or RGL. Blocks. Returns the stack and its error in a sentence. Raises lamina.MeasurementError,
    OSError, RefusedError, NativeMissingError; then nothing is changed."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of data that gain light, which no stack does
        return show(material, native.require().nearest(path, preferences.threads()))


def start(material, path):
    """Start a background job; only one runs at a time. Raises like match, before the job starts."""
    return _place.take(MatchJob(material, path))


def show(material, found):
    """Give the material the stack of a lamina.Nearest. Returns its error and remarks in sentences."""
    stack_io.assign_stack(material, found.stack)
    mean, worst = messages.percent(found.error), messages.percent(found.worst)
    error = f"{found.kind.capitalize()}, mean error {mean}, worst {worst} at {found.worst_angle:.0f} degrees."
    return " ".join([error, *found.remarks])
