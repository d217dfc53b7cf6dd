# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust on many objects at once: a layer of dust on each of their materials, baked once for each stack, and
dust that settles on all of them together.

Nothing in the file changes before all bakes and all dust are known: `gather` reads, a thread works, `finish`
writes. What was added to a material is noted in the material, so that `remove` takes exactly that away."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import bpy

from ..baking import bake_job, update
from ..base import editable, messages, native, preferences, rendered
from ..base.messages import RefusedError
from ..base.worker import Worker, with_uid
from ..editing import layer_list, over_material, stack_io
from ..nodes import detail_wiring, node_tree, rest_coordinates, thickness
from ..properties import migration
from ..settling import dust_job, live_dust, object_dust

# House dust, by eye: warm grey grains and fibers, which scatter more evenly than the compact grains of Mie
# theory (substances). The optical thickness is the most that settled dust may have.
LAYER = {"name": "Dust", "mode": "optical", "albedo": (0.88, 0.84, 0.78), "phase": "hg", "g": 0.3,
         "varying": True, "tau": 4.0}  # fmt: skip

MARK = "lamina_dusted"  # of a material: what was added to it, see below
_STACK, _LAYER, _NEW = "stack", "layer", "new"
_EVEN, _PLAIN = "even", "plain"  # nothing, but the artist's own layer was even, and without grain
BAKES = 0.4  # share of the progress bar


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
    own layer is even before dust settles on it: (a value of MARK, its thickness)}."""

    tasks: list
    bakes: dict
    notes: list = field(default_factory=list)
    shapes: list = field(default_factory=list)
    cover: Callable = lambda material: _cover(material)
    even: dict = field(default_factory=dict)


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
    found = work(gathered, threads, progress or (lambda *_: None), cancel or (lambda: False))
    return finish(gathered, found)


def start(context, objects):
    """Start in the background, as dust_job.start does. Raises as `gather` does, before it starts."""
    return dust_job.take(DustingJob(gather(context, objects), preferences.threads()))


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
    bakes = {}
    for obj in dusty:
        live_dust.leave(obj)
        choose_storage(context, obj)
        for material in _materials(obj):
            uid = _uid(material)
            if uid in bakes:
                continue
            try:
                bakes[uid] = _bake_with_dust(material)
            except Exception as error:
                bakes[uid] = None
                notes.append(_note(error, material))
    bakes = {uid: bake for uid, bake in bakes.items() if bake is not None}
    even = {one.session_uid: found for obj in dusty for one in _materials(obj) if (found := _even(one))}
    return Gathered(object_dust.gather_all(context, dusty), bakes, list(dict.fromkeys(notes)),
                    [obj.name for obj in shapes], even=even)


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
            return None
        if self.error is not None:
            raise self.error
        return self.written()

    def written(self):
        return finish(self.gathered, self.result)


def remove(objects, tell=print):
    """Take the dust of `objects` away, and what `dust` has added to their materials, unless other objects
    have dust on them. Returns the number of objects that had dust. `tell(sentence)`: of a material whose
    other layers could not be baked."""
    cleared, materials = set(), {}
    for obj in objects:
        if obj.type != "MESH" or not obj.is_editable or not obj.data.is_editable:
            continue
        materials |= {one.session_uid: one for one in _materials(obj) if one is not None and MARK in one}
        if obj.lamina_dust.told:
            live_dust.leave(obj)
            object_dust.clear(obj)
            cleared.add(obj)
    still = {slot.material for obj in bpy.data.objects if obj.type == "MESH" and obj.lamina_dust.told
             for slot in obj.material_slots}
    for material in materials.values():
        if material not in still and editable.is_editable(material):
            try:
                _take_away(material, cleared)
            except Exception as error:
                tell(_note(error, material))
    for obj in cleared:
        if not any(one is not None and rest_coordinates.is_read(one.node_tree) for one in _materials(obj)):
            rest_coordinates.remove(obj.data)
    return len(cleared)


def _materials(obj):
    """The materials of an object's slots; None for faces without one."""
    return [slot.material for slot in obj.material_slots] or [None]


def _uid(material):
    return None if material is None else material.session_uid


def choose_storage(context, obj):
    """Keep the dust in an image where an attribute is too coarse, and no other object shares a material."""
    alone = all(one is None or _users(one) == {obj} for one in _materials(obj))
    if alone and object_dust.advice(obj, obj.evaluated_get(context.evaluated_depsgraph_get())):
        object_dust.keep_in_image(obj)


def _users(material):
    return {obj for obj in bpy.data.objects for slot in obj.material_slots if slot.material == material}


def _even(material):
    """An entry of Gathered.even, or None."""
    if material is None or MARK in material or not _has_dust(material):
        return None
    now = thickness.wiring(material)
    if now.source != "value":
        return None
    return _PLAIN if detail_wiring.detail(material) is None else _EVEN, now.socket.default_value


def _note(error, material):
    """A sentence on an error of a material. Raises the error if it is not for the user."""
    if not messages.expected(error):
        raise error
    return f"{material.name}: {messages.sentence(error, material)}"


def _bake_with_dust(material):
    """The Bake of a material with a layer of dust; None if the material has a varying layer and is baked.
    Raises RefusedError, StackError. The file is as before."""
    if material is not None:
        problem = editable.problem(material)
        if problem:
            raise RefusedError(problem)
        if migration.is_from_the_future(material):
            raise RefusedError("its layers were made by a newer version of Lamina")
        if _has_dust(material) and bake_job.state(material) in ("fresh", "other"):
            return None
    trial = _plain() if material is None else material.copy()
    try:
        _cover(trial)
        return Bake(stack_io.to_stack(trial), *update.first_settings(trial))
    finally:
        bpy.data.materials.remove(trial)


def _plain():
    material = bpy.data.materials.new("Material")
    node_tree.of(material)
    return material


def _has_dust(material):
    return material.lamina.enabled and any(
        layer.varying and layer.kind == "medium" for layer in material.lamina.layers)


def _cover(material):
    """Give a material a layer of dust, if no layer varies yet. Returns what was added: a value of MARK, or
    None. Raises RefusedError."""
    if _has_dust(material):
        return None
    added = _LAYER if material.lamina.enabled else _STACK
    if added == _STACK:
        over_material.add(material)
        layer = material.lamina.layers[0]
    else:
        material.lamina.active_index = 0
        layer = layer_list.add_layer(material)
    for name, value in {**LAYER, "dusted": True}.items():
        setattr(layer, name, value)
    return added


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
    settled, failed = _sorted(gathered.tasks, answers)
    if failed and not settled:
        raise RefusedError(failed[0][1])
    dusty = {_uid(one) for obj, *_ in settled for one in _materials(obj)}
    bare = {_uid(one) for obj, _ in failed for one in _materials(obj)} - dusty
    for uid, bake in gathered.bakes.items():
        if uid in bare:  # a layer without its dust is as thick everywhere as it can be
            continue
        material = with_uid(bpy.data.materials, uid) if uid is not None else _plain()
        new = material if uid is None else new
        if material is None:
            continue
        lut = luts[bake.key]
        if isinstance(lut, Exception):
            notes.append(_note(lut, material))
            continue
        added = gathered.cover(material)
        if added is not None:
            material[MARK] = _NEW if uid is None else added
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
            notes.append(f"{task.name}: {messages.sentence(_expected(error))}")
    return Done(done, len(luts), list(dict.fromkeys(notes)), gathered.shapes)


def _sorted(tasks, answers):
    """([(object, Task, Answer)], [(object, sentence on why no dust has settled)])."""
    by_uid, settled, failed = {obj.session_uid: obj for obj in bpy.data.objects}, [], []
    for task, answer in zip(tasks, answers, strict=True):
        obj = by_uid.get(task.uid)
        if obj is not None and isinstance(answer, Exception):
            failed.append((obj, f"{task.name}: {messages.sentence(answer)}"))
        elif obj is not None:
            settled.append((obj, task, answer))
    return settled, failed


def _fill_slots(obj, new):
    """Give faces without a material the new one."""
    if new is None:
        return
    if not obj.material_slots:
        obj.data.materials.append(new)
    for slot in obj.material_slots:
        if slot.material is None:
            slot.material = new


def _take_away(material, cleared):
    """Take away what `dust` has added to a material; what the artist has made of it since stays. `cleared`:
    the objects that had dust."""
    if material[MARK] in (_EVEN, _PLAIN):
        _make_even(material, material.pop(MARK))
        return
    index, is_alone = _our_layer(material), len(material.lamina.layers) == 1
    if index is not None and is_alone and material[MARK] != _LAYER:
        is_new = material[MARK] == _NEW
        layer_list.remove_stack(material)
        material.pop(MARK, None)
        if is_new and _users(material) <= cleared and _is_untouched(material):
            _remove(material)
        return
    if index is not None:
        material.lamina.active_index = index
        layer_list.remove_layer(material)
    del material[MARK]
    if index is not None:
        bake_job.bake_material(material)


def _make_even(material, mark):
    """Let the artist's own layer lie where it lay before dust settled on it."""
    if not object_dust.is_source(thickness.wiring(material)):
        return
    if mark == _PLAIN:
        detail_wiring.remove_detail(material)
    socket = thickness.wire_thickness(material, "value", replace=True).socket
    socket.default_value = material.pop(thickness.EVEN)


def _our_layer(material):
    """The index of the layer that `dust` has added to a material, under any name; None if it is gone."""
    layers = list(enumerate(material.lamina.layers))
    ours = [(index, one) for index, one in layers if one.dusted]
    ours = ours or [(index, one) for index, one in layers  # of earlier versions
                    if one.varying and one.kind == "medium" and one.name.startswith(LAYER["name"])]
    # A duplicate does not vary.
    return max(ours, key=lambda each: each[1].varying, default=(None, None))[0]


def _is_untouched(material):
    """True if a new material has the name and the nodes with which `_plain` made it."""
    plain = _plain()
    try:
        return material.name.startswith("Material") and _values(material) == _values(plain)
    finally:
        bpy.data.materials.remove(plain)


def _values(material):
    """The kinds of a material's nodes and the values of their inputs."""
    found = [(node.bl_idname, [getattr(one, "default_value", None) for one in node.inputs])
             for node in material.node_tree.nodes]
    return sorted((kind, [tuple(one) if hasattr(one, "__len__") else one for one in values])
                  for kind, values in found)


def _remove(material):
    """Remove a new material, which leaves slots empty."""
    for obj in _users(material):
        for slot in obj.material_slots:
            if slot.material == material:
                slot.material = None
    bpy.data.materials.remove(material)
