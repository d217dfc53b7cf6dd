# SPDX-License-Identifier: GPL-3.0-or-later
"""What cannot fill an object, in one sentence each."""

import bpy
import numpy as np
import pytest
from addon_helpers import icosphere, linked


@pytest.fixture
def contents(addon, lamina):
    from bl_ext.user_default.lamina.interior import contents

    return contents


@pytest.fixture
def ball(addon):
    """A ball with the materials Marble and Gold, all of its faces in Marble."""
    obj = linked("Ball", icosphere("Ball", 1.0))
    for name in ("Marble", "Gold"):
        made = bpy.data.materials.new(name)
        addon.nodes.node_tree.of(made)
        obj.data.materials.append(made)
    return obj


def filled(contents, obj, material, uvs=None):
    """Its Contents, for a UV map of one triangle per face, or `uvs`."""
    from bl_ext.user_default.lamina.base import mesh_arrays
    from bl_ext.user_default.lamina.interior import body
    from mathutils import Matrix

    still = Matrix.Identity(4)
    vertices, triangles = mesh_arrays.vertices(obj.data, still, 1.0), mesh_arrays.triangles(obj.data, still)
    places = np.tile([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], (len(triangles), 1, 1)) if uvs is None else uvs
    arrays = mesh_arrays.Arrays(vertices, triangles, None, places, obj.name)
    return contents.of_material(obj, bpy.data.materials[material], body.Body(arrays, 1.0, None, None, None, ()))


def test_a_coordinate_that_is_not_a_number(contents, ball):
    ball.data.vertices[7].co.y = float("nan")
    with pytest.raises(contents.RefusedError, match="^vertex 7 of Ball has a coordinate that is not a number: delete"):
        filled(contents, ball, "Marble")


def test_a_material_that_is_on_no_face(contents, ball):
    """Unless modifiers give it to faces, which then have places in the map."""
    nowhere = np.zeros((len(ball.data.polygons), 3, 2))
    with pytest.raises(contents.RefusedError, match="^no face of Ball has the material Gold: assign it to faces"):
        filled(contents, ball, "Gold", nowhere)
    assert filled(contents, ball, "Gold").identity
    assert filled(contents, ball, "Marble", nowhere).identity  # lamina refuses this map, in a sentence of its own


def test_homogeneous_without_layers(contents, ball, addon):
    material = bpy.data.materials["Marble"]
    material.lamina.interior.source = "LAYERS"
    with pytest.raises(contents.RefusedError, match="^Marble has no Lamina layers: add one homogeneous medium, or"):
        filled(contents, ball, "Marble")
    addon.editing.layer_list.add_stack(material)
    with pytest.raises(ValueError, match="has no lengths"):
        filled(contents, ball, "Marble")
