# SPDX-License-Identifier: GPL-3.0-or-later
"""The error of a material's light from below the surface on the artist's own object: walks through the
object, at some places that the camera sees, against a small render of what the material shows there."""

import logging
from dataclasses import dataclass

import numpy as np

from ..base import native, preferences
from ..base.messages import RefusedError
from ..base.worker import OfMaterial, Place, Worker
from ..nodes import node_group, volume_graph
from . import body, contents, lights, seen, trial_render

log = logging.getLogger(__name__)
_place = Place()
running, forget, stop = _place.running, _place.forget, _place.stop
running_for, register, unregister = _place.running_for, _place.register, _place.unregister

SAMPLES, MOST_SAMPLES = 64, 4096  # walks at each place: of the first pass, of all
ENOUGH = 0.01  # relative standard error of the mean over all places
LEAST_PLACES = 20


@dataclass(frozen=True)
class Trial:
    """The relative error of the light of all places together and its standard error; `spread`, the rms error
    of a place against the mean light, without noise; the number of places."""

    error: float
    stderr: float
    spread: float
    places: int

    @property
    def sentence(self):
        """The result in words."""
        error, spread = f"{100.0 * self.stderr:.1f} %", f"{100.0 * self.spread:.0f} %"
        return (f"Tried at {self.places} places that the camera sees: {self.words} on the whole (standard "
                f"error {error}), {spread} off at a place")

    @property
    def words(self):
        return f"{100.0 * abs(self.error):.1f} % too {'bright' if self.error > 0.0 else 'dark'}"


@dataclass(frozen=True)
class Task:
    """One trial, as arrays and numbers. `rendered`: (2, n, 3)."""

    material: int
    solid: object
    fill: object
    surface: object
    sources: list
    occluders: object
    places: trial_render.Places
    rendered: np.ndarray


class TrialJob(OfMaterial, Worker):
    """The walks of a trial."""

    def __init__(self, task):
        self.uid = task.material
        super().__init__(lambda progress, cancel: walk(task, progress, cancel), "lamina trial")

    def apply(self, material):
        material.lamina.trial = self.result.sentence


def make(context, obj, material, progress=None, cancel=None):
    """The Trial of what the material shows on the object. Blocks. Raises as `gather` does, and the errors of
    lamina.light_in_mesh."""
    found = walk(gather(context, obj, material), progress, cancel)
    material.lamina.trial = found.sentence
    return found


def start(context, obj, material):
    """Start a background job; only one runs at a time. Raises like `gather`, before the job starts."""
    return _place.take(TrialJob(gather(context, obj, material)))


def problem(obj, material):
    """The reason why a trial is impossible, in a sentence, or ''."""
    if not node_group.shows_lateral(material):
        return "Nothing to try: the material shows no light from below its surface"
    if volume_graph.has_boundary(material):
        return ("Volume is right without a trial, and below a boundary its light from inside cannot be told "
                "from reflections")
    return body.problem(obj) or native.reason()


def gather(context, obj, material, shown=None, bounces=None):
    """The Task: renders the object, with the material `shown` in place of `material` if it is given, and with
    the scene's bounces, or more as `bounces` says. Main thread only. Raises RefusedError, lamina.StackError
    and lamina.InteriorError."""
    shown = shown or material
    sentence = problem(obj, shown)
    if sentence:
        raise RefusedError(sentence)
    scene = context.scene
    found = seen.of_object(context, obj, material)
    sources = lights.of_scene(scene, obj, found)
    # Nodes of the panel's choice Soft show the layers, whatever Veins would fill.
    source = "LAYERS" if shown.lamina.lateral_report else None
    filled = contents.of_material(obj, material, found.body, source)
    camera = trial_render.camera_of(scene, found.body)
    places = trial_render.places(found.body, found.occluders, camera)
    if len(places.pixels) < LEAST_PLACES:
        what = f"the camera sees too little of {material.name} on {obj.name}"
        raise RefusedError(f"{what}: turn the camera to it")
    rendered = trial_render.pictures(context, obj, camera, {material: shown}, bounces or {})
    rendered = rendered[:, places.pixels]
    uid, others = material.session_uid, found.occluders
    return Task(uid, found.body.solid(), filled.fill, filled.surface, sources, others, places, rendered)


def walk(task, progress=None, cancel=None):
    """The Trial of a Task. Raises as lamina.light_in_mesh does."""
    lamina, told = native.require(), progress or (lambda _fraction, _text="": None)
    interior = task.fill(lambda fraction, text="": told(0.1 * fraction, text), cancel)
    shining = [one.lamp(lamina) for one in task.sources if one.kind]
    sky = task.sources[-1]
    around = None if sky.radiance is None else lamina.Surroundings(sky.radiance)
    factors = np.array([one.factor * one.strength * np.array(one.colour) for one in task.sources])
    light, variance, done = 0.0, 0.0, 0
    while done < MOST_SAMPLES:
        samples = max(done, SAMPLES)
        part = lamina.light_in_mesh(
            task.solid, interior, shining, task.places.positions, task.places.normals, task.places.directions,
            surface=task.surface, samples=samples, seed=done, threads=preferences.threads(), cancel=cancel,
            surroundings=around, occluders=task.occluders)
        found = np.concatenate([part.lamps.value, part.sky.value[:, None]], axis=1)
        noise = np.concatenate([part.lamps.stderr, part.sky.stderr[:, None]], axis=1)
        done += samples
        new = samples / done
        light = (1.0 - new) * light + new * (factors * found).sum(axis=(1, 2))
        variance = (1.0 - new) ** 2 * variance + new**2 * ((factors * noise) ** 2).sum(axis=(1, 2))
        reached = np.sqrt(variance.sum()) / max(light.sum(), 1e-30)
        share = max(done / MOST_SAMPLES, (ENOUGH / max(reached, ENOUGH)) ** 2)
        told(0.1 + 0.9 * share, "Walks for the trial")
        if reached < ENOUGH:
            break
    return compare(task.rendered.sum(axis=2), light, variance)


def compare(rendered, light, variance):
    """The Trial from two renders (2, n) of the places and from walks: light and variance, (n,) each. Raises
    RefusedError where walks find no light."""
    total = float(light.sum())
    if not total > 0.0:
        raise RefusedError("no light comes from below the surface at these places")
    shown, noise = rendered.mean(axis=0), 0.25 * (rendered[0] - rendered[1]) ** 2
    ratio = float(shown.sum()) / total
    # The places are a sample of the surface: residuals hold their differences and the noise.
    stderr = np.sqrt(np.sum((shown - ratio * light) ** 2)) / total
    uneven = np.mean((shown - light) ** 2 - variance - noise)
    spread = np.sqrt(max(float(uneven), 0.0)) / np.mean(light)
    return Trial(ratio - 1.0, float(stderr), float(spread), len(light))
