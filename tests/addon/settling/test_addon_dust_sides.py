# SPDX-License-Identifier: GPL-3.0-or-later
"""Planes without thickness, seen from both sides: dust is visible on its own side, and below a sheet by transmitted
light. Under a constant sky of radiance 1 the radiance is the reflectance plus the transmittance of the stack in the
view's direction.
"""

import math

import bpy
import numpy as np
import pytest
from dusty_objects import cube, grid
from rendered_plane import render

DUST = {"kind": "medium", "albedo": 0.9, "tau": 2.0, "varying": True, "phase": {"kind": "hg", "g": 0.3}}
LEAF = {"kind": "medium", "albedo": 0.5, "tau": 1.5, "phase": {"kind": "isotropic"}}
PAPER = {"kind": "medium", "albedo": 0.95, "tau": 1.5, "phase": {"kind": "isotropic"}}
STACKS = {
    "opaque": ([DUST], {"kind": "lambert", "reflectance": 0.05}),
    "leaf": ([DUST, LEAF], None),
    "leaf on paper": ([DUST, LEAF, PAPER], None),
}
MU = math.cos(math.radians(30.0))


def shown_by(addon, lamina, material, name):
    """The exact reflectance plus transmittance of a stack: function of the thickness of its dust and the side seen."""
    layers, base = STACKS[name]
    data = {"schema": 1, "layers": layers, "base": base}
    addon.editing.stack_io.assign_stack(material, lamina.Stack.from_json(data))
    material.lamina.quality = "preview"
    addon.baking.bake_job.bake_material(material)

    def exact(thickness, side):
        media = [lamina.Medium(albedo=one["albedo"], tau=thickness if one is DUST else one["tau"],
                               phase=lamina.HenyeyGreenstein(0.3) if one is DUST else lamina.Isotropic())
                 for one in layers]
        solved = lamina.solve(lamina.Stack(media, base=lamina.Lambert(0.05) if base else None))
        through = 0.0 if base else solved.transmittance(MU, side=side)
        return float(np.max(solved.reflectance(MU, side=side) + through))

    return exact


def scene(addon, below):
    made = bpy.context.scene
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", 0.5
    eye = bpy.data.objects.new("Camera", camera)
    tilt = math.radians(150.0 if below else 30.0)
    eye.location, eye.rotation_euler = (0.0, -5.0 * math.sin(tilt), 5.0 * math.cos(tilt)), (tilt, 0.0, 0.0)
    made.collection.objects.link(eye)
    made.camera = eye
    made.world = bpy.data.worlds.new("Sky")
    addon.nodes.node_tree.of(made.world).nodes["Background"].inputs[0].default_value = (1.0, 1.0, 1.0, 1.0)
    made.render.engine = "CYCLES"
    made.render.threads_mode, made.render.threads = "FIXED", 1
    made.render.resolution_x = made.render.resolution_y = 24
    made.render.resolution_percentage = 100
    made.render.image_settings.file_format, made.render.image_settings.color_depth = "OPEN_EXR", "32"
    made.cycles.samples, made.cycles.seed, made.cycles.max_bounces = 256, 0, 0
    made.cycles.use_denoising = made.cycles.use_adaptive_sampling = False


def seen(addon, tmp_path, below):
    scene(addon, below)
    return float(render(tmp_path / "seen.exr").reshape(-1, 4)[:, 1].mean())


def plane(material, turned):
    plate = grid(material=material)
    if turned:
        plate.data.flip_normals()
        plate.lamina_dust.two_sided = True
    return plate


@pytest.mark.parametrize("target", ["attribute", "image"])
@pytest.mark.parametrize("turned", [False, True], ids=["normals up", "normals down"])
@pytest.mark.parametrize("name", ["opaque", "leaf"])
def test_dust_shows_on_the_side_that_it_lies_on(dust, addon, lamina, material, tmp_path, name, turned, target):
    exact = shown_by(addon, lamina, material, name)
    plate = plane(material, turned)
    plate.lamina_dust.target, plate.lamina_dust.size = target, 16
    dust.settle(bpy.context, plate)
    assert addon.ui.settled_fields.mismatch(material, plate.lamina_dust) == ""
    addon.nodes.detail_wiring.remove_detail(material)  # reflectance is not linear in its noise
    above, below = exact(1.0, "top"), exact(1.0, "bottom") if name == "leaf" else 0.05
    assert abs(above - below) > 0.1, "the sides differ by more than the errors"
    # Each row of the table has energy errors up to .2 %; interpolation between rows and noise are of similar size.
    assert seen(addon, tmp_path, below=False) == pytest.approx(above, rel=0.015)
    assert seen(addon, tmp_path, below=True) == pytest.approx(below, rel=0.015)


@pytest.mark.parametrize("modifier", [None, "SUBSURF"])
def test_cycles_reads_dust_of_face_corners(dust, addon, lamina, material, tmp_path, modifier):
    exact = shown_by(addon, lamina, material, "opaque")
    body = cube()
    body.data.materials.append(material)
    body.location.z = -1.0
    if modifier:
        body.modifiers.new("Finer", modifier).subdivision_type = "SIMPLE"
    dust.settle(bpy.context, body)
    assert body.data.attributes["lamina_dust"].domain == "CORNER"
    addon.nodes.detail_wiring.remove_detail(material)  # its noise is not part of the settled dust
    assert seen(addon, tmp_path, below=False) == pytest.approx(exact(1.0, "top"), rel=0.015)
    body.location.z = 1.0
    assert seen(addon, tmp_path, below=True) == pytest.approx(0.05, rel=0.015)


def test_a_sheet_of_two_different_sides_is_not_turned_over(dust, addon, lamina, material, tmp_path):
    """If turned over, it would show its other colour; its table has dust on the front only."""
    exact = shown_by(addon, lamina, material, "leaf on paper")
    plate = plane(material, True)
    dust.settle(bpy.context, plate)
    assert "Flip the normals" in addon.ui.settled_fields.mismatch(material, plate.lamina_dust)
    assert seen(addon, tmp_path, below=False) == pytest.approx(exact(0.0, "bottom"), rel=0.015)
    assert seen(addon, tmp_path, below=True) == pytest.approx(exact(0.0, "top"), rel=0.015)


@pytest.mark.parametrize("below", [False, True], ids=["front", "back"])
def test_a_thickness_of_another_source_counts_for_both_sides(addon, lamina, material, tmp_path, below):
    exact = shown_by(addon, lamina, material, "opaque")
    plate = grid(material=material)
    plate.data.attributes.new("soot", "FLOAT", "POINT").data.foreach_set("value", [1.0] * len(plate.data.vertices))
    addon.nodes.thickness.wire_thickness(material, "attribute", "soot")
    assert seen(addon, tmp_path, below) == pytest.approx(exact(1.0, "top"), rel=0.015)
