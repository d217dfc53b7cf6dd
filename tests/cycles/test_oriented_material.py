# SPDX-License-Identifier: GPL-3.0-or-later
"""Brushed metals on the virtual goniophotometer: the tangent picks the row of the table."""

import math

import bpy
import goniophotometer
import numpy as np
import pytest

import lamina
from lamina import Conductor, HenyeyGreenstein, Interface, Medium, Stack

if bpy.app.version < (5, 0):
    pytest.skip("anisotropic facets need Blender 5.0", allow_module_level=True)

GOLD = {"facing": (1.0, 0.7837, 0.3427), "grazing": (1.0, 0.8899, 0.6307)}
STACKS = {
    "brushed gold": Stack([], Conductor(alpha=0.08, alpha_v=0.35, **GOLD)),
    "brushed gold under lacquer": Stack([Interface(1.5)], Conductor(alpha=0.08, alpha_v=0.35, angle=0.5, **GOLD)),
}
# (view cosine, azimuth of the view from the tangent): in all quadrants, and between rows and columns.
VIEWS = [(0.95, 0.3), (0.7, 1.2), (0.7, -1.2), (0.5, 2.0), (0.3, -0.4), (0.5, math.pi / 2 + 0.01)]
COSINES, AZIMUTHS = (0.15, 0.4, 0.6, 0.8, 0.97), (0.0, 0.15, -0.4, 1.0, -2.0, 3.0)
MIXTURE = 5e-3
# Relative L2 error of the light of these few directions.
LARGEST_ERROR = 0.1
LARGEST_ERROR_OF_LAYERS = 0.2  # the report's worst slice over all directions has .125


@pytest.fixture(scope="module", params=STACKS)
def sample(request, addon):
    material = bpy.data.materials.new(request.param)
    addon.editing.stack_io.assign_stack(material, STACKS[request.param])
    lut = addon.baking.bake_job.bake_material(material, "preview")
    yield material, lut
    bpy.data.materials.remove(material)


def turn_to(material, phi_o):
    """Link a tangent from which the viewer, who is at azimuth 0, has the azimuth `phi_o`."""
    tree = material.node_tree
    node = next(node for node in tree.nodes if node.type == "GROUP")
    vector = tree.nodes.new("ShaderNodeCombineXYZ")
    vector.inputs[0].default_value, vector.inputs[1].default_value = math.cos(phi_o), -math.sin(phi_o)
    tree.links.new(vector.outputs[0], node.inputs["Tangent"])


def test_radiance_is_the_fitted_mixture_and_near_the_stack(sample):
    material, lut = sample
    exact = lamina.solve(lut.stack, "preview")
    for mu_o, phi_o in VIEWS:
        turn_to(material, phi_o)
        lights = [(mu_i, dphi) for mu_i in COSINES for dphi in AZIMUTHS]
        # The goniophotometer's light is at azimuth pi + dphi, the solver's at pi - dphi
        seen = np.array([goniophotometer.measure(material, mu_o, mu_i, -dphi, samples=1) for mu_i, dphi in lights])
        mu_i, dphi = np.array(lights).T
        mixture = lut.evaluate(mu_o, mu_i, dphi, phi_o=phi_o) * mu_i[:, None]
        dark = np.maximum(mixture, 1e-4 * mixture.max())
        assert np.abs(seen / dark - mixture / dark).max() <= MIXTURE, (mu_o, phi_o)
        wanted = exact.brdf(mu_o, mu_i, dphi, phi_o=phi_o) * mu_i[:, None]
        error = np.sqrt(((seen - wanted) ** 2).sum() / (wanted**2).sum())
        assert error <= LARGEST_ERROR, (mu_o, phi_o)


def test_a_furnace_shows_the_exact_albedo(sample):
    material, lut = sample
    exact = lamina.solve(lut.stack, "preview")
    for mu_o, phi_o in VIEWS[:4]:
        turn_to(material, phi_o)
        mean = goniophotometer.furnace(material, mu_o, samples=4096)
        assert mean == pytest.approx(exact.reflectance(mu_o, phi=phi_o), rel=1e-2), (mu_o, phi_o)


def test_an_empty_input_reads_the_uv_map(sample):
    """A plane whose u grows along y, seen from x: the azimuth of the view is -90 degrees."""
    material, lut = sample
    node = next(node for node in material.node_tree.nodes if node.type == "GROUP")
    turn_to(material, -math.pi / 2)
    args = (0.6, 0.5, 0.4)
    linked = goniophotometer.measure(material, *args, samples=1)
    for link in list(node.inputs["Tangent"].links):
        material.node_tree.links.remove(link)
    patch = goniophotometer._patch

    def with_uv(*given):
        mesh = patch(*given)
        layer = mesh.uv_layers.new(name="uv")
        for loop in mesh.loops:
            x, y, _ = mesh.vertices[loop.vertex_index].co
            layer.data[loop.index].uv = (y, -x)
        return mesh

    with pytest.MonkeyPatch.context() as change:
        change.setattr(goniophotometer, "_patch", with_uv)
        assert goniophotometer.measure(material, *args, samples=1) == pytest.approx(linked, rel=1e-3)


LAYERED = Stack([Medium((0.75, 0.68, 0.58), 1.0, HenyeyGreenstein(0.6), varying=True)],
                Conductor(alpha=0.08, alpha_v=0.3, angle=0.5, **GOLD))


@pytest.fixture(scope="module")
def dusty(addon):
    material = bpy.data.materials.new("dusty brushed gold")
    addon.editing.stack_io.assign_stack(material, LAYERED)
    lut = addon.baking.bake_job.bake_material(material, "preview")
    yield material, lut
    bpy.data.materials.remove(material)


@pytest.mark.parametrize("tau", [0.0, 0.03, 0.4, 1.0])
def test_a_varying_layer_has_both_axes(dusty, tau):
    """Thickness and azimuth are read between the rows of the table; the light is near that of the stack."""
    material, lut = dusty
    node = next(node for node in material.node_tree.nodes if node.type == "GROUP")
    node.inputs["Thickness"].default_value = tau
    exact = lamina.solve(LAYERED, "preview").with_thickness(0, tau)
    for mu_o, phi_o in VIEWS:
        turn_to(material, phi_o)
        lights = [(mu_i, dphi) for mu_i in COSINES for dphi in AZIMUTHS]
        seen = np.array([goniophotometer.measure(material, mu_o, mu_i, -dphi, samples=1) for mu_i, dphi in lights])
        mu_i, dphi = np.array(lights).T
        mixture = lut.evaluate(mu_o, mu_i, dphi, phi_o=phi_o, tau=tau) * mu_i[:, None]
        dark = np.maximum(mixture, 1e-4 * mixture.max())
        assert np.abs(seen / dark - mixture / dark).max() <= MIXTURE, (mu_o, phi_o)
        wanted = exact.brdf(mu_o, mu_i, dphi, phi_o=phi_o) * mu_i[:, None]
        error = np.sqrt(((seen - wanted) ** 2).sum() / (wanted**2).sum())
        assert error <= LARGEST_ERROR_OF_LAYERS, (mu_o, phi_o)
