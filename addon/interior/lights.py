# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's lamps and world, as sources of light for an interior."""

import json
import math
from dataclasses import dataclass, field

import numpy as np

from ..base.messages import RefusedError
from ..nodes import node_tree
from . import world_image

STILL = 1e-3  # relative, and in radians: a lamp that changed by less counts as unmoved
METRE = 1000.0  # mm
FLAT = 1e-6  # relative difference between the scales of a lamp's axes


@dataclass(frozen=True)
class Source:
    """A lamp or the world. `kind`: of lamina's lamp, or "" for the world. `numbers`: of that lamp, in the
    object's axes and in mm. `factor`: the light of strength 1 relative to that lamp. `strength`, `colour`:
    the present light. `radiance`: the world's image, for lamina.Surroundings, or None for one colour."""

    name: str
    strength: float
    colour: tuple
    kind: str = ""
    numbers: dict = field(default_factory=dict)
    factor: float = 1.0
    radiance: np.ndarray | None = None

    def lamp(self, lamina):
        """The lamina lamp of unit strength."""
        classes = {
            "SUN": lamina.Lamp,
            "POINT": lamina.PointLamp,
            "SPOT": lamina.SpotLamp,
            "AREA": lamina.AreaLamp,
        }
        return classes[self.kind](**self.numbers)


def lamps(scene, frame):
    """The lamps that are rendered, by name. Raises RefusedError for what lamina's lamps do not have."""
    shown = [one for one in scene.objects if one.type == "LIGHT" and not one.hide_render]
    return [_lamp(obj, frame) for obj in sorted(shown, key=lambda one: one.name)]


def world(scene, frame):
    """The world, as a sky of one colour or as an image. Raises RefusedError."""
    if scene.world is None:
        return Source("World", 0.0, (1.0, 1.0, 1.0))
    tree = scene.world.node_tree
    if tree is None:
        return Source("World", 1.0, tuple(scene.world.color))
    node = next((one for one in tree.nodes if one.type == "BACKGROUND"), None)
    if node is None:
        return Source("World", 0.0, (1.0, 1.0, 1.0))
    strength = node.inputs["Strength"].default_value
    if not node.inputs["Color"].links and not node.inputs["Strength"].links:
        return Source("World", strength, tuple(node.inputs["Color"].default_value)[:3])
    if node.inputs["Strength"].links:
        raise RefusedError(
            f"{scene.world.name} has a link to its Background's Strength: set a number, and link Color only"
        )
    return Source("World", strength, (1.0,) * 3, radiance=world_image.of_scene(scene, frame.axes))


def kept(sources):
    """The lamps as JSON, for `moved`."""
    return json.dumps([[one.name, one.kind, one.numbers] for one in sources if one.kind])


def moved(text, scene, frame):
    """Names of lamps that were moved, changed in shape or removed since `kept` wrote `text`."""
    found = []
    for name, kind, numbers in json.loads(text or "[]"):
        obj = scene.objects.get(name)
        same = obj is not None and obj.type == "LIGHT" and obj.data.type == kind
        if not same or not _alike(_numbers(obj, frame), numbers):
            found.append(name)
    return found


def _alike(one, other):
    for name, value in one.items():
        mine, theirs = np.atleast_1d(value), np.atleast_1d(other[name])
        size = max(1.0, float(np.abs(theirs).max()))
        if np.abs(mine.astype(float) - theirs.astype(float)).max() > STILL * size:
            return False
    return True


def _lamp(obj, frame):
    lamp = obj.data
    if node_tree.is_on(lamp) and _has_own_nodes(lamp.node_tree):
        raise RefusedError(f"{obj.name} has nodes of its own: remove them for Lit, or hide it in renders")
    if lamp.type == "AREA" and abs(lamp.spread - math.pi) > STILL:
        degrees = f"{math.degrees(lamp.spread):.3g}"
        raise RefusedError(f"{obj.name} has a Spread of {degrees} degrees: must be 180 for Lit")
    colour = np.array(lamp.color)
    if getattr(lamp, "use_temperature", False):
        colour = colour * np.array(lamp.temperature_color)
    strength = lamp.energy * 2.0 ** getattr(lamp, "exposure", 0.0)
    numbers, colour = _numbers(obj, frame), tuple(map(float, colour))
    factor = _factor(lamp.type, numbers, frame.unit)
    return Source(obj.name, strength, colour, lamp.type, numbers, factor)


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


def _numbers(obj, frame):
    """The numbers of lamina's lamp. Raises RefusedError."""
    lamp, matrix = obj.data, np.array(obj.matrix_world, float)
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    if not scale.min() > 0.0:
        raise RefusedError(f"{obj.name} has the scale 0: must be above 0")
    axes = [_triple(frame.towards(matrix[:3, k] / scale[k])) for k in range(3)]
    if lamp.type == "SUN":
        return {"towards": axes[2], "angle": min(0.5 * lamp.angle, 1.0)}
    place = _triple(frame.place(matrix[:3, 3]))
    if lamp.type == "AREA":
        high = lamp.size_y if lamp.shape in ("RECTANGLE", "ELLIPSE") else lamp.size
        # The lamp shines along its own -z, which is -x cross y.
        first = -0.5 * lamp.size * scale[0] * frame.unit * np.array(axes[0])
        second = 0.5 * high * scale[1] * frame.unit * np.array(axes[1])
        ellipse = lamp.shape in ("DISK", "ELLIPSE")
        return {"position": place, "first": _triple(first), "second": _triple(second), "ellipse": ellipse}
    found = {"position": place, "radius": lamp.shadow_soft_size * frame.unit}
    if lamp.type == "SPOT":
        if np.ptp(scale) > FLAT * scale.max():
            raise RefusedError(f"{obj.name} has a scale that is not uniform: Lit needs a round cone")
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
        quarter = np.linalg.norm(np.cross(numbers["first"], numbers["second"]))
        area = (math.pi if numbers["ellipse"] else 4.0) * quarter / unit**2
        return 1.0 / (math.pi * area)
    return (unit / METRE) ** 2 / (4.0 * math.pi)


def _triple(values):
    return tuple(map(float, values))
