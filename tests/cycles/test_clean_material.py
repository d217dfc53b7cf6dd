# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust of the thickness 0 over a material that an artist made: the picture is that of the material before."""

import bpy
import goniophotometer
import numpy as np
import pytest
from test_principled_law import principled

CLEAN = 1e-5
DIRECTIONS = ((0.9, 0.8, 0.1), (0.5, 0.5, 0.0), (0.3, 0.6, 2.0))
RED = {"color": (0.8, 0.4, 0.1)}
# Cycles attenuates by a table of the coat's reflectance, which differs from Fresnel's equations.
BELOW_COAT = 0.003


def bsdf(material):
    return next(one for one in material.node_tree.nodes if one.type == "BSDF_PRINCIPLED")


@pytest.fixture
def readings(addon):
    """readings(material, reading): a reading of the material, and of its copy under dust of the thickness 0."""
    made = []

    def readings(material, read):
        clean = material.copy()
        made[:] = [material, clean]
        addon.editing.over_material.add(clean)
        clean.lamina.layers[0].varying = True
        addon.baking.bake_job.bake_material(clean, "preview")
        for node in addon.nodes.node_group.group_nodes(clean):
            node.inputs["Thickness"].default_value = 0.0
        return read(made)

    yield readings
    for material in made:
        bpy.data.materials.remove(material)


def under_suns(materials):
    return np.array([goniophotometer.measure_many(materials, *direction, samples=1) for direction in DIRECTIONS])


@pytest.mark.parametrize("roughness", [0.3, 0.8])
def test_a_metal_with_the_distribution_ggx(readings, roughness):
    """Without the light between the facets, a rough metal reflects a third less."""
    metal = principled("GGX", {**RED, "metallic": 1.0, "roughness": roughness})
    bsdf(metal).distribution = "GGX"
    before, after = np.moveaxis(readings(metal, under_suns), 1, 0)
    assert after == pytest.approx(before, rel=CLEAN)


@pytest.mark.parametrize("values", [{}, {"coat": 1.0}, {"coat": 0.5, "coat_ior": 1.8}], ids=["bare", "coat", "half"])
@pytest.mark.parametrize("backface", [False, True])
def test_emission_below_a_coat(readings, values, backface):
    """No light reaches the patch: it shows its emission alone."""
    lamp = principled("Lamp", {**RED, **values})
    node = bsdf(lamp)
    node.inputs["Emission Color"].default_value = (1.0, 0.5, 0.25, 1.0)
    node.inputs["Emission Strength"].default_value = 2.0

    def dark(materials):
        return np.array([goniophotometer.measure_many(materials, mu, 0.5, 0.0, samples=1, below=True, backface=backface)
                         for mu in (0.95, 0.6, 0.3)])

    before, after = np.moveaxis(readings(lamp, dark), 1, 0)
    assert after == pytest.approx(before, rel=BELOW_COAT if values else CLEAN)


def test_rough_glass_stays_glass(readings):
    """The sun shines through the patch."""
    glass = principled("Glass", {**RED, "roughness": 0.4})
    bsdf(glass).inputs["Transmission Weight"].default_value = 1.0

    def through(materials):
        return np.array([goniophotometer.measure_many(materials, *direction, samples=1, below=True)
                         for direction in DIRECTIONS])

    before, after = np.moveaxis(readings(glass, through), 1, 0)
    assert before[0, 0] > 0.05 and after == pytest.approx(before, rel=CLEAN)


def test_a_normal_map_without_bump_map_correction(readings, addon):
    """With the correction the picture differs, and the dialog says so."""
    bumpy = principled("Bumpy", RED)
    normal = bumpy.node_tree.nodes.new("ShaderNodeCombineXYZ")
    for socket, value in zip(normal.inputs, (0.4, 0.1, 0.9), strict=True):
        socket.default_value = value
    bumpy.node_tree.links.new(normal.outputs[0], bsdf(bumpy).inputs["Normal"])
    told = addon.editing.over_material.not_carried(bumpy)
    assert len(told) == 1 and told[0].startswith("bump map correction")
    before, after = np.moveaxis(readings(bumpy, under_suns), 1, 0)
    assert np.abs(after / before - 1.0).max() == pytest.approx(0.05, abs=0.05)
    assert np.abs(after / before - 1.0).max() > 0.005
    bumpy.cycles.use_bump_map_correction = False
    assert not addon.editing.over_material.not_carried(bumpy)
    before = under_suns([bumpy])[:, 0]
    assert after == pytest.approx(before, rel=CLEAN)
