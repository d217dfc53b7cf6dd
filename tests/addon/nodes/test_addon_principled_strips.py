# SPDX-License-Identifier: GPL-3.0-or-later
"""How the node group of layers over a Principled BSDF reads its table: few textures and few closures."""

import numpy as np
import pytest
from addon_helpers import image_of, pixels

INPUTS = [(), ("color",), ("color", "metallic", "roughness")]


@pytest.fixture(params=INPUTS, ids=["fixed", "color", "all"])
def shown(addon, lamina, material, request, equal_bakes_once):
    """(the package, node group, table) of dust over a metal."""
    dust = lamina.Medium(albedo=0.9, tau=1.0, phase=lamina.HenyeyGreenstein(0.6), varying=True)
    base = lamina.PrincipledBase(color=(0.8, 0.4, 0.1), metallic=1.0, roughness=0.5, inputs=request.param)
    addon.editing.stack_io.assign_stack(material, lamina.Stack([dust], base))
    lut = addon.baking.bake_job.bake_material(material, "preview")
    return addon, material.lamina.node_group, lut


def test_the_weight_of_the_bsdf_is_the_alpha_of_a_strip(shown):
    addon, group, lut = shown
    names, rows = lut.header["closures"], lut.weights.shape[2]
    first = names.index(addon.nodes.lut_image.holder_of_principled(lut).name) * rows
    texels = pixels(image_of(group))
    assert np.array_equal(texels[first:first + rows, :, 3], lut.weights[0, names.index("principled"), ..., 0])
    labels = {node.label for node in group.nodes if node.type == "TEX_IMAGE"}
    assert "w" not in labels and "Eevee w" in labels


def test_each_closure_of_a_metal_or_dielectric_is_drawn_once(shown):
    addon, group, lut = shown
    used = [lut.header["closures"][index] for index in addon.nodes.closure_graph.used_closures(lut)]
    labels = [node.label for node in group.nodes]
    wanted = {(name.startswith("metal/"), name.removeprefix("metal/").removeprefix("base/")) for name in used}
    drawn = [name for name in used if name in labels]
    assert len(drawn) == len(wanted) == sum(labels.count(name) for name in used)
    # All strips are read, twice with roughness as an input
    reads = 2 if lut.header["axes"].get("roughness") else 1
    assert all(labels.count(f"weight {name}") == reads for name in used)
