# SPDX-License-Identifier: GPL-3.0-or-later
"""Grain, clouds and wiped places on the thickness: the mean is kept, and the source of the thickness stays linked."""

import bpy
import numpy as np
import pytest
from rendered_plane import add_plane, render

LARGEST = 2.0
SIDE = 48  # pixels of a picture of the detail
STRENGTHS = ("Clouds", "Grain", "Fibers", "Specks")


@pytest.fixture
def dusty(addon, lamina, material):
    """A baked material whose layer varies up to LARGEST."""
    layer = material.lamina.layers[0]
    layer.varying, layer.tau = True, LARGEST
    addon.baking.bake_job.bake_material(material)
    return material


@pytest.fixture
def add(addon):
    return addon.nodes.detail_wiring.add_detail


def plane(width=2.0, cells=1):
    """A square in the xy plane with a UV map, seen exactly by the camera from above; no light."""
    mesh = bpy.data.meshes.new("Square")
    ticks = np.linspace(-0.5 * width, 0.5 * width, cells + 1)
    points = [(x, y, 0.0) for y in ticks for x in ticks]
    row = cells + 1
    mesh.from_pydata(points, [], [(row * j + i, row * j + i + 1, row * (j + 1) + i + 1, row * (j + 1) + i)
                                  for j in range(cells) for i in range(cells)])
    uv = mesh.uv_layers.new(name="UVMap")
    for loop in mesh.loops:
        uv.uv[loop.index].vector = [points[loop.vertex_index][axis] / width + 0.5 for axis in range(2)]
    thing = bpy.data.objects.new("Square", mesh)
    scene = bpy.context.scene
    scene.collection.objects.link(thing)
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", width
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location.z = 2.0
    scene.collection.objects.link(scene.camera)
    return thing


def shown(material, socket, path, side=SIDE):
    """float (side, side): the values of a socket of the material's tree over the square, at pixels' centers."""
    tree = material.node_tree
    emission = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(socket, emission.inputs["Color"])
    surface = tree.get_output_node("CYCLES").inputs["Surface"]
    before = surface.links[0].from_socket
    tree.links.new(emission.outputs[0], surface)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.pixel_filter_type = 1, False, "BOX"
    scene.render.resolution_x = scene.render.resolution_y = side
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    found = render(path)[..., 0]
    tree.nodes.remove(emission)
    tree.links.new(before, surface)
    return found


@pytest.mark.parametrize("strength", ["Clouds", "Grain"])
def test_noise_varies_the_thickness_and_keeps_its_mean(dusty, add, tmp_path, strength):
    plane().data.materials.append(dusty)
    node = add(dusty)
    for name in STRENGTHS:
        node.inputs[name].default_value = 1.0 if name == strength else 0.0
    for size in ("Cloud Size", "Grain Size"):
        node.inputs[size].default_value = 2.0 / SIDE
    node.inputs["Thickness"].default_value = 0.5
    found = shown(dusty, node.outputs["Thickness"], tmp_path / "detail.exr") / 0.5
    assert found.min() >= 0.0 and found.max() <= 2.0
    assert found.std() > 0.3
    # Neighbouring pixels are one noise cell apart and correlated; blocks of 6 x 6 pixels are nearly independent.
    blocks = found.reshape(SIDE // 6, 6, SIDE // 6, 6).mean(axis=(1, 3))
    error = blocks.std(ddof=1) / blocks.size**0.5
    assert abs(found.mean() - 1.0) < 3.0 * error
    assert error < 0.03


@pytest.fixture
def noise(dusty, add, tmp_path):
    """noise(size): a picture of the clouds, of this size in the world, on the square of `plane`."""

    def noise(size):
        node = add(dusty)
        for name in ("Grain", "Fibers", "Specks"):
            node.inputs[name].default_value = 0.0
        node.inputs["Cloud Size"].default_value = size
        return shown(dusty, node.outputs["Thickness"], tmp_path / "noise.exr")

    return noise


def likeness(one, other):
    return np.corrcoef(one.ravel(), other.ravel())[0, 1]


def test_noise_stays_with_a_surface_that_deforms(addon, dusty, noise, tmp_path):
    """A shape key moves all vertices, and the camera follows. On a mesh without rest coordinates, the noise swims."""
    detail = addon.nodes.detail_wiring.detail
    square, camera = plane(cells=8), bpy.context.scene.camera
    square.data.materials.append(dusty)
    square.shape_key_add(name="Basis")
    before = noise(0.3)
    moved = square.shape_key_add(name="Moved")
    for point in moved.data:
        point.co.x += 3.7
    moved.value, camera.location.x = 1.0, 3.7
    assert likeness(before, noise(0.3)) > 0.999
    square.data.attributes.remove(square.data.attributes["lamina_rest"])
    node = detail(dusty)
    swimming = shown(dusty, node.outputs["Thickness"], tmp_path / "swimming.exr")
    assert swimming.std() > 0.5 * before.std() and abs(likeness(before, swimming)) < 0.5


@pytest.mark.parametrize("factor", [1.0, 4.0])
def test_noise_has_one_size_in_the_world(dusty, noise, factor):
    """A mesh that is scaled by its object, and one that is as large itself."""
    square = plane(width=2.0 / factor)
    square.data.materials.append(dusty)
    square.scale = (factor,) * 3
    bpy.context.scene.camera.data.ortho_scale = 2.0
    bpy.context.view_layer.update()
    scaled = noise(0.3)
    square.data.attributes.remove(square.data.attributes["lamina_rest"])
    square.data.transform(square.matrix_world)
    square.scale = (1.0, 1.0, 1.0)
    bpy.context.view_layer.update()
    assert likeness(scaled, noise(0.3)) > 0.999


def test_sizes_are_metres(dusty, add):
    bpy.context.scene.unit_settings.scale_length = 0.01
    node = add(dusty)
    bpy.context.scene.unit_settings.scale_length = 1.0
    assert [node.inputs[f"{name} Size"].default_value for name in ("Cloud", "Grain", "Speck")] == pytest.approx(
        [5.0, 0.15, 0.05])
    assert node.inputs["Fiber Length"].default_value == pytest.approx(0.8)


def test_rest_coordinates_are_stored_once(addon, dusty, add, call):
    square = plane()
    square.data.materials.append(dusty)

    def stored():
        return [tuple(one.vector) for one in square.data.attributes["lamina_rest"].data]

    add(dusty)
    first = stored()
    assert first == [tuple(vertex.co) for vertex in square.data.vertices]
    square.data.vertices[0].co.x += 0.5
    add(dusty)
    assert stored() == first
    bpy.context.view_layer.objects.active = square
    assert call(bpy.ops.lamina.dust_detail, dusty) == {"FINISHED"}
    assert stored() == [tuple(vertex.co) for vertex in square.data.vertices]
    addon.nodes.detail_wiring.remove_detail(dusty)
    assert not any(group.name.startswith("Lamina Dust Detail") for group in bpy.data.node_groups)


def test_rest_coordinates_of_an_object_in_another_scene(addon, dusty, add):
    parent, child = (bpy.data.objects.new(name, data) for name, data in (("P", None), ("C", plane().data.copy())))
    other = bpy.data.scenes.new("Other")
    for obj in (parent, child):
        other.collection.objects.link(obj)
    child.parent, parent.scale, child.scale = parent, (5.0, 5.0, 5.0), (2.0, 2.0, 2.0)
    child.data.materials.append(dusty)
    add(dusty)
    places = np.empty(3 * len(child.data.vertices), np.float32)
    child.data.attributes["lamina_rest"].data.foreach_get("vector", places)
    own = np.array([one.co[:] for one in child.data.vertices]).ravel()
    assert np.allclose(places, 10.0 * own) and bpy.context.scene != other


def test_a_wiped_place_has_no_layer_and_a_back_without_thickness_stays_so(dusty, add, tmp_path):
    plane().data.materials.append(dusty)
    node = add(dusty)
    assert node.inputs["Thickness Back"].default_value == -1.0
    assert (shown(dusty, node.outputs["Thickness"], tmp_path / "front.exr") > 0.1).all()
    # Emission cuts negative values: show the back's thickness with 3 added.
    more = dusty.node_tree.nodes.new("ShaderNodeMath")
    more.inputs[1].default_value = 3.0
    dusty.node_tree.links.new(node.outputs["Thickness Back"], more.inputs[0])
    assert shown(dusty, more.outputs[0], tmp_path / "back.exr") == pytest.approx(2.0, abs=1e-6)
    node.inputs["Wiped"].default_value = 1.0
    assert not shown(dusty, node.outputs["Thickness"], tmp_path / "wiped.exr").any()


@pytest.mark.parametrize("source", ["value", "attribute", "image"])
def test_detail_stays_between_any_source_and_the_group(addon, dusty, add, source):
    thickness = addon.nodes.thickness
    thickness.wire_thickness(dusty, source)
    before = thickness.wiring(dusty)
    links = sorted((link.from_node.name, link.to_node.name, link.to_socket.name) for link in dusty.node_tree.links)
    node = add(dusty)
    assert add(dusty) == node
    now = thickness.wiring(dusty)
    assert (now.source, now.name) == (before.source, before.name) and now.socket.node == node
    group = addon.nodes.node_group.group_nodes(dusty)[0]
    assert group.inputs["Thickness"].links[0].from_node == node
    for other in ("attribute", "image", "value", source):
        thickness.wire_thickness(dusty, other)
        assert thickness.wiring(dusty).source == other and addon.nodes.detail_wiring.detail(dusty) == node
    addon.nodes.detail_wiring.remove_detail(dusty)
    assert thickness.wiring(dusty).source == source
    after = sorted((link.from_node.name, link.to_node.name, link.to_socket.name) for link in dusty.node_tree.links)
    assert len(after) == len(links) and [one[2] for one in after] == [one[2] for one in links]


def test_detail_survives_bakes_without_a_varying_layer(addon, dusty, add):
    addon.nodes.thickness.wire_thickness(dusty, "attribute")
    node = add(dusty)
    for varying in (False, True):
        dusty.lamina.layers[0].varying = varying
        addon.baking.bake_job.bake_material(dusty)
        assert (addon.nodes.detail_wiring.detail(dusty) == node) == varying
    assert addon.nodes.thickness.wiring(dusty).source == "attribute"


@pytest.mark.parametrize("kept", ["attribute", "image"])
def test_white_strokes_remove_the_layer_there_only(addon, dusty, tmp_path, kept):
    square = plane(cells=8)
    square.data.materials.append(dusty)
    wiping, detail = addon.settling.wiping, addon.nodes.detail_wiring
    stored, image = wiping.add_mask(square, dusty, kept)
    assert stored == kept
    node = detail.detail(dusty)
    for name in STRENGTHS:
        node.inputs[name].default_value = 0.0
    assert shown(dusty, node.outputs["Thickness"], tmp_path / "full.exr") == pytest.approx(LARGEST)
    if kept == "attribute":
        mask = square.data.attributes["lamina_wiped"]
        left = np.array([vertex.co.x < -0.3 for vertex in square.data.vertices])
        mask.data.foreach_set("color", np.repeat(left[:, None], 4, axis=1).astype(np.float32).ravel())
    else:
        texels = np.ones((*image.size, 4), np.float32)
        texels[:, image.size[0] // 3 :, :3] = 0.0
        image.pixels.foreach_set(texels.ravel())
        image.update()
    found = shown(dusty, node.outputs["Thickness"], tmp_path / "part.exr")
    assert found[:, : SIDE // 8] == pytest.approx(0.0, abs=1e-6)
    assert found[:, -SIDE // 2 :] == pytest.approx(LARGEST)
    assert wiping.add_mask(square, dusty, kept)[1] == image
    other = "image" if kept == "attribute" else "attribute"
    assert wiping.add_mask(square, dusty, other)[0] == other
    assert sum(node.label == "Wiped places" for node in dusty.node_tree.nodes) == 1
    if kept == "image":
        assert wiping.add_mask(square, dusty, kept)[1] == image, "the mask that the material had before"


def test_appended_dust_follows_the_strength_of_all_dust(addon, dusty, add, tmp_path):
    add(dusty)
    bpy.data.libraries.write(str(tmp_path / "dusty.blend"), {dusty})
    with bpy.data.libraries.load(str(tmp_path / "dusty.blend")) as (_source, target):
        target.materials = [dusty.name]
    add(dusty)
    (group,) = [one for one in bpy.data.node_groups if "lamina_dust_strength" in one]
    details = [one for one in bpy.data.node_groups if "lamina_dust_detail" in one]
    assert len(details) == group.users == 2


def test_animation_goes_with_the_thickness(addon, dusty, add):
    def shown():
        (socket,) = addon.nodes.thickness.sockets_to_feed(dusty)
        values = []
        for frame in (1, 11):
            bpy.context.scene.frame_set(frame)
            values.append(socket.default_value)
        return values

    add_plane(dusty)
    (socket,) = addon.nodes.thickness.sockets_to_feed(dusty)
    for frame, value in ((1, 0.0), (11, 0.25)):
        socket.default_value = value
        socket.keyframe_insert("default_value", frame=frame)
    add(dusty)
    assert shown() == [0.0, 0.25]
    animation = dusty.node_tree.animation_data
    assert len(addon.base.f_curves.of_active(animation)) == 1
    addon.nodes.detail_wiring.remove_detail(dusty)
    assert shown() == [0.0, 0.25] and len(addon.base.f_curves.of_active(animation)) == 1


def test_a_new_object_of_an_old_name_gets_a_new_mask(addon, dusty):
    square = plane()
    old = bpy.data.images.new(f"{square.name} wiped", 8, 8)
    assert addon.settling.wiping.add_mask(square, dusty, "image")[1] != old


def test_a_mesh_without_the_mask_has_no_wiped_places(addon, dusty, tmp_path):
    square = plane()
    square.data.materials.append(dusty)
    addon.settling.wiping.add_mask(square, dusty, "attribute")
    square.data.attributes.remove(square.data.attributes["lamina_wiped"])
    node = addon.nodes.detail_wiring.detail(dusty)
    assert (shown(dusty, node.outputs["Thickness"], tmp_path / "full.exr") > 0.1).all()


def test_the_buttons_add_detail_and_start_painting(addon, dusty, call):
    square = plane()
    square.data.materials.append(dusty)
    bpy.context.view_layer.objects.active = square
    assert call(bpy.ops.lamina.dust_detail, dusty) == {"FINISHED"}
    node = addon.nodes.detail_wiring.detail(dusty)
    assert node.inputs["Cloud Size"].default_value == pytest.approx(0.05)
    other = plane(cells=3)
    with bpy.context.temp_override(object=other), pytest.raises(RuntimeError, match="has this material"):
        call(bpy.ops.lamina.dust_wipe, dusty, paint=False)
    assert not other.data.attributes.get("lamina_wiped")
    assert call(bpy.ops.lamina.dust_wipe, dusty, paint=False) == {"FINISHED"}
    assert node.inputs["Wiped"].links[0].from_node.type == "TEX_IMAGE"  # the mesh is coarse and has a UV map
    assert call(bpy.ops.lamina.dust_detail, dusty, remove=True) == {"FINISHED"}
    assert addon.nodes.detail_wiring.detail(dusty) is None
    assert addon.nodes.thickness.wiring(dusty).source == "value"
    assert not any("lamina_thickness" in one for one in dusty.node_tree.nodes)


def test_without_uv_map_an_image_is_refused(addon, dusty):
    square = plane()
    square.data.uv_layers.remove(square.data.uv_layers[0])
    assert addon.settling.wiping.store(square) == "attribute"
    with pytest.raises(addon.base.messages.RefusedError, match="no UV map"):
        addon.settling.wiping.add_mask(square, dusty, "image")
    assert addon.nodes.detail_wiring.detail(dusty) is None


def test_render_does_not_change_with_strengths_of_zero(addon, dusty, add, tmp_path):
    add_plane(dusty)
    before = render(tmp_path / "before.exr")
    node = add(dusty)
    for name in STRENGTHS:
        node.inputs[name].default_value = 0.0
    assert np.array_equal(render(tmp_path / "after.exr"), before)
