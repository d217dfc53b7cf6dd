# SPDX-License-Identifier: GPL-3.0-or-later
"""Short words for making the node trees of materials and groups."""

import bpy
import numpy as np


class Tree:
    """The tree of a new material, which has a Principled BSDF and an output."""

    def __init__(self, material):
        self.material = material
        material.use_fake_user = True
        self.nodes, self.links = material.node_tree.nodes, material.node_tree.links
        self.output = self.nodes.get("Material Output")
        self.principled = self.nodes.get("Principled BSDF")

    def add(self, kind, x=0.0, y=0.0, label="", parent=None, **settings):
        node = self.nodes.new(kind)
        node.location, node.label, node.parent = (x, y), label, parent
        for name, value in settings.items():
            setattr(node, name, value)
        return node

    def link(self, given, target, muted=False):
        link = self.links.new(given, target)
        link.is_muted = muted
        return link

    def image(self, name, data=False, packed=False, x=-600.0, y=300.0):
        image = bpy.data.images.new(name, 4, 4, float_buffer=data, is_data=data)
        image.pixels.foreach_set(np.linspace(0.0, 1.0, 64, dtype=np.float32))
        if packed:
            image.pack()
        return self.add("ShaderNodeTexImage", x, y, image=image)

    def set(self, **values):
        for name, value in values.items():
            self.principled.inputs[name.replace("_", " ")].default_value = value

    def only_output(self):
        self.nodes.remove(self.principled)
        self.principled = None
        return self.output.inputs["Surface"]


def new_group(name, inputs, output=None):
    """A shader group with (label, socket type, value) of its inputs, and a socket type for its output Out."""
    group = bpy.data.node_groups.new(name, "ShaderNodeTree")
    for label, kind, value in inputs:
        group.interface.new_socket(label, in_out="INPUT", socket_type=kind).default_value = value
    if output:
        group.interface.new_socket("Out", in_out="OUTPUT", socket_type=output)
    group.nodes.new("NodeGroupInput")
    group.nodes.new("NodeGroupOutput").location = (400.0, 0.0)
    return group
