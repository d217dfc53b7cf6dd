# SPDX-License-Identifier: GPL-3.0-or-later
"""What lights an interior: a lamp or the world as a source of light, and the world of a scene as one."""

import math
from dataclasses import dataclass, field

import numpy as np

from ..base import native
from ..base.linking import ALL, Linking
from ..base.messages import RefusedError
from ..nodes import links, node_tree, node_values
from . import world_image

WORLD = "World"  # name of the world's source


@dataclass(frozen=True)
class Source:
    """A lamp or the world. `kind`: of lamina's lamp, or "" for the world. `numbers`: of that lamp, in the
    object's axes and in mm. `factor`: the light of strength 1 relative to that lamp. `strength`, `colour`:
    the present light. `radiance`: the world's image, for lamina.Surroundings, or None for one colour.
    `linking`: what the lamp lights, and what casts shadows of it."""

    name: str
    strength: float
    colour: tuple
    kind: str = ""
    numbers: dict = field(default_factory=dict)
    factor: float = 1.0
    radiance: np.ndarray | None = None
    linking: Linking = ALL

    @property
    def is_dark(self):
        """True for a world without light, at present."""
        colours = self.colour if self.radiance is None else (float(self.radiance.max()),)
        return not self.kind and (self.strength == 0.0 or not any(colours))

    def lamp(self, lamina):
        """The lamina lamp of unit strength."""
        classes = {
            "SUN": lamina.Lamp,
            "POINT": lamina.PointLamp,
            "SPOT": lamina.SpotLamp,
            "AREA": lamina.AreaLamp,
        }
        return classes[self.kind](**self.numbers)


DARK = Source(WORLD, 0.0, (1.0, 1.0, 1.0))


def of_scene(scene, obj, seen):
    """The lamps, then the world, of a seen.Seen. What other objects emit is part of the world's image. Main
    thread only. Raises RefusedError, also where nothing lights the object."""
    shines = seen.occluders is not None and bool(seen.occluders.emission.any())
    sky = world(scene, seen.body.frame)
    sources = [*seen.lamps, _absolute(sky) if shines else sky]
    if not shines and all(one.is_dark for one in sources):
        raise RefusedError(f"nothing lights {obj.name}: add a lamp or a world")
    return sources


def check_sizes(sources, surface):
    """Raises RefusedError for a lamp that is too small for light behind this lamina.Surface."""
    lamina = native.require()
    for one in sources if surface is not None and surface.is_smooth else ():
        if one.kind and one.lamp(lamina).too_small:
            size, least = "Radius 0", "above 0"
            if one.kind == "SUN":
                size = f"Angle {2.0 * math.degrees(one.numbers['angle']):.3g} degrees"
                least = f"at least {2.0 * math.degrees(native.part('interior.lamps').LEAST_DISC):.3g} degrees"
            raise RefusedError(f"{one.name} has the {size}: behind a smooth boundary it must be {least}, or "
                               "give the boundary a Roughness")


def _absolute(sky):
    """The world with an image that holds its strength and color."""
    found = np.ones((1, 1, 3), np.float32) if sky.radiance is None else sky.radiance
    return Source(WORLD, 1.0, (1.0,) * 3, radiance=found * (sky.strength * np.float32(sky.colour)))


def world(scene, frame):
    """The scene's world, as a sky of one colour or as an image. Main thread only: it may render. Raises
    RefusedError."""
    sky = scene.world
    if sky is None or not _is_seen(sky):
        return DARK
    if not _has_nodes(sky):
        return Source(WORLD, 1.0, tuple(sky.color))
    node = _shader(sky)
    if node is None:
        return DARK
    if not _has_strength(node):
        # The image holds the strengths of all nodes.
        return Source(WORLD, 1.0, (1.0,) * 3, radiance=world_image.of_scene(scene, frame.axes))
    strength = node.inputs["Strength"].default_value
    if not node.inputs["Color"].links:
        return Source(WORLD, strength, tuple(node.inputs["Color"].default_value)[:3])
    image = world_image.of_scene(scene, frame.axes, node.name)
    return Source(WORLD, strength, (1.0,) * 3, radiance=image)


def mark(scene, shines):
    """A text that changes with what an image of the world would hold; cheap. `shines`: other objects emit
    light, so the image holds the strength and the color too, see of_scene."""
    sky = scene.world
    if sky is None or not _is_seen(sky):
        return ""
    if not _has_nodes(sky):
        return repr(tuple(sky.color)) if shines else ""
    node = _shader(sky)
    if node is None:
        return ""
    followed = () if shines or not _has_strength(node) else (node.inputs["Strength"],)
    if followed and not node.inputs["Color"].links:
        return ""
    return node_values.mark(node, followed)


def _has_nodes(sky):
    return node_tree.is_on(sky) and sky.node_tree is not None


def _shader(sky):
    """The node of the world's shader, or None."""
    output = sky.node_tree.get_output_node("CYCLES") or sky.node_tree.get_output_node("ALL")
    shader = None if output is None else links.source(output.inputs["Surface"])
    return None if shader is None else shader.node


def _has_strength(node):
    """True for one Background node, whose strength the group of the interior follows."""
    return node.type == "BACKGROUND" and not node.mute and not node.inputs["Strength"].links


def _is_seen(world):
    """False for a world that lights no diffuse surface, by its Ray Visibility."""
    visibility = getattr(world, "cycles_visibility", None)
    return getattr(visibility, "diffuse", True)
