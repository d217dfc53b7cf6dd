# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust on objects: what is asked of `lamina`, and where the answer goes.

`gather` reads the scene, `settle_gathered` sees arrays only and may run in a thread, `apply` writes. Nothing
is written before all of an object's dust is there.
"""

import math
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector, kdtree

from . import float_image, geometry, native, thickness
from .dust_properties import ATTRIBUTE
from .messages import RefusedError

FINER = 3  # times the mesh's own vertices, behind modifiers, are worth a word
MARGIN = 4  # texels by which an image's islands grow, so that filtering finds dust at their borders


@dataclass(frozen=True)
class Task:
    """The dust of one object, as arrays."""

    uid: int
    name: str
    surface: geometry.Arrays
    occluders: list
    settling: dict
    seed: int
    size: int  # of the image; 0: an attribute


@dataclass(frozen=True)
class Answer:
    """`dust`: lamina's; `image`: (size, size) float32, bottom row first, or None."""

    dust: object
    image: np.ndarray | None


def settle(context, obj, progress=None, cancel=None, threads=0):
    """Let dust settle on a mesh object and keep it there; returns lamina's Dust. Blocks.

    Raises RefusedError, lamina's DustError and Cancelled, NativeMissingError; the last dust stays as it was.
    """
    task = gather(context, obj)
    answer = settle_gathered(task, progress, cancel, threads)
    apply(obj, task, answer)
    return answer.dust


def problem(obj):
    """Why no dust can settle on an object, in a sentence, or ''."""
    if obj is None or obj.type != "MESH":
        return "Dust settles on mesh objects: select one"
    if not obj.is_editable or not obj.data.is_editable:
        return f"{obj.name} is linked from another file: edit it there, or make it local"
    if obj.mode == "EDIT":
        return f"{obj.name} is being edited: leave Edit Mode"
    return unavailable()


def unavailable():
    """Why dust cannot settle at all, in a sentence, or ''."""
    if not native.available():
        return native.reason()
    try:
        return native.part("dust").available()
    except native.NativeMissingError as error:
        return str(error)


def gather(context, obj):
    """What the dust of an object depends on. Raises RefusedError."""
    sentence = problem(obj)
    if sentence:
        raise RefusedError(sentence)
    settings = obj.lamina_dust
    size = settings.size if settings.target == "image" else 0
    if not size:
        _own_attribute(obj.data)
    surface = geometry.of_object(context, obj, settings.uv_map if size else None)
    return Task(
        uid=obj.session_uid,
        name=obj.name,
        surface=surface,
        occluders=geometry.others(context, obj) if settings.others else [],
        settling=_settling(settings, context.scene),
        seed=settings.seed,
        size=size,
    )


def settle_gathered(task, progress=None, cancel=None, threads=0):
    """The Answer to a Task. Raises as lamina.dust.settle does."""
    dust = native.part("dust")
    surface = dust.Mesh(task.surface.vertices, task.surface.triangles)
    occluders = [dust.Mesh(one.vertices, one.triangles) for one in task.occluders]
    points = mask = None
    if task.size:
        points, mask = dust.texel_points(surface, task.surface.uvs, task.size)
    found = dust.settle(surface, points, occluders, dust.Settling(**task.settling), seed=task.seed,
                        progress=progress, cancel=cancel, threads=threads)
    return Answer(found, None if mask is None else dust.dilate(found.tau, mask, MARGIN))


def apply(obj, task, answer):
    """Keep an Answer on its object, and feed the thickness of its materials from there where nothing
    else does. Raises RefusedError when the mesh has changed meanwhile.
    """
    if len(obj.data.vertices) != len(task.surface.own):
        raise RefusedError(f"{obj.name} has been edited while dust settled: let it settle again")
    if answer.image is None:
        if obj.data.users > 1:  # dust depends on where an object is: a shared mesh becomes its own
            obj.data = obj.data.copy()
        _write_attribute(obj.data, _on_own_vertices(task.surface, answer.dust.tau))
        source, name = "attribute", ATTRIBUTE
    else:
        source, name = "image", _write_image(obj, answer.image).name
    settings = obj.lamina_dust
    statistics = answer.dust.statistics
    notes = [str(statistics), *statistics.notes, *_coarseness(task)]
    settings.told, settings.largest = "; ".join(notes), statistics.maximum
    for slot in obj.material_slots:
        if slot.material is not None and slot.material.is_editable and _is_free(slot.material):
            thickness.wire_thickness(slot.material, source, name, settings.uv_map)


def clear(obj):
    """Take the dust of an object away. Its materials show none where they read the attribute."""
    attribute = _own_attribute(obj.data)
    if attribute is not None:
        obj.data.attributes.remove(attribute)
    settings = obj.lamina_dust
    image, settings.image = settings.image, None
    if image is not None:
        bpy.data.images.remove(image)
    settings.told, settings.largest = "", 0.0


def _own_attribute(mesh):
    """The attribute that holds dust, or None. Raises RefusedError when its name is another's."""
    attribute = mesh.attributes.get(ATTRIBUTE)
    if attribute is not None and (attribute.data_type, attribute.domain) != ("FLOAT", "POINT"):
        text = f"{mesh.name} has another kind of attribute named {ATTRIBUTE}: rename or remove it"
        raise RefusedError(text)
    return attribute


def _write_attribute(mesh, values):
    attribute = _own_attribute(mesh) or mesh.attributes.new(ATTRIBUTE, "FLOAT", "POINT")
    attribute.data.foreach_set("value", np.ascontiguousarray(values, np.float32))
    mesh.update()


def _settling(settings, scene):
    gravity = scene.gravity if scene.use_gravity and scene.gravity.length > 0.0 else Vector((0.0, 0.0, -1.0))
    towards = settings.wind_from + math.pi
    wind = settings.wind * np.array([math.cos(towards), math.sin(towards), 0.0])
    by_mass = settings.form == "mass"
    return {
        "amount": None if by_mass else settings.amount,
        "grams": settings.grams if by_mass else None,
        "extinction": settings.substance,
        "time": settings.time,
        "gravity": tuple(gravity),
        "spread": settings.spread,
        "wind": tuple(wind),
        "repose": settings.repose,
        "concavity": settings.concavity,
        "coverage": settings.coverage,
        "patch": settings.patch * scene.unit_settings.scale_length or None,
        "two_sided": settings.two_sided,
        "rays": settings.rays,
    }


def _on_own_vertices(surface, tau):
    """Dust of the rendered surface on the vertices of the object's own mesh: the most of those that stand for
    one (both sides of a shell), the nearest one's where modifiers leave none.
    """
    values = np.full(len(surface.own), -1.0, np.float32)
    if surface.origins is not None:
        known = surface.origins >= 0
        np.maximum.at(values, surface.origins[known], tau[known])
    lost = np.flatnonzero(values < 0.0)
    if len(lost):
        tree = kdtree.KDTree(len(surface.vertices))
        for index, place in enumerate(surface.vertices):
            tree.insert(place, index)
        tree.balance()
        for index in lost:
            _, nearest, _ = tree.find(surface.own[index])
            values[index] = tau[nearest]
    return values


def _coarseness(task):
    """What an attribute loses where modifiers make the surface finer than its mesh."""
    own, rendered = len(task.surface.own), len(task.surface.vertices)
    if not task.size and rendered > FINER * own:
        yield (
            f"the attribute has the mesh's {own:,} vertices for the {rendered:,} that modifiers make of it: "
            "apply those, or keep the dust in an image"
        )


def _write_image(obj, values):
    """A new image takes the place of the last one: renders do not look again at pixels that they know."""
    texels = np.ones((*values.shape, 4), np.float32)
    texels[..., :3] = values[..., None]
    image = float_image.create(f"{obj.name} dust", texels)
    last, obj.lamina_dust.image = obj.lamina_dust.image, image
    if last is not None:
        name = last.name
        last.user_remap(image)
        bpy.data.images.remove(last)
        image.name = name
    return image


def _is_free(material):
    """Whether a material's thickness is an unused input, or fed by what we made."""
    return thickness.wiring(material).source in ("value", "attribute", "image")
