# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's suns and world, as sources of light for an interior."""

import json
from dataclasses import dataclass

import numpy as np

from ..base.messages import RefusedError

STILL = 1e-3  # radians: a sun that turned by less counts as unmoved


@dataclass(frozen=True)
class Source:
    """A sun or the world. `towards`: direction to the sun in the object's axes, and `angle`: radius of
    its disc in radians; None for the world. `strength`, `colour`: its present light."""

    name: str
    strength: float
    colour: tuple
    towards: tuple | None = None
    angle: float = 0.0


def suns(scene, body):
    """The suns that are rendered, by name. Raises RefusedError for lamps of other types, whose light has
    no single direction."""
    found = []
    for obj in sorted(scene.objects, key=lambda one: one.name):
        if obj.type != "LIGHT" or obj.hide_render:
            continue
        if obj.data.type != "SUN":
            kind = obj.data.type.capitalize()
            raise RefusedError(
                f"{obj.name} is a lamp of type {kind}: Lit takes suns and the world, hide it in renders"
            )
        found.append(_sun(obj, body))
    return found


def world(scene):
    """The world, as a sky of one colour: that of its background, or white where a texture is linked."""
    tree = scene.world.node_tree if scene.world is not None else None
    if tree is None:
        return Source(
            "World", 1.0 if scene.world else 0.0, tuple(scene.world.color) if scene.world else (1.0,) * 3
        )
    node = next((one for one in tree.nodes if one.type == "BACKGROUND"), None)
    if node is None:
        return Source("World", 0.0, (1.0, 1.0, 1.0))
    colour = (1.0,) * 3 if node.inputs["Color"].links else tuple(node.inputs["Color"].default_value)[:3]
    return Source("World", node.inputs["Strength"].default_value, colour)


def kept(sources):
    """The suns as JSON, for `moved`."""
    return json.dumps([[one.name, *one.towards, one.angle] for one in sources if one.towards is not None])


def moved(text, scene, axes):
    """Names of suns that were turned, changed in size or removed since `kept` wrote `text`; `axes` are
    the object's unit axes, as columns."""
    found = []
    for name, x, y, z, angle in json.loads(text or "[]"):
        obj = scene.objects.get(name)
        if obj is None or obj.type != "LIGHT" or obj.data.type != "SUN":
            found.append(name)
            continue
        turned = np.linalg.norm(axes.T @ _direction(obj) - np.array([x, y, z])) > STILL
        if turned or abs(0.5 * obj.data.angle - angle) > STILL:
            found.append(name)
    return found


def _sun(obj, body):
    lamp = obj.data
    colour = np.array(lamp.color)
    if getattr(lamp, "use_temperature", False):
        colour = colour * np.array(lamp.temperature_color)
    strength = lamp.energy * 2.0 ** getattr(lamp, "exposure", 0.0)
    towards = body.towards(_direction(obj))
    return Source(
        obj.name, strength, tuple(map(float, colour)), tuple(map(float, towards)), min(0.5 * lamp.angle, 1.0)
    )


def _direction(obj):
    """Unit vector towards the sun, in world space."""
    axis = np.array(obj.matrix_world, float)[:3, 2]
    return axis / np.linalg.norm(axis)
