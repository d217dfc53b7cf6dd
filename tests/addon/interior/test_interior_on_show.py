# SPDX-License-Identifier: GPL-3.0-or-later
"""The interior beside the other nodes of its material: which result the panels tell of, what is restored, and how an
interior is removed."""

from types import SimpleNamespace

import bpy
import pytest
from addon_helpers import drawn, icosphere, linked, surface_source

UNLINKED = "Not connected to the output"
REMOVE = "Remove Lamina from Material"


@pytest.fixture
def ball(addon):
    """A ball of 10 mm of marble under a grey sky, with few voxels and texels."""
    mesh = icosphere("Ball", 0.01)
    obj = linked("Ball", mesh)
    mesh.materials.append(bpy.data.materials.new("Marble"))
    addon.nodes.node_tree.of(obj.active_material)
    settings = obj.active_material.lamina.interior
    settings.resolution, settings.size, settings.noise = 8, 8, 50.0
    bpy.context.scene.world = bpy.data.worlds.new("Sky")
    bpy.context.view_layer.objects.active = obj
    return obj


@pytest.fixture
def layered(addon, lamina, ball):
    """The ball with layers of marble as well."""
    addon.editing.stack_io.assign_stack(ball.active_material, lamina.presets.load("marble-honed"))
    ball.active_material.lamina.quality = "preview"
    return ball


def make(jobs, obj, output):
    obj.active_material.lamina.interior.output = output
    bpy.context.view_layer.update()
    jobs.make(bpy.context, obj, obj.active_material)


def panel(name, obj):
    """What a panel draws for the object."""
    from importlib import import_module

    ui = "bl_ext.user_default.lamina.ui"
    draw = {"interior": import_module(f"{ui}.interior_fields").draw,
            "lateral": import_module(f"{ui}.depth_panel")._draw_soft}[name]
    context = SimpleNamespace(
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)), region=SimpleNamespace(width=3000),
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get, object=obj, material=obj.active_material,
        scene=bpy.context.scene, view_layer=bpy.context.view_layer,
    )  # fmt: skip
    return drawn(lambda layout: draw(context, layout))


def begins(lines, words):
    return any(line.startswith(words) for line in lines)


def sampling(obj):
    return obj.active_material.cycles.emission_sampling


def by_relightable(jobs, addon, obj, call):
    make(jobs, obj, "RELIGHTABLE")


def by_lateral(jobs, addon, obj, call):
    addon.baking.lateral_job.make(obj.active_material, bpy.context.scene)


def by_bake(jobs, addon, obj, call):
    addon.baking.bake_job.bake_material(obj.active_material, quality="preview")


def by_removal(jobs, addon, obj, call):
    assert call(bpy.ops.lamina.remove_stack, obj.active_material) == {"FINISHED"}


@pytest.mark.parametrize("change", [by_relightable, by_lateral, by_bake, by_removal])
def test_emission_sampling_is_restored(jobs, addon, layered, call, change):
    layered.active_material.cycles.emission_sampling = "FRONT_BACK"
    for _ in range(2):
        make(jobs, layered, "LIT")
        assert sampling(layered) == "NONE"
    change(jobs, addon, layered, call)
    assert sampling(layered) == "FRONT_BACK"


def test_a_later_choice_of_emission_sampling_stays(jobs, ball):
    make(jobs, ball, "LIT")
    ball.active_material.cycles.emission_sampling = "BACK"
    make(jobs, ball, "RELIGHTABLE")
    assert sampling(ball) == "BACK"


@pytest.mark.parametrize("way", ["operator", "function"])
def test_remove_from_a_material_without_layers(jobs, addon, ball, call, way):
    """An interior alone can be removed, from the panel as well."""
    material = ball.active_material
    assert not _can(material) and REMOVE not in panel("interior", ball)
    make(jobs, ball, "LIT")
    assert REMOVE in panel("interior", ball) and _can(material)
    if way == "operator":
        assert call(bpy.ops.lamina.remove_stack, material) == {"FINISHED"}
    else:
        addon.editing.layer_list.remove_stack(material)
    assert surface_source(material).type == "BSDF_PRINCIPLED" and material.lamina.lateral_group is None
    assert not [image for image in bpy.data.images if image.name.startswith("Lamina")]
    assert REMOVE not in panel("interior", ball) and not _can(material)


def _can(material):
    with bpy.context.temp_override(material=material):
        return bpy.ops.lamina.remove_stack.poll()


def test_no_removal_while_light_is_computed(jobs, layered):
    assert _can(layered.active_material)
    job = jobs.start(bpy.context, layered, layered.active_material)
    assert not _can(layered.active_material)
    job.cancel()
    job.wait()
    jobs.forget()
    assert _can(layered.active_material)


def test_the_panel_says_what_has_changed(jobs, ball):
    make(jobs, ball, "LIT")
    assert not begins(panel("interior", ball), "The settings") and begins(panel("interior", ball), "Light: ")
    ball.active_material.lamina.interior.size = 16
    assert "The settings have changed since: compute again" in panel("interior", ball)


def test_only_nodes_choose_the_texture(jobs, ball):
    settings = ball.active_material.lamina.interior
    settings.node, settings.socket = "Noise Texture", "Color"
    make(jobs, ball, "RELIGHTABLE")
    assert (settings.node, settings.socket) == ("Noise Texture", "Color")


def test_interior_and_lateral_replace_one_another(jobs, addon, layered, call):
    """The panels tell of the result on show only."""
    material = layered.active_material
    by_lateral(jobs, addon, layered, call)
    assert begins(panel("lateral", layered), "Subsurface")
    make(jobs, layered, "LIT")
    assert not begins(panel("lateral", layered), "Subsurface") and begins(panel("interior", layered), "Light: ")
    by_lateral(jobs, addon, layered, call)
    assert begins(panel("lateral", layered), "Subsurface") and not begins(panel("interior", layered), "Light: ")
    assert material.lamina.interior.made_from == ""


def test_a_portal_is_gone_with_its_warning(jobs, addon, layered, call):
    layered.active_material.lamina.lateral = "PORTAL"
    layered.scale = (0.1,) * 3
    bpy.context.view_layer.update()
    by_lateral(jobs, addon, layered, call)
    assert any("thick in thin parts" in line for line in panel("lateral", layered))
    make(jobs, layered, "RELIGHTABLE")
    assert not any("thick in thin parts" in line for line in panel("lateral", layered))


@pytest.mark.parametrize(("name", "words"), [("interior", "Colors and radii: "), ("lateral", "Subsurface")])
def test_a_bake_takes_the_output(jobs, addon, layered, call, name, words):
    (by_lateral if name == "lateral" else by_relightable)(jobs, addon, layered, call)
    assert begins(panel(name, layered), words) and UNLINKED not in panel(name, layered)
    by_bake(jobs, addon, layered, call)
    assert not begins(panel(name, layered), words) and UNLINKED in panel(name, layered)


def test_lateral_is_out_of_date(jobs, addon, layered, call):
    material = layered.active_material
    by_lateral(jobs, addon, layered, call)
    assert not begins(panel("lateral", layered), "Out of date")
    material.lamina.layers[0].name = "Renamed"
    assert not begins(panel("lateral", layered), "Out of date")
    material.lamina.lateral = "PORTAL"
    assert "Out of date: computed with output Mean Distance instead of Full Profile" in panel("lateral", layered)
    material.lamina.lateral = "RELIGHTABLE"
    material.lamina.layers[0].alpha += 0.1
    assert "Out of date: the layers have changed" in panel("lateral", layered)


def test_lit_needs_light(jobs, ball):
    bpy.context.scene.world = None
    with pytest.raises(ValueError, match="nothing lights Ball: add a lamp or a world"):
        make(jobs, ball, "LIT")
    make(jobs, ball, "RELIGHTABLE")


def test_a_copy_in_no_scene_does_not_count(jobs, ball):
    copy = ball.copy()
    copy.use_fake_user = True
    assert jobs.problem(ball, ball.active_material) == ""
    bpy.context.scene.collection.objects.link(copy)
    assert jobs.problem(ball, ball.active_material).startswith("Marble is also on Ball.001")


def test_a_modifier_that_copies_the_map(jobs, ball):
    """No unwrap helps: the refusal comes before the work, and no UV map is made."""
    ball.modifiers.new("Twice", "MIRROR").use_axis[0] = True
    with pytest.raises(ValueError, match="the modifier Twice makes faces"):
        make(jobs, ball, "RELIGHTABLE")
    assert not ball.data.uv_layers
