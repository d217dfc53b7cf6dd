# SPDX-License-Identifier: GPL-3.0-or-later
"""The dragon in veined stone, lit from behind, so that its thin parts glow, and a cup with a candle. In millimetres.

The light that leaves towards the eye is computed at the vertices (`lamina.lit_images`) and shown by an Emission node
under a glossy boundary. Cycles adds the reflections and the floor, and Open Image Denoise removes the noise of both,
with albedo and normal passes.
"""

import math
from dataclasses import dataclass

import bmesh
import bpy
import cycles_render
import extension
import mesh_file
import node_tree
import numpy as np
from dragon import scene as dragon_scene
from mathutils import Vector
from slab.light import frame, towards_sun

from . import bodies, surfaces, veins

LENS = 90.0
INDEX, ROUGHNESS = 1.5, 0.28  # of the polished surface; Blender's Roughness
VOXELS = 240  # along the longest side
FLOOR = (0.012, 0.013, 0.016)


@dataclass(frozen=True)
class Stone:
    """Coefficients (sigma_s, sigma_a) in 1/mm of ground and vein, the pattern, and the view of a body.

    Angles in degrees, lengths in mm. `eye`: azimuth, elevation. `lamps`: azimuth, elevation, angular radius, and
    irradiance of each. `sky`: its radiance. `frame`: the middle of the picture above the floor and to the right, and
    its width. `flame`: height above the floor on the body's axis, radius, and irradiance at a distance of 1 m."""

    name: str
    ground: tuple
    vein: tuple
    pattern: veins.Veins
    eye: tuple
    lamps: tuple
    sky: tuple
    exposure: float
    frame: tuple = (128.0, -14.0, 300.0)
    flame: tuple = ()


MARBLE = Stone(
    "Veined marble", veins.WHITE, ((1.2, 1.3, 1.4), (1.10, 1.05, 0.95)),
    veins.Veins(spacing=22.0, turn=(0.5, 0.9, 0.6), distortion=5.0, feature=34.0, octaves=3.0, edge=0.93),
    eye=(-58.0, 5.0), lamps=((92.0, 22.0, 3.0, (9.0, 6.6, 4.4)), (-165.0, 40.0, 9.0, (0.75, 0.85, 1.05))),
    sky=(0.03, 0.037, 0.05), exposure=1.5,
)
# Green stone: chosen coefficients. No measured ones of jade were found.
GREEN = Stone(
    "Green stone", ((1.1, 1.5, 1.3), (0.300, 0.022, 0.150)), ((2.0, 2.3, 2.2), (0.090, 0.020, 0.055)),
    veins.Veins(spacing=30.0, turn=(1.1, 0.3, 0.2), distortion=5.0, feature=30.0, octaves=3.0, edge=0.5),
    eye=(-58.0, 5.0), lamps=((92.0, 22.0, 3.0, (8.0, 7.4, 6.2)), (-165.0, 40.0, 9.0, (0.8, 0.9, 1.05))),
    sky=(0.035, 0.045, 0.05), exposure=1.6,
)
CANDLE = Stone(
    "Cup with a candle", veins.WHITE, ((1.1, 1.3, 1.5), (0.60, 0.48, 0.38)),
    veins.Veins(spacing=16.0, turn=(0.5, 0.9, 0.6), distortion=5.0, feature=14.0, octaves=3.0, edge=0.9),
    eye=(-70.0, 36.0), lamps=((130.0, 40.0, 9.0, (0.20, 0.24, 0.32)),), sky=(0.012, 0.015, 0.02), exposure=0.35,
    frame=(20.0, 4.0, 92.0), flame=(28.0, 3.0, (0.012, 0.0062, 0.0023)),
)
CUP_SCALE = 3.0


@dataclass(frozen=True)
class Effort:
    """Walks per vertex, pixels along an edge, samples of a pixel."""

    walks: int
    size: int
    samples: int


def dragon():
    """(Blender mesh in mm, triangles (m, 3))."""
    mesh = mesh_file.as_mesh("dragon", *mesh_file.read(dragon_scene.DRAGON))
    return mesh, mesh_file.triangles(mesh)


def cup():
    """(Blender mesh in mm, triangles (m, 3)), on the floor."""
    vertices, *faces = mesh_file.read(bodies.CUP)
    vertices = CUP_SCALE * (vertices - [0.0, 0.0, vertices[:, 2].min()])
    mesh = mesh_file.as_mesh("cup", vertices, *faces)
    return mesh, mesh_file.triangles(mesh)


@dataclass(frozen=True, eq=False)
class Studio:
    """A body in its scene. `suns`: the objects of the stone's lamps, in sequence. `solid` and `interior`: the body as
    Lamina's walks need it. `lamps` and `strengths`: all lamps of the scene, the flame last, as the walks need them."""

    stage: bpy.types.Scene
    mesh: bpy.types.Mesh
    suns: list
    solid: object
    interior: object
    lamps: list
    strengths: list


def studio_of(stone, made, effort):
    """The Studio of the body `made` by dragon() or cup()."""
    import lamina

    mesh, triangles = made
    vertices = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", vertices)
    vertices = vertices.reshape(-1, 3).astype(float)
    stage, suns = _stage(stone)
    thing = bpy.data.objects.new(mesh.name, mesh)
    stage.collection.objects.link(thing)
    lamps, strengths = [sun_lamp(one) for one in stone.lamps], [one[3] for one in stone.lamps]
    if stone.flame:
        height, radius, strength = stone.flame
        lamps.append(lamina.PointLamp((0.0, 0.0, height), radius))
        strengths.append(strength)
        _add_flame(stage, height, radius, strength)
    _quality(stage, effort)
    interior = _interior(stone, thing, vertices)
    mesh.materials.clear()
    mesh.materials.append(surfaces.polished(surfaces.lit(), INDEX, ROUGHNESS))
    return Studio(stage, mesh, suns, lamina.Solid(vertices, triangles, name=mesh.name), interior, lamps, strengths)


def sun_lamp(lamp):
    """The lamina.Lamp of one of a stone's lamps."""
    import lamina

    return lamina.Lamp(tuple(towards(lamp)), math.radians(lamp[2]))


def walked(studio, lamps, effort):
    """lamina.LitImages of the light of these lamps that leaves the body towards the camera."""
    import lamina

    return lamina.lit_images(studio.solid, studio.interior, lamps, eye=tuple(studio.stage.camera.location),
                             samples=effort.walks)


def shown(studio, radiance):
    """Linear pixels of the body that emits `radiance` (vertices, 3)."""
    surfaces.write(studio.mesh, surfaces.LIT, radiance)
    return cycles_render.render(studio.stage)[0]


def picture(stone, made, effort):
    """(linear pixels (size, size, 3), facts as plain data) of the body `made` by dragon() or cup()."""
    studio = studio_of(stone, made, effort)
    light = walked(studio, studio.lamps, effort)
    pixels = shown(studio, light.sky * stone.sky + np.einsum("lvc,lc->vc", light.lamps, studio.strengths))
    bpy.data.scenes.remove(studio.stage)
    return pixels, {"vertices": len(light.mask), "walked": int(light.mask.sum()), "walks": effort.walks,
                    "collisions": light.estimate.count.collisions}


def _interior(stone, thing, vertices):
    """The lamina.Interior whose voxels sample the nodes of the stone's veins."""
    import lamina

    low, high = vertices.min(axis=0), vertices.max(axis=0)
    voxels = np.rint(VOXELS * (high - low) / (high - low).max()).astype(int)
    with cycles_render.quiet():
        share = extension.part("interior.node_texture").sample_nodes(
            thing, veins.material(stone.pattern), low, high, voxels)[..., 0]
    ends = [lamina.EndMaterial(*stone.ground), lamina.EndMaterial(*stone.vein)]
    return lamina.Interior.mixed(np.clip(share, 0.0, 1.0), ends, low, high)


def _stage(stone):
    """(scene with lamps, sky, floor and camera; objects of the lamps)."""
    stage = bpy.data.scenes.new("portrait")
    suns = []
    for one in stone.lamps:
        lamp = bpy.data.lights.new("lamp", "SUN")
        lamp.energy, lamp.angle = max(one[3]), 2.0 * math.radians(one[2])
        lamp.color = [value / lamp.energy for value in one[3]]
        sun = bpy.data.objects.new("lamp", lamp)
        sun.matrix_world = frame(towards(one))
        stage.collection.objects.link(sun)
        suns.append(sun)
    stage.world = bpy.data.worlds.new("sky")
    background = node_tree.of(stage.world).nodes["Background"]
    background.inputs["Color"].default_value = (*stone.sky, 1.0)
    camera = bpy.data.cameras.new("camera")
    camera.lens, camera.clip_start, camera.clip_end = LENS, 1.0, 1e5
    eye = bpy.data.objects.new("camera", camera)
    back = towards(stone.eye)
    eye.matrix_world = frame(back)
    right = Vector((-back.y, back.x, 0.0)).normalized()
    height, aside, width = stone.frame
    eye.location = Vector((0.0, 0.0, height)) + aside * right + back * width * LENS / camera.sensor_width
    stage.collection.objects.link(eye)
    stage.camera = eye
    stage.collection.objects.link(_floor(back))
    stage.view_layers[0].update()
    return stage, suns


def _add_flame(stage, height, radius, strength):
    """A point lamp of irradiance `strength` at 1 m, and a longish body in its place that only the camera sees."""
    lamp = bpy.data.lights.new("flame", "POINT")
    # Irradiance at the distance d is power / (4 pi^2 d^2).
    lamp.energy, lamp.shadow_soft_size = 4.0 * math.pi**2 * 1e6 * max(strength), radius
    lamp.color = [value / max(strength) for value in strength]
    mesh = bpy.data.meshes.new("flame")
    shape = bmesh.new()
    bmesh.ops.create_uvsphere(shape, u_segments=32, v_segments=16, radius=radius)
    for vertex in shape.verts:
        narrow = 0.6 * (1.0 - 0.7 * max(vertex.co.z / radius, 0.0))
        vertex.co = narrow * vertex.co.x, narrow * vertex.co.y, (3.0 if vertex.co.z > 0.0 else 1.0) * vertex.co.z
    shape.to_mesh(mesh)
    shape.free()
    mesh.shade_smooth()
    material = bpy.data.materials.new("flame")
    shader = node_tree.of(material).nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    shader.inputs["Emission Color"].default_value = (*lamp.color, 1.0)
    shader.inputs["Emission Strength"].default_value = 60.0
    mesh.materials.append(material)
    body = bpy.data.objects.new("body of the flame", mesh)
    body.visible_diffuse = body.visible_glossy = body.visible_shadow = False
    for one in (bpy.data.objects.new("flame", lamp), body):
        one.location.z = height
        stage.collection.objects.link(one)


def _floor(back):
    """A dark plane that fills the picture behind the dragon: the eye sees no sky."""
    reach = 4e3
    mesh = bpy.data.meshes.new("floor")
    away = Vector((back.x, back.y, 0.0)).normalized()
    side = Vector((-away.y, away.x, 0.0))
    wall = -600.0 * away
    corners = [reach * away + reach * side, reach * away - reach * side, wall - reach * side, wall + reach * side,
               wall - reach * side + Vector((0.0, 0.0, reach)), wall + reach * side + Vector((0.0, 0.0, reach))]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3), (3, 2, 4, 5)])
    material = bpy.data.materials.new("floor")
    shader = node_tree.of(material).nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*FLOOR, 1.0)
    shader.inputs["Roughness"].default_value = 0.35
    mesh.materials.append(material)
    return bpy.data.objects.new("floor", mesh)


def towards(angles):
    """The unit vector to the azimuth and elevation, in degrees, with which `angles` begins."""
    return towards_sun(*map(math.radians, angles[:2]))


def _quality(stage, effort):
    cycles_render.unbiased(stage, effort.size, effort.size, effort.samples, bounces=4)
    stage.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    # Clamp to reduce noise: nothing is measured from this picture.
    stage.cycles.sample_clamp_indirect = 4.0
    cycles_render.denoised(stage)
