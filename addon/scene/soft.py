# SPDX-License-Identifier: GPL-3.0-or-later
"""Chooses how soft light is shown: by the first output whose error on the artist's own object is small.

Each output in turn is built on a copy of the material. Walks through the object tell its error, see
interior.trial. Volume, which is right for all closed shapes and the noisiest, is the last and needs no
trial. Through a boundary, lamps reach a volume by chance only: then the best of the tried outputs is chosen,
and the trial says that Exact is nearer."""

import threading
from typing import NamedTuple

import bpy

from ..baking import body_thickness, lateral_body, lateral_job, volume_bounces
from ..base import native, renders
from ..base.messages import RefusedError
from ..base.worker import OfMaterial, Worker, with_uid
from ..editing import stack_io
from ..interior import trial
from ..nodes import node_group
from ..properties.material_properties import LATERAL_OUTPUTS

NAMES = {item[0]: item[1] for item in LATERAL_OUTPUTS}
TRIED, LAST = ("RELIGHTABLE", "PORTAL"), "VOLUME"  # the fastest renders first
# Largest errors that count as small: of all light together, and of the light at a place.
MEAN, SPREAD = 0.05, 0.25


class SoftJob(OfMaterial, Worker):
    """The choice for one material. Its thread lets `tick` do what needs the main thread."""

    def __init__(self, context, obj, material):
        choice = _Choice(context, obj, material)
        self.uid, self._choice = material.session_uid, choice
        self._asked, self._answered = None, threading.Event()
        super().__init__(lambda progress, cancel: choice.made(self._on_main, progress, cancel), "lamina soft")

    def _on_main(self, function):
        self._answered.clear()
        self._asked = function
        while not self._answered.wait(0.1):
            if self.cancelling:
                raise native.require().Cancelled("the choice was cancelled")
        if isinstance(self._answer, BaseException):
            raise self._answer
        return self._answer

    def tick(self):
        """Do what the thread has asked for, not during a render that would refuse the trial's."""
        if self._asked is None or renders.is_running():
            return
        function, self._asked = self._asked, None
        try:
            self._answer = function()
        except BaseException as error:  # for the thread
            self._answer = error
        self._answered.set()

    def apply(self, material):
        self._choice.show(material, *self.result)


def make(context, obj, material):
    """Choose and build the nodes. Blocks. Returns (output, interior.trial.Trial or None). Raises as
    lateral_job.make does; the material is then unchanged."""
    choice = _Choice(context, obj, material)
    output, found, tried = choice.made(lambda function: function())
    choice.show(material, output, found, tried)
    return output, tried


def start(context, obj, material):
    """Start a background job, which takes the place of a lateral_job's. Raises like make, before the job
    starts."""
    return lateral_job.take(SoftJob(context, obj, material))


class _Tried(NamedTuple):
    """An output, what was computed for it, and its Trial."""

    output: str
    found: object
    trial: trial.Trial


class _Choice:
    """The choice for one material on one object, read on the main thread."""

    def __init__(self, context, obj, material):
        # Undo may replace data-blocks while the thread works.
        self._uids = obj.session_uid, material.session_uid, context.scene.session_uid
        self._quality = material.lamina.quality
        self._millimetre = lateral_job.millimetre(context.scene)
        self._has_lamps = any(one.type == "LIGHT" and not one.hide_render for one in context.scene.objects)
        self._layers, self._stack = lateral_job.made_from(material), stack_io.to_stack(material)
        self._compute = {output: lateral_job.computation(output, material) for output in (*TRIED, LAST)}
        self._outputs, self._tried, self._reason = TRIED, [], ""
        try:
            self._note = lateral_body.require(context, context.scene, material, TRIED[0])
        except RefusedError:
            self._outputs = TRIED[1:]
            self._note = lateral_body.require(context, context.scene, material, LAST)

    def made(self, on_main, progress=None, cancel=None):
        """(output, what was computed for it, the Trial or None). `on_main` calls a function on the main
        thread."""
        told, lamina = progress or (lambda _fraction, _text="": None), native.require()
        for number, output in enumerate(self._outputs):
            def step(fraction, text="", first=number):
                told((first + fraction) / len(self._outputs), text)

            found = self._compute[output](self._stack, self._quality, step, cancel)
            try:
                task = on_main(lambda output=output, found=found: self._task(output, found))
            except (RefusedError, lamina.StackError, lamina.InteriorError) as error:
                self._reason = str(error)
                return self._untried(on_main, output, found, cancel)
            tried = _Tried(output, found, trial.walk(task, step, cancel))
            self._tried.append(tried)
            if _is_right(tried.trial):
                return tried
        last = self._last(cancel)
        if self._has_lamps and last[1].hides_lamps:
            return min(self._tried, key=lambda tried: abs(tried.trial.error))
        return last

    def _untried(self, on_main, output, found, cancel):
        """Without walks, the thickness of the body decides. Only one medium can be a volume."""
        if on_main(lambda: self._thin(found)):
            try:
                return self._last(cancel)
            except native.require().StackError:
                pass
        return output, found, None

    def _last(self, cancel):
        return LAST, self._compute[LAST](self._stack, self._quality, None, cancel), None

    def show(self, material, output, found, tried):
        """Build the nodes of the choice."""
        scene = with_uid(bpy.data.scenes, self._uids[2])
        lateral_job.show(material, scene, output, self._layers, self._note, found, self._millimetre)
        if tried is not None:
            more = "" if _is_right(tried) else ". Exact is nearer"
            material.lamina.trial = f"{tried.sentence}{more}"
        elif self._tried:
            words = ", ".join(f"{NAMES[one.output]} {one.trial.words}" for one in self._tried)
            material.lamina.trial = f"Tried: {words}"
        elif self._reason:
            chosen = f"{NAMES[output]}, by the thickness of the object"
            material.lamina.trial = f"{chosen}. No trial: {self._reason}"

    def _task(self, output, found):
        """The trial of an output on a copy of the material. Main thread only."""
        obj, material = self._found()
        copy = material.copy()
        try:
            lateral_job.show(copy, None, output, self._layers, "", found, self._millimetre)
            return trial.gather(bpy.context, obj, material, copy, volume_bounces.needed(copy))
        finally:
            node_group.remove(copy)
            bpy.data.materials.remove(copy)

    def _thin(self, found):
        evaluated = self._found()[0].evaluated_get(bpy.context.evaluated_depsgraph_get())
        thickness = body_thickness.thin_part(evaluated) / self._millimetre
        return thickness < body_thickness.LEAST * body_thickness.reach(found)

    def _found(self):
        """(object, material). Raises lamina.Cancelled if one of them has been deleted."""
        pairs = zip((bpy.data.objects, bpy.data.materials), self._uids, strict=False)
        found = [with_uid(blocks, uid) for blocks, uid in pairs]
        if None in found:
            raise native.require().Cancelled("the object or the material has been deleted")
        return found


def _is_right(tried):
    return abs(tried.error) <= MEAN and tried.spread <= SPREAD
