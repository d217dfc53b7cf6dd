# SPDX-License-Identifier: GPL-3.0-or-later
"""The UV map that Lamina unwraps: when it is made again, and which modifiers no unwrap can help."""

import bmesh
import bpy
import numpy as np
import pytest
from addon_helpers import icosphere, linked


@pytest.fixture
def unwrap(addon, lamina):
    from bl_ext.user_default.lamina.base import unwrap

    return unwrap


@pytest.fixture
def ball(addon):
    return linked("Ball", icosphere("Ball", 1.0))


def uvs(obj, name="Lamina"):
    found = np.empty(2 * len(obj.data.loops), np.float32)
    obj.data.uv_layers[name].uv.foreach_get("vector", found)
    return found.reshape(-1, 2)


def change(obj, edit):
    """Edit the mesh of an object in a BMesh."""
    made = bmesh.new()
    made.from_mesh(obj.data)
    edit(made)
    made.to_mesh(obj.data)
    made.free()


def with_new_faces(made):
    """Without places in the map."""
    bmesh.ops.create_cube(made, size=0.5)


def with_copied_faces(made):
    """In the places of others."""
    bmesh.ops.duplicate(made, geom=[*made.verts, *made.edges, *made.faces][: len(made.verts) + len(made.edges) + 40])


def test_a_map_that_fits_is_kept(unwrap, ball):
    """Also after it was edited, and after the shape was."""
    assert unwrap.ensure(ball) == "Lamina"
    layer = ball.data.uv_layers["Lamina"]
    layer.uv.foreach_set("vector", (0.5 * uvs(ball)).ravel())
    ball.data.vertices[3].co *= 1.3
    before = uvs(ball)
    assert unwrap.ensure(ball) == "Lamina"
    np.testing.assert_array_equal(uvs(ball), before)


@pytest.mark.parametrize("edit", [with_new_faces, with_copied_faces])
def test_a_map_is_made_again_after_faces_were_added(unwrap, ball, edit):
    """Other maps stay, and the render sees the new map."""
    own = ball.data.uv_layers.new(name="Own")
    own.uv.foreach_set("vector", np.full(2 * len(ball.data.loops), 0.25, np.float32))
    unwrap.ensure(ball)
    change(ball, edit)
    assert not unwrap.fits(ball.data)
    before = uvs(ball, "Own")
    bpy.context.view_layer.update()
    assert unwrap.ensure(ball) == "Lamina"
    assert unwrap.fits(ball.data) and [one.name for one in ball.data.uv_layers] == ["Own", "Lamina"]
    np.testing.assert_array_equal(uvs(ball, "Own"), before)
    seen = ball.evaluated_get(bpy.context.evaluated_depsgraph_get())
    np.testing.assert_array_equal(uvs(seen), uvs(ball))


def test_a_map_with_a_wrong_number_is_made_again(unwrap, ball):
    unwrap.ensure(ball)
    ball.data.uv_layers["Lamina"].uv[5].vector = (float("nan"), 0.0)
    unwrap.ensure(ball)
    assert np.isfinite(uvs(ball)).all()


@pytest.mark.parametrize(("kind", "numbers", "copies"), [
    ("MIRROR", {}, True),
    ("MIRROR", {"use_axis": (False, False, False)}, False),
    ("MIRROR", {"offset_u": 1.0}, False),
    ("MIRROR", {"use_mirror_u": True}, False),
    ("ARRAY", {}, True),
    ("ARRAY", {"count": 1}, False),
    ("ARRAY", {"offset_v": 1.0}, False),
    ("SOLIDIFY", {}, True),
    ("SOLIDIFY", {"use_rim_only": True}, False),
    ("SOLIDIFY", {"material_offset": 1}, True),  # there is one material only
    ("WIREFRAME", {"thickness": 0.05}, True),
    ("SUBSURF", {}, False),
    ("BEVEL", {}, False),
    ("MIRROR", {"show_render": False}, False),
])  # fmt: skip
def test_modifiers_that_copy_faces(unwrap, ball, kind, numbers, copies):
    """Applied, they do no harm: the map is made again."""
    ball.data.materials.append(bpy.data.materials.new("Marble"))
    unwrap.ensure(ball)
    modifier = ball.modifiers.new("Own Name", kind)
    for name, value in numbers.items():
        setattr(modifier, name, value)
    assert unwrap.copying_modifier(ball) == ("Own Name" if copies else "")
    bpy.context.view_layer.update()
    applied = bpy.data.meshes.new_from_object(ball.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    if copies:
        assert not unwrap.fits(applied)
    ball.modifiers.clear()
    ball.data = applied
    unwrap.ensure(ball)
    assert unwrap.fits(ball.data)


def test_a_lathe(unwrap, ball):
    """Its mesh has no faces before the modifier is applied."""
    profile = bpy.data.meshes.new("Profile")
    profile.from_pydata([(0.0, 0.0, -1.0), (0.7, 0.0, 0.0), (0.0, 0.0, 1.0)], [(0, 1), (1, 2)], [])
    ball.data = profile
    ball.modifiers.new("Lathe", "SCREW")
    assert unwrap.copying_modifier(ball) == "Lathe"
    bpy.context.view_layer.update()
    applied = bpy.data.meshes.new_from_object(ball.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    ball.modifiers.clear()
    ball.data = applied
    unwrap.ensure(ball)
    assert len(applied.polygons) == 32 and unwrap.fits(applied)


def test_an_inner_side_with_a_material_of_its_own(unwrap, ball):
    for name in ("Outside", "Inside"):
        ball.data.materials.append(bpy.data.materials.new(name))
    ball.modifiers.new("Shell", "SOLIDIFY").material_offset = 1
    assert unwrap.copying_modifier(ball) == ""


def test_an_object_that_is_hidden_in_renders(unwrap, ball):
    """It is read as the viewport shows it."""
    modifier = ball.modifiers.new("Mirror", "MIRROR")
    modifier.show_render, ball.hide_render = False, True
    assert unwrap.copying_modifier(ball) == "Mirror"
    modifier.show_viewport = False
    assert unwrap.copying_modifier(ball) == ""
