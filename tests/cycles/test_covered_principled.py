# SPDX-License-Identifier: GPL-3.0-or-later
"""Varnish on Principled materials with textures, baked and rendered in Cycles, against lamina.solve of the same stack
at values of the inputs."""

import baked_samples
import bpy
import goniophotometer
import numpy as np
import principled_samples
import pytest

import lamina
from lamina import HenyeyGreenstein, Interface, Medium, PrincipledBase

SMOOTH, ROUGH = Interface(ior=1.5), Interface(ior=1.5, alpha=0.15)
LACQUER = Medium(albedo=[0.7, 0.3, 0.1], tau=0.3, phase=HenyeyGreenstein(0.5))
RED, BLUE, GOLD = (0.8, 0.1, 0.1), (0.2, 0.5, 0.9), (1.0, 0.78, 0.34)
EVERY = PrincipledBase(color=RED, inputs=("color", "metallic", "roughness"))
LAYERS = {"smooth": [SMOOTH], "rough": [ROUGH], "lacquer": [SMOOTH, LACQUER], "plastic": [SMOOTH]}
BASES = {"smooth": EVERY, "rough": EVERY, "lacquer": PrincipledBase(color=RED, metallic=1.0, inputs=("roughness",)),
         "plastic": PrincipledBase(color=RED, ior=1.7, inputs=("color",))}
VALUES = {
    "smooth": ({}, {"color": BLUE}, {"color": GOLD, "metallic": 1.0, "roughness": 0.3},
               *({"color": BLUE, "metallic": 1.0, "roughness": rough} for rough in (0.25, 0.45, 0.8)),
               {"color": RED, "metallic": 0.5, "roughness": 0.6}),
    "rough": ({}, {"color": GOLD, "metallic": 1.0, "roughness": 0.35}, {"color": BLUE, "metallic": 0.3}),
    "lacquer": ({"roughness": 0.4}, {"roughness": 0.7}),
    "plastic": ({"color": BLUE},),
}
VIEWS = baked_samples.gauss_views(3)
LIGHTS = baked_samples.about_the_mirror_direction(VIEWS, 4, 6, 4.0)
MEAN_SLICE, OF_DEDICATED, ALBEDO = 0.06, 1.5, 0.02


@pytest.fixture(scope="module")
def tables(addon):
    made = {name: principled_samples.baked(addon, name, LAYERS[name], base, "preview") for name, base in BASES.items()}
    yield made
    for material, _ in made.values():
        bpy.data.materials.remove(material)


def shown(tables, name, **values):
    return principled_samples.below(*tables[name], LAYERS[name], BASES[name], **values)


def test_slices_and_albedo_follow_the_inputs(tables):
    samples = [shown(tables, name, **values) for name, each in VALUES.items() for values in each]
    slices = principled_samples.slice_errors(samples, VIEWS, LIGHTS)
    albedo = principled_samples.albedo_errors(samples, (0.9, 0.4), samples=512)
    for sample, errors, off in zip(samples, slices, albedo, strict=True):
        allowed = MEAN_SLICE
        if VIEWS.mean(errors) > allowed:
            allowed = OF_DEDICATED * lamina.bake(sample.stack, "preview").report["fit_error"]
        assert VIEWS.mean(errors) <= allowed, (sample.name, errors)
        assert off.max() <= ALBEDO, (sample.name, off)


def test_polished_metal_below_varnish_keeps_its_albedo(tables):
    samples = [shown(tables, "smooth", color=GOLD, metallic=1.0, roughness=rough) for rough in (0.0, 0.1)]
    assert principled_samples.albedo_errors(samples, (0.9, 0.4), samples=512).max() <= ALBEDO


def test_textures_below_varnish_are_two_materials(tables):
    """Half of a patch has the values of one material and half those of another: the reading is the mean of both."""
    pair = ({"color": GOLD, "metallic": 1.0, "roughness": 0.3}, {"color": BLUE, "metallic": 0.0, "roughness": 0.6})
    one, other = (shown(tables, "smooth", **values) for values in pair)
    mixed = shown(tables, "smooth", roughness=0.3)
    tree = mixed.material.node_tree
    node = baked_samples.group_node(mixed.material, tables["smooth"][1])
    place, checker = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeTexChecker")
    rough = tree.nodes.new("ShaderNodeMapRange")
    checker.inputs["Scale"].default_value = 40.0
    tree.links.new(place.outputs["Position"], checker.inputs["Vector"])
    checker.inputs["Color1"].default_value, checker.inputs["Color2"].default_value = (*GOLD, 1.0), (*BLUE, 1.0)
    rough.inputs["To Min"].default_value, rough.inputs["To Max"].default_value = 0.6, 0.3
    tree.links.new(checker.outputs["Fac"], rough.inputs["Value"])
    for output, name in ((checker.outputs["Color"], "Base Color"), (checker.outputs["Fac"], "Metallic"),
                         (rough.outputs["Result"], "Roughness")):
        tree.links.new(output, node.inputs[name])
    for direction in ((0.8, 0.7, 0.5), (0.5, 0.6, 0.4)):
        seen = goniophotometer.measure_many([mixed.material, one.material, other.material], *direction, samples=4096)
        share = (seen[0] - seen[2]) / (seen[1] - seen[2])
        assert share == pytest.approx(np.full(3, share.mean()), abs=0.03), share
        assert 0.3 < share.mean() < 0.7
