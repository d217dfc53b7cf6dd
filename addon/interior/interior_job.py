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

from ..base import native, package, preferences, renders, undo, unwrap, uv_maps
from ..base.messages import RefusedError
from ..base.worker import OfMaterial, Place, Worker
from ..kinds import interiors
from ..nodes import before, interior_graph, lateral_group, other_materials
from ..properties.described import quantity
from . import body, contents, freshness, lights, seen

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
    lamina.Interior. `sources`: the lamps, then the world, and `occluders`: of other objects, for Lit. `note`:
    of `freshness`. `folder`: of finished parts. `remarks`: sentences about faces of other materials."""

    material: int
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
    occluders: object
    view: dict
    scale: np.ndarray
    node: tuple
    note: str
    millimetre: float
    folder: Path
    threads: int
    remarks: tuple[str, ...]


class InteriorJob(OfMaterial, Worker):
    """The computation for one material on one object. While it runs, `tick` shows previews. After a cancel or
    an error the last preview stays."""

    def __init__(self, task):
        self.task, self.uid = task, task.material
        self._preview, self._report = None, None
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
        # A first preview may fill an existing group, which Undo must restore.
        again = self.shows
        with undo.recorded("Lamina Interior", always=not again):
            apply(material, self.task, images, again)
        self._report = material.lamina.interior.report

    @property
    def shows(self):
        """True if the material's nodes show a preview of this job: not before the first preview, nor after an
        undo of it."""
        material = self.material()
        return material is not None and material.lamina.interior.report == self._report

    def finish(self):
        """Like OfMaterial.finish. After a cancel with a preview on show, returns the material, whose report
        then tells how far the work had come."""
        if not (self.cancelling and self.shows):
            return super().finish()
        material = self.material()
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
    other = sharing(obj, material)
    if other:
        return f"{material.name} is also on {other}: its images fit one object"
    modifier = copying_modifier(obj, material)
    if modifier:
        what = "makes faces that have no place of their own in the UV map"
        return f"{obj.name}: the modifier {modifier} {what}: apply it"
    return ""


def sharing(obj, material):
    """The name of another object with the material, or ''."""
    # Objects in no scene are left over: they stay in the file while something else uses them.
    others = (one.name for one in bpy.data.objects if one != obj and _has(one, material) and one.users_scene)
    return next(others, "")


def own_copy(obj, material):
    """Give the object a copy of the material in place of the one that other objects have too. Its mesh may
    stay shared. Returns the copy."""
    copy = material.copy()
    for slot in obj.material_slots:
        if slot.material == material:
            slot.link = "OBJECT"
            slot.material = copy
    return copy


def copying_modifier(obj, material):
    """The name of a modifier whose faces have no places in the map that Lamina unwraps, or ''."""
    return "" if _own_map(obj, material.lamina.interior) else unwrap.copying_modifier(obj)


def _own_map(obj, settings):
    """True if the images lie over a UV map of the object's own."""
    layer = uv_maps.find(obj.data, settings.uv_map)
    is_made = layer is not None and layer.name == unwrap.NAME
    return settings.map == "OWN" and len(obj.data.uv_layers) > 0 and not is_made


def gather(context, obj, material, folder=None):
    """The Task, read from the scene. Main thread only: it renders node textures. Raises RefusedError."""
    sentence = problem(obj, material)
    if sentence:
        raise RefusedError(sentence)
    settings, scene = material.lamina.interior, context.scene
    layer = uv_maps.find(obj.data, settings.uv_map)
    named = layer.name if layer is not None else ""
    uv_map = settings.uv_map if _own_map(obj, settings) else unwrap.ensure(obj)
    is_lit = settings.output == "LIT"
    found = seen.of_object(context, obj, material, uv_map, is_lit, is_lit and settings.view == "CAMERA")
    shape = found.body
    remarks = shape.notes
    if settings.output == "RELIGHTABLE" and shape.opaque.any():
        remarks = (*remarks, other_materials.OPEN_TO_LAMPS)
    uv_map = uv_map or named
    sources = lights.of_scene(scene, obj, found) if is_lit else []
    filled = contents.of_material(obj, material, shape)
    lights.check_sizes(sources, filled.surface)
    node = contents.texture(material) if settings.source == "NODES" else ()
    has_image = any(one.radiance is not None for one in sources)
    task = Task(
        material=material.session_uid,
        name=material.name,
        output=settings.output,
        solid=shape.solid(),
        fill=filled.fill,
        surface=filled.surface,
        uvs=shape.arrays.uvs,
        uv_map=uv_map,
        normals=shape.arrays.normals,
        size=quantity(settings, interiors.SIZE),
        noise=quantity(settings, interiors.NOISE),
        sources=sources,
        occluders=found.occluders,
        view=found.view,
        scale=shape.frame.scale,
        node=node,
        note=freshness.note(context, obj, material, node, uv_map, has_image),
        millimetre=0.001 / scene.unit_settings.scale_length,
        folder=Path("."),
        threads=preferences.threads(),
        remarks=remarks,
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
        shining, radiance = _lit_by(task, lamina)
        around = None if radiance is None else lamina.Surroundings(radiance)
        lit_by = {"surroundings": around, "occluders": task.occluders}
        return lamina.lit_images(task.solid, interior, shining, **lit_by, **how, **task.view)
    return lamina.relightable_images(task.solid, interior, version=tuple(bpy.app.version[:2]), **how)


def _lit_by(task, lamina):
    """(lamps of unit strength, the radiance of the world's image or None)."""
    found = [one.lamp(lamina) for one in task.sources if one.kind]
    return found, next((one.radiance for one in task.sources if not one.kind), None)


def apply(material, task, found, again=False):
    """Build the nodes of a Task's images. The folder of parts is removed, except for a preview. `again`: the
    nodes show a preview of this task, so the numbers that an artist has set there are kept."""
    settings = material.lamina.interior
    if task.output == "LIT":
        inputs = interior_graph.lit_inputs(task.sources)

        def draw(graph, _length, sockets):
            return interior_graph.draw_lit(
                graph, found, task.sources, task.surface, task.uv_map, task.name, task.scale, sockets
            )
    else:
        inputs = ()

        def draw(graph, length, _sockets):
            return interior_graph.draw_relightable(graph, found.inputs, length, task.uv_map, task.name)

    lateral_group.build(material, task.output.capitalize(), draw, task.millimetre, inputs, again)
    if task.output == "LIT":
        before.switch_sampling_off(material)
    else:
        before.restore_sampling(material)
    if task.node:
        settings.node, settings.socket = task.node
    settings.made_from = task.note
    # The nodes of the panel Lateral are gone.
    material.lamina.lateral_report = ""
    notes = (*found.notes, *task.remarks)
    settings.report = " ".join([found.report, *(f"{note[0].upper()}{note[1:]}." for note in notes)])
    if found.done == 1.0:
        shutil.rmtree(task.folder, ignore_errors=True)


def _has(obj, material):
    return any(slot.material == material for slot in obj.material_slots)


def _key(task, identity):
    """Name of the folder: equal settings and geometry have the same."""
    digest = hashlib.sha256()
    for array in (task.solid.vertices, task.solid.triangles, task.solid.opaque, task.uvs, task.normals):
        digest.update(np.ascontiguousarray(array).data)
    lit_by = [[one.kind, one.numbers] for one in task.sources if one.kind]
    for one in task.sources:
        if one.radiance is not None:
            digest.update(one.radiance.tobytes())
    others = None if task.occluders is None else task.occluders.hash
    surface = [task.surface.ior, task.surface.alpha, task.surface.distribution]
    digest.update(
        json.dumps(
            [identity, task.output, task.size, task.noise, lit_by, task.view, surface, others, "previews"]
        ).encode()
    )
    return digest.hexdigest()[:24]
