# SPDX-License-Identifier: GPL-3.0-or-later
"""Sparkle of a material's flakes: inputs of its node group, which the viewport follows without a bake."""

from ..base import renders
from ..base.messages import RefusedError
from ..nodes import detail_group, group_sockets, node_group, rest_coordinates
from ..nodes.sparkle_graph import DISTANCE, SIZE, SPARKLE

USUAL = 0.8  # share of the flakes' light

MISSING = ("The material cannot sparkle: that takes a bake in Blender 5.0 or newer, with flakes under smooth "
           "interfaces alone")

BY_HAND = "The scene has no perspective camera: set the Fade Distance by hand"


def sockets(material):
    """{name: input socket} of the sparkle, of the first node with the baked group; empty without the
    inputs."""
    for node in node_group.group_nodes(material):
        if SPARKLE in node.inputs:
            return {name: node.inputs[name] for name in (SPARKLE, SIZE, DISTANCE)}
    return {}


def is_on(material):
    found = sockets(material)
    return bool(found) and (found[SPARKLE].is_linked or found[SPARKLE].default_value > 0.0)


def add(material, scene):
    """Let the flakes of a baked material sparkle, with a size of the flakes in the world, and fade where a
    flake is as wide as a pixel of the scene's camera. If they sparkle already, only the fading is set anew.
    Meshes with the material get rest coordinates. Returns the distance from which the sparkle fades, in units
    of the scene. Raises RefusedError for a material that cannot sparkle, and where there is no perspective
    camera by which to set the fading anew."""
    if not sockets(material):
        raise RefusedError(MISSING)
    starts = not is_on(material)
    if not starts and not has_perspective(scene):
        raise RefusedError(BY_HAND)
    renders.stop_previews()
    rest_coordinates.store_for(material)
    for node in node_group.group_nodes(material):
        if starts:
            node.inputs[SPARKLE].default_value = USUAL
            detail_group.set_sizes(node, {SIZE: group_sockets.OF_SPARKLE[SIZE]})
        node.inputs[DISTANCE].default_value = node.inputs[SIZE].default_value / pixel_angle(scene)
    return sockets(material)[DISTANCE].default_value


def has_perspective(scene):
    """True if the scene's camera has a perspective, which gives pixels an angle."""
    camera = scene.camera
    return camera is not None and camera.type == "CAMERA" and camera.data.type == "PERSP"


def pixel_angle(scene):
    """The width of a pixel over its distance, of the scene's camera; that of the defaults without a
    perspective camera."""
    camera = scene.camera
    if not has_perspective(scene):
        return group_sockets.OF_SPARKLE[SIZE] / group_sockets.OF_SPARKLE[DISTANCE]
    corners = camera.data.view_frame(scene=scene)
    width = (corners[0] - corners[3]).length / -corners[0].z
    return width / (scene.render.resolution_x * scene.render.resolution_percentage / 100.0)
