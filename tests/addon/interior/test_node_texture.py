# SPDX-License-Identifier: GPL-3.0-or-later
"""Node textures as voxels, against formulas."""

import bpy
import numpy as np
import pytest

LOW, HIGH, SHAPE = (-1.0, 0.5, 2.0), (3.0, 1.5, 2.6), (16, 10, 7)


@pytest.fixture
def sampling(addon):
    from bl_ext.user_default.lamina.interior import node_texture

    return node_texture


@pytest.fixture
def textured(addon):
    """textured(build): an object that is moved, turned and scaled, whose base colour is what `build(tree)` returns."""

    def make(build):
        mesh = bpy.data.meshes.new("Block")
        mesh.from_pydata([LOW, (3, 0.5, 2), (0, 1.5, 2), HIGH], [], [(0, 1, 2), (1, 2, 3)])
        obj = bpy.data.objects.new("Block", mesh)
        bpy.context.scene.collection.objects.link(obj)
        obj.location, obj.rotation_euler, obj.scale = (5, 6, 7), (0.3, 0.2, 0.1), (2, 1, 3)
        material = bpy.data.materials.new("Veins")
        addon.nodes.node_tree.of(material)
        tree = material.node_tree
        shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
        tree.links.new(build(tree), shader.inputs["Base Color"])
        mesh.materials.append(material)
        return obj, material

    return make


def coordinates(tree, output="Object"):
    return tree.nodes.new("ShaderNodeTexCoord").outputs[output]


def centres():
    """[x, y, z, 3]: of the voxels, in the object's space."""
    lines = [low + (high - low) * (np.arange(count) + 0.5) / count
             for low, high, count in zip(LOW, HIGH, SHAPE, strict=True)]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)


def counts():
    """Of all data in the file but Blender's own result of a render."""
    data = bpy.data
    names = ("scenes", "objects", "meshes", "cameras", "materials", "worlds", "node_groups")
    images = sum(image.type != "RENDER_RESULT" for image in data.images)
    return {name: len(getattr(data, name)) for name in names} | {"images": images}


def test_object_coordinates_are_those_of_the_voxels(sampling, textured):
    """Also negative ones and those above 1, which no view transform clips."""
    obj, material = textured(coordinates)
    before = counts()
    found = sampling.sample_nodes(obj, material, LOW, HIGH, SHAPE)
    assert found.shape == (*SHAPE, 3)
    assert np.abs(found - centres()).max() < 1e-3
    assert counts() == before


def test_generated_coordinates_are_those_of_the_mesh(sampling, textured):
    obj, material = textured(lambda tree: coordinates(tree, "Generated"))
    found = sampling.sample_nodes(obj, material, LOW, HIGH, SHAPE)
    expected = (centres() - LOW) / (np.array(HIGH) - LOW)
    assert np.abs(found - expected).max() < 1e-3


def checker(tree):
    node = tree.nodes.new("ShaderNodeTexChecker")
    node.inputs["Scale"].default_value = 2.0
    node.inputs["Color1"].default_value, node.inputs["Color2"].default_value = (0.2, 0.5, 4.0, 1), (0.9, 0.1, 0.0, 1)
    tree.links.new(coordinates(tree), node.inputs["Vector"])
    return node.outputs["Color"]


def test_a_checker(sampling, textured):
    """In several pictures."""
    sampling_tiles, sampling.MOST_PIXELS = sampling.MOST_PIXELS, 3 * 160
    try:
        found = sampling.sample_nodes(*textured(checker), LOW, HIGH, SHAPE)
    finally:
        sampling.MOST_PIXELS = sampling_tiles
    odd = np.floor(2.0 * centres() + 1e-6).astype(int).sum(axis=-1) % 2
    expected = np.where(odd[..., None] == 1, (0.2, 0.5, 4.0), (0.9, 0.1, 0.0))
    assert np.abs(found - expected).max() < 1e-3


def test_a_number_of_a_named_socket(sampling, textured):
    def build(tree):
        split = tree.nodes.new("ShaderNodeSeparateXYZ")
        split.name = "Axes"
        tree.links.new(coordinates(tree), split.inputs[0])
        return split.outputs["X"]

    obj, material = textured(build)
    found = sampling.sample_nodes(obj, material, LOW, HIGH, SHAPE, ("Axes", "Z"))
    assert np.abs(found - centres()[..., 2:]).max() < 1e-3


@pytest.mark.parametrize("kind", ["Noise", "Voronoi", "Wave", "Magic", "Checker", "Brick", "Gradient"])
def test_a_texture_without_a_vector_is_in_generated_coordinates(sampling, textured, kind):
    def build(vector):
        def make(tree):
            node = tree.nodes.new(f"ShaderNodeTex{kind}")
            if "Scale" in node.inputs:
                node.inputs["Scale"].default_value = 1.7  # voxels do not lie on the lines of the pattern
            if vector:
                tree.links.new(coordinates(tree, vector), node.inputs["Vector"])
            return node.outputs[0]

        return sampling.sample_nodes(*textured(make), LOW, HIGH, SHAPE)

    found = build(None)
    assert found.std() > 0.05
    np.testing.assert_allclose(found, build("Generated"), atol=1e-5)


def test_what_fails_or_is_cancelled_leaves_nothing(sampling, textured, monkeypatch):
    obj, material = textured(coordinates)
    before = counts()
    told = []
    with pytest.raises(sampling.SamplingCancelled):
        sampling.sample_nodes(obj, material, LOW, HIGH, SHAPE, cancel=lambda: True)
    with pytest.raises(ZeroDivisionError):
        sampling.sample_nodes(obj, material, LOW, HIGH, SHAPE, progress=lambda f, text: told.append(1 / 0))
    monkeypatch.setattr(sampling.float_render, "prepare", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        sampling.sample_nodes(obj, material, LOW, HIGH, SHAPE)
    assert counts() == before
    assert material.node_tree.nodes.get("Emission") is None


@pytest.mark.parametrize(("build", "words"), [
    (lambda tree: coordinates(tree, "UV"), "Veins: node Texture Coordinate gives UV, which has no value inside"),
    (lambda tree: tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"], "node Geometry has no value inside"),
    (lambda tree: tree.nodes.new("ShaderNodeObjectInfo").outputs["Color"], "node Object Info has no value inside"),
])
def test_values_that_belong_to_a_surface_are_refused(sampling, textured, build, words):
    with pytest.raises(sampling.RefusedError, match=words):
        sampling.sample_nodes(*textured(build), LOW, HIGH, SHAPE)


def test_bad_requests(addon, sampling, textured):
    obj, material = textured(coordinates)
    for change, words in (({"shape": (0, 1, 1)}, "voxels = .0, 1, 1.: must be"),
                          ({"high": LOW}, "must have an extent along each axis"),
                          ({"source": ("Nothing", "Color")}, "Veins has no output Color of a node Nothing")):
        with pytest.raises(sampling.RefusedError, match=words):
            whole = {"obj": obj, "material": material, "low": LOW, "high": HIGH, "shape": SHAPE}
            sampling.sample_nodes(**whole | change)
    plain = bpy.data.materials.new("Plain")
    addon.nodes.node_tree.of(plain)
    with pytest.raises(sampling.RefusedError, match="Plain has no texture linked to a color or density"):
        sampling.sample_nodes(obj, plain, LOW, HIGH, SHAPE)
