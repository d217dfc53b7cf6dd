# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust on many objects at once: layers, bakes, settling, and their removal."""

import importlib
import itertools

import bpy
import numpy as np
import pytest
import serialised_tree

pytestmark = pytest.mark.usefixtures("equal_bakes_once")


@pytest.fixture
def dusting(addon, dust):
    return importlib.import_module(f"{addon.__package__}.scene.dusting")


def new_object(name, place, material=None, mesh=None):
    if mesh is None:
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=place)
        obj = bpy.context.object
    else:
        obj = bpy.data.objects.new(name, mesh)
        bpy.context.collection.objects.link(obj)
        obj.location = place
    obj.name = name
    if material is not None:
        obj.data.materials.append(material)
    return obj


def new_material(addon, name, color):
    material = bpy.data.materials.new(name)
    addon.nodes.node_tree.of(material).nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1.0)
    return material


@pytest.fixture
def scene(addon, dusting):
    """Two red cubes with one material, a blue one, and one without a material, under a roof: the last."""
    red, blue = new_material(addon, "Red", (0.8, 0.1, 0.1)), new_material(addon, "Blue", (0.1, 0.1, 0.8))
    objects = [new_object("A", (0, 0, 0), red), new_object("B", (3, 0, 0), red), new_object("C", (6, 0, 0), blue),
               new_object("Plain", (9, 0, 0))]
    bpy.context.view_layer.update()
    return objects


def top(obj):
    """The mean dust on the faces that look up."""
    attribute = obj.data.attributes["lamina_dust"]
    values = np.empty(len(attribute.data), np.float32)
    attribute.data.foreach_get("value", values)
    if attribute.domain == "POINT":
        return values.max()
    loops = [k for face in obj.data.polygons if face.normal.z > 0.9 for k in face.loop_indices]
    return values[loops].mean()


def test_curves_are_named(dusting, scene):
    curve = bpy.data.objects.new("Wire", bpy.data.curves.new("Wire", "CURVE"))
    bpy.context.scene.collection.objects.link(curve)
    done = dusting.dust(bpy.context, [scene[2], curve])
    assert str(done) == "Dust lies on 1 object; 1 bake; Wire is no mesh, and holds no dust" and not done.notes
    with pytest.raises(ValueError, match="Wire is no mesh: convert it"):
        dusting.dust(bpy.context, [curve])


def test_dust_on_all_objects_and_back(addon, dusting, scene):
    before = {one.name: serialised_tree.of_material(one) for one in bpy.data.materials}
    said = []
    done = dusting.dust(bpy.context, scene, progress=lambda share, text="": said.append(share))
    assert [obj.name for obj in done.objects] == ["A", "B", "C", "Plain"] and done.bakes == 3 and not done.notes
    assert str(done) == "Dust lies on 4 objects; 3 bakes"
    assert all(later >= earlier - 1e-12 for earlier, later in itertools.pairwise(said)) and said[-1] == 1.0
    for obj in scene:
        material = obj.material_slots[0].material
        assert addon.baking.bake_job.state(material) == "fresh"
        assert addon.nodes.thickness.wiring(material).source == "attribute"
        assert top(obj) == pytest.approx(1.0, rel=0.05), "the usual amount lies on the top"
    assert scene[0].material_slots[0].material == scene[1].material_slots[0].material
    assert dusting.remove(scene) == 4
    assert {one.name: serialised_tree.of_material(one) for one in bpy.data.materials} == before
    assert not any("lamina_dust" in obj.data.attributes for obj in scene)
    assert scene[3].material_slots[0].material is None and not bpy.data.node_groups


def test_all_dust_has_one_strength(addon, dusting, scene):
    dusting.dust(bpy.context, scene)
    strength = addon.nodes.dust_strength.socket()
    assert strength.default_value == 1.0
    groups = [one for one in bpy.data.node_groups if "lamina_dust_strength" in one]
    details = [one for one in bpy.data.node_groups if "lamina_dust_detail" in one]
    assert len(groups) == len(details) == 1 and groups[0].users == 1
    assert all(addon.nodes.detail_wiring.detail(obj.material_slots[0].material).node_tree == details[0]
               for obj in scene)


def test_a_second_time_bakes_nothing(dusting, scene):
    dusting.dust(bpy.context, scene)
    scene[0].lamina_dust.amount = 0.5
    done = dusting.dust(bpy.context, scene[:2])
    assert done.bakes == 0 and top(scene[0]) == pytest.approx(0.5, rel=0.05)


def test_layers_that_are_there_already(addon, dusting, scene):
    varnished = scene[2].material_slots[0].material
    addon.editing.over_material.add(varnished)
    varnished.lamina.layers[0].name = "Varnish"
    addon.baking.bake_job.bake_material(varnished)
    dusting.dust(bpy.context, [scene[2]])
    assert [layer.name for layer in varnished.lamina.layers] == ["Dust", "Varnish"]
    assert varnished.lamina.layers[0].varying and top(scene[2]) == pytest.approx(1.0, rel=0.05)
    dusting.remove([scene[2]])
    assert [layer.name for layer in varnished.lamina.layers] == ["Varnish"]
    assert "lamina_rest" not in scene[2].data.attributes
    assert addon.baking.bake_job.state(varnished) == "fresh"


def test_layers_that_the_artist_adds_or_renames_afterwards(addon, dusting, scene):
    """Remove takes the layer that Dust has added, under any name, and no other one."""
    dusting.dust(bpy.context, scene[2:3])
    blue = scene[2].material_slots[0].material
    addon.editing.layer_list.duplicate_layer(blue)
    addon.editing.layer_list.add_layer(blue, "interface").name = "My varnish"
    blue.lamina.layers[0].name = "Pollen"
    dusting.remove(scene[2:3])
    assert [layer.name for layer in blue.lamina.layers] == ["My varnish", "Dust.001"]
    assert addon.baking.bake_job.state(blue) == "fresh"
    addon.editing.layer_list.remove_stack(blue)
    dusting.dust(bpy.context, scene[2:3])
    blue.lamina.layers[0].name = "Pollen"
    dusting.remove(scene[2:3])
    assert not blue.lamina.enabled


def test_layers_that_cannot_be_baked_after_the_removal_are_told(addon, dusting, scene, capfd):
    red, blue = (scene[k].material_slots[0].material for k in (0, 2))
    dusting.dust(bpy.context, scene)
    for layer in (addon.editing.layer_list.add_layer(red), addon.editing.layer_list.add_layer(blue)):
        layer.kind = "film"  # films lie on metals alone
    assert bpy.ops.lamina.dust_objects_remove(which="SCENE") == {"FINISHED"}
    assert not any(obj.lamina_dust.told for obj in scene)
    said = capfd.readouterr().out
    assert "Warning: Dust removed from 4 objects; Red: " in said and "; Blue: " in said
    for material in (red, blue):
        assert [layer.kind for layer in material.lamina.layers] == ["film"] and dusting.MARK not in material


def _rename(material, _other):
    material.name = "Hero paint"


def _edit(material, _other):
    material.node_tree.nodes.new("ShaderNodeTexNoise")


def _color(material, _other):
    node = next(one for one in material.node_tree.nodes if one.type == "BSDF_PRINCIPLED")
    node.inputs["Base Color"].default_value = (1.0, 0.0, 0.0, 1.0)


def _give(material, other):
    other.data.materials.append(material)


@pytest.mark.parametrize("change", [_rename, _edit, _color, _give])
def test_a_new_material_that_the_artist_uses_stays(dusting, scene, change):
    dusting.dust(bpy.context, scene[3:])
    new = scene[3].material_slots[0].material
    other = new_object("Other", (12, 0, 0))
    change(new, other)
    dusting.remove([scene[3], other])
    assert scene[3].material_slots[0].material == new and not new.lamina.enabled
    assert dusting.MARK not in new


@pytest.mark.parametrize("grain", [True, False])
def test_the_artists_own_even_layer_is_even_again(addon, dusting, scene, grain):
    blue, nodes = scene[2].material_slots[0].material, addon.nodes
    addon.editing.over_material.add(blue)
    blue.lamina.layers[0].varying = True
    addon.baking.bake_job.bake_material(blue)
    nodes.thickness.wiring(blue).socket.default_value = 0.25
    if grain:
        nodes.detail_wiring.add_detail(blue)
    dusting.dust(bpy.context, scene[2:3])
    dusting.dust(bpy.context, scene[2:3])
    assert nodes.thickness.wiring(blue).source == "attribute"
    dusting.remove(scene[2:3])
    now = nodes.thickness.wiring(blue)
    assert (now.source, now.socket.default_value) == ("value", 0.25)
    assert (nodes.detail_wiring.detail(blue) is not None) == grain, "the layer has the grain that it had"
    assert ("lamina_rest" in scene[2].data.attributes) == grain, "grain needs the coordinates"


def test_a_material_that_other_dusty_objects_share_keeps_its_layer(dusting, scene):
    dusting.dust(bpy.context, scene)
    assert dusting.remove([scene[0]]) == 1
    red = scene[1].material_slots[0].material
    assert red.lamina.enabled and "lamina_dust" in scene[1].data.attributes
    dusting.remove([scene[1]])
    assert not red.lamina.enabled


def test_what_gets_no_dust_is_told_and_the_others_go_on(addon, dusting, scene):
    red = scene[0].material_slots[0].material
    red.node_tree.nodes.clear()
    empty = new_object("Empty", (0, 5, 0), mesh=bpy.data.meshes.new("Empty"))
    done = dusting.dust(bpy.context, [*scene, empty, bpy.data.objects.new("Light", bpy.data.lights.new("L", "SUN"))])
    assert done.notes == ["Red: No shader is linked to the Surface of the material output"]
    assert len(done.objects) == 4 and not red.lamina.enabled
    with pytest.raises(addon.base.messages.RefusedError, match="There is no mesh object for dust to settle on"):
        dusting.dust(bpy.context, [empty])


def test_materials_get_a_layer_only_where_dust_settles(addon, dusting, scene):
    """A layer without its dust would be as thick everywhere as it can be."""
    scene[2].data.vertices[0].co.x = float("nan")
    scene[3].lamina_dust.others = False
    done = dusting.dust(bpy.context, scene[2:])
    assert [obj.name for obj in done.objects] == ["Plain"] and len(done.notes) == 1
    blue = scene[2].material_slots[0].material
    assert not blue.lamina.enabled and scene[3].material_slots[0].material.lamina.enabled
    with pytest.raises(addon.base.messages.RefusedError, match=r"^C: "):
        dusting.dust(bpy.context, scene[2:3])
    assert not blue.lamina.enabled
    for obj in scene:
        obj.select_set(obj == scene[0])
    with pytest.raises(RuntimeError, match=r"Error: A: C\.vertices"):
        bpy.ops.lamina.dust_objects()


def test_a_coarse_cage_of_a_subdivided_object_gets_an_image(dusting, scene):
    scene[2].modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    scene[0].modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    for obj in scene:
        obj.lamina_dust.size = 64
    done = dusting.dust(bpy.context, scene)
    assert scene[2].lamina_dust.target == "image" and scene[2].lamina_dust.image is not None
    assert scene[0].lamina_dust.target == "attribute", "its material is shared"
    assert len(done.objects) == 4


def test_a_duplicate_that_shares_the_material_of_dust_in_an_image(addon, dusting, scene):
    """Both get attributes, because a material reads one image; until then the panel tells."""
    original = scene[2]
    original.modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    original.lamina_dust.size = 64
    dusting.dust(bpy.context, [original])
    blue, mismatch = original.material_slots[0].material, addon.ui.settled_fields.mismatch
    assert original.lamina_dust.target == "image" and mismatch(blue, original.lamina_dust) == ""
    twin = original.copy()
    twin.data = original.data.copy()
    bpy.context.collection.objects.link(twin)
    dusting.object_dust.settle(bpy.context, twin)
    assert "the image C.001 dust in place of this object's dust" in mismatch(blue, original.lamina_dust)
    assert mismatch(blue, twin.lamina_dust) == ""
    dusting.dust(bpy.context, [original, twin])
    for obj in (original, twin):
        assert obj.lamina_dust.target == "attribute" and mismatch(blue, obj.lamina_dust) == ""


def test_the_operators(addon, dusting, scene, call):
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in scene[:2])
    assert bpy.ops.lamina.dust_objects() == {"FINISHED"}
    assert [obj.name for obj in scene if obj.lamina_dust.told] == ["A", "B"]
    assert bpy.ops.lamina.dust_objects(which="SCENE") == {"FINISHED"}
    assert all(obj.lamina_dust.told for obj in scene)
    assert bpy.ops.lamina.dust_objects_remove(which="SCENE") == {"FINISHED"}
    assert not any(obj.lamina_dust.told for obj in scene)
    scene[0].hide_render = True
    inner = bpy.data.collections.new("Inner")
    bpy.context.scene.collection.children.link(inner)
    inner.objects.link(scene[1])
    bpy.context.view_layer.active_layer_collection = bpy.context.view_layer.layer_collection.children["Inner"]
    bpy.ops.lamina.dust_objects(which="COLLECTION")
    assert [obj.name for obj in scene if obj.lamina_dust.told] == ["B"]


def test_objects_that_renders_show(addon, dusting, scene):
    """Collections may be off in renders, or excluded from the view layer, too."""
    root = bpy.context.scene.collection
    for obj, name in zip(scene[:2], ("Off", "Excluded"), strict=True):
        bpy.context.collection.objects.unlink(obj)
        outer, inner = bpy.data.collections.new(name), bpy.data.collections.new(f"{name} inside")
        root.children.link(outer)
        outer.children.link(inner)
        inner.objects.link(obj)
    bpy.data.collections["Off"].hide_render = True
    bpy.context.view_layer.layer_collection.children["Excluded"].exclude = True
    scene[3].hide_render = True
    assert addon.operators.dust.objects_of(bpy.context, "SCENE") == scene[2:3]
    assert addon.command_line.selection.objects([]) == scene[2:3]
    assert addon.command_line.selection.objects(["A"]) == scene[:1], "by name"


def test_a_cancel_changes_nothing(lamina, dusting, scene, known_tables):
    known_tables.clear()  # bakes ask whether they are canceled
    scene[2].modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    scene[2].data.uv_layers.remove(scene[2].data.uv_layers[0])
    before = {**serialised_tree.of_file(), "images": []}  # reading the scene makes a Render Result
    with pytest.raises(lamina.Cancelled):
        dusting.dust(bpy.context, scene, cancel=iter([False] * 3 + [True] * 1000).__next__)
    job = dusting.start(bpy.context, scene)
    job.cancel()
    job.wait()
    assert job.finish() is None
    dusting.dust_job.forget()
    assert {**serialised_tree.of_file(), "images": []} == before
    assert not any(one.lamina.enabled for one in bpy.data.materials) and len(bpy.data.materials) == 2
    assert scene[2].lamina_dust.target == "attribute" and not scene[2].data.uv_layers


def test_objects_without_a_material_share_a_new_one_and_so_get_attributes(addon, dusting, scene):
    """One material cannot read the images of several objects."""
    bare = [scene[3], new_object("Other", (12, 0, 0))]
    for obj in bare:
        obj.modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    dusting.dust(bpy.context, bare)
    assert bare[0].material_slots[0].material == bare[1].material_slots[0].material
    for obj in bare:
        assert obj.lamina_dust.target == "attribute" and top(obj) > 0.0
        assert addon.ui.settled_fields.mismatch(obj.material_slots[0].material, obj.lamina_dust) == ""


@pytest.mark.parametrize("target", ["attribute", "image"])
def test_another_object_with_the_mesh_gets_no_material(dusting, scene, target):
    obj = scene[3]
    twin = new_object("Twin", (12, 0, 0), mesh=obj.data)
    obj.lamina_dust.target, obj.lamina_dust.size = target, 64
    dusting.dust(bpy.context, [obj])
    assert obj.material_slots[0].material is not None and not twin.material_slots
    dusting.remove([obj])
    assert not bpy.data.materials.get("Material") and not twin.material_slots


def test_a_mesh_that_is_being_edited_at_the_end_keeps_its_material(addon, dusting, scene):
    job = dusting.start(bpy.context, scene[1:3])
    job.wait(60.0)
    addon.settling.dust_job.forget()
    bpy.context.view_layer.objects.active = scene[2]
    bpy.ops.object.mode_set(mode="EDIT")
    done = job.finish()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert done.objects == [scene[1]] and "C is being edited: leave Edit Mode" in done.notes
    assert scene[1].active_material.lamina.enabled and not scene[2].active_material.lamina.enabled


def test_an_object_that_only_shares_the_material_keeps_no_rest_coordinates(dusting, scene):
    dusting.dust(bpy.context, scene[:1])
    assert "lamina_rest" in scene[1].data.attributes and not scene[1].lamina_dust.told
    dusting.remove(scene)
    assert not any("lamina_rest" in obj.data.attributes for obj in scene)


def test_a_duplicate_that_hides_the_dust_of_its_original_tells_so(dusting, scene):
    original = scene[2]
    original.modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    original.lamina_dust.size = 64
    assert not dusting.dust(bpy.context, [original]).notes and original.lamina_dust.image
    twin = original.copy()
    twin.data = original.data.copy()
    bpy.context.collection.objects.link(twin)
    said = "C no longer shows its dust, because it shares Blue: dust both together"
    assert dusting.dust(bpy.context, [twin]).notes == [said]
    assert not dusting.dust(bpy.context, [original, twin]).notes


def test_a_refusal_names_the_object_once(addon, dusting, scene):
    scene[0].scale = (0.0, 0.0, 0.0)
    with pytest.raises(addon.base.messages.RefusedError, match="^A is 0 m large"):
        dusting.dust(bpy.context, scene[:1])
