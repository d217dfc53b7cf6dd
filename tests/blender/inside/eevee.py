# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender window: renders balls of presets in Cycles and in Eevee under the same light, and prints the mean
colors, the peaks of the highlights, the means at the rim, and the root mean square difference, as JSON.

Arguments: the presets; "+" after a name lays a checker on the input Thickness. Names of VARNISHED are varnish over
Principled BSDFs whose values are linked."""

import importlib
import json
import math
import os
import sys
import traceback

import bpy
import numpy as np
from mathutils import Vector

SIZE, RADIUS = 64, 0.42  # pixels of a ball's cell; its radius, in cells
SUNS = (((-0.4, -0.8, 0.45), 2.0), ((0.5, 0.8, 0.3), 1.0))  # (towards the sun, irradiance)
SKY = 0.3
VARNISHED = {"varnished paint": ((0.6, 0.1, 0.05), 0.0, 0.4), "varnished gold": ((1.0, 0.7, 0.3), 1.0, 0.3)}


def material_of(name):
    lamina = sys.modules["bl_ext.user_default.lamina"]
    presets = lamina.base.native.part("presets")
    material = bpy.data.materials.new(name)
    lamina.editing.stack_io.assign_stack(material, presets.load(name.rstrip("+")))
    lamina.baking.bake_job.bake_material(material, "preview")
    if name.endswith("+"):
        tree = material.node_tree
        (node,) = [one for one in tree.nodes if one.type == "GROUP"]
        checker, place = tree.nodes.new("ShaderNodeTexChecker"), tree.nodes.new("ShaderNodeTexCoord")
        most = node.inputs["Thickness"].default_value
        checker.inputs["Scale"].default_value = 4.0
        for socket, value in zip(checker.inputs[1:3], (most, 0.0), strict=True):
            socket.default_value = (value, value, value, 1.0)
        tree.links.new(place.outputs["UV"], checker.inputs[0])
        tree.links.new(checker.outputs[0], node.inputs["Thickness"])
    return material


def varnished(name):
    """Smooth varnish over a Principled BSDF with linked color, metallic and roughness."""
    addon, lamina = sys.modules["bl_ext.user_default.lamina"], importlib.import_module("lamina")
    material = bpy.data.materials.new(name)
    tree = addon.nodes.node_tree.of(material)
    (shader,) = [one for one in tree.nodes if one.type == "BSDF_PRINCIPLED"]
    color, metallic, roughness = VARNISHED[name]
    given = {"Base Color": ("ShaderNodeRGB", (*color, 1.0)), "Metallic": ("ShaderNodeValue", metallic),
             "Roughness": ("ShaderNodeValue", roughness)}
    for socket, (kind, value) in given.items():
        node = tree.nodes.new(kind)
        node.outputs[0].default_value = value
        tree.links.new(node.outputs[0], shader.inputs[socket])
    addon.editing.over_material.add(material)
    addon.editing.over_material.assign_layers(material, lamina.Stack([lamina.Interface(1.5)], lamina.Black()))
    addon.baking.bake_job.bake_material(material, "preview")
    return material


def build(names):
    """Balls in a row, which neither shadow nor reflect each other, under suns and a grey sky."""
    scene = bpy.data.scenes.new("balls")
    bpy.context.window.scene = scene
    bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=48, radius=RADIUS)
    bpy.ops.object.shade_smooth()
    first = bpy.context.object
    for place, name in enumerate(names):
        ball = first if place == 0 else bpy.data.objects.new(name, first.data.copy())
        if place:
            scene.collection.objects.link(ball)
        ball.data.materials.clear()
        ball.data.materials.append(varnished(name) if name in VARNISHED else material_of(name))
        ball.location = (place, 0.0, 0.0)
        ball.visible_diffuse = ball.visible_glossy = ball.visible_transmission = ball.visible_shadow = False
    for towards, irradiance in SUNS:
        lamp = bpy.data.lights.new("sun", "SUN")
        lamp.energy, lamp.angle = irradiance, math.radians(10.0)
        sun = bpy.data.objects.new("sun", lamp)
        sun.rotation_euler = Vector(towards).to_track_quat("Z", "Y").to_euler()
        scene.collection.objects.link(sun)
    scene.world = bpy.data.worlds.new("sky")
    tree = sys.modules["bl_ext.user_default.lamina"].nodes.node_tree.of(scene.world)
    tree.nodes["Background"].inputs[0].default_value = (SKY, SKY, SKY, 1.0)
    lens = bpy.data.cameras.new("eye")
    lens.type, lens.ortho_scale = "ORTHO", len(names)
    scene.camera = bpy.data.objects.new("eye", lens)
    scene.camera.location = ((len(names) - 1) / 2, -10.0, 0.0)
    scene.camera.rotation_euler = (math.pi / 2, 0.0, 0.0)
    scene.collection.objects.link(scene.camera)
    scene.render.resolution_x, scene.render.resolution_y = SIZE * len(names), SIZE
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    return scene


def picture(scene, engine):
    """Linear RGB of the scene, (height, width, 3)."""
    scene.render.engine = engine
    scene.cycles.samples, scene.cycles.seed, scene.cycles.max_bounces = 128, 0, 1
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.eevee.taa_render_samples = 32
    scene.render.filepath = f"{os.environ['HOME']}/{engine}.exr"
    bpy.ops.render.render(write_still=True, scene=scene.name)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    return np.array(image.pixels[:], np.float32).reshape(SIZE, -1, 4)[:, :, :3]


def compared(names, cycles, eevee):
    """{name: facts} of both pictures."""
    y, x = np.mgrid[0:SIZE, 0:SIZE] - (SIZE - 1) / 2
    radius = np.hypot(x, y) / (SIZE * RADIUS)
    disc, rim, facts = radius < 0.9, (radius > 0.9) & (radius < 0.97), {}
    for place, name in enumerate(names):
        pair = [whole[:, place * SIZE:(place + 1) * SIZE] for whole in (cycles, eevee)]
        change = (pair[1] - pair[0])[disc]
        facts[name] = {
            "mean": [one[disc].mean(axis=0).tolist() for one in pair],
            "peak": [float(one[disc].mean(axis=1).max()) for one in pair],
            "rim": [float(one[rim].mean()) for one in pair],
            "darkest": [float(one[radius < 0.97].mean(axis=1).min()) for one in pair],
            "difference": float(np.sqrt((change**2).mean() / (pair[0][disc] ** 2).mean())),
        }
    return facts


if __name__ == "__main__":
    code = 1
    try:
        names = sys.argv[sys.argv.index("--") + 1:]
        scene = build(names)
        eevee = "BLENDER_EEVEE_NEXT" if bpy.app.version < (5, 0) else "BLENDER_EEVEE"
        print("facts:", json.dumps(compared(names, *(picture(scene, engine) for engine in ("CYCLES", eevee)))))
        code = 0
    except Exception:
        traceback.print_exc()
    finally:  # a window would stay open
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
