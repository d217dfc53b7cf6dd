# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust over an anisotropic Principled BSDF of the artist, against the BSDF itself and against a solve."""

import functools
import math

import bpy
import goniophotometer
import numpy as np
import pytest

import lamina
from lamina import Conductor, HenyeyGreenstein, Medium, Stack

DUST = Medium((0.75, 0.68, 0.58), 1.0, HenyeyGreenstein(0.6), varying=True)
REFLECTANCE, ROUGHNESS, ANISOTROPIC, ROTATION = 0.9, 0.35, 0.6, 0.1
VIEWS = [(0.9, 0.3), (0.6, 1.2), (0.6, -0.9), (0.4, 1.8)]  # (view cosine, azimuth of the view from the tangent)
COSINES, AZIMUTHS = (0.25, 0.5, 0.7, 0.95), (0.0, 0.3, -0.5, 1.2, -2.2)
GRAZING = 0.96  # of the solver's metal, whose Fresnel curve differs by up to 10 % from that of the BSDF
# Relative L2 error of the light of these few directions, by thickness.
LARGEST = {0.05: 0.07, 0.3: 0.2, 1.0: 0.19}


def steel(name):
    """(material, its Principled BSDF, the node of its tangent)."""
    material = bpy.data.materials.new(name)
    tree = goniophotometer.node_tree.of(material)
    node, vector = tree.nodes["Principled BSDF"], tree.nodes.new("ShaderNodeCombineXYZ")
    values = {"Base Color": (*(REFLECTANCE,) * 3, 1.0), "Metallic": 1.0, "Roughness": ROUGHNESS,
              "Anisotropic": ANISOTROPIC, "Anisotropic Rotation": ROTATION}
    for socket, value in values.items():
        node.inputs[socket].default_value = value
    tree.links.new(vector.outputs[0], node.inputs["Tangent"])
    return material, node, vector


def turn_to(vector, phi_o):
    vector.inputs[0].default_value, vector.inputs[1].default_value = math.cos(phi_o), -math.sin(phi_o)


def seen(material, mu_o):
    return np.array([goniophotometer.measure(material, mu_o, mu_i, -dphi, samples=1)
                     for mu_i in COSINES for dphi in AZIMUTHS])


@pytest.fixture(scope="module")
def dusty(addon):
    material, _, vector = steel("dusty")
    addon.editing.over_material.add(material)
    addon.editing.over_material.assign_layers(material, Stack([DUST]))
    addon.baking.bake_job.bake_material(material, "preview")
    yield material, vector
    bpy.data.materials.remove(material)


def group_of(material):
    return next(node for node in material.node_tree.nodes if node.type == "GROUP")


def test_without_dust_it_is_the_artists_own(dusty):
    material, vector = dusty
    clean, _, own = steel("clean")
    group_of(material).inputs["Thickness"].default_value = 0.0
    for mu_o, phi_o in VIEWS:
        turn_to(vector, phi_o)
        turn_to(own, phi_o)
        assert seen(material, mu_o) == pytest.approx(seen(clean, mu_o), rel=1e-3, abs=1e-6)


def errors_of(material, vector, exact):
    errors = []
    for mu_o, phi_o in VIEWS:
        turn_to(vector, phi_o)
        mu_i, dphi = np.array([(mu_i, dphi) for mu_i in COSINES for dphi in AZIMUTHS]).T
        wanted = exact.brdf(mu_o, mu_i, dphi, phi_o=phi_o) * mu_i[:, None]
        errors.append(float(np.sqrt(((seen(material, mu_o) - wanted) ** 2).sum() / (wanted**2).sum())))
    return errors


@functools.cache
def solved():
    aspect = math.sqrt(1.0 - 0.9 * ANISOTROPIC)
    metal = Conductor(facing=REFLECTANCE, grazing=GRAZING, alpha=ROUGHNESS**2 / aspect,
                      alpha_v=ROUGHNESS**2 * aspect, angle=2.0 * math.pi * ROTATION)
    return lamina.solve(Stack([DUST], metal), "preview")


@pytest.mark.parametrize("tau", LARGEST)
def test_dust_is_near_the_solve(dusty, tau):
    """Light that passes the dust unscattered has the anisotropic lobe; scattered light is that of round facets."""
    material, vector = dusty
    group = group_of(material)
    group.inputs["Thickness"].default_value = tau
    exact = solved().with_thickness(0, tau)
    errors = errors_of(material, vector, exact)
    assert max(errors) <= LARGEST[tau], errors
    bsdf = next(node for node in group.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    assert bsdf.inputs["Anisotropic"].default_value == pytest.approx(ANISOTROPIC)
    bsdf.inputs["Anisotropic"].default_value = 0.0
    try:
        round_errors = errors_of(material, vector, exact)
    finally:
        bsdf.inputs["Anisotropic"].default_value = ANISOTROPIC
    assert np.mean(errors) <= 0.65 * np.mean(round_errors)
