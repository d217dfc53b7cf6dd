# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers over a shader that is no Principled BSDF, in a white furnace in Cycles: the energy is right on average.

The exact values are those of the solver for the same layers on a Lambert surface and on a rough metal."""

import bpy
import goniophotometer
import numpy as np
import pytest

import lamina
from lamina import HenyeyGreenstein, Interface, Medium, Stack

DUST = {"albedo": 0.9, "phase": HenyeyGreenstein(0.6)}
LAYERS = {
    "light dust": [Medium(tau=0.1, **DUST)],
    "dust": [Medium(tau=0.5, **DUST)],
    "heavy dust": [Medium(tau=2.0, **DUST)],
    "varnish": [Interface(1.5)],
    "rough varnish": [Interface(1.5, alpha=0.3)],
    "dark varnish": [Interface(1.5), Medium(albedo=0.2, tau=0.5)],
}
METAL = lamina.Conductor(facing=0.9, grazing=0.9, alpha=0.3)
# Views of equal weight under a uniform sky: Gauss-Legendre in the square of the cosine.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(5)
COSINES, WEIGHTS = np.sqrt(0.5 * (NODES + 1.0)), 0.5 * WEIGHTS
SAMPLES, MOST = 512, 0.05
# The fit of the layers' own light at preview quality, and noise.
FIT = 0.005


def matte(node):
    node.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1.0)


def dark(node):
    node.inputs["Color"].default_value = (0.2, 0.2, 0.2, 1.0)


def rough_metal(node):
    node.distribution, node.fresnel_type = "MULTI_GGX", "PHYSICAL_CONDUCTOR"
    eta, k = Stack(LAYERS["dust"], METAL).indices(0)
    node.inputs["IOR"].default_value, node.inputs["Extinction"].default_value = (eta,) * 3, (k,) * 3
    node.inputs["Roughness"].default_value = METAL.alpha**0.5


BASES = {
    "lambert": ("ShaderNodeBsdfDiffuse", matte, lamina.Lambert(0.8)),
    "dark": ("ShaderNodeBsdfDiffuse", dark, lamina.Lambert(0.2)),
    "metal": ("ShaderNodeBsdfMetallic", rough_metal, METAL),
}


def exact(layers, base):
    """The mean over the views of the light under a uniform sky. All media and bases are reciprocal."""
    return float(WEIGHTS @ lamina.solve(Stack(layers, base)).reflectance(COSINES)[:, 0])


def with_shader(kind, settle):
    """(a new material with a node of this kind, its output)."""
    material = bpy.data.materials.new("Shader")
    tree = goniophotometer.node_tree.of(material)
    tree.nodes.clear()
    shader, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    settle(shader)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material, output


@pytest.fixture(scope="module")
def materials(addon):
    """{(layers, base): a material with the layers over the shader of the base}."""
    made, tables = {}, {}
    for below, (kind, settle, _) in BASES.items():
        for name, layers in LAYERS.items():
            material, output = with_shader(kind, settle)
            addon.editing.over_material.add(material)
            addon.editing.over_material.assign_layers(material, Stack(layers, lamina.Black()))
            if name not in tables:  # the table does not depend on the reflectance
                tables[name] = lamina.bake(addon.editing.stack_io.to_stack(material), quality="preview")
            addon.baking.bake_job.apply(material, tables[name])
            node = output.inputs["Surface"].links[0].from_node
            node.inputs["Base Reflectance"].default_value = (*material.lamina.base.shader_reflectance, 1.0)
            made[name, below] = material
    yield made
    for material in made.values():
        bpy.data.materials.remove(material)


def test_the_energy_is_right_on_average(materials):
    bare = {below: with_shader(*one[:2])[0] for below, one in BASES.items()}
    shown = [*materials.values(), *bare.values()]
    rendered = sum(weight * goniophotometer.furnace_many(shown, mu_o, SAMPLES).mean(axis=1)
                   for mu_o, weight in zip(COSINES, WEIGHTS, strict=True))
    for below, found in zip(bare, rendered[len(materials):], strict=True):
        alone = exact([Medium(albedo=0.5, tau=0.0)], BASES[below][2])
        assert found == pytest.approx(alone, rel=5e-3), "Cycles' own shaders are the solver's bases"
    for ((name, below), material), found in zip(materials.items(), rendered, strict=False):
        stated = material.lamina.result.report["base_error"]["metal" if below == "metal" else "lambert"]
        error = found / exact(LAYERS[name], BASES[below][2]) - 1.0
        assert abs(error) <= MOST, (name, below, error)
        assert abs(error) <= stated + FIT, (name, below, error, stated)
