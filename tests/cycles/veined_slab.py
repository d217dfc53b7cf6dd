# SPDX-License-Identifier: GPL-3.0-or-later
"""A slab with veins from above: as Cycles' volume, the truth, and with the nodes of an interior. One Blender unit is a
millimetre."""

import bpy
import goniophotometer
import numpy as np
from mathutils import Euler

SIDE, THICKNESS = 12.0, 4.0  # mm
SEEN, PIXELS = 8.0, 32  # side of the picture in mm and pixels
GROUND, VEIN = ((2.0, 2.4, 2.8), (0.02, 0.04, 0.08)), ((1.6, 1.4, 1.2), (0.5, 0.6, 0.8))  # (sigma_s, sigma_a) per mm
SUN = (0.7, 0.3, 0.0)  # Euler angles


def scene_with(light):
    """A new scene with the slab's camera and `light`: "sky" or "sun"."""
    scene = bpy.data.scenes.new("veined slab")
    scene.unit_settings.scale_length = 0.001
    camera = bpy.data.cameras.new("eye")
    camera.type, camera.ortho_scale = "ORTHO", SEEN
    scene.camera = bpy.data.objects.new("eye", camera)
    scene.camera.location = (0.0137, 0.0071, 20.0)
    scene.collection.objects.link(scene.camera)
    scene.world = goniophotometer._world(1.0 if light == "sky" else 0.0)
    if light == "sun":
        lamp = bpy.data.lights.new("Sun", "SUN")
        lamp.angle, lamp.energy = 0.0, np.pi
        obj = bpy.data.objects.new("Sun", lamp)
        obj.rotation_euler = Euler(SUN)
        scene.collection.objects.link(obj)
    return scene


def slab(scene, material):
    mesh = bpy.data.meshes.new("slab")
    h, d = 0.5 * SIDE, THICKNESS
    corners = [(x, y, z) for x in (-h, h) for y in (-h, h) for z in (-d, 0.0)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh.from_pydata(corners, [], quads)
    mesh.materials.append(material)
    layer = mesh.uv_layers.new(name="Top")
    # The seen part of the top face fills the image; the other faces are points in the UV map.
    uvs = np.zeros((len(mesh.loops), 2), np.float32)
    for loop in mesh.loops:
        place = mesh.vertices[loop.vertex_index].co
        if all(abs(mesh.vertices[k].co.z) < 1e-9 for k in mesh.polygons[loop.index // 4].vertices):
            uvs[loop.index] = [0.5 + place.x / (1.25 * SEEN), 0.5 + place.y / (1.25 * SEEN)]
    layer.uv.foreach_set("vector", uvs.ravel())
    obj = bpy.data.objects.new("slab", mesh)
    scene.collection.objects.link(obj)
    return obj


def veins(tree):
    """The socket of a number from 0 to 1, in the object's coordinates: waves, bent by each other."""
    nodes, links = tree.nodes, tree.links
    place = nodes.new("ShaderNodeTexCoord").outputs["Object"]
    wave = nodes.new("ShaderNodeTexWave")
    wave.name = "Veins"
    wave.inputs["Scale"].default_value = 0.12
    wave.inputs["Distortion"].default_value = 3.0
    wave.inputs["Detail"].default_value = 0.0
    links.new(place, wave.inputs["Vector"])
    return wave.outputs["Fac"]


def volume(material):
    """The truth: the same mixture as Cycles' scattering and absorption."""
    tree = goniophotometer.node_tree.of(material)
    for node in list(tree.nodes):
        if node.type != "OUTPUT_MATERIAL":
            tree.nodes.remove(node)
    share = veins(tree)
    both = tree.nodes.new("ShaderNodeAddShader")
    kinds = (("ShaderNodeVolumeScatter", False), ("ShaderNodeVolumeAbsorption", True))
    for place, (kind, inverted) in enumerate(kinds):
        most = max(max(GROUND[place]), max(VEIN[place]))
        mix = tree.nodes.new("ShaderNodeMix")
        mix.data_type = "RGBA"
        tree.links.new(share, mix.inputs[0])
        for socket, end in ((6, GROUND), (7, VEIN)):
            shares = np.array(end[place]) / most
            mix.inputs[socket].default_value = (*(1.0 - shares if inverted else shares), 1.0)
        shader = tree.nodes.new(kind)
        shader.inputs["Density"].default_value = most
        tree.links.new(mix.outputs[2], shader.inputs["Color"])
        tree.links.new(shader.outputs[0], both.inputs[place])
    tree.links.new(both.outputs[0], tree.get_output_node("CYCLES").inputs["Volume"])


def interior(material, output, noise, size=40):
    """Settings of the extension for the same mixture."""
    tree = goniophotometer.node_tree.of(material)
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    tree.links.new(veins(tree), shader.inputs["Base Color"])
    settings = material.lamina.interior
    settings.source, settings.output, settings.ior, settings.resolution = "NODES", output, 1.0, 96
    for end, (sigma_s, sigma_a) in ((settings.first, GROUND), (settings.second, VEIN)):
        end.sigma_s, end.sigma_a, end.g = sigma_s, sigma_a, 0.0
    settings.size, settings.noise, settings.view = size, noise, "CAMERA"


def picture(scene, samples, bounces=256, step=None, seed=0):
    """(PIXELS, PIXELS, 3), bottom row first."""
    goniophotometer._settings(scene, samples, 1)
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    scene.cycles.max_bounces = scene.cycles.volume_bounces = bounces
    scene.cycles.seed = seed
    if step is not None:
        scene.cycles.volume_step_rate = step
        scene.cycles.volume_max_steps = 65536
    return goniophotometer._render(scene)[..., :3]
