# SPDX-License-Identifier: GPL-3.0-or-later
"""The lamps of a scene, as sources of light for an interior."""

import math
from dataclasses import replace

import numpy as np

from ..base import linking
from ..base.messages import RefusedError
from ..nodes import node_tree
from .lights import WORLD, Source

STILL = 1e-3  # radians: a Spread that differs by less is the wanted one
METRE = 1000.0  # mm
FLAT = 1e-6  # relative difference between the scales of a lamp's axes
# Bytes in UTF-8: Blender's names have at most 63, and those of sockets end with “ Strength”.
LONGEST = 63 - len(" Strength")


def rendered(depsgraph, frame, body):
    """The lamps of a render's dependency graph that light diffuse surfaces of the object `body`, by name;
    each name is unique and differs from the world's. Raises RefusedError for what lamina's lamps do not
    have, and for lamps of whose light the object casts no shadows: in Cycles none reaches its interior."""
    found = []
    for instance in depsgraph.object_instances:
        obj = instance.object
        if obj.type == "LIGHT" and instance.show_self and shines(obj.original, body):
            linked = linking.of(obj.original)
            check_blocks(obj, linked, body)
            source = _source(obj, np.array(instance.matrix_world, float), frame)
            found.append(replace(source, linking=linked))
    found.sort(key=lambda one: one.name)
    names = unique([one.name for one in found])
    return [replace(one, name=name) for one, name in zip(found, names, strict=True)]


def shines(obj, body):
    """False for a portal of the world's light, for a lamp that lights no diffuse surface, by its Ray
    Visibility, and for one that does not light the object `body`, by its Light Linking."""
    is_portal = obj.data.type == "AREA" and getattr(getattr(obj.data, "cycles", None), "is_portal", False)
    is_linked = linking.of(obj).receivers.holds(body.original.name_full)
    return obj.visible_diffuse and not is_portal and is_linked


def check_blocks(source, linked, body):
    """Raises RefusedError if the object `body` casts no shadows of the light of an object `source`."""
    if not linked.blockers.holds(body.original.name_full):
        raise RefusedError(
            f"{body.name} casts no shadows of the light of {source.name}: include {body.name} in the Shadow "
            f"Linking of {source.name}, or hide {source.name} in renders")


def unique(names):
    """The names, shortened to LONGEST. Numbers tell equal names apart, and a lamp from the world."""
    taken, found = {WORLD}, []
    for name in names:
        number, new = 1, _cut(name, "")
        while new in taken:
            number += 1
            new = _cut(name, f" {number}")
        taken.add(new)
        found.append(new)
    return found


def _cut(name, end):
    """The name and `end`, in at most LONGEST bytes and without a part of a character."""
    return name.encode()[: LONGEST - len(end)].decode(errors="ignore") + end


def _source(obj, matrix, frame):
    lamp = obj.data
    if node_tree.is_on(lamp) and _has_own_nodes(lamp.node_tree):
        raise RefusedError(
            f"{obj.name} has nodes of its own: remove them for Lamps Stay, or hide it in renders")
    if lamp.type == "AREA" and abs(lamp.spread - math.pi) > STILL:
        degrees = f"{math.degrees(lamp.spread):.3g}"
        raise RefusedError(f"{obj.name} has a Spread of {degrees} degrees: must be 180 for Lamps Stay")
    colour = np.array(lamp.color)
    if getattr(lamp, "use_temperature", False):
        colour = colour * np.array(lamp.temperature_color)
    strength = lamp.energy * 2.0 ** getattr(lamp, "exposure", 0.0)
    kind, colour = lamp.type, tuple(map(float, colour))
    found = numbers(obj, matrix, frame)
    factor = _factor(kind, found, frame.unit)
    if not getattr(lamp, "normalize", True):  # from Blender 4.5 on
        factor *= _size(lamp, found, frame.unit)
    return Source(obj.name, strength, colour, kind, found, factor)


def _has_own_nodes(tree):
    """True unless the nodes are the ones that every lamp starts with."""
    if tree is None:
        return False
    emission = [one for one in tree.nodes if one.type == "EMISSION"]
    linked = any(socket.links for one in emission for socket in one.inputs)
    plain = len(tree.nodes) <= 2 and not linked
    fields = [one.inputs for one in emission]
    values = [(*one["Color"].default_value[:3], one["Strength"].default_value) for one in fields]
    return not plain or any(value != (1.0,) * 4 for value in values)


def numbers(obj, matrix, frame):
    """The numbers of lamina's lamp, for a lamp with this matrix in world space. Raises RefusedError."""
    lamp, scale = obj.data, np.linalg.norm(matrix[:3, :3], axis=0)
    if not scale.min() > 0.0:
        raise RefusedError(f"{obj.name} has the scale 0: must be above 0")
    axes = [_triple(frame.towards(matrix[:3, k] / scale[k])) for k in range(3)]
    if lamp.type == "SUN":
        return {"towards": axes[2], "angle": min(0.5 * lamp.angle, 1.0)}
    place = _triple(frame.place(matrix[:3, 3]))
    if lamp.type == "AREA":
        high = lamp.size_y if lamp.shape in ("RECTANGLE", "ELLIPSE") else lamp.size
        first = 0.5 * lamp.size * scale[0] * frame.unit * np.array(axes[0])
        second = 0.5 * high * scale[1] * frame.unit * np.array(axes[1])
        # The lamp shines along its -z, and lamina's along first x second. Mirrored lamps and objects have
        # left-handed axes.
        if np.dot(np.cross(first, second), axes[2]) > 0.0:
            first = -first
        ellipse = lamp.shape in ("DISK", "ELLIPSE")
        return {"position": place, "first": _triple(first), "second": _triple(second), "ellipse": ellipse}
    found = {"position": place, "radius": lamp.shadow_soft_size * frame.unit}
    if lamp.type == "SPOT":
        if np.ptp(scale) > FLAT * scale.max():
            raise RefusedError(f"{obj.name} has a scale that is not uniform: Lamps Stay needs a round cone")
        direction = tuple(-value for value in axes[2])
        found |= {"direction": direction, "cone": lamp.spot_size, "blend": lamp.spot_blend}
    return found


def _factor(kind, numbers, unit):
    """The light of a lamp of 1 W (of a sun of strength 1) in Blender, relative to that of lamina's lamp. In
    Blender, 1 W gives a point the radiant intensity 1 / (4 pi), per square Blender unit, and an area the
    radiance 1 / (pi area)."""
    if kind == "SUN":
        return 1.0
    if kind == "AREA":
        return 1.0 / (math.pi * _area(numbers, unit))
    return (unit / METRE) ** 2 / (4.0 * math.pi)


def _size(lamp, numbers, unit):
    """By how much a lamp without Normalize is brighter: the area by which Cycles would divide its light."""
    if lamp.type == "SUN":
        half = 0.5 * lamp.angle
        return math.pi * math.sin(half) ** 2 if half > 0.0 else 1.0
    if lamp.type == "AREA":
        return _area(numbers, unit)
    radius = lamp.shadow_soft_size
    return 4.0 * math.pi * radius**2 if radius > 0.0 else 4.0


def _area(numbers, unit):
    """The area of an area lamp, in square Blender units."""
    quarter = np.linalg.norm(np.cross(numbers["first"], numbers["second"]))
    return float((math.pi if numbers["ellipse"] else 4.0) * quarter / unit**2)


def _triple(values):
    return tuple(map(float, values))
