# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the last result of an interior still fits: one sentence for each change, none for changes that do not
matter. Nothing is computed: the note is written as a computation writes it."""

import json

import bpy
import pytest
from addon_helpers import icosphere, linked


@pytest.fixture
def freshness(addon, lamina):
    from bl_ext.user_default.lamina.interior import freshness

    return freshness


@pytest.fixture
def ball(addon):
    mesh = icosphere("Ball", 1.0)
    mesh.materials.append(bpy.data.materials.new("Marble"))
    mesh.uv_layers.new(name="Own")
    obj = linked("Ball", mesh)
    obj.scale, obj.location = (0.01,) * 3, (1.0, 2.0, 3.0)
    return obj


def settings_of(obj):
    return obj.active_material.lamina.interior


def note(freshness, obj, node=(), has_image=False):
    bpy.context.view_layer.update()
    settings_of(obj).made_from = freshness.note(bpy.context, obj, obj.active_material, node, "Own", has_image)


def stale(freshness, obj):
    bpy.context.view_layer.update()
    return freshness.stale(bpy.context, obj, obj.active_material)


def chosen(name, value):
    def change(obj):
        setattr(settings_of(obj), name, value)

    return change


def another_end(obj):
    settings_of(obj).second.sigma_s = (1.0, 2.0, 3.0)


def scaled(obj):
    obj.scale = (0.02,) * 3


def edited(obj):
    obj.data.vertices[0].co *= 1.5
    obj.data.update()


def dented(obj):
    dent(obj, 0.1)


def dent(obj, margin):
    """A dent in a vertex further than `margin` from all sides of the box, which stays as it is."""
    low, high = obj.bound_box[0], obj.bound_box[6]
    inside = [one for one in obj.data.vertices
              if all(low[k] + margin < one.co[k] < high[k] - margin for k in range(3))]
    inside[0].co *= 0.8
    obj.data.update()


def subdivided(obj):
    mesh = icosphere("Other", 1.0)
    mesh.materials.append(obj.active_material)
    mesh.uv_layers.new(name="Own")
    mesh.vertices.add(1)
    obj.data = mesh


def displaced(obj):
    obj.modifiers.new("Thick", "DISPLACE").strength = 0.2


def without_map(obj):
    obj.data.uv_layers.remove(obj.data.uv_layers["Own"])


SETTINGS, SHAPE = "The settings have changed since: compute again", "The object has been scaled or edited since"


@pytest.mark.parametrize(("change", "words"), [
    (chosen("output", "LIT"), SETTINGS), (chosen("size", 64), SETTINGS), (chosen("ior", 1.4), SETTINGS),
    (chosen("roughness", 0.1), SETTINGS), (chosen("resolution", 64), SETTINGS), (chosen("spacing", 3.0), SETTINGS),
    (chosen("direction", (1.0, 0.0, 0.0)), SETTINGS), (chosen("uv_map", "Own"), SETTINGS),
    (chosen("source", "LAYERS"), SETTINGS), (another_end, SETTINGS),
    (scaled, SHAPE), (edited, SHAPE), (dented, SHAPE), (subdivided, SHAPE), (displaced, SHAPE),
    (without_map, "The UV map “Own” is gone: compute again"),
])  # fmt: skip
def test_changes_that_matter(freshness, ball, change, words):
    note(freshness, ball)
    assert stale(freshness, ball) == ""
    change(ball)
    assert stale(freshness, ball).startswith(words)


def renamed(obj):
    obj.name = "Other"


def moved(obj):
    obj.location.x += 5.0


@pytest.mark.parametrize("change", [
    renamed, moved, chosen("noise", 3.0), chosen("view", "CAMERA"), chosen("node", "Noise Texture"),
])  # fmt: skip
def test_changes_that_do_not_matter(freshness, ball, change):
    """To Relightable of a marble."""
    note(freshness, ball)
    change(ball)
    assert stale(freshness, ball) == ""


def test_a_dent_in_a_small_mesh(freshness, ball):
    """Of a mesh of a centimeter in meters, as many models are."""
    for vertex in ball.data.vertices:
        vertex.co *= 0.005
    ball.scale = (1.0,) * 3
    note(freshness, ball)
    assert stale(freshness, ball) == ""
    dent(ball, 0.0005)
    assert stale(freshness, ball).startswith(SHAPE)


def test_note_of_another_version(freshness, ball):
    """Settings that only one of the versions has do not count; the others do."""
    note(freshness, ball)
    settings = settings_of(ball)
    earlier = json.loads(settings.made_from)
    for values in (earlier["settings"], *earlier["settings"]["ends"]):
        values.pop("resolution" if "resolution" in values else "sigma_s")
        values["gone"] = 1.0
    settings.made_from = json.dumps(earlier)
    assert stale(freshness, ball) == ""
    settings.spacing = 3.0
    assert stale(freshness, ball).startswith(SETTINGS)


def test_layers(freshness, ball, addon):
    """Their names do not matter."""
    material = ball.active_material
    addon.editing.layer_list.add_stack(material)
    settings_of(ball).source = "LAYERS"
    note(freshness, ball)
    settings_of(ball).spacing, material.lamina.layers[0].name = 3.0, "Renamed"
    assert stale(freshness, ball) == ""
    material.lamina.base.reflectance = (0.1, 0.2, 0.3)
    assert stale(freshness, ball) == "The layers have changed since: compute again"


def test_other_materials(freshness, ball, addon):
    """What counts is which faces are opaque: not the name or the color of their material."""
    cap = bpy.data.materials.new("Cap")
    tree = addon.nodes.node_tree.of(cap)
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    note(freshness, ball)
    ball.data.materials.append(cap)
    assert stale(freshness, ball) == ""
    ball.data.polygons[0].material_index = 1
    words = "The materials of the object's faces have changed since: compute again"
    assert stale(freshness, ball) == words
    note(freshness, ball)
    cap.name, shader.inputs["Base Color"].default_value = "Lid", (0.1, 0.2, 0.3, 1.0)
    assert stale(freshness, ball) == ""
    shader.inputs["Transmission Weight"].default_value = 1.0
    assert stale(freshness, ball) == words
    note(freshness, ball)
    ball.data.polygons[1].material_index = 5  # drawn with the last slot
    assert stale(freshness, ball) == words


def test_node_texture(freshness, ball):
    settings_of(ball).source = "NODES"
    note(freshness, ball, ("Noise Texture", "Fac"))
    settings_of(ball).node, settings_of(ball).socket = "Noise Texture", "Fac"  # as after a computation
    assert stale(freshness, ball) == ""
    settings_of(ball).socket = "Color"
    assert stale(freshness, ball) == SETTINGS


def test_nodes_of_the_texture(freshness, ball, addon):
    """What they compute matters, not how they are called, where they stand and what else the material has."""
    tree = addon.nodes.node_tree.of(ball.active_material)
    ramp, noise = tree.nodes.new("ShaderNodeValToRGB"), tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs[0], ramp.inputs[0])
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree = bpy.data.node_groups.new("Turn", "ShaderNodeTree")
    inner = group.node_tree.nodes.new("ShaderNodeMapping")
    group.node_tree.interface.new_socket("Vector", in_out="OUTPUT", socket_type="NodeSocketVector")
    tree.links.new(group.outputs[0], noise.inputs["Vector"])
    settings_of(ball).source = "NODES"
    settings_of(ball).node, settings_of(ball).socket = ramp.name, "Color"

    def is_stale_after(change):
        note(freshness, ball, (ramp.name, "Color"))
        assert stale(freshness, ball) == ""
        change()
        return stale(freshness, ball) == SETTINGS

    def scale():
        noise.inputs["Scale"].default_value = 7.0

    def kind():
        noise.noise_dimensions = "2D"

    def position():
        ramp.color_ramp.elements[0].position = 0.3

    def inside():
        inner.inputs["Location"].default_value[0] = 2.0

    def links():
        tree.links.new(noise.outputs[1], ramp.inputs[0])

    def names():
        noise.name, noise.label, noise.location.x = "Clouds", "Clouds", 300.0

    def others():
        tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.1

    assert all(map(is_stale_after, (scale, kind, position, inside, links)))
    assert not any(map(is_stale_after, (names, others)))


@pytest.fixture
def lit(ball):
    """The ball with output Lit under the lamps Key and, by an instance of a collection, Far."""
    settings_of(ball).output = "LIT"
    linked("Key", bpy.data.lights.new("Key", "AREA")).location = (3.0, -4.0, 9.0)
    source = bpy.data.collections.new("Source")
    linked("Far", bpy.data.lights.new("Far", "POINT"), source)
    instance = linked("Instance")
    instance.instance_type, instance.instance_collection = "COLLECTION", source
    return ball


def put(name, place):
    def change(_obj):
        bpy.data.objects[name].location = place

    return change


def larger(_obj):
    bpy.data.lights["Key"].size = 2.0


def hidden(_obj):
    bpy.data.objects["Key"].hide_render = True


def removed(_obj):
    bpy.data.objects.remove(bpy.data.objects["Key"])


def collection_hidden(_obj):
    key, off = bpy.data.objects["Key"], bpy.data.collections.new("Off")
    bpy.context.scene.collection.children.link(off)
    off.objects.link(key)
    bpy.context.scene.collection.objects.unlink(key)
    off.hide_render = True


def added(_obj):
    linked("New", bpy.data.lights.new("New", "SUN"))


@pytest.mark.parametrize(("change", "words"), [
    (put("Key", (4.0, 0.0, 9.0)), "Key has moved or changed in size since: compute again"),
    (larger, "Key has moved or changed in size since"), (hidden, "Key no longer lights the object: compute again"),
    (removed, "Key no longer lights the object"), (collection_hidden, "Key no longer lights the object"),
    (added, "New lights the object now: compute again"),
    (put("Far", (1.0, 0.0, 0.0)), "Far of Instance has moved"),
    (put("Instance", (1.0, 0.0, 0.0)), "Far of Instance has moved"),
    (moved, "The object has moved against its lamps since: compute again"),
])  # fmt: skip
def test_lamps(freshness, lit, change, words):
    note(freshness, lit)
    bpy.data.lights["Key"].energy, bpy.data.lights["Key"].color = 7.0, (1.0, 0.0, 0.0)
    assert stale(freshness, lit) == ""
    change(lit)
    assert stale(freshness, lit).startswith(words)


def test_names_of_lamps_and_of_other_objects_do_not_matter(freshness, lit, addon):
    from bl_ext.user_default.lamina.interior import around

    wall = linked("Wall", icosphere("Wall", 1.0))
    note(freshness, lit)
    named = around.mark(bpy.context.scene.objects, lit, with_names=True)
    settings = settings_of(lit)
    settings.made_from = json.dumps(json.loads(settings.made_from) | {"around": named})
    assert stale(freshness, lit) == "", "a note of an earlier version"
    note(freshness, lit)
    wall.name, bpy.data.objects["Key"].name, bpy.data.objects["Instance"].name = "Screen", "Lamp", "Copy"
    assert stale(freshness, lit) == ""
    wall.location.x += 1.0
    assert stale(freshness, lit) == "Other objects have moved or changed since: compute again"
    bpy.data.objects["Lamp"].location.x += 1.0
    assert stale(freshness, lit) == "Key no longer lights the object: compute again"


def test_the_linking_of_lamps_and_of_meshes(freshness, lit):
    note(freshness, lit)
    wall = linked("Wall", icosphere("Wall", 1.0))
    note(freshness, lit)
    listed = bpy.data.collections.new("Listed")
    listed.objects.link(wall)
    for name in ("receiver_collection", "blocker_collection"):
        listed.collection_objects[0].light_linking.link_state = "EXCLUDE"
        for owner, words in (("Key", "Key has another light linking or shadow linking since: compute again"),
                             ("Far", "Far of Instance has another light linking"),
                             ("Wall", "Other objects have moved or changed since")):
            setattr(bpy.data.objects[owner].light_linking, name, listed)
            assert stale(freshness, lit).startswith(words)
            note(freshness, lit)
            assert stale(freshness, lit) == ""
    listed.collection_objects[0].light_linking.link_state = "INCLUDE"
    assert stale(freshness, lit) == "Key and Far of Instance no longer lights the object: compute again"


def test_a_lamp_that_the_viewport_hides(freshness, lit):
    """Its matrix is not up to date, so its own location counts."""
    key = bpy.data.objects["Key"]
    note(freshness, lit)
    key.hide_viewport = True
    assert stale(freshness, lit) == ""
    key.location.x = 4.0
    assert stale(freshness, lit).startswith("Key has moved")


def test_the_image_of_the_world(freshness, ball):
    settings_of(ball).output = "LIT"
    note(freshness, ball, has_image=True)
    ball.location.x += 5.0
    assert stale(freshness, ball) == ""
    ball.rotation_euler.z = 0.5
    assert stale(freshness, ball) == "The object has turned under the world's image since: compute again"
    note(freshness, ball, has_image=False)
    ball.rotation_euler.z = 1.0
    assert stale(freshness, ball) == ""


@pytest.fixture
def room(lit, addon):
    """The lit ball above a grey floor and beside a screen that emits, under a world of one color."""
    for name, place in (("Floor", (1.0, 2.0, 0.0)), ("Screen", (9.0, 2.0, 3.0))):
        mesh = icosphere(name, 1.0)
        mesh.materials.append(bpy.data.materials.new(name))
        linked(name, mesh).location = place
        addon.nodes.node_tree.of(mesh.materials[0])
    bpy.context.scene.world = bpy.data.worlds.new("Sky")
    addon.nodes.node_tree.of(bpy.context.scene.world)
    return lit


def principled_of(name):
    return bpy.data.materials[name].node_tree.nodes["Principled BSDF"]


def recolored(_obj):
    principled_of("Floor").inputs["Base Color"].default_value = (0.7, 0.1, 0.1, 1.0)


def emptied(_obj):
    bpy.data.objects["Floor"].material_slots[0].material = None


def shining(_obj):
    principled_of("Screen").inputs["Emission Strength"].default_value = 2.0


def brighter(_obj):
    principled_of("Screen").inputs["Emission Strength"].default_value *= 1.5


def background():
    return bpy.context.scene.world.node_tree.nodes["Background"]


def brighter_sky(_obj):
    background().inputs["Strength"].default_value = 3.0


def colored_sky(_obj):
    background().inputs["Color"].default_value = (0.2, 0.3, 0.9, 1.0)


def image_sky(_obj):
    tree = bpy.context.scene.world.node_tree
    image = tree.nodes.new("ShaderNodeTexEnvironment")
    tree.links.new(image.outputs["Color"], background().inputs["Color"])


def another_image(_obj):
    nodes = bpy.context.scene.world.node_tree.nodes
    nodes["Environment Texture"].image = bpy.data.images.new("Dusk", 8, 4)


OTHERS, SKY = "Materials of other objects have changed in color or light since", "The world has changed since"


@pytest.mark.parametrize(("before", "change", "words"), [
    ((), recolored, OTHERS), ((recolored,), emptied, OTHERS), ((), shining, OTHERS), ((shining,), brighter, OTHERS),
    # The group's own inputs follow the strength and the color of a world without an image.
    ((), brighter_sky, ""), ((), colored_sky, ""), ((image_sky,), brighter_sky, ""),
    ((shining,), brighter_sky, SKY), ((shining,), colored_sky, SKY),
    ((), image_sky, SKY), ((image_sky,), another_image, SKY), ((image_sky, shining), brighter_sky, SKY),
])  # fmt: skip
def test_materials_of_other_objects_and_the_world(freshness, room, before, change, words):
    for one in before:
        one(room)
    note(freshness, room)
    assert stale(freshness, room) == ""
    change(room)
    assert stale(freshness, room) == (f"{words}: compute again" if words else "")


def test_a_note_without_looks(freshness, room):
    """As of an earlier version."""
    note(freshness, room)
    settings = settings_of(room)
    earlier = json.loads(settings.made_from)
    for name in ("looks", "shines", "sky"):
        del earlier[name]
    del earlier["body"]["vertices"]
    settings.made_from = json.dumps(earlier)
    for change in (recolored, shining, image_sky, dented):
        change(room)
    assert stale(freshness, room) == ""


def test_the_camera(freshness, ball):
    settings_of(ball).output, settings_of(ball).view = "LIT", "CAMERA"
    camera = bpy.context.scene.camera = linked("Eye", bpy.data.cameras.new("Eye"))
    note(freshness, ball)
    camera.rotation_euler.z = 1.0
    assert stale(freshness, ball) == ""
    camera.location.x = 1.0
    assert stale(freshness, ball) == "The camera has moved against the object since: compute again"


def test_after_saving_and_loading(freshness, lit, tmp_path):
    lit.hide_viewport = True
    note(freshness, lit)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "saved.blend"))
    assert stale(freshness, bpy.data.objects["Ball"]) == ""
