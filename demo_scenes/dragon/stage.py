# SPDX-License-Identifier: GPL-3.0-or-later
"""Sun, sky, a sweep of grey paper and the camera. Lengths in metres."""

import math

import bpy
import node_tree
import numpy as np
from mathutils import Vector

CAMERA_AZIMUTH, CAMERA_HEIGHT = math.radians(-38.0), math.radians(24.0)
SUN_AZIMUTH, SUN_HEIGHT, SUN_ANGLE = math.radians(-112.0), math.radians(21.0), math.radians(3.0)
SUN_COLOUR, SUN_IRRADIANCE, SKY_STRENGTH = (1.0, 0.82, 0.62), 5.0, 0.17
PAPER = (0.055, 0.064, 0.076)
AHEAD = Vector((math.cos(CAMERA_AZIMUTH), math.sin(CAMERA_AZIMUTH), 0.0))  # horizontal direction from the figures to
                                                                           # the viewer
RIGHT = Vector((-AHEAD.y, AHEAD.x, 0.0))


def build(scene, middle, width, lens=90.0):
    """Light, paper, and a camera with a view `width` metres wide around the point at the height `middle`."""
    scene.world = _sky()
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.energy, lamp.angle = SUN_IRRADIANCE, SUN_ANGLE
    lamp.color = SUN_COLOUR
    sun = bpy.data.objects.new("sun", lamp)
    towards = Vector((math.cos(SUN_AZIMUTH) * math.cos(SUN_HEIGHT), math.sin(SUN_AZIMUTH) * math.cos(SUN_HEIGHT),
                      math.sin(SUN_HEIGHT)))
    sun.rotation_euler = towards.to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(sun)
    camera = bpy.data.cameras.new("camera")
    camera.lens, camera.clip_start = lens, 0.01
    eye = bpy.data.objects.new("camera", camera)
    backwards = AHEAD * math.cos(CAMERA_HEIGHT) + Vector((0.0, 0.0, math.sin(CAMERA_HEIGHT)))
    eye.location = Vector((0.0, 0.0, middle)) + backwards * width * lens / camera.sensor_width
    eye.rotation_euler = backwards.to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(eye)
    scene.camera = eye
    return eye


def paper(scene, floor, distance, width):
    """A sweep: the floor at z = `floor`, bent up `distance` behind the middle."""
    radius, top = 0.5 * distance, 3.0 * distance
    turn = np.linspace(0.0, 0.5 * np.pi, 24)
    profile = [(8.0 * distance, 0.0), *zip(-distance + radius - radius * np.sin(turn), radius - radius * np.cos(turn),
                                           strict=True), (-distance, top)]
    points = [AHEAD * float(x) + RIGHT * side * width + Vector((0.0, 0.0, floor + float(z)))
              for x, z in profile for side in (-1.0, 1.0)]
    mesh = bpy.data.meshes.new("paper")
    mesh.from_pydata(points, [], [(2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2) for k in range(len(profile) - 1)])
    mesh.shade_smooth()
    material = bpy.data.materials.new("paper")
    tree = node_tree.of(material)
    tree.nodes.clear()
    diffuse, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (*PAPER, 1.0)
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("paper", mesh))


def _sky():
    """Nishita's sky without its sun, which is a lamp: the world then has no small bright source to sample."""
    world = bpy.data.worlds.new("sky")
    world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", 256
    tree = node_tree.of(world)
    tree.nodes.clear()
    sky = tree.nodes.new("ShaderNodeTexSky")
    kinds = sky.bl_rna.properties["sky_type"].enum_items
    sky.sky_type = "NISHITA" if "NISHITA" in kinds else "SINGLE_SCATTERING"  # its name from Blender 5.0 on
    sky.sun_disc, sky.altitude = False, 0.0
    # The node's azimuth runs clockwise from +y.
    sky.sun_elevation, sky.sun_rotation = SUN_HEIGHT, 0.5 * math.pi - SUN_AZIMUTH
    background, output = tree.nodes.new("ShaderNodeBackground"), tree.nodes.new("ShaderNodeOutputWorld")
    background.inputs["Strength"].default_value = SKY_STRENGTH
    tree.links.new(sky.outputs[0], background.inputs["Color"])
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    return world
