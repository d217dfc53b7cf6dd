# SPDX-License-Identifier: GPL-3.0-or-later
"""Images that a timer has made, across an undo that frees them or keeps them."""

import bpy
import numpy as np
import pytest


@pytest.fixture
def made(addon, material):
    """(addon.base.undo, a node of the material's tree with an image of this session, the image)."""
    tree = addon.nodes.node_tree.of(material)
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = addon.base.data_image.create("Table", np.ones((2, 2, 4)))
    return addon.base.undo, node, node.image


def test_an_image_that_stays_is_taken_again(made):
    undo, node, image = made
    undo.let_go()
    assert node.image is None and image.users == 0
    undo.take_again()
    assert node.image == image


def test_a_lost_image_is_told(made, addon, material, monkeypatch):
    """Undo frees an image that is in no step."""
    undo, node, image = made
    told = []
    monkeypatch.setattr(addon.base.changes, "losses", [told.append])
    undo.let_go()
    bpy.data.images.remove(image)
    undo.take_again()
    assert node.image is None and told == [material]


def test_what_the_step_says_counts(made):
    """A node that the undo has given another image keeps it, and images of the file are left alone."""
    undo, node, _image = made
    other = bpy.data.images.new("Other", 2, 2)
    undo.let_go()
    node.image = other
    undo.take_again()
    assert node.image == other
    undo.let_go()
    assert node.image == other
    undo.take_again()


def test_nodes_and_trees_may_be_gone(made, material):
    undo, node, _image = made
    undo.let_go()
    node.id_data.nodes.remove(node)
    undo.take_again()
    assert not undo._held


def test_dust_of_objects(made, addon):
    undo, _node, image = made
    obj = bpy.data.objects.new("Dusty", bpy.data.meshes.new("Mesh"))
    obj.lamina_dust.image = image
    undo.let_go()
    assert obj.lamina_dust.image is None
    undo.take_again()
    assert obj.lamina_dust.image == image
