# SPDX-License-Identifier: GPL-3.0-or-later
"""Exit albedo and mean exit distance of a material, from renders of a wide plane that is seen along its normal.

The exit albedo is the radiance under a white sky. For the distance, a sun shines past the straight edge of a screen:
points in the shadow show light that entered in the lit half and travelled below the surface. Light with the profile P
brings to the distance x from the edge the part of P beyond x. So the integral of the radiance over the shadow, divided
by that of the lit half, is the mean of max(x, 0), which is E[r] / pi.

`prepare(scene)` is called before a render."""

import math

import bpy
import goniophotometer

HALF = 0.5  # half the width of the plane, in Blender units: a thousand times the mean distance of a material in mm


def exit_albedo(material, samples, prepare=None):
    """(exit albedo, its standard error), each of shape (3,)."""
    pixels = _render(material, samples, 0.002, (16, 16), None, prepare).reshape(-1, 4)[:, :3]
    return pixels.mean(axis=0), pixels.std(axis=0, ddof=1) / math.sqrt(len(pixels))


def exit_moment(material, samples, reach, prepare=None):
    """(exit albedo times mean exit distance in Blender units, its standard error), each of shape (3,), of light that
    stays within `reach`."""
    rows = _render(material, samples, reach, (16, 128), "sun", prepare).mean(axis=1)[:, :3] * math.pi * reach
    return rows.mean(axis=0), rows.std(axis=0, ddof=1) / math.sqrt(len(rows))


def _render(material, samples, width, size, light, prepare):
    scene = bpy.data.scenes.new("lit edge")
    meshes = [_plane(scene, -HALF, 0.0, material)]
    lamp = None
    if light is not None:
        meshes.append(_plane(scene, 0.0, 0.1, None))
        screen = scene.objects[-1]
        # It shows in shadows only: lit from below by the plane, it would light the plane.
        screen.visible_camera = screen.visible_diffuse = screen.visible_glossy = screen.visible_transmission = False
        screen.visible_volume_scatter = False
        lamp = bpy.data.lights.new("sun", "SUN")
        lamp.angle, lamp.energy = 0.0, math.pi
        scene.collection.objects.link(bpy.data.objects.new("sun", lamp))
    camera = bpy.data.cameras.new("eye")
    camera.type, camera.sensor_fit, camera.ortho_scale = "ORTHO", "HORIZONTAL", width
    scene.camera = bpy.data.objects.new("eye", camera)
    scene.collection.objects.link(scene.camera)
    scene.camera.location = (0.5 * width, 0.0137, 1.0)  # off the diagonal of the plane
    scene.world = goniophotometer._world(1.0 if lamp is None else 0.0)
    goniophotometer._settings(scene, samples, 1)
    scene.cycles.max_bounces = 8
    scene.render.resolution_y, scene.render.resolution_x = size
    if prepare is not None:
        prepare(scene)
    try:
        return goniophotometer._render(scene)
    finally:
        bpy.data.scenes.remove(scene)
        for mesh in meshes:
            bpy.data.meshes.remove(mesh)
        bpy.data.cameras.remove(camera)
        if lamp is not None:
            bpy.data.lights.remove(lamp)


def _plane(scene, start, height, material):
    """From x = `start` to HALF; with a material, the top of a box."""
    mesh = bpy.data.meshes.new("plane")
    corners = [(start, -HALF, height), (HALF, -HALF, height), (HALF, HALF, height), (start, HALF, height)]
    faces = [(0, 1, 2, 3)]
    if material is not None:  # a box: volumes need a closed mesh
        corners += [(x, y, height - HALF) for x, y, _ in corners]
        faces += [(7, 6, 5, 4), *((k, k + 4, (k + 1) % 4 + 4, (k + 1) % 4) for k in range(4))]
        mesh.materials.append(material)
    mesh.from_pydata(corners, [], faces)
    scene.collection.objects.link(bpy.data.objects.new("plane", mesh))
    return mesh
