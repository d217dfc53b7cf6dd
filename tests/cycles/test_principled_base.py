# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust over Principled materials, baked and rendered in Cycles, against lamina.solve of the same stack; without dust,
against the Principled BSDF itself. bench/principled_table.py measures more materials."""

import baked_samples
import bpy
import goniophotometer
import numpy as np
import principled_samples
import pytest
from test_principled_law import principled

from lamina import HenyeyGreenstein, Medium, PrincipledBase

DUST = Medium(albedo=[0.9, 0.88, 0.84], tau=2.0, phase=HenyeyGreenstein(0.6), varying=True)
RED, BLUE = (0.8, 0.4, 0.1), (0.2, 0.6, 0.9)
BASES = {
    "inputs": PrincipledBase(color=RED, metallic=1.0, roughness=0.6, inputs=("color", "metallic")),
    "roughness": PrincipledBase(color=RED, roughness=0.5, inputs=("roughness",)),
    "coated": PrincipledBase(color=RED, roughness=0.5, coat=0.5),
}
VALUES = {
    "inputs": ({}, {"metallic": 0.0}, {"color": BLUE, "metallic": 0.5}),
    "roughness": ({"roughness": 0.3}, {"roughness": 0.62}),
}
THICKNESSES = (0.1, 0.5, 2.0)
VIEWS = baked_samples.gauss_views(3)
LIGHTS = baked_samples.about_the_mirror_direction(VIEWS, 3, 5, 3.0)
MEAN_SLICE, ALBEDO = 0.06, 0.02
CLEAN = 1e-5


@pytest.fixture(scope="module")
def tables(addon):
    made = {name: principled_samples.baked(addon, name, [DUST], base, "preview") for name, base in BASES.items()}
    yield made
    for material, _ in made.values():
        bpy.data.materials.remove(material)


def shown(tables, name, tau, **values):
    return principled_samples.at(*tables[name], DUST, BASES[name], tau, **values)


def test_slices_and_albedo_follow_the_inputs(tables):
    samples = [shown(tables, name, tau, **values)
               for name, each in VALUES.items() for values in each for tau in THICKNESSES]
    slices = principled_samples.slice_errors(samples, VIEWS, LIGHTS)
    albedo = principled_samples.albedo_errors(samples, (0.9, 0.4), samples=512)
    for sample, errors, off in zip(samples, slices, albedo, strict=True):
        assert VIEWS.mean(errors) <= MEAN_SLICE, (sample.name, errors)
        assert off.max() <= ALBEDO, (sample.name, off)


def test_the_albedo_of_a_coated_base(tables):
    samples = [shown(tables, "coated", tau) for tau in THICKNESSES]
    assert principled_samples.albedo_errors(samples, (0.9, 0.4), samples=512).max() <= ALBEDO


@pytest.mark.parametrize("name", BASES)
@pytest.mark.parametrize("tilted", [False, True], ids=["", "with a normal"])
def test_without_dust_the_picture_is_that_of_the_principled_bsdf(tables, name, tilted):
    sample = shown(tables, name, 0.0)
    base = BASES[name]
    bare = principled("bare", {key: getattr(base, key) for key in ("color", "metallic", "roughness", "coat")})
    if tilted:
        node = baked_samples.group_node(sample.material, tables[name][1])
        own = next(one for one in bare.node_tree.nodes if one.type == "BSDF_PRINCIPLED")
        for tree, sockets in ((sample.material.node_tree, [node.inputs["Normal"]]),
                              (bare.node_tree, [own.inputs["Normal"], own.inputs["Coat Normal"]])):
            normal = tree.nodes.new("ShaderNodeCombineXYZ")
            for number, value in enumerate((0.2, 0.1, 0.97)):
                normal.inputs[number].default_value = value
            for socket in sockets:
                tree.links.new(normal.outputs[0], socket)
        bare.cycles.use_bump_map_correction = False
    for mu_o, mu_i, dphi in ((0.9, 0.8, 0.1), (0.5, 0.5, 0.0), (0.3, 0.6, 2.0)):
        one, other = goniophotometer.measure_many([sample.material, bare], mu_o, mu_i, dphi, samples=1)
        assert one == pytest.approx(other, rel=CLEAN)
    for material in (sample.material, bare):
        bpy.data.materials.remove(material)


def test_a_texture_of_metallic_and_color_is_two_materials(tables):
    """Half of a patch has the values of one material and half those of another: the reading is the mean of both."""
    pair = ({"color": RED, "metallic": 1.0}, {"color": BLUE, "metallic": 0.0})
    one, other = (shown(tables, "inputs", 0.5, **values) for values in pair)
    mixed = shown(tables, "inputs", 0.5)
    tree = mixed.material.node_tree
    node = baked_samples.group_node(mixed.material, tables["inputs"][1])
    place, checker = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeTexChecker")
    checker.inputs["Scale"].default_value = 40.0
    tree.links.new(place.outputs["Position"], checker.inputs["Vector"])
    checker.inputs["Color1"].default_value, checker.inputs["Color2"].default_value = (*RED, 1.0), (*BLUE, 1.0)
    tree.links.new(checker.outputs["Color"], node.inputs["Base Color"])
    tree.links.new(checker.outputs["Fac"], node.inputs["Metallic"])
    for direction in ((0.8, 0.7, 0.5), (0.4, 0.6, 2.0)):
        seen = goniophotometer.measure_many([mixed.material, one.material, other.material], *direction, samples=4096)
        share = (seen[0] - seen[2]) / (seen[1] - seen[2])
        assert share == pytest.approx(np.full(3, share.mean()), abs=0.03), share
        assert 0.3 < share.mean() < 0.7
