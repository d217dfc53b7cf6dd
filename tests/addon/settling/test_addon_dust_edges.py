# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust at hard edges: each face has the dust for its own normal, stored by face corner where necessary."""

import math

import bmesh
import bpy
import numpy as np
import pytest
from addon_helpers import pixels
from dusty_objects import NAME, alone, ball, cube, grid

UP = (0.0, 0.0, 1.0)


def cylinder(smooth=False, sides=32):
    return alone("Cylinder", lambda bm: bmesh.ops.create_cone(
        bm, cap_ends=True, segments=sides, radius1=1.0, radius2=1.0, depth=2.0), smooth)


def bevelled():
    def build(bm):
        bmesh.ops.create_cube(bm, size=2.0)
        bmesh.ops.bevel(bm, geom=[*bm.edges, *bm.verts], offset=0.1, segments=2, profile=0.5, affect="EDGES")

    return alone("Bevelled", build)


def attribute(mesh, domain):
    found = mesh.attributes[NAME]
    assert (found.data_type, found.domain) == ("FLOAT", domain)
    values = np.empty(len(found.data), np.float32)
    found.data.foreach_get("value", values)
    return values


def on_faces(mesh, wanted):
    """Values of the corners of all faces whose normal is near `wanted`."""
    domain = mesh.attributes[NAME].domain
    values, chosen = attribute(mesh, domain), []
    for polygon in mesh.polygons:
        if polygon.normal.dot(wanted) > 0.999:
            chosen += [values[loop if domain == "CORNER" else mesh.loops[loop].vertex_index]
                       for loop in polygon.loop_indices]
    assert chosen
    return np.array(chosen)


def rendered(obj):
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data


OPEN_TOPS = {
    "default cube": cube,
    "table top": lambda: cube("Table", (3.0, 2.0, 0.05)),
    "cylinder": cylinder,
    "bevelled": bevelled,
}


@pytest.mark.parametrize("name", OPEN_TOPS)
def test_the_top_has_the_amount(dust, name):
    obj = OPEN_TOPS[name]()
    dust.settle(bpy.context, obj)
    assert np.allclose(on_faces(obj.data, UP), 1.0, rtol=1e-5)
    assert np.allclose(on_faces(obj.data, (0.0, 0.0, -1.0)), 0.0)
    assert attribute(obj.data, "CORNER").size == len(obj.data.loops)
    assert "mesh is coarse" not in obj.lamina_dust.told


def test_a_side_has_what_slides_not_off(dust):
    """The wall of a cube is hit by grains from the flank of the cone. They slide off because of its slope, except for
    the share that concavity keeps. With an angle of repose of 180 degrees all stay: the mean of max(0, n.d) over the
    cone.
    """
    obj = cube()
    obj.lamina_dust.repose, obj.lamina_dust.rays = math.pi, 1024
    dust.settle(bpy.context, obj)
    spread = obj.lamina_dust.spread
    # (1 / pi) of the mean of tan(theta), over the density 2 sin cos / sin^2 s.
    truth = (spread - math.sin(spread) * math.cos(spread)) / math.sin(spread) ** 2 / math.pi
    assert np.allclose(on_faces(obj.data, (1.0, 0.0, 0.0)), truth, rtol=0.03)


def groove(slope=50.0):
    """Walls of `slope` degrees; the bottom line's vertices are at its ends and in its middle."""
    height = math.tan(math.radians(slope))

    def build(bm):
        rows = [[bm.verts.new((x, y, abs(x) * height)) for x in (-1.0, 0.0, 1.0)] for y in (-20.0, 0.0, 20.0)]
        for first, second in zip(rows, rows[1:], strict=False):
            for k in range(2):
                bm.faces.new((first[k], first[k + 1], second[k + 1], second[k]))

    return alone("Groove", build)


def test_the_bottom_of_a_groove(dust):
    """The dust of each wall: n.up = cos 50 arrives; by the cubic at (50 - 45) / 20 + 1/2 = .75, the share .156 of it
    does not slide. Of the rest, concavity keeps one half of the share of the cosine-weighted hemisphere that the other
    wall hides: (1 + cos 80) / 2 in the middle, between this and half of it at the ends. The other wall stops no grain
    of a cone of 35 degrees, because it begins 40 degrees off the vertical.
    """
    obj = groove()
    obj.lamina_dust.rays = 4096
    dust.settle(bpy.context, obj)
    arrived, lying = math.cos(math.radians(50.0)), 1.0 - 0.75**2 * (3.0 - 1.5)
    hidden = 0.5 * (1.0 + math.cos(math.radians(80.0)))
    middle, end = (arrived * (lying + (1.0 - lying) * 0.5 * share) for share in (hidden, 0.5 * hidden))
    values = attribute(obj.data, "CORNER")
    for loop, value in zip(obj.data.loops, values, strict=True):
        place = obj.data.vertices[loop.vertex_index].co
        if place.x == 0.0:
            if place.y == 0.0:
                assert value == pytest.approx(middle, abs=0.006)
            else:
                assert end + 0.02 < value < middle - 0.02


def test_sharp_edges_and_custom_normals_are_the_meshs_own(dust):
    smooth, sharp, custom = cylinder(smooth=True), cylinder(smooth=True), cylinder(smooth=True)
    for edge in sharp.data.edges:
        ends = [sharp.data.vertices[vertex].co for vertex in edge.vertices]
        edge.use_edge_sharp = abs(ends[0].z - ends[1].z) < 1e-6
    mesh = custom.data
    normals = [UP if polygon.normal.z > 0.9 else tuple(polygon.normal)
               for polygon in mesh.polygons for _ in polygon.loop_indices]
    mesh.normals_split_custom_set(normals)
    for obj in (smooth, sharp, custom):
        dust.settle(bpy.context, obj)
    # As shaded: at 45 degrees of the rim.
    assert attribute(smooth.data, "POINT").max() < 0.9
    assert np.allclose(on_faces(sharp.data, UP), 1.0, rtol=1e-5)
    assert np.allclose(on_faces(custom.data, UP), 1.0, rtol=1e-3)
    # The side is smooth around: one value a vertex there.
    by_vertex = {}
    values = attribute(sharp.data, "CORNER")
    for polygon in sharp.data.polygons:
        for loop in polygon.loop_indices if abs(polygon.normal.z) < 0.1 else ():
            by_vertex.setdefault(sharp.data.loops[loop].vertex_index, set()).add(float(values[loop]))
    assert all(len(found) == 1 for found in by_vertex.values())


def test_smooth_and_flat_meshes_have_a_value_a_vertex(dust):
    for obj in (ball(smooth=True), grid()):
        dust.settle(bpy.context, obj)
        attribute(obj.data, "POINT")


def test_a_mesh_may_change_from_one_kind_to_the_other(dust):
    obj = cube()
    for smooth, domain in ((False, "CORNER"), (True, "POINT"), (False, "CORNER")):
        for polygon in obj.data.polygons:
            polygon.use_smooth = smooth
        dust.settle(bpy.context, obj)
        attribute(obj.data, domain)
    with bpy.context.temp_override(object=obj):
        assert bpy.ops.lamina.dust_clear() == {"FINISHED"}
    assert NAME not in obj.data.attributes


MODIFIERS = {
    "subdivided flat": ("SUBSURF", {"subdivision_type": "SIMPLE", "levels": 2}),
    "bevelled": ("BEVEL", {"width": 0.1, "segments": 2}),
    "solid": ("SOLIDIFY", {"thickness": 0.05, "offset": -1.0}),
    "triangles": ("TRIANGULATE", {}),
}


@pytest.mark.parametrize("name", MODIFIERS)
@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-1.0, 1.0, 2.0)], ids=["plain", "mirrored"])
def test_modifiers_carry_it(dust, name, scale):
    obj = cube()
    obj.scale = scale
    kind, settings = MODIFIERS[name]
    modifier = obj.modifiers.new("Any", kind)
    for key, value in settings.items():
        setattr(modifier, key, value)
    dust.settle(bpy.context, obj)
    assert np.allclose(on_faces(obj.data, UP), 1.0, rtol=1e-5)
    shown = rendered(obj)
    highest = max(vertex.co.z for vertex in shown.vertices)
    values = shown.attributes[NAME]
    assert values.domain == "CORNER"
    for polygon in shown.polygons:
        corners = [values.data[loop].value for loop in polygon.loop_indices]
        if polygon.normal.z > 0.999 and shown.vertices[polygon.vertices[0]].co.z > highest - 1e-4:
            assert np.allclose(corners, 1.0, rtol=1e-5)
        if polygon.normal.z < -0.999 and kind != "SOLIDIFY":
            assert np.allclose(corners, 0.0, atol=1e-5)


def test_the_border_of_a_solidified_plane(dust):
    plate = grid(cells=4)
    modifier = plate.modifiers.new("Solid", "SOLIDIFY")
    modifier.thickness = 0.05
    dust.settle(bpy.context, plate)
    assert np.allclose(attribute(plate.data, "POINT"), 1.0, rtol=1e-5)


def test_images_know_hard_edges(dust):
    obj = cube()
    layer = obj.data.uv_layers.new(name="UVMap")
    for polygon in obj.data.polygons:  # six squares in rows of three
        for place, loop in zip(((0, 0), (1, 0), (1, 1), (0, 1)), polygon.loop_indices, strict=True):
            layer.uv[loop].vector = ((polygon.index % 3 + place[0]) / 3.0, (polygon.index // 3 + place[1]) / 2.0)
    obj.lamina_dust.target, obj.lamina_dust.size = "image", 48
    dust.settle(bpy.context, obj)
    texels = pixels(obj.lamina_dust.image)[..., 0]
    for polygon in obj.data.polygons:
        row, column = 24 * (polygon.index // 3), 16 * (polygon.index % 3)
        inside = texels[row:row + 24, column:column + 16]
        if abs(polygon.normal.z) > 0.9:
            assert np.allclose(inside, max(0.0, polygon.normal.z), atol=1e-5)
        else:
            assert inside.max() < 0.01
