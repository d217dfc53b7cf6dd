# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of the light in an object's interior, and their nodes: in a blocking function, or in a polled
worker.

`gather` reads the scene on the main thread, `compute` works on arrays only and may run in a thread,
`apply` writes. Nothing in the file is written before all is computed, except the UV map of an automatic
unwrap.
"""

import hashlib
import json
import logging
import shutil
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np

from ..base import native, package, preferences, renders
from ..base.messages import RefusedError
from ..base.worker import OfMaterial, Place, Worker
from ..kinds import interiors
from ..nodes import interior_graph, lateral_group
from ..properties.described import quantity
from . import body, contents, lights, unwrap

log = logging.getLogger(__name__)

_place = Place()
running, forget, stop = _place.running, _place.forget, _place.stop
running_for, register, unregister = _place.running_for, _place.register, _place.unregister

FILLING = 0.1  # share of the progress: the voxels
MARGIN = 4  # texels
STOPPED = "Stopped early: the next start continues."


@dataclass(frozen=True)
class Task:
    """One computation, as arrays and numbers. `fill`: a function of (progress, cancel) that returns the
    lamina.Interior. `sources`: the lamps, then the world, for Lit. `folder`: of finished parts."""

    material: int
    object: str
    name: str
    output: str
    solid: object
    fill: object
    surface: object
    uvs: np.ndarray
    uv_map: str
    normals: np.ndarray
    size: int
    noise: float
    sources: list
    view: dict
    node: tuple
    millimetre: float
    folder: Path
    threads: int


class InteriorJob(OfMaterial, Worker):
    """The computation for one material on one object. While it runs, `tick` shows previews. After a cancel or
    an error the last preview stays. `shows`: whether the material's nodes show images of this job."""

    def __init__(self, task):
        self.task, self.uid = task, task.material
        self._preview, self.shows = None, False
        super().__init__(
            lambda progress, cancel: compute(task, progress, cancel, self._keep), "lamina interior"
        )

    def _keep(self, images):
        self._preview = images

    def tick(self):
        """Show the latest preview, if there is a new one."""
        if renders.is_running():
            return
        images, self._preview = self._preview, None
        material = self.material()
        if images is None or material is None or self.cancelling:
            return
        apply(material, self.task, images, again=self.shows)
        self.shows = True

    def finish(self):
        """Like OfMaterial.finish. After a cancel with a preview on show, returns the material, whose report
        then tells how far the work had come."""
        if not (self.cancelling and self.shows):
            return super().finish()
        material = self.material()
        if material is not None:
            material.lamina.interior.report += f" {STOPPED}"
        return material

    def apply(self, material):
        """Build the nodes."""
        apply(material, self.task, self.result, again=self.shows)


def make(context, obj, material, progress=None, cancel=None, folder=None):
    """Compute the light inside an object and show it by the material's nodes. Blocks.

    Returns lamina.RelightableImages or lamina.LitImages, as material.lamina.interior.output says.
    Finished parts are kept in `folder`, by default one of Lamina's own: after a cancel, an error or the
    end of Blender, the next call with equal settings continues there. The folder is removed at the end.
    Raises RefusedError, NativeMissingError, OSError and the errors of lamina.relightable_images; the
    material is then unchanged."""
    task = gather(context, obj, material, folder)
    found = compute(task, progress, cancel)
    apply(material, task, found)
    return found


def start(context, obj, material):
    """Start a background job; only one runs at a time. Raises like make, before the job starts."""
    return _place.take(InteriorJob(gather(context, obj, material)))


def problem(obj, material):
    """The reason why the interior of an object cannot be computed, in a sentence, or ''."""
    sentence = body.problem(obj)
    if sentence or not native.available():
        return sentence or native.reason()
    reason = native.part("dust").available()
    if reason:
        return reason
    others = [one.name for one in bpy.data.objects if one != obj and _has(one, material)]
    if others:
        return f"{material.name} is also on {others[0]}: its images fit one object, make it single-user"
    return ""


def gather(context, obj, material, folder=None):
    """The Task, read from the scene. Main thread only: it renders node textures. Raises RefusedError."""
    sentence = problem(obj, material)
    if sentence:
        raise RefusedError(sentence)
    lamina, settings = native.require(), material.lamina.interior
    own = settings.map == "OWN" and len(obj.data.uv_layers) > 0
    uv_map = settings.uv_map if own else unwrap.ensure(obj)
    shape = body.of_object(context, obj, material, uv_map)
    uv_map = uv_map or next(one.name for one in obj.data.uv_layers if one.active_render)
    filled = contents.of_material(obj, material, shape)
    is_lit = settings.output == "LIT"
    task = Task(
        material=material.session_uid,
        object=obj.name,
        name=material.name,
        output=settings.output,
        solid=lamina.Solid(shape.arrays.vertices, shape.arrays.triangles, name=obj.name),
        fill=filled.fill,
        surface=filled.surface,
        uvs=shape.arrays.uvs,
        uv_map=uv_map,
        normals=shape.arrays.normals,
        size=quantity(settings, interiors.SIZE),
        noise=quantity(settings, interiors.NOISE),
        sources=_sources(context.scene, shape.frame) if is_lit else [],
        view=_view(context.scene, shape.frame) if is_lit and settings.view == "CAMERA" else {},
        node=contents.texture(material) if settings.source == "NODES" else ("", ""),
        millimetre=0.001 / context.scene.unit_settings.scale_length,
        folder=Path("."),
        threads=preferences.threads(),
    )
    base = package.user_folder("interiors") if folder is None else Path(folder)
    return replace(task, folder=base / _key(task, filled.identity))


def compute(task, progress=None, cancel=None, preview=None):
    """The images of a Task. `preview(images)` gets those so far. Raises as lamina.relightable_images does."""
    lamina = native.require()
    told = progress or (lambda _fraction, _text="": None)
    interior = task.fill(lambda fraction, text="": told(FILLING * fraction, text), cancel)
    how = {
        "uvs": task.uvs,
        "size": task.size,
        "surface": task.surface,
        "noise": task.noise,
        "normals": task.normals,
        "margin": MARGIN,
        "folder": task.folder,
        "threads": task.threads,
        "progress": lambda fraction, text="": told(FILLING + (1.0 - FILLING) * fraction, text),
        "cancel": cancel,
        # Runs with and without previews have different parts: the panel and a batch continue each other's.
        "preview": preview or (lambda _images: None),
    }
    if task.output == "LIT":
        lamps, radiance = _lit_by(task, lamina)
        around = None if radiance is None else lamina.Surroundings(radiance)
        return lamina.lit_images(task.solid, interior, lamps, surroundings=around, **how, **task.view)
    return lamina.relightable_images(task.solid, interior, version=tuple(bpy.app.version[:2]), **how)


def _lit_by(task, lamina):
    """(lamps of unit strength, the radiance of the world's image or None)."""
    lamps = [one.lamp(lamina) for one in task.sources if one.kind]
    return lamps, next((one.radiance for one in task.sources if not one.kind), None)


def apply(material, task, found, again=False):
    """Build the nodes of a Task's images. The folder of parts is removed, except for a preview. `again`: the
    nodes show a preview of this task, so the numbers that an artist has set there are kept."""
    settings = material.lamina.interior
    if task.output == "LIT":
        inputs = interior_graph.lit_inputs(task.sources)

        def draw(graph, _length, sockets):
            return interior_graph.draw_lit(
                graph, found, task.sources, task.surface, task.uv_map, task.name, sockets
            )
    else:
        inputs = ()

        def draw(graph, length, _sockets):
            return interior_graph.draw_relightable(graph, found.inputs, length, task.uv_map, task.name)

    lateral_group.build(material, task.output.capitalize(), draw, task.millimetre, inputs, again)
    if hasattr(material, "cycles"):
        # A lit surface shines on others as a diffuse one would: Cycles need not aim at its texels.
        material.cycles.emission_sampling = "NONE" if task.output == "LIT" else "AUTO"
    settings.node, settings.socket = task.node
    settings.suns, settings.shown_on = lights.kept(task.sources), task.object
    settings.report = " ".join([found.report, *(f"{note[0].upper()}{note[1:]}." for note in found.notes)])
    if found.done == 1.0:
        shutil.rmtree(task.folder, ignore_errors=True)


def stale(context, obj, material):
    """The reason why the last Lit no longer fits the scene, in a sentence, or ''."""
    settings = material.lamina.interior
    if not settings.suns or obj is None or obj.name != settings.shown_on:
        return ""
    try:
        names = lights.moved(settings.suns, context.scene, body.frame_of(obj, context.scene))
    except RefusedError as error:
        return str(error)
    if names:
        return f"{' and '.join(names)} has moved, changed in size or gone since: compute again"
    return ""


def _has(obj, material):
    return any(slot.material == material for slot in obj.material_slots)


def _sources(scene, frame):
    return [*lights.lamps(scene, frame), lights.world(scene, frame)]


def _view(scene, frame):
    """The view of the scene's camera, as arguments of lamina.lit_images. Raises RefusedError."""
    camera = scene.camera
    if camera is None:
        raise RefusedError("The scene has no camera: set one, or choose the view All")
    if camera.data.type == "ORTHO":
        return {"view": tuple(frame.towards(np.array(camera.matrix_world, float)[:3, 2]))}
    return {"eye": tuple(frame.place(camera.matrix_world.translation))}


def _key(task, identity):
    """Name of the folder: equal settings and geometry have the same."""
    digest = hashlib.sha256()
    for array in (task.solid.vertices, task.solid.triangles, task.uvs, task.normals):
        digest.update(np.ascontiguousarray(array).data)
    lamps = [[one.kind, one.numbers] for one in task.sources if one.kind]
    for one in task.sources:
        if one.radiance is not None:
            digest.update(one.radiance.tobytes())
    surface = [task.surface.ior, task.surface.alpha, task.surface.distribution]
    digest.update(
        json.dumps(
            [identity, task.output, task.size, task.noise, lamps, task.view, surface, "previews"]
        ).encode()
    )
    return digest.hexdigest()[:24]
