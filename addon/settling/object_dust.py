# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust on objects: input for `lamina`, and storage of its result.

`gather` reads the scene, `settle_gathered` works on arrays only and may run in a thread, `apply` writes.
Nothing is written before all of an object's dust is known.
"""

from dataclasses import dataclass

import bpy
import numpy as np

from ..base import data_image, editable, image_removal, native, rendered, renders, unwrap, uv_maps
from ..base.messages import RefusedError
from ..kinds.dust import ATTRIBUTE
from ..nodes import detail_wiring, thickness
from ..nodes.group_sockets import COVERAGE
from ..nodes.side_graph import FRONT
from . import dust_attribute, dust_frames, dust_settings, geometry

FINER = 3  # a note is added if modifiers make the mesh finer by this factor
PREVIEW_RAYS, PREVIEW_SIZE = 16, 256
PARTLY = "partly"  # instead of the settings' text, of dust without all of its quality, frames or levels
MARGIN = 4  # texels by which an image's islands are extended, so that filtering finds dust at their borders


@dataclass(frozen=True)
class Moment:
    """The surface, the object's own mesh, and what keeps dust off it, at one frame."""

    surface: geometry.Arrays
    own: geometry.OwnMesh
    occluders: list


@dataclass(frozen=True)
class Task:
    """The dust of one object, as arrays. `settling`: of one moment. `follows`: the frames of the moments, if
    dust settles anew at each; otherwise the moments' dust is added up. `settled`: all settings as text."""

    uid: int
    name: str
    moments: list[Moment]
    settling: dict
    seed: int
    size: int  # of the image; 0: an attribute
    follows: range | None
    settled: str

    @property
    def surface(self):
        return self.moments[0].surface

    @property
    def own(self):
        return self.moments[0].own


@dataclass(frozen=True)
class Answer:
    """`dust`: lamina's Dust; an image if the task has a size. `each`: that of each moment, if dust follows.
    """

    dust: object
    each: list | None = None


def settle(context, obj, progress=None, cancel=None, threads=0):
    """Let dust settle on a mesh object and store it there; returns lamina's Dust. Blocks.

    Raises RefusedError, lamina's DustError and Cancelled, NativeMissingError; then the last dust is
    unchanged.
    """
    task = gather(context, obj)
    answer = settle_gathered(task, progress, cancel, threads)
    apply(obj, task, answer)
    return answer.dust


def problem(obj):
    """The reason why no dust can settle on an object, in a sentence, or ''."""
    if rendered.can_convert(obj):
        return f"{obj.name} is no mesh, and holds no dust: convert it (Object > Convert > Mesh)"
    if obj is None or obj.type != "MESH":
        return "Dust settles on mesh objects: select one"
    if not obj.is_editable or not obj.data.is_editable:
        return f"{obj.name} is linked from another file: edit it there, or make it local"
    if obj.mode == "EDIT":
        return f"{obj.name} is being edited: leave Edit Mode"
    return unavailable()


def unavailable():
    """The reason why dust cannot settle at all, in a sentence, or ''."""
    if not native.available():
        return native.reason()
    try:
        return native.part("dust").available()
    except native.NativeMissingError as error:
        return str(error)


def advice(obj, evaluated):
    """Why an attribute does not suit the dust of `obj`, in a sentence, or ''. `evaluated`: the object as the
    viewport shows it."""
    own, shown = len(obj.data.vertices), len(evaluated.data.vertices)
    if obj.lamina_dust.target != "attribute" or not (geometry.subdivides(obj) or shown > FINER * own):
        return ""
    return (
        f"Modifiers make more vertices than the {own:,} of the mesh, and an attribute has no values for "
        "them: keep the dust in an image"
    )


def keep_in_image(obj):
    """Let the next dust of `obj` be an image, over a UV map whose faces do not overlap: the chosen one, or
    one named “Lamina” that is unwrapped now. Raises RefusedError, NativeMissingError."""
    settings, mesh = obj.lamina_dust, obj.data
    chosen = uv_maps.find(mesh, settings.uv_map)
    if chosen is None or not unwrap.fits(mesh, chosen.name):
        settings.uv_map = unwrap.ensure(obj)
    settings.target = "image"


def gather(context, obj, live=False, preview=False, moment=None):
    """The input of the settling, read from the scene. Raises RefusedError.

    `live`: the present frame only, as shown while settings change. `preview`: few rays, and a small image.
    `moment`: of an earlier task of this object, used instead of reading the scene.
    """
    sentence = problem(obj)
    if sentence:
        raise RefusedError(sentence)
    settings = obj.lamina_dust
    size = settings.size if settings.target == "image" else 0
    if not size:
        dust_attribute.check_names(obj.data)
    frames = None if live else dust_frames.wanted(settings)
    follows = frames if frames is not None and settings.frames_as == "follow" else None
    moments = [] if moment is None else [moment]
    if moment is None:
        budget = dust_frames.Budget(settings, follows)
        for _frame in dust_frames.visited(context.scene, frames):
            request = geometry.Request(obj, _uv_map(obj), settings.others)
            surface, own, occluders = geometry.read(context, [request], live)[0]
            before = moments[-1].occluders if moments else []
            occluders = dust_frames.shared(occluders, before)
            budget.add(surface, own, [one for one in occluders if not any(one is known for known in before)])
            moments.append(Moment(surface, own, occluders))
    settling = dust_settings.numbers(settings, context.scene)
    if follows is None:
        settling["time"] /= len(moments)
    if preview:
        settling["rays"], size = min(settling["rays"], PREVIEW_RAYS), min(size, PREVIEW_SIZE)
    is_part = preview or (live and (settings.over_frames or geometry.has_own_levels(obj)))
    settled = PARTLY if is_part else dust_settings.text(settings)
    return Task(obj.session_uid, obj.name, moments, settling, settings.seed, size, follows, settled)


def gather_all(context, objects):
    """The input of the settling on several objects: their tasks. The scene is read once for all whose dust is
    wanted at the present frame. Raises as `gather` does."""
    sentence = next(filter(None, map(problem, objects)), "")
    if sentence:
        raise RefusedError(sentence)
    still = [obj for obj in objects if not obj.lamina_dust.over_frames]
    requests = [geometry.Request(obj, _uv_map(obj), obj.lamina_dust.others) for obj in still]
    moments = {obj: Moment(*one) for obj, one in zip(still, geometry.read(context, requests), strict=True)}
    return [gather(context, obj, moment=moments.get(obj)) for obj in objects]


def _uv_map(obj):
    """The UV map that is read for dust in an image; None for an attribute."""
    return obj.lamina_dust.uv_map if obj.lamina_dust.target == "image" else None


def settle_gathered(task, progress=None, cancel=None, threads=0):
    """The Answer to a Task. Raises as lamina.dust.settle does."""
    dust = native.part("dust")
    settled = []
    for number, moment in enumerate(task.moments):
        def told(fraction, text="", number=number):
            if progress is not None:
                before = f"frame {number + 1} of {len(task.moments)}, " if len(task.moments) > 1 else ""
                progress((number + fraction) / len(task.moments), before + text)

        settled.append(_at(moment, task, dust, progress=told, cancel=cancel, threads=threads))
    if task.follows is not None:
        dust_frames.check_same_points(settled)
        return Answer(settled[0], settled)
    return Answer(dust.accumulate(settled) if len(settled) > 1 else settled[0])


def _at(moment, task, dust, **how):
    """The Dust of one moment."""
    surface, *occluders = (dust.Mesh(one.vertices, one.triangles, one.normals, name=one.name)
                           for one in (moment.surface, *moment.occluders))
    how |= {"settings": dust.Settling(**task.settling), "seed": task.seed}
    if task.size:
        return dust.settle_image(surface, moment.surface.uvs, task.size, occluders, margin=MARGIN, **how)
    return dust.settle(surface, None, occluders, **how)


def apply(obj, task, answer):
    """Store an Answer on its object, and link the thickness of its materials to it if nothing else is linked.
    The first dust of a material also gets grain and clouds, see dust_detail. Returns a sentence on each
    material that goes on reading an image of the artist's.
    Raises RefusedError as `check_mesh` does.
    """
    check_mesh(obj, task)
    if not task.size:
        if obj.data.users > 1:  # dust depends on the object's transformation, so a shared mesh is copied
                                # first
            obj.data = obj.data.copy()
        dust_frames.remove(obj)
        if answer.each is None:
            dust_attribute.write(obj.data, task.surface, task.own, answer.dust)
        else:
            dust_frames.write(obj, task.moments, answer.each, task.follows)
    else:
        _write_image(obj, answer.dust)
    settings = obj.lamina_dust
    every = answer.each or [answer.dust]
    statistics = answer.dust.statistics
    notes = [str(statistics), *statistics.notes, *_switches(statistics), *_coarseness(task)]
    if task.own.has_instances:
        notes.append(geometry.INSTANCES)
    if task.follows is not None:
        notes[0] = f"{len(every)} frames; at frame {task.follows[0]} {notes[0]}"
    unread = [_painted(slot.material) for slot in obj.material_slots if slot.material is not None]
    unread = list(dict.fromkeys(filter(None, unread)))
    settings.told, settings.settled = "; ".join([*notes, *unread]), task.settled
    settings.largest = max(dust.statistics.maximum for dust in every)
    backs = [dust.back for dust in every if dust.back is not None]
    settings.largest_back = max((float(back.max(initial=0.0)) for back in backs), default=0.0)
    for slot in obj.material_slots:
        material = slot.material
        if material is None or not editable.is_editable(material):
            continue
        linked = thickness.wiring(material).source
        if linked in thickness.SOURCES and not _painted(material):
            wire(obj, material)
        if is_source(thickness.wiring(material, COVERAGE)):
            wire(obj, material, COVERAGE)
        if linked == "value" or detail_wiring.detail(material) is not None:
            detail_wiring.add_settled_detail(material)
    return unread


def check_mesh(obj, task):
    """Raises RefusedError if the mesh has changed since `gather`, or cannot hold the dust of a Task now."""
    if (len(obj.data.vertices), len(obj.data.loops)) != (len(task.own.vertices), len(task.own.corners)):
        raise RefusedError(f"{obj.name} has been edited while dust settled: let it settle again")
    if not task.size:
        editable.require_no_edit_mode(obj)
        dust_attribute.check_names(obj.data)


def _painted(material):
    """The sentence on a material that reads an image of the artist's, or ''. The image is not replaced unless
    the material keeps it, because Blender does not save an image that nothing uses."""
    now = thickness.wiring(material)
    image = now.node.image if now.source == "image" else None
    kept = [value for key, value in material.items() if key.startswith(thickness.KEPT[FRONT])]
    if image is None or is_source(now) or image in kept:
        return ""
    return (f"the thickness of {material.name} stays that of the image {image.name}: choose Settled in the "
            "panel Where for settled dust")


def wire(obj, material, to=FRONT):
    """Feed that input of the material with the dust of the object."""
    settings = obj.lamina_dust
    if settings.target == "image" and settings.image is not None:
        thickness.wire_thickness(material, "image", settings.image, settings.uv_map, to=to)
    else:
        thickness.wire_thickness(material, "attribute", ATTRIBUTE, to=to)


def is_source(wiring):
    """True if a thickness.Wiring reads settled dust."""
    if wiring.source == "image":
        return wiring.node.image is not None and bool(wiring.node.image.get(thickness.TWO_SIDES))
    return wiring.source == "attribute" and wiring.name == ATTRIBUTE


def clear(obj):
    """Remove the dust of an object. Its materials show none if they read it."""
    renders.stop_previews()
    dust_frames.remove(obj)
    dust_attribute.remove(obj.data)
    settings = obj.lamina_dust
    image, settings.image = settings.image, None
    if image is not None:
        _show_none(image)
        if not _holders(image):
            image_removal.remove(image)
    settings.told, settings.settled, settings.largest, settings.largest_back = "", "", 0.0, 0.0


def _show_none(image):
    """Let materials read the attribute, which is 0 where it is missing, in place of an image of dust that no
    object with them has: Cycles would show a texture without an image as magenta."""
    kept = {slot.material for obj in _holders(image) for slot in obj.material_slots}
    for material in bpy.data.materials:
        for name in (FRONT, COVERAGE) if material not in kept and editable.is_editable(material) else ():
            wiring = thickness.wiring(material, name)
            if wiring.source == "image" and wiring.node.image == image:
                thickness.wire_thickness(material, "attribute", to=name, replace=True)


def _switches(statistics):
    """A note on how to let dust fall through objects that stop it."""
    if statistics.keepers:
        names = " and ".join(statistics.keepers)
        yield f"switch off Keeps Dust Off Others in the panel of {names} to let it through"


def _coarseness(task):
    """A note on an attribute that is coarser than the rendered surface."""
    own, rendered = len(task.own.vertices), len(task.surface.vertices)
    if not task.size and task.own.is_lost:
        yield "a modifier drops the attributes of the mesh and so the dust: apply it, and settle again"
    if not task.size and rendered > FINER * own:
        yield (
            f"the attribute has the mesh's {own:,} vertices for the {rendered:,} that modifiers make of it: "
            "apply those, or keep the dust in an image"
        )


def _write_image(obj, dust):
    """Dust on front faces is the colour, dust on back faces the alpha. A new image replaces the last one,
    because Cycles does not reload the pixels of a known image.
    """
    renders.stop_previews()
    texels = np.zeros((*dust.tau.shape, 4), np.float32)
    texels[..., :3] = dust.tau[..., None]
    if dust.back is not None:
        texels[..., :3] -= dust.back[..., None]
        texels[..., 3] = dust.back
    image = data_image.create(f"{obj.name} dust", texels)
    image[thickness.TWO_SIDES] = True
    last, obj.lamina_dust.image = obj.lamina_dust.image, image
    if last is not None and not _holders(last):
        image_removal.replace(last, image)
    return image


def _holders(image):
    """The objects whose dust is this image: a duplicate has that of the original until dust settles on it."""
    return [obj for obj in bpy.data.objects if obj.lamina_dust.image == image]
