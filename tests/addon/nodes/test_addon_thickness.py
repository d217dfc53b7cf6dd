# SPDX-License-Identifier: GPL-3.0-or-later
"""The source of the varying layer's thickness: set by function and by operator, with the artist's own links kept."""


import addon_utils
import bpy
import numpy as np
import own_blender
import pytest
from rendered_plane import add_plane, render

LARGEST = 2.0


@pytest.fixture
def dusty(addon, lamina, material):
    """A baked material whose layer varies up to LARGEST."""
    layer = material.lamina.layers[0]
    layer.varying, layer.tau = True, LARGEST
    material.lamina.base.reflectance = (0.05, 0.05, 0.05)
    addon.baking.bake_job.bake_material(material)
    return material


def group_input(material, addon):
    return addon.nodes.node_group.group_nodes(material)[0].inputs["Thickness"]


def wired(addon, material):
    now = addon.nodes.thickness.wiring(material)
    return now.source, now.name, now.uv.uv_map if now.uv else ""


def count(material):
    return len(material.node_tree.nodes)


def image(name="Map", value=0.5, **settings):
    made = bpy.data.images.new(name, 4, 4, float_buffer=True, is_data=True)
    made.pixels.foreach_set(np.tile([value, value, value, 1.0], 16).astype(np.float32))
    for key, setting in settings.items():
        setattr(made.colorspace_settings, key, setting)
    return made


CASES = {
    "value": ("value", {}, ("value", "", "")),
    "attribute": ("attribute", {}, ("attribute", "lamina_dust", "")),
    "other attribute": ("attribute", {"name": "soot"}, ("attribute", "soot", "")),
    "image": ("image", {"name": "Map"}, ("image", "Map", "")),
    "image and UV map": ("image", {"name": "Map", "uv_map": "Second"}, ("image", "Map", "Second")),
    "new image": ("image", {}, ("image", "Bronze thickness", "")),
}


@pytest.mark.parametrize(("source", "more", "expected"), CASES.values(), ids=CASES)
def test_each_source_is_wired_and_shown(addon, dusty, source, more, expected):
    image()
    before = count(dusty)
    addon.nodes.thickness.wire_thickness(dusty, source, **more)
    assert wired(addon, dusty) == expected
    own = source == "attribute" and not more  # settled dust has an attribute for back faces as well
    assert count(dusty) == before + {"value": 0, "attribute": 1, "image": 2}[source] + own
    assert dusty.node_tree.animation_data is None
    picture = addon.nodes.thickness.wiring(dusty).node.image if source == "image" else None
    if picture is not None:
        assert picture.is_float and picture.packed_file is not None
        assert picture.colorspace_settings.name == "Non-Color"


def test_one_source_takes_the_place_of_another_and_leaves_nothing(addon, dusty):
    before = sorted(node.name for node in dusty.node_tree.nodes)
    for source in ("attribute", "image", "attribute", "image", "image", "value"):
        addon.nodes.thickness.wire_thickness(dusty, source)
        assert addon.nodes.thickness.wiring(dusty).source == source
    assert sorted(node.name for node in dusty.node_tree.nodes) == before


def own_node(material, addon):
    node = material.node_tree.nodes.new("ShaderNodeTexNoise")
    material.node_tree.links.new(node.outputs[0], group_input(material, addon))
    return node


@pytest.mark.parametrize("source", ["value", "attribute", "image"])
def test_the_artists_own_link_stays_unless_asked(addon, dusty, source):
    node = own_node(dusty, addon)
    before, images = count(dusty), len(bpy.data.images)
    with pytest.raises(addon.base.messages.RefusedError, match="Noise"):
        addon.nodes.thickness.wire_thickness(dusty, source)
    assert wired(addon, dusty)[:2] == ("custom", node.name)
    assert (count(dusty), len(bpy.data.images)) == (before, images)
    addon.nodes.thickness.wire_thickness(dusty, source, replace=True)
    assert addon.nodes.thickness.wiring(dusty).source == source
    assert node.name in dusty.node_tree.nodes, "the artist's node itself stays"


def test_a_node_that_the_artist_uses_as_well_stays(addon, dusty):
    node = addon.nodes.thickness.wire_thickness(dusty, "attribute").node
    mix = dusty.node_tree.nodes.new("ShaderNodeMath")
    dusty.node_tree.links.new(node.outputs["Fac"], mix.inputs[0])
    addon.nodes.thickness.wire_thickness(dusty, "value")
    assert mix.inputs[0].links[0].from_node == node and not group_input(dusty, addon).is_linked


def test_every_use_of_the_group_is_fed(addon, dusty):
    second = dusty.node_tree.nodes.new("ShaderNodeGroup")
    second.node_tree = dusty.lamina.node_group
    addon.nodes.thickness.wire_thickness(dusty, "attribute")
    sources = {node.inputs["Thickness"].links[0].from_node.name
               for node in addon.nodes.node_group.group_nodes(dusty)}
    assert len(sources) == 1


def test_without_a_thickness_there_is_nothing_to_wire(addon, lamina, material):
    addon.baking.bake_job.bake_material(material)
    assert addon.nodes.thickness.wiring(material).source == "none"
    with pytest.raises(addon.base.messages.RefusedError, match="no thickness input"):
        addon.nodes.thickness.wire_thickness(material, "attribute")


@pytest.mark.parametrize(("source", "name", "match"), [("gradient", "", "source"), ("image", "Nowhere", "Nowhere")])
def test_what_cannot_be_wired_is_one_sentence(addon, dusty, source, name, match):
    addon.nodes.thickness.wire_thickness(dusty, "attribute")
    with pytest.raises(addon.base.messages.RefusedError, match=match):
        addon.nodes.thickness.wire_thickness(dusty, source, name)
    assert wired(addon, dusty)[0] == "attribute"


def test_an_images_colour_space(addon, dusty):
    """An image without other users becomes Non-Color; an image with other users is refused."""
    mine, others = image("Mine"), image("Others")
    for one in (mine, others):
        one.colorspace_settings.name = "sRGB"
    addon.nodes.node_tree.of(bpy.data.materials.new("User")).nodes.new("ShaderNodeTexImage").image = others
    addon.nodes.thickness.wire_thickness(dusty, "image", mine)
    assert mine.colorspace_settings.name == "Non-Color"
    with pytest.raises(addon.base.messages.RefusedError, match="sRGB"):
        addon.nodes.thickness.wire_thickness(dusty, "image", others)
    assert others.colorspace_settings.name == "sRGB" and wired(addon, dusty)[1] == "Mine"


def test_a_rebake_keeps_the_wiring_and_a_lost_input_gets_it_back(addon, dusty):
    addon.nodes.thickness.wire_thickness(dusty, "attribute", "soot")
    layer = dusty.lamina.layers[0]
    layer.tau = 3.0
    addon.baking.bake_job.bake_material(dusty)
    assert wired(addon, dusty)[:2] == ("attribute", "soot")
    layer.varying = False
    addon.baking.bake_job.bake_material(dusty)
    assert wired(addon, dusty)[0] == "none"
    layer.varying = True
    addon.baking.bake_job.bake_material(dusty)
    assert wired(addon, dusty)[:2] == ("attribute", "soot")


def test_wiring_can_be_undone_and_done_again(addon, dusty):
    name = dusty.name
    bpy.context.scene.world = None
    dusty.use_fake_user = True
    bpy.ops.ed.undo_push(message="before")
    addon.nodes.thickness.wire_thickness(dusty, "attribute")
    bpy.ops.ed.undo_push(message="wired")
    bpy.ops.ed.undo()
    assert addon.nodes.thickness.wiring(bpy.data.materials[name]).source == "value"
    bpy.ops.ed.redo()
    assert wired(addon, bpy.data.materials[name])[:2] == ("attribute", "lamina_dust")


def test_the_panel_tells_the_error_of_the_thickness_shown(addon, dusty):
    result = dusty.lamina.result
    rows = result.report["row_errors"]["tau"]
    assert len(rows) == 33 and rows[-1] == pytest.approx(LARGEST)
    lines = addon.ui.numbers.thickness_lines(dusty)
    assert lines[0][0] == "Error at 2" and "mean" in lines[0][1]
    addon.nodes.thickness.wire_thickness(dusty, "attribute")
    assert len(addon.ui.numbers.thickness_lines(dusty)) == 5


ODD = np.array([np.inf, -np.inf, np.nan, 0.5], np.float32)
FINITE = [1e6, 0.0, 0.0, 0.5]


def odd_image(tmp_path, stored):
    """A 4 x 4 image whose columns hold ODD: generated, packed, or a file on disk."""
    made = image("Map")
    texels = np.repeat(np.tile(ODD, 4), 4)
    texels[3::4] = 1.0
    made.pixels.foreach_set(texels)
    if stored == "packed":
        made.pack()
    if stored == "file":
        made.file_format = "OPEN_EXR"
        made.filepath_raw = str(tmp_path / "map.exr")
        made.save()
        bpy.data.images.remove(made)
        made = bpy.data.images.load(str(tmp_path / "map.exr"))
        made.name, made.colorspace_settings.name = "Map", "Non-Color"
    return made


@pytest.mark.parametrize("stored", ["generated", "packed", "file"])
def test_an_image_keeps_no_texel_that_is_not_finite(addon, dusty, tmp_path, stored):
    """Blender 5.2 reads such a texel as 0, and in all versions it spoils neighbouring texels."""
    made = odd_image(tmp_path, stored)
    addon.nodes.thickness.wire_thickness(dusty, "image", "Map")
    assert made.packed_file is not None
    dusty.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "saved.blend"))
    shown = np.empty(64, np.float32)
    bpy.data.images["Map"].pixels.foreach_get(shown)
    assert shown.reshape(4, 4, 4)[1, :, 0].tolist() == FINITE and set(shown[3::4]) == {1.0}


def test_an_image_that_others_read_keeps_its_texels(addon, dusty, tmp_path):
    made = odd_image(tmp_path, "generated")
    addon.nodes.node_tree.of(bpy.data.materials.new("User")).nodes.new("ShaderNodeTexImage").image = made
    with pytest.raises(addon.base.messages.RefusedError, match="“Map” holds texels that are not finite"):
        addon.nodes.thickness.wire_thickness(dusty, "image", "Map")
    assert made.pixels[0] == np.inf and addon.nodes.thickness.wiring(dusty).source == "value"


def plane_at(thickness, addon, kind, material):
    """Give the scene's plane this thickness by attribute or image; None: no attribute."""
    mesh = bpy.data.objects["Patch"].data
    if kind == "value":
        group_input(material, addon).default_value = thickness
    elif kind == "attribute" and thickness is not None:
        mesh.attributes.new("lamina_dust", "FLOAT", "POINT").data.foreach_set("value", [thickness] * 4)
    elif kind == "image":
        mesh.uv_layers.new(name="Second")
        image("Map", thickness)


@pytest.mark.parametrize("kind", ["attribute", "image"])
def test_the_file_renders_alike_without_the_addon(addon, dusty, tmp_path, disabled_afterwards, kind):
    add_plane(dusty)
    plane_at(0.5, addon, "value", dusty)
    expected = render(tmp_path / "value.exr")
    plane_at(0.5, addon, kind, dusty)
    names = ("Map", "Second") if kind == "image" else ("", "")
    addon.nodes.thickness.wire_thickness(dusty, kind, *names)
    assert render(tmp_path / "wired.exr") == pytest.approx(expected, rel=1e-5)
    blend = str(tmp_path / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=blend)
    own_blender.disable()
    assert addon_utils.check(own_blender.MODULE) == (False, False)
    bpy.ops.wm.open_mainfile(filepath=blend)
    assert render(tmp_path / "reopened.exr") == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize(("thickness", "shown"), [(None, 0.0), (float("nan"), 0.0), (-1.0, 0.0),
                                                  (float("-inf"), 0.0), (50.0, LARGEST), (float("inf"), LARGEST)])
@pytest.mark.parametrize("kind", ["attribute", "image"])
def test_what_is_missing_and_odd_numbers_are_defined(addon, dusty, tmp_path, kind, thickness, shown):
    if kind == "image" and thickness is None:
        thickness = 0.0
    add_plane(dusty)
    plane_at(shown, addon, "value", dusty)
    expected = render(tmp_path / "value.exr")
    plane_at(thickness, addon, kind, dusty)
    addon.nodes.thickness.wire_thickness(dusty, kind, "Map" if kind == "image" else "")
    assert render(tmp_path / "wired.exr") == pytest.approx(expected, rel=1e-5)
