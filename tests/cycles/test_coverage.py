# SPDX-License-Identifier: GPL-3.0-or-later
"""The coverage of a varying interface in Cycles: 0 is the stack without its film, 1 with it, and .5 the mean."""

import bpy
import goniophotometer
import numpy as np
import pytest
from test_principled_law import principled

import lamina
from lamina import HenyeyGreenstein, Interface, Lambert, Medium, Stack

DIRECTIONS = ((0.9, 0.8, 0.1), (0.5, 0.5, 0.0), (0.3, 0.6, 2.0))
FILM = [Interface(1.33, alpha=0.2, varying=True), Medium(albedo=[0.8, 0.7, 0.5], tau=0.4)]
DUST = Medium(albedo=[0.9, 0.8, 0.6], tau=1.0, phase=HenyeyGreenstein(0.5), varying=True)
SOIL = Lambert([0.3, 0.25, 0.2])
PANE = [Interface(1.5, alpha=0.3), Medium(albedo=0.9, tau=0.5), Interface(1.0, alpha=0.3)]
STACKS = {
    "a puddle": Stack(FILM, SOIL),
    "dust on a puddle": Stack([DUST, *FILM], SOIL),
    "a wet pane": Stack([*FILM, *PANE]),
}
EQUAL = 1e-5


def fixed(stack):
    """The stack, always with its film."""
    layers = [Interface(one.ior, one.alpha) if isinstance(one, Interface) else one for one in stack.layers]
    return Stack(layers, stack.base)


@pytest.fixture(scope="module")
def baked(addon):
    """baked(stack, **inputs): a material with the baked stack and these values of the group's inputs. Equal stacks are
    baked once; of varying thicknesses every eighth is solved."""
    first = {}
    made = []

    def baked(stack, **inputs):
        if stack.hash not in first:
            first[stack.hash] = bpy.data.materials.new("Sample")
            addon.editing.layer_list.add_stack(first[stack.hash])
            addon.editing.stack_io.assign_stack(first[stack.hash], stack)
            lut = lamina.bake(stack, "preview", row_stride=1 if stack.varying is None else 8)
            addon.baking.bake_job.apply(first[stack.hash], lut)
        material = first[stack.hash].copy()
        made.append(material)
        for name, value in inputs.items():
            addon.nodes.node_group.group_nodes(material)[0].inputs[name].default_value = value
        return material

    yield baked
    for material in (*made, *first.values()):
        bpy.data.materials.remove(material)


@pytest.mark.parametrize("light", ["reflected", "transmitted", "on back faces"])
@pytest.mark.parametrize("name", STACKS)
def test_coverage_is_a_mixture(baked, name, light):
    stack = STACKS[name]
    if light == "transmitted" and stack.base is not None:
        pytest.skip("no light comes through")
    thickness = {"Thickness": 0.4} if stack.varying is not None else {}
    every = [baked(stack.uncovered, **thickness), baked(fixed(stack), **thickness),
             *(baked(stack, Coverage=coverage, **thickness) for coverage in (0.0, 1.0, 0.5, -3.0, 7.0))]
    options = {"below": light == "transmitted", "backface": light == "on back faces"}
    for direction in DIRECTIONS:
        dry, wet, at_0, at_1, half, below, above = goniophotometer.measure_many(every, *direction, samples=1, **options)
        assert np.all(dry > 0.0) and np.abs(wet / dry - 1.0).max() > 0.03
        assert at_0 == pytest.approx(dry, rel=EQUAL) and at_1 == pytest.approx(wet, rel=EQUAL)
        assert half == pytest.approx(0.5 * (dry + wet), rel=EQUAL)
        assert below == pytest.approx(dry, rel=EQUAL) and above == pytest.approx(wet, rel=EQUAL)


def test_an_artists_material_is_as_before_where_it_is_dry(addon):
    """The Principled BSDF itself, with its own inputs."""
    before = principled("Metal", {"color": (0.8, 0.4, 0.1), "metallic": 1.0, "roughness": 0.4})
    after = before.copy()
    addon.editing.over_material.add(after)
    addon.editing.over_material.assign_layers(after, Stack(FILM, SOIL))
    addon.baking.bake_job.bake_material(after, "preview")
    socket = addon.nodes.node_group.group_nodes(after)[0].inputs["Coverage"]
    for coverage, is_equal in ((0.0, True), (1.0, False)):
        socket.default_value = coverage
        for direction in DIRECTIONS:
            clean, seen = goniophotometer.measure_many([before, after], *direction, samples=1)
            assert (seen == pytest.approx(clean, rel=EQUAL)) is is_equal
    for material in (before, after):
        bpy.data.materials.remove(material)
