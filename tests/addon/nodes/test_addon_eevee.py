# SPDX-License-Identifier: GPL-3.0-or-later
"""The group's closures for Eevee: kinds that Eevee has, values of lamina's few closures, nothing changed in Cycles."""

import bpy
import numpy as np
import pytest
from addon_helpers import image_of, pixels
from rendered_plane import add_plane, render

KINDS = {"BSDF_DIFFUSE", "BSDF_GLOSSY", "BSDF_TRANSLUCENT", "BSDF_REFRACTION", "BSDF_TRANSPARENT"}


def baked(addon, material):
    lut = addon.baking.bake_job.bake_material(material)
    return material.lamina.node_group, lut


def switches(group):
    return [node for node in group.nodes if node.type == "MIX_SHADER" and node.label == "Cycles or Eevee"]


def shaders(socket):
    """The shader nodes below the input socket."""
    if not socket.links:
        return []
    node = socket.links[0].from_node
    below = [one for source in node.inputs if source.type == "SHADER" for one in shaders(source)]
    return below or [node]


@pytest.mark.parametrize("base", ["lambert", "none", "conductor"])
def test_eevee_gets_kinds_that_it_has(addon, lamina, material, base):
    material.lamina.base.kind = base
    group, lut = baked(addon, material)
    (switch,) = switches(group)
    assert switch.inputs[0].default_value == 0.0 and switch.inputs[0].links[0].from_node.type == "SHADERTORGB"
    found = shaders(switch.inputs[2])
    assert {node.type for node in found} <= KINDS and len(found) <= 6
    assert len({node.label for node in found}) == len(found)
    used = addon.nodes.closure_graph.used_closures(lut)
    assert len(shaders(switch.inputs[1])) == len(used)


@pytest.mark.parametrize("varying", [False, True])
@pytest.mark.parametrize("base", ["lambert", "none"])
def test_strips_in_the_image(addon, lamina, material, base, varying):
    """The texel that a texture node reads at the top and bottom side is that of the few closures."""
    material.lamina.base.kind = base
    material.lamina.layers[0].varying = varying
    group, lut = baked(addon, material)
    table = addon.nodes.node_group.few_closures(lut)
    image = pixels(image_of(group))
    rows, strips = lut.weights.shape[2], lut.weights.shape[1]
    assert np.array_equal(image[:len(lut.image())], lut.image())
    for number, drawn in enumerate(table.strips):
        textures = [node for node in group.nodes if node.label == f"Eevee {drawn.name}" and node.type == "TEX_IMAGE"]
        assert {node.interpolation for node in textures} == {"Closest"}  # Eevee filters others by mipmaps
        assert len(textures) == (4 if varying else 2)
        first = min(node.inputs[0].links[0].from_node.inputs[1].default_value[1] for node in textures)
        first = first * len(image) - 0.5
        assert first == round(first)
        for side, strip in enumerate(table.texels[:, number]):
            start = round(first) + side * strips * rows
            assert np.array_equal(image[start:start + rows], strip), (drawn, side)


def bases(lamina):
    return {
        "lambert": lamina.Lambert([0.5, 0.3, 0.1]),
        "none": None,
        "texture": lamina.Lambert([0.5, 0.3, 0.1], textured=True),
        "principled": lamina.PrincipledBase(color=[0.5, 0.3, 0.1], roughness=0.4, inputs=("color", "metallic")),
        "roughness": lamina.PrincipledBase(color=[0.5, 0.3, 0.1], roughness=0.4, inputs=("color", "roughness")),
    }


@pytest.mark.parametrize("base", ["lambert", "none", "texture", "principled", "roughness"])
def test_the_same_picture_in_cycles(addon, lamina, material, tmp_path, base):
    """Pixels of Cycles are the same bytes with Eevee's nodes and without them."""
    dust = lamina.Medium(albedo=[0.9, 0.8, 0.6], tau=1.0, phase=lamina.HenyeyGreenstein(0.6))
    addon.editing.stack_io.assign_stack(material, lamina.Stack([dust], base=bases(lamina)[base]))
    group, _ = baked(addon, material)
    add_plane(material)
    expected = render(tmp_path / "with.exr")
    for switch in [node for node in group.nodes if node.label in ("Cycles or Eevee", "Cycles only")]:
        own = next(one for one in switch.inputs[1:] if one.is_linked)  # the first is the factor
        for link in [link for one in switch.outputs for link in one.links]:
            group.links.new(own.links[0].from_socket, link.to_socket)
        group.nodes.remove(switch)
    for node in [one for one in group.nodes if one.label.startswith("Eevee")]:
        group.nodes.remove(node)
    assert expected.max() > 0.05 and np.array_equal(render(tmp_path / "without.exr"), expected)


def test_live_values_reach_eevee(addon, lamina, material):
    """A replaced image holds new strips for Eevee too."""
    group, _ = baked(addon, material)
    before = pixels(image_of(group)).copy()
    material.lamina.layers[0].albedo = (0.2, 0.3, 0.4)
    native = addon.base.native.require()
    lut = native.bake(addon.editing.stack_io.to_stack(material), "preview",
                      closures=addon.nodes.node_group.closures(material),
                      basis=addon.base.preferences.table_basis("standard"))
    assert addon.nodes.node_group.update(material, lut)
    table, image = addon.nodes.node_group.few_closures(lut), pixels(image_of(group))
    start = addon.nodes.lut_image.eevee_strip(lut, 0) * lut.weights.shape[2]
    assert np.array_equal(image[start:start + lut.weights.shape[2]], table.texels[0, 0])
    assert not np.array_equal(image[start:], before[start:])
    assert len(bpy.data.images) == 1
