# SPDX-License-Identifier: GPL-3.0-or-later
"""A sheet of all overlays over ten materials of an artist: a row of the materials alone, and one for each overlay."""

import math

import bpy
import node_tree
import output
import picture
from PIL import Image, ImageDraw, ImageFont

# (name, values of a Principled BSDF, texture of its color)
MATERIALS = (
    ("white plastic", {"Base Color": (0.8, 0.8, 0.8), "Roughness": 0.3}, None),
    ("red plastic", {"Base Color": (0.6, 0.02, 0.015), "Roughness": 0.15}, None),
    ("black gloss", {"Base Color": (0.01, 0.01, 0.01), "Roughness": 0.05}, None),
    ("chrome", {"Base Color": (0.55, 0.56, 0.57), "Metallic": 1.0, "Roughness": 0.05}, None),
    ("rough gold", {"Base Color": (1.0, 0.77, 0.34), "Metallic": 1.0, "Roughness": 0.4}, None),
    ("wood", {"Roughness": 0.5}, "ShaderNodeTexWave"),
    ("brick", {"Roughness": 0.9}, "ShaderNodeTexBrick"),
    ("glass", {"Base Color": (1.0, 1.0, 1.0), "Roughness": 0.0, "Transmission Weight": 1.0}, None),
    ("skin", {"Base Color": (0.7, 0.42, 0.32), "Roughness": 0.45, "Subsurface Weight": 1.0,
              "Subsurface Radius": (0.02, 0.008, 0.004)}, None),
    ("velvet", {"Base Color": (0.08, 0.03, 0.2), "Roughness": 0.9, "Sheen Weight": 1.0}, None),
)
_COLORS = {"ShaderNodeTexWave": ((0.22, 0.09, 0.03), (0.45, 0.24, 0.1)),
           "ShaderNodeTexBrick": ((0.4, 0.1, 0.05), (0.5, 0.45, 0.4))}
TITLES, NAMES, MARGIN = 26, 118, 16


def made(name, values, texture):
    """A new material of an artist."""
    material = bpy.data.materials.new(name)
    tree = node_tree.of(material)
    shader = tree.nodes["Principled BSDF"]
    for socket, value in values.items():
        if isinstance(value, tuple):
            count = len(shader.inputs[socket].default_value)
            value = value if count == 3 else (*value, 1.0)
        shader.inputs[socket].default_value = value
    if texture is not None:
        pattern, ramp = tree.nodes.new(texture), tree.nodes.new("ShaderNodeValToRGB")
        pattern.inputs["Scale"].default_value = 6.0
        if texture == "ShaderNodeTexWave":
            pattern.inputs["Distortion"].default_value = 6.0
        # Both patterns lie in x and y: turned, so that the camera sees them on the front of the body.
        turn = tree.nodes.new("ShaderNodeMapping")
        turn.inputs["Rotation"].default_value[0] = 0.5 * math.pi
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Object"], turn.inputs["Vector"])
        tree.links.new(turn.outputs["Vector"], pattern.inputs["Vector"])
        for element, color in zip(ramp.color_ramp.elements, _COLORS[texture], strict=True):
            element.color = (*color, 1.0)
        tree.links.new(pattern.outputs["Fac"], ramp.inputs[0])
        tree.links.new(ramp.outputs[0], shader.inputs["Base Color"])
    return material


def sheet(path, names, cells):
    """The picture: `cells` has a row of ten for each name."""
    size = len(cells[0])
    width, height = NAMES + len(MATERIALS) * size + MARGIN, TITLES + len(names) * size + MARGIN
    found = Image.new("RGB", (width, height), picture.PAPER)
    draw, font = ImageDraw.Draw(found), ImageFont.load_default(13)
    for column, (name, *_) in enumerate(MATERIALS):
        draw.text((NAMES + (column + 0.5) * size, 6), name, picture.INK, font, "ma")
    for row, name in enumerate(names):
        draw.text((MARGIN, TITLES + (row + 0.5) * size), name, picture.INK, font, "lm")
        for column in range(len(MATERIALS)):
            cell = Image.fromarray(cells[row * len(MATERIALS) + column])
            found.paste(cell, (NAMES + column * size, TITLES + row * size))
    output.place(path, lambda partial: found.save(partial, "PNG", optimize=True))
