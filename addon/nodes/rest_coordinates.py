# SPDX-License-Identifier: GPL-3.0-or-later
"""Coordinates that stay with the surface of a mesh: where its vertices are at rest, in lengths of the world,
as an attribute. Noise over them does not swim when shape keys or modifiers deform the mesh, and has its size
in the world."""

import bpy
import numpy as np

from .expression import length

NAME = "lamina_rest"


def store(obj, again=False):
    """Store the rest coordinates of a mesh object of this file. They are stored once, `again`: anew. Objects
    that share the mesh share them."""
    mesh = obj.data
    if obj.type != "MESH" or not mesh.is_editable or obj.mode == "EDIT":
        return
    attribute = mesh.attributes.get(NAME)
    if attribute is not None and (attribute.data_type, attribute.domain) != ("FLOAT_VECTOR", "POINT"):
        return  # not ours
    if attribute is None:
        attribute, again = mesh.attributes.new(NAME, "FLOAT_VECTOR", "POINT"), True
    if again:
        places = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", places)
        scale = np.array(obj.matrix_world.to_scale(), np.float32)
        attribute.data.foreach_set("vector", (places.reshape(-1, 3) * scale).ravel())
        mesh.update()


def store_for(material):
    """Store them for all objects with the material."""
    objects = [obj for obj in bpy.data.objects if obj.type == "MESH" and NAME not in obj.data.attributes
               and any(slot.material == material for slot in obj.material_slots)]
    for scene in {scene for obj in objects for scene in obj.users_scene}:
        # Matrices of scenes that no window shows are out of date.
        layer = bpy.context.view_layer if scene == bpy.context.scene else scene.view_layers[0]
        layer.update()
    for obj in objects:
        store(obj)


def remove(mesh):
    """Remove the rest coordinates."""
    attribute = mesh.attributes.get(NAME)
    if attribute is not None:
        mesh.attributes.remove(attribute)


def is_read(tree):
    """True if linked nodes of a tree, or of groups in it, read the coordinates."""
    linked = [node for node in tree.nodes if any(one.is_linked for one in node.outputs)] if tree else []
    return any(getattr(node, "attribute_name", "") == NAME or is_read(getattr(node, "node_tree", None))
               for node in linked)


def draw(graph):
    """The coordinates in a shader: the object's own on a mesh without the attribute."""
    stored = graph.node("ShaderNodeAttribute", "at rest")
    stored.attribute_type, stored.attribute_name = "GEOMETRY", NAME
    rest = graph.value(stored.outputs["Vector"])
    place = graph.node("ShaderNodeTexCoord").outputs["Object"]
    # A missing attribute is 0 everywhere.
    return graph.mix("VECTOR", "at rest or now", length(rest) > 0.0, place, rest)
