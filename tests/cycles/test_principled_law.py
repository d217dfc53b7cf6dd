# SPDX-License-Identifier: GPL-3.0-or-later
"""The Principled base without layers against the Principled BSDF of Cycles, on the virtual goniophotometer."""

import bpy
import goniophotometer
import node_tree
import numpy as np
import pytest

import lamina
from lamina import PrincipledBase, Stack

SOCKETS = {"color": "Base Color", "metallic": "Metallic", "roughness": "Roughness", "ior": "IOR",
           "specular": "Specular IOR Level", "coat": "Coat Weight", "coat_roughness": "Coat Roughness",
           "coat_ior": "Coat IOR"}
RED = {"color": (0.8, 0.4, 0.1)}
ROUGH = {
    **{f"metallic {m}, roughness {r}": {**RED, "metallic": m, "roughness": r} for m in (0, 1) for r in (0.2, 0.5, 0.9)},
    "no specular": {**RED, "specular": 0.0},
    "strong specular": {**RED, "specular": 0.8, "roughness": 0.3},
    "low index": {**RED, "ior": 1.33, "roughness": 0.3},
}
# Light of repeated scattering has the mean color of both parts; the coat's narrow lobe is a mirror in the solver.
MIXED = {"half metal": {**RED, "metallic": 0.5, "roughness": 0.5}}
SMOOTH = {
    "coated metal": {**RED, "metallic": 1.0, "roughness": 0.4, "coat": 1.0},
    "half a coat": {**RED, "coat": 0.5, "coat_ior": 1.6},
    "smooth metal": {**RED, "metallic": 1.0, "roughness": 0.1},
    "smooth plastic": {**RED, "roughness": 0.05},
}
# A mirror has the energy of the coat's facets.
WIDE = {"wide coat": {**RED, "coat": 1.0, "coat_roughness": 0.5}}
DIRECTIONS = ((0.9, 0.9, 0.1), (0.7, 0.7, 0.0), (0.6, 0.5, 0.2), (0.3, 0.7, 2.0), (0.8, 0.3, 3.0), (0.2, 0.25, 0.1))
OFF_THE_MIRROR = ((0.3, 0.7, 2.0), (0.8, 0.3, 3.0))
VIEWS = (0.95, 0.6, 0.3)
# The furnace takes 1024 samples of 8 pixels: the measured standard error is below .1 %.
FURNACE = 4e-3


def principled(name, values):
    """A material with a Principled BSDF alone, with these values of a PrincipledBase."""
    material = bpy.data.materials.new(name)
    tree = node_tree.of(material)
    tree.nodes.clear()
    node, output = tree.nodes.new("ShaderNodeBsdfPrincipled"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    for key, value in values.items():
        node.inputs[SOCKETS[key]].default_value = (*value, 1.0) if key == "color" else value
    return material


def compared(cases, directions):
    """Relative errors [case, direction, channel] of the solver's values."""
    materials = [principled(*case) for case in cases.items()]
    solved = [lamina.solve(Stack([], PrincipledBase(**values))) for values in cases.values()]
    errors = []
    for mu_o, mu_i, dphi in directions:
        seen = goniophotometer.measure_many(materials, mu_o, mu_i, dphi, samples=1)
        wanted = np.array([function.brdf(mu_o, mu_i, dphi) * mu_i for function in solved])
        errors.append(np.abs(seen - wanted) / wanted)
    for material in materials:
        bpy.data.materials.remove(material)
    return np.array(errors).swapaxes(0, 1)


@pytest.mark.parametrize("cases, directions, allowed", [
    (ROUGH, DIRECTIONS, 1e-3), (MIXED, DIRECTIONS, 1.2e-2), (SMOOTH, OFF_THE_MIRROR, 1.5e-3),
], ids=["rough", "mixed", "smooth"])
def test_values_are_those_of_cycles(cases, directions, allowed):
    if cases is SMOOTH:
        cases = {name: values for name, values in cases.items() if values.get("metallic", 0.0) < 1.0}
    errors = compared(cases, directions)
    assert errors.max() <= allowed, dict(zip(cases, errors.max(axis=(1, 2)), strict=True))


@pytest.mark.parametrize("mu_o", VIEWS)
def test_the_directional_albedo_is_that_of_cycles(mu_o):
    cases = {**ROUGH, **MIXED, **SMOOTH, **WIDE}
    materials = [principled(*case) for case in cases.items()]
    seen = goniophotometer.furnace_many(materials, mu_o, samples=1024)
    for values, reading in zip(cases.values(), seen, strict=True):
        wanted = lamina.solve(Stack([], PrincipledBase(**values))).reflectance(mu_o)
        assert reading == pytest.approx(wanted, rel=FURNACE), values
    for material in materials:
        bpy.data.materials.remove(material)
