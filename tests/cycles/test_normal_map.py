# SPDX-License-Identifier: GPL-3.0-or-later
"""The group's Normal input: a flat patch with a tilted normal looks like the material on a patch tilted by the same
angle.

Views and lights are away from grazing, where Cycles bends shading normals that would reflect the viewer below the
surface. The only light is a sun, for which closures are evaluated: Cycles 4.5 samples tilted microfacets differently
from their evaluation."""

import math

import baked_samples
import bpy
import goniophotometer
import numpy as np
import pytest

import lamina

LAMBERT = lamina.Lambert([0.5, 0.3, 0.1])
DUST = lamina.Medium(albedo=[0.9, 0.8, 0.6], tau=1.0, phase=lamina.HenyeyGreenstein(0.6))
STACKS = {
    "dust": lamina.Stack([DUST], base=LAMBERT),
    "coat": lamina.Stack([lamina.Interface(ior=1.5, alpha=0.2), DUST], base=LAMBERT),
}
TILTS = (-20.0, 15.0)  # degrees towards the viewer
# (theta_o, theta_i, dphi) in degrees and radians, on the flat patch: forward, backward, aside, near the mirror's.
DIRECTIONS = [(30.0, 35.0, 0.0), (45.0, 20.0, math.pi), (40.0, 30.0, 1.2), (25.0, 50.0, 0.3), (45.0, 10.0, 2.5)]
TOLERANCE = 1e-3


@pytest.fixture(scope="module", params=list(STACKS))
def material(request, addon):
    views = baked_samples.gauss_views(3)
    sample = baked_samples.make_sample(addon, request.param, STACKS[request.param], views, "preview")
    yield sample
    bpy.data.materials.remove(sample.material)


def _tilted(sample, degrees):
    """A copy whose Normal input is a constant vector, in the plane of incidence."""
    material = sample.material.copy()
    tree = material.node_tree
    normal = tree.nodes.new("ShaderNodeCombineXYZ")
    angle = math.radians(degrees)
    normal.inputs[0].default_value, normal.inputs[2].default_value = math.sin(angle), math.cos(angle)
    tree.links.new(normal.outputs[0], baked_samples.group_node(material, sample.lut).inputs["Normal"])
    return material


def _turned(theta_o, theta_i, dphi, degrees):
    """(mu_o, mu_i, dphi) of those directions on a patch turned by `degrees` towards the viewer."""
    angle, sin_i = math.radians(degrees), math.sin(math.radians(theta_i))
    x, y, z = -sin_i * math.cos(dphi), -sin_i * math.sin(dphi), math.cos(math.radians(theta_i))
    across, up = x * math.cos(angle) - z * math.sin(angle), x * math.sin(angle) + z * math.cos(angle)
    return math.cos(math.radians(theta_o - degrees)), up, math.atan2(-y, -across)


@pytest.mark.parametrize("degrees", TILTS)
def test_a_tilted_normal_is_a_turned_patch(material, degrees):
    tilted = _tilted(material, degrees)
    for theta_o, theta_i, dphi in DIRECTIONS:
        flat = math.cos(math.radians(theta_o)), math.cos(math.radians(theta_i)), dphi
        seen = goniophotometer.measure(tilted, *flat, samples=1)
        expected = goniophotometer.measure(material.material, *_turned(theta_o, theta_i, dphi, degrees), samples=1)
        untilted = goniophotometer.measure(material.material, *flat, samples=1)
        assert seen == pytest.approx(expected, rel=TOLERANCE), (theta_o, theta_i, dphi)
        assert np.abs(untilted / expected - 1.0).max() > 0.01, "these directions cannot tell"
    bpy.data.materials.remove(tilted)
