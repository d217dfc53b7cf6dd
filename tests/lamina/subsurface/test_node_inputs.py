# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of Cycles' Subsurface Scattering node: the resulting walk has the target albedo and distance."""

import cycles_walk
import numpy as np
import pytest
from z_limit import z_limit

import lamina
from lamina import Conductor, HalfSpace, HenyeyGreenstein, Interface, Lambert, Medium, PrincipledBase, Stack
from lamina.common.errors import ArgumentError, StackError
from lamina.subsurface.entry_cosines import entry_cosines
from lamina.subsurface.first_flights import FirstFlights
from lamina.subsurface.later_flights import escape
from lamina.subsurface.node_inputs import RESPONSE_ERRORS
from lamina.subsurface.node_parameters import albedo_of_colour, colour_of_albedo
from lamina.subsurface.node_response import single_albedo
from lamina.subsurface.response_table import CURVE, response_curves

VERSIONS = [(4, 5), (5, 2)]
COUNT = 60_000
WORST_Z = z_limit(80)


def half_space(albedo, g=0.0):
    return Stack([], HalfSpace(sigma_s=albedo, sigma_a=1.0 - np.asarray(albedo), phase=HenyeyGreenstein(g)))


def mean_free_path(radius, g, version):
    """1 / sigma_t of the node's medium; before 5.2, sigma_t (1 - g) is 4 pi / radius."""
    return radius if version >= (5, 2) else radius * (1.0 - g) / (4.0 * np.pi)


def walked(inputs, index, mu_in, seed):
    """(exit albedo, its standard error, mean distance, its standard error) of the node's closures, from photons."""
    light = moment = light_variance = moment_variance = 0.0
    for k, (weight, colour, radius) in enumerate([(1.0, inputs.color, inputs.radius),
                                                  (inputs.extra_weight, inputs.extra_color, inputs.extra_radius)]):
        if weight == 0.0 or colour[index] == 0.0:
            continue
        single = float(albedo_of_colour(colour[index], inputs.anisotropy, inputs.version))
        path = float(mean_free_path(radius[index], inputs.anisotropy, inputs.version))
        left = cycles_walk.walk(single, path, inputs.anisotropy, mu_in, COUNT, seed + k)
        light += weight * left.albedo
        moment += weight * left.moment
        light_variance += (weight * left.albedo_error) ** 2
        moment_variance += (weight * left.moment_error) ** 2
    return light, light_variance**0.5, moment / light, moment_variance**0.5 / light


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize(("albedo", "g"), [(0.3, 0.0), (0.9, 0.0), (0.99, 0.0), (0.9, 0.5), (0.99, 0.8), (0.97, 0.9)])
def test_walk_of_a_half_space(albedo, g, version):
    """One closure has the exit albedo and mean exit distance of the searchlight, in the anisotropic walks of both
    versions."""
    beam = lamina.searchlight(half_space(albedo, g), quality="preview")
    inputs = lamina.subsurface_inputs(beam.reflectance, beam.mean_distance, g, version)
    assert inputs.extra_weight == 0.0
    light, light_error, way, way_error = walked(inputs, 0, 1.0, 7)
    # The documented errors are .3 % and 1 %; the errors of the method are about .05 % and .1 %.
    assert abs(light - beam.reflectance[0]) < WORST_Z * light_error + 5e-4 * light
    assert abs(way - beam.mean_distance[0]) < WORST_Z * way_error + 1e-3 * way
    assert inputs.albedo == pytest.approx(beam.reflectance, rel=1e-5)
    assert inputs.distance == pytest.approx(beam.mean_distance, rel=1e-5)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize(("albedo", "g"), [(0.999, 0.0), (0.9999, 0.6)])
def test_light_that_the_limit_of_flights_loses_comes_back(albedo, g, version):
    beam = lamina.searchlight(half_space(albedo, g), quality="preview")
    inputs = lamina.subsurface_inputs(beam.reflectance, beam.mean_distance, g, version)
    assert 0.0 < inputs.extra_weight < 1.0
    light, light_error, way, way_error = walked(inputs, 0, 1.0, 11)
    assert abs(light - beam.reflectance[0]) < WORST_Z * light_error + 5e-4 * light
    assert abs(way - beam.mean_distance[0]) < WORST_Z * way_error + 1e-3 * way


def test_shares_that_are_known():
    """Albedo 1, isotropic: the exit albedo is .897855 for light along the normal, and .918670 for Lambert light."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    cosines = 0.5 * (nodes + 1.0)
    for curves, share in ((response_curves(0.0, np.ones(1), np.ones(1)), 0.897855),
                          (response_curves(0.0, cosines, weights * cosines), 0.918670)):
        assert curves.albedo[0] == pytest.approx(share, abs=1e-4)
        assert curves.single[0] == pytest.approx(1.0, abs=1e-6)


def exit_albedo(g, cosines, places):
    """Exit albedo of Cycles' walk, shape (place, cosine): without the table, at the positions `places` on CURVE."""
    first = FirstFlights(g, cosines)
    leaving, tenth = first.at(0.0)
    later = escape(np.zeros(1), 1.0 - places**4)
    albedo = single_albedo(places, g)
    found = []
    for k, a in enumerate(albedo):
        early = np.tensordot(a ** np.arange(1, 10), leaving, (0, 0))
        depths = first.cells.depths * (1.0 - a * g)
        late = (later.cells.interpolation(depths) @ later.limited[0, :, k]) * first.cells.weights
        found.append(early + a**10 * late @ tenth)
    return np.array(found)


@pytest.mark.parametrize("g", [0.1, 0.7, 0.8, 0.88])
def test_between_the_nodes_of_the_table(g):
    cosines, places = np.array([0.1, 0.4, 0.9, 1.0]), np.array([0.34, 0.56, 0.7, 0.82, 0.92, 0.96])
    wanted = exit_albedo(g, cosines, places)
    for cosine, column in zip(cosines, wanted.T, strict=True):
        curves = response_curves(g, np.array([cosine]), np.ones(1))
        assert np.interp(places, CURVE, curves.albedo) == pytest.approx(column, rel=RESPONSE_ERRORS[0])


@pytest.mark.parametrize("mu_in", [0.15, 0.6])
def test_light_that_enters_aslant(mu_in):
    curves = response_curves(0.6, np.array([mu_in]), np.ones(1))
    place = np.interp(-0.95, -curves.single, CURVE)
    left = cycles_walk.walk(0.95, 1.0, 0.6, mu_in, COUNT, 3)
    light, way = np.interp(place, CURVE, curves.albedo), np.interp(place, CURVE, curves.distance) / (1.0 - 0.95 * 0.6)
    assert abs(left.albedo - light) < WORST_Z * left.albedo_error + 5e-4 * light
    assert abs(left.moment - light * way) < WORST_Z * left.moment_error + 1e-3 * light * way


def test_rough_entry():
    """Compared with randomly sampled facets: visible GGX normals in proportion to their projected area."""
    rng = np.random.default_rng(5)
    mu, ior, alpha = 0.6, 1.4, 0.5
    # Slopes of GGX facets, kept with the probability of their area as seen from the view.
    tangent = alpha * np.sqrt((u := rng.random(400_000)) / (1.0 - u))
    turn = 2.0 * np.pi * rng.random(len(u))
    cosine = 1.0 / np.hypot(1.0, tangent)
    view = np.array([np.sqrt(1.0 - mu * mu), 0.0, mu])
    normals = np.stack([tangent * cosine * np.cos(turn), tangent * cosine * np.sin(turn), cosine])
    area = np.maximum(view @ normals, 0.0) / cosine
    meeting = view @ normals
    inside = np.sqrt(1.0 - (1.0 - meeting**2) / ior**2)
    entered = mu / ior - (meeting / ior - inside) * normals[2]
    cosines, shares = entry_cosines(mu, ior, alpha)
    for power in (1, 2, 4):
        wanted = np.average(np.where(entered > 0.0, entered, 0.0) ** power, weights=area)
        assert shares @ cosines**power == pytest.approx(wanted, rel=5e-3)


def test_stack_with_a_boundary():
    """The Glossy closure has the boundary's reflection; the node has the rest of the light, at its mean distance."""
    stack = Stack([Interface(1.5), Medium(sigma_s=[2.0, 1.0, 0.5], sigma_a=[0.02, 0.1, 0.5], thickness=4.0,
                                          phase=HenyeyGreenstein(0.3))], Lambert(0.4))
    inputs = lamina.subsurface_nodes(stack, (5, 2), quality="preview")
    beam = lamina.searchlight(stack, quality="preview")
    assert inputs.ior == 1.5 and inputs.roughness == 0.0 and inputs.anisotropy == pytest.approx(0.3)
    mirrored = 0.04
    assert inputs.albedo == pytest.approx((beam.reflectance - mirrored) / (1.0 - mirrored), rel=1e-4)
    moment = beam.mean_distance * beam.reflectance
    assert inputs.distance * (beam.reflectance - mirrored) == pytest.approx(moment, rel=1e-3)
    for channel in range(3):
        light, light_error, way, way_error = walked(inputs, channel, 1.0, 20 + channel)
        assert abs(light - inputs.albedo[channel]) < WORST_Z * light_error + 5e-4 * light
        assert abs(way - inputs.distance[channel]) < WORST_Z * way_error + 1e-3 * way


def test_texels_at_once():
    """Arrays keep their shape; one weight is valid for all texels, including black ones."""
    albedo = np.array([[0.0, 0.02, 0.5], [0.97, 0.9, 1.0]])
    distance = np.array([[0.0, 0.1, 0.4], [3.0, 1.0, 9.0]])
    inputs = lamina.subsurface_inputs(albedo, distance, 0.7)
    for array in (inputs.color, inputs.radius, inputs.extra_color, inputs.extra_radius, inputs.albedo_error):
        assert array.shape == albedo.shape and np.all(np.isfinite(array))
    assert np.all(np.abs(inputs.albedo_error) < 1e-3) and np.all(np.abs(inputs.distance_error) < 5e-3)
    assert inputs.color[0, 0] == 0.0 and 0.0 < inputs.extra_weight < 1.0
    assert "with a second closure" in inputs.report


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("g", [0.0, 0.45, 0.9])
def test_colours_and_albedos(g, version):
    albedos = np.array([0.01, 0.05, 0.2, 0.9, 0.999, 0.99999])
    colours = colour_of_albedo(albedos, g, version)
    assert np.all(np.diff(colours) > 0.0) and colours[0] > 0.0 and colours[-1] <= 1.0
    assert colour_of_albedo(0.0, g, version) == 0.0
    assert albedo_of_colour(colours, g, version) == pytest.approx(albedos, abs=1e-6)


@pytest.mark.parametrize(("change", "words"), [
    ({"albedo": 1.2}, "albedo = 1.2: must lie in [0, 1]"),
    ({"distance": -1.0}, "distance = -1: must be at least 0"),
    ({"distance": np.inf}, "distance holds a value that is not finite"),
    ({"distance": [1.0, 2.0]}, "distance has the shape (2,): must have that of albedo, ()"),
    ({"anisotropy": 0.95}, "anisotropy = 0.95: must lie in [0, 0.9]"),
    ({"version": (3, 6)}, "version = (3, 6): must be a release of Blender from (4, 2) on"),
    ({"version": 5}, "version = 5: must be a release of Blender from (4, 2) on"),
    ({"mu": 0.0}, 'mu = 0.0: must lie in (0, 1], or be "diffuse"'),
    ({"ior": 1.0}, "ior = 1.0: must lie in [1.01, 3.8]"),
    ({"roughness": 2.0}, "roughness = 2.0: must lie in [0, 1]"),
])
def test_bad_arguments(change, words):
    with pytest.raises(ArgumentError) as raised:
        lamina.subsurface_inputs(**{"albedo": 0.5, "distance": 1.0, **change})
    assert str(raised.value) == words


def test_light_that_nothing_absorbs():
    with pytest.raises(StackError, match="channel 0: light that nothing absorbs leaves at an infinite mean distance"):
        lamina.subsurface_nodes(half_space(1.0), quality="preview")


METALS = {"conductor": Conductor(eta=0.2, k=3.5), "principled": PrincipledBase(color=[0.8, 0.5, 0.2], metallic=1.0)}


def enamel(thickness):
    return [Interface(1.5), Medium(sigma_s=[20.0, 30.0, 40.0], sigma_a=0.1, thickness=thickness)]


@pytest.mark.parametrize("compute", [lamina.subsurface_nodes, lamina.portal_tables])
@pytest.mark.parametrize("base", METALS)
@pytest.mark.parametrize(("layers", "words"), [
    ([], "channel 0: the base is a metal, and 100 % of the light can reach it and return without scattering"),
    (enamel(0.1), "channel 0: the base is a metal, and 1.8 % of the light can reach it and return without scattering"),
])
def test_metal_that_shows_is_refused(compute, base, layers, words):
    with pytest.raises(StackError) as raised:
        compute(Stack(layers, METALS[base]), quality="preview")
    assert str(raised.value) == (f"{words}: must be at most 1 %, by media above it, for light that travels sideways")


def test_metal_below_deep_enamel():
    """Nearly all light that leaves was scattered, so that the base does not matter for its directions."""
    stack = Stack(enamel(0.3), METALS["conductor"])
    beam = lamina.searchlight(stack, quality="preview")
    inputs = lamina.subsurface_nodes(stack, quality="preview")
    assert inputs.albedo == pytest.approx((beam.reflectance - 0.04) / 0.96, rel=1e-3)
