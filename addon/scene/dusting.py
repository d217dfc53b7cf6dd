# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust on many objects at once: a layer of dust on each of their materials, baked once for each stack, and
dust that settles on all of them together.

Nothing in the file changes before all bakes and all dust are known: `gather` reads, a thread works, `finish`
writes."""

from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import NamedTuple

import bpy

from ..baking import bake_job, update
from ..base import messages, native, preferences, rendered, unwrap
from ..base.messages import RefusedError
from ..base.slots import materials_of
from ..base.worker import Worker, with_uid
from ..editing import stack_io
from ..nodes import node_group, thickness
from ..properties import migration
from ..settling import dust_job, live_dust, object_dust
from . import dust_layers

BAKES = 0.4  # share of the progress bar
MARK, remove = dust_layers.MARK, dust_layers.remove


class Bake(NamedTuple):
    """A bake of a lamina.Stack. Equal ones are made once."""

    stack: object
    quality: str
    basis: str

    @property
    def key(self):
        return self.stack.hash, self.quality, self.basis


@dataclass
class Gathered:
    """What is to be done. tasks: of the settling. bakes: {uid of a material: its Bake with dust}, where a
    layer or a bake is missing; the uid None stands for a new material for faces without one. notes: sentences
    on what gets no dust. shapes: names of curves, texts and the like, which hold no dust. cover: gives a
    material its layer, and returns what was added: a value of MARK, or None. even: {uid of a material whose
    own layer is even before dust settles on it: (a value of MARK, its thickness)}. storage: what
    `choose_storage` has returned."""

    tasks: list
    bakes: dict
    notes: list = field(default_factory=list)
    shapes: list = field(default_factory=list)
    cover: Callable = dust_layers.cover
    even: dict = field(default_factory=dict)
    storage: list = field(default_factory=list)


@dataclass
class Done:
    """The objects that are dusty now, the number of bakes, sentences on what got no dust, and the names of
    curves, texts and the like."""

    objects: list
    bakes: int
    notes: list
    shapes: list

    def __str__(self):
        count = len(self.objects)
        said = [f"Dust lies on {count} object{'s' * (count != 1)}"]
        if self.bakes:
            said.append(f"{self.bakes} bake{'s' * (self.bakes != 1)}")
        if self.shapes:
            why = "is no mesh, and holds" if len(self.shapes) == 1 else "are no meshes, and hold"
            said.append(f"{', '.join(self.shapes)} {why} no dust")
        return "; ".join([*said, *self.notes])


def dust(context, objects, progress=None, cancel=None, threads=None):
    """Put dust on all mesh objects among `objects`. Returns Done. Blocks.

    An object or material that cannot get dust is told in the notes, and the others go on. Raises RefusedError
    if none can, lamina's Cancelled with nothing changed, NativeMissingError."""
    gathered = gather(context, objects)
    threads = preferences.threads() if threads is None else threads
    with restored(gathered.storage):
        found = work(gathered, threads, progress or (lambda *_: None), cancel or (lambda: False))
        return finish(gathered, found)


def start(context, objects):
    """Start in the background, as dust_job.start does. Raises as `gather` does, before it starts."""
    gathered = gather(context, objects)
    with restored(gathered.storage):
        return dust_job.take(DustingJob(gathered, preferences.threads()))


def gather(context, objects):
    """What is to be done for `objects`: Gathered. Raises RefusedError if none can get dust."""
    sentence = object_dust.unavailable()
    if sentence:
        raise RefusedError(sentence)
    notes, dusty, shapes = [], [], []
    for obj in objects:
        if rendered.can_convert(obj):
            shapes.append(obj)
        if obj.type != "MESH" or not len(obj.data.polygons):
            continue
        sentence = object_dust.problem(obj)
        if sentence:
            notes.append(sentence)
        else:
            dusty.append(obj)
    if not dusty:
        notes += map(rendered.to_convert, shapes)
        raise RefusedError(notes[0] if notes else "There is no mesh object for dust to settle on")
    storage = []
    with restored(storage):
        for obj in dusty:
            live_dust.leave(obj)
            storage.append(choose_storage(context, obj, dusty))
        bakes = _bakes(dusty, notes)
        even = {one.session_uid: found for obj in dusty for one in materials_of(obj)
                if (found := dust_layers.evenness(one))}
        return Gathered(object_dust.gather_all(context, dusty), bakes, list(dict.fromkeys(notes)),
                        [obj.name for obj in shapes], even=even, storage=storage)


def _bakes(dusty, notes):
    """The bakes of Gathered; `notes` gets sentences."""
    bakes = {}
    for obj in dusty:
        for material in materials_of(obj):
            uid = _uid(material)
            if uid in bakes:
                continue
            try:
                bakes[uid] = _bake_with_dust(material)
            except Exception as error:
                bakes[uid] = None
                notes.append(dust_layers.note(error, material))
    return {uid: bake for uid, bake in bakes.items() if bake is not None}


class DustingJob(Worker):
    """The bakes and the settling in a thread."""

    def __init__(self, gathered, threads):
        native.require()
        self.gathered = gathered
        super().__init__(lambda progress, cancel: work(gathered, threads, progress, cancel), "lamina dust")

    def finish(self):
        """Write layers, bakes and dust; main thread only. Returns what `written` does; None after a cancel,
        with nothing changed. Raises errors of the work."""
        if self.cancelling:
            _restore(self.gathered.storage)
            return None
        with restored(self.gathered.storage):
            if self.error is not None:
                raise self.error
            return self.written()

    def written(self):
        return finish(self.gathered, self.result)


def _uid(material):
    return None if material is None else material.session_uid


def choose_storage(context, obj, objects=()):
    """Keep the dust in an image where an attribute is too coarse, and no other object shares a material.
    A material reads one image, so objects that share it, and are dusty or among `objects`, get attributes.
    Those of `objects` that lack a material share the new one. Returns what was before: (the object's uid,
    target, UV map, True if it had the map of `unwrap`)."""
    settings = obj.lamina_dust
    before = obj.session_uid, settings.target, settings.uv_map, unwrap.NAME in obj.data.uv_layers
    materials = materials_of(obj)
    sharing = {one for material in materials if material is not None for one in dust_layers.users(material)}
    if None in materials:
        sharing |= {one for one in objects if None in materials_of(one)}
    sharing.discard(obj)
    if any(one.lamina_dust.told or one in objects for one in sharing):
        settings.target = "attribute"
    elif not sharing and object_dust.advice(obj, obj.evaluated_get(context.evaluated_depsgraph_get())):
        object_dust.keep_in_image(obj)
    return before


def _restore(storage):
    """Undo `choose_storage`; `storage` holds what it has returned."""
    for uid, target, uv_map, has_map in storage:
        obj = with_uid(bpy.data.objects, uid)
        if obj is None:
            continue
        obj.lamina_dust.target, obj.lamina_dust.uv_map = target, uv_map
        made = None if has_map or obj.mode == "EDIT" else obj.data.uv_layers.get(unwrap.NAME)
        if made is not None:
            obj.data.uv_layers.remove(made)


@contextmanager
def restored(storage):
    """The storage of the objects is as before after an error."""
    try:
        yield
    except BaseException:
        _restore(storage)
        raise


def _bake_with_dust(material):
    """The Bake of a material with a layer of dust; None if the material has a varying layer and is baked.
    Raises RefusedError, StackError. The file is as before."""
    if material is not None:
        problem = migration.problem(material)
        if problem:
            raise RefusedError(problem)
        if dust_layers.has_dust(material) and bake_job.state(material) in ("fresh", "other"):
            return None
        problem = node_group.unreachable(material)
        if problem:
            raise RefusedError(problem)
    trial = dust_layers.plain() if material is None else material.copy()
    try:
        dust_layers.cover(trial)
        return Bake(stack_io.to_stack(trial), *update.first_settings(trial))
    finally:
        bpy.data.materials.remove(trial)


def work(gathered, threads, progress, cancel):
    """({key of a Bake: (LUT, curves) or an error}, [an Answer or an error, for each task])."""
    lamina = native.require()
    bakes = {bake.key: bake for bake in gathered.bakes.values()}
    share = BAKES if bakes else 0.0
    luts, answers = {}, []
    for number, (key, bake) in enumerate(bakes.items()):
        def told(fraction, text="", number=number):
            progress(share * (number + fraction) / len(bakes), f"Bake {number + 1} of {len(bakes)}: {text}")

        how = {"basis": bake.basis, "progress": told, "cancel": cancel, "threads": threads}
        try:
            lut = lamina.bake(bake.stack, bake.quality, **how)
            luts[key] = lut, bake_job.curves_of(bake.stack, lut, threads)
        except Exception as error:
            luts[key] = _expected(error)
    for number, task in enumerate(gathered.tasks):
        def rest(fraction, text=""):
            progress(share + (1.0 - share) * fraction, text)

        try:
            told = dust_job.portion(rest, number, gathered.tasks)
            answers.append(object_dust.settle_gathered(task, told, cancel, threads))
        except Exception as error:
            answers.append(_expected(error))
    return luts, answers


def _expected(error):
    """An error whose text is for the user. Raises any other one."""
    if not messages.expected(error):
        raise error
    return error


def finish(gathered, found):
    """Write layers, bakes and dust; main thread only. Returns Done. Raises RefusedError if no dust has
    settled; then nothing has changed."""
    luts, answers = found
    notes, new = list(gathered.notes), None
    settled, failed = answered(gathered.tasks, answers)
    dusty = {_uid(one) for obj, *_ in settled for one in materials_of(obj)}
    bare = {_uid(one) for obj, _ in failed for one in materials_of(obj)} - dusty
    for uid, bake in gathered.bakes.items():
        if uid in bare:  # a layer without its dust is as thick everywhere as it can be
            continue
        material = with_uid(bpy.data.materials, uid) if uid is not None else dust_layers.plain()
        new = material if uid is None else new
        if material is None:
            continue
        lut = luts[bake.key]
        if isinstance(lut, Exception):
            notes.append(dust_layers.note(lut, material))
            continue
        added = gathered.cover(material)
        if added is not None:
            material[MARK] = dust_layers.NEW if uid is None else added
        bake_job.apply(material, *lut)
        update.refine(material)
    for uid, (mark, value) in gathered.even.items():
        material = with_uid(bpy.data.materials, uid)
        if material is not None and uid not in bare:
            material[MARK], material[thickness.EVEN] = mark, value
    notes += [sentence for _, sentence in failed]
    done = []
    for obj, task, answer in settled:
        try:
            _fill_slots(obj, new)
            notes += object_dust.apply(obj, task, answer)
            done.append(obj)
        except Exception as error:
            notes.append(_of(task, _expected(error)))
    notes += _hidden(done)
    return Done(done, len(luts), list(dict.fromkeys(notes)), gathered.shapes)


def _hidden(done):
    """Sentences on other objects whose dust is an image that a material of the objects `done` has ceased to
    read."""
    for material in {one for obj in done for one in materials_of(obj) if one is not None}:
        now = thickness.wiring(material)
        read = now.node.image if now.source == "image" else None
        for other in dust_layers.users(material).difference(done) if object_dust.is_source(now) else ():
            settings = other.lamina_dust
            if settings.told and settings.target == "image" and settings.image != read:
                yield (f"{other.name} no longer shows its dust, because it shares {material.name}: dust "
                       "both together")


def _of(task, error):
    """The sentence of an error, which names the task's object."""
    text = messages.sentence(error)
    return text if text.startswith(f"{task.name} ") else f"{task.name}: {text}"


def answered(tasks, answers):
    """([(object, Task, Answer)], [(object, sentence on why it gets no dust)]). Raises RefusedError if none
    gets dust."""
    by_uid, settled, failed = {obj.session_uid: obj for obj in bpy.data.objects}, [], []
    for task, answer in zip(tasks, answers, strict=True):
        obj = by_uid.get(task.uid)
        if obj is None:
            continue
        if isinstance(answer, Exception):
            failed.append((obj, _of(task, answer)))
            continue
        try:
            object_dust.check_mesh(obj, task)
        except RefusedError as error:
            failed.append((obj, str(error)))
        else:
            settled.append((obj, task, answer))
    if failed and not settled:
        raise RefusedError(failed[0][1])
    return settled, failed


def _fill_slots(obj, new):
    """Give faces without a material the new one."""
    if new is None or None not in materials_of(obj):
        return
    if obj.data.users > 1:  # other objects with the mesh stay as they are
        obj.data = obj.data.copy()
    if not obj.material_slots:
        obj.data.materials.append(new)
    for slot in obj.material_slots:
        if slot.material is None:
            slot.material = new
