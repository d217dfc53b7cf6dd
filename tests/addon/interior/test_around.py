# SPDX-License-Identifier: GPL-3.0-or-later
"""The other objects of a scene, as occluders of a body."""

import bpy
import numpy as np
import pytest
from tried_bodies import body, link, others


@pytest.fixture
def seen(addon, lamina):
    from bl_ext.user_default.lamina.interior import seen

    obj = body("torus", "side")
    obj.location, obj.rotation_euler, obj.scale = (1.0, 2.0, 3.0), (0.3, 0.2, 0.1), (2.0, 2.0, 2.0)
    others()

    def occluders():
        bpy.context.view_layer.update()
        return seen.of_object(bpy.context, obj, obj.active_material).occluders

    return occluders


def glass(material):
    nodes = material.node_tree.nodes
    node = nodes.new("ShaderNodeBsdfGlass")
    material.node_tree.links.new(node.outputs[0], nodes["Material Output"].inputs["Surface"])


def test_places_in_the_axes_of_the_body(seen):
    """In millimetres, with the diffuse colors."""
    found = seen()
    torus, wall = bpy.data.objects["Torus"], bpy.data.objects["Wall"]
    inverse = torus.matrix_world.normalized().inverted()
    wanted = np.array([inverse @ wall.matrix_world @ corner.co for corner in wall.data.vertices])
    distances = np.linalg.norm(wanted[:, None] - found.vertices, axis=2)
    assert distances.min(axis=1).max() < 1e-4
    np.testing.assert_allclose(np.unique(found.albedo, axis=0), [[0.1, 0.3, 0.7], [0.8, 0.4, 0.2]], atol=1e-6)


def test_what_is_left_out(seen):
    assert len(seen().triangles) == 4
    bpy.data.objects["Wall"].hide_render = True
    assert len(seen().triangles) == 2
    bpy.data.objects["Floor"].visible_shadow = False
    assert seen() is None
    bpy.data.objects["Wall"].hide_render, bpy.data.objects["Floor"].visible_shadow = False, True
    glass(bpy.data.materials["Floor"])
    assert len(seen().triangles) == 2


def test_copies_and_curves_count(seen):
    curve = bpy.data.curves.new("Tube", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.1
    spline = curve.splines.new("POLY")
    spline.points.add(1)
    spline.points[1].co = (1.0, 0.0, 0.0, 1.0)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Tube", curve))
    tube = len(seen().triangles) - 4
    assert tube > 0
    again = bpy.data.objects.new("Again", bpy.data.objects["Torus"].data)
    bpy.context.scene.collection.objects.link(again)
    again.data.calc_loop_triangles()
    assert len(seen().triangles) == 4 + tube + len(again.data.loop_triangles)


def test_what_a_mesh_that_shines_is_linked_to(addon, seen):
    """The wall shines, lights the floor alone, and has no shadow of the floor. An object that does not shine counts
    like any other."""
    link("Floor", "receiver", Wall="INCLUDE")
    assert seen().links is None
    inputs = addon.nodes.node_tree.of(bpy.data.materials["Wall"])
    shader = inputs.nodes.new("ShaderNodeEmission")
    inputs.links.new(shader.outputs[0], inputs.nodes["Material Output"].inputs["Surface"])
    link("Wall", "receiver", Floor="INCLUDE")
    link("Wall", "blocker", Floor="EXCLUDE")
    found = seen()
    is_wall = found.emission.any(axis=1)
    assert is_wall.sum() == 2 and (found.linking == is_wall).all()
    assert (found.lit == np.where(is_wall, 1, 3)).all() and (found.shadows == np.where(is_wall, 3, 1)).all()
    assert found.solid_lit == 1
    link("Wall", "blocker", Torus="EXCLUDE")
    with pytest.raises(ValueError, match="Torus casts no shadows of the light of Wall"):
        seen()


def test_albedos(addon, seen):
    from bl_ext.user_default.lamina.interior import around

    plain = bpy.data.materials.new("Plain")
    addon.nodes.node_tree.of(plain)
    plain.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.1, 0.2, 0.3, 1.0)
    assert around.albedo_of(plain) == pytest.approx((0.1, 0.2, 0.3))
    texture = plain.node_tree.nodes.new("ShaderNodeTexNoise")
    plain.node_tree.links.new(texture.outputs["Color"], plain.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    plain.diffuse_color = (0.5, 0.6, 0.7, 1.0)
    assert around.albedo_of(plain) == pytest.approx((0.5, 0.6, 0.7))
    assert around.albedo_of(None) == (0.8, 0.8, 0.8)
    assert around.emission_of(plain) == around.emission_of(None) == (0.0, 0.0, 0.0)
    inputs = plain.node_tree.nodes["Principled BSDF"].inputs
    inputs["Emission Color"].default_value, inputs["Emission Strength"].default_value = (1.0, 0.5, 0.2, 1.0), 3.0
    assert around.emission_of(plain) == pytest.approx((3.0, 1.5, 0.6))
