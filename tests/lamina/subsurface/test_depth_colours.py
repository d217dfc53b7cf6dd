# SPDX-License-Identifier: GPL-3.0-or-later
"""Red, green and blue of light that travels sideways, against searchlights and solves at every wavelength."""

import numpy as np
import pytest
from skimage.color import deltaE_ciede2000, rgb2lab

import lamina
from lamina import HalfSpace, HenyeyGreenstein, Interface, Lambert, Medium, Stack
from lamina.common.srgb import srgb

PIGMENTS = [("oxyhemoglobin", 0.02), ("melanin", 0.1), ("chlorophyll", 0.05), ("iron-oxide", 0.01)]


def filled(pigment, amount, thickness=np.inf, top=(), g=0.6):
    return Stack([*top, Medium(pigment=pigment, amount=amount, sigma_s=2.0, thickness=thickness,
                               phase=HenyeyGreenstein(g))])


def as_interior(stack, thickness, top=(), g=0.6):
    (material,) = lamina.interior_of_stack(stack)[0].palette
    assert material.g == pytest.approx(g)
    return Stack([*top, Medium(sigma_s=material.sigma_s, sigma_a=material.sigma_a, thickness=thickness,
                               phase=HenyeyGreenstein(g))])


def apart(first, second):
    """dE2000 of two linear colours, brought into the gamut by clipping."""
    return float(deltaE_ciede2000(*(rgb2lab(srgb(np.asarray(one))) for one in (first, second))))


@pytest.mark.parametrize("top", [(), (Interface(1.4),), (Interface(1.4, 0.3),)])
@pytest.mark.parametrize(("pigment", "amount"), PIGMENTS)
def test_a_deep_body(pigment, amount, top):
    """Color, and the mean exit distances of the channels that hold most light."""
    stack = filled(pigment, amount, top=top)
    exact, shown = (lamina.searchlight(one, quality="preview") for one in (stack, as_interior(stack, np.inf, top)))
    assert apart(stack.seen(exact.reflectance), shown.reflectance) < 1.6
    matrix = np.maximum(stack.seen(np.eye(stack.channels), 0), 0.0) * exact.reflectance
    distances = matrix @ exact.mean_distance / matrix.sum(axis=1)
    bright = shown.reflectance > 0.5 * shown.reflectance.max()
    assert np.allclose(shown.mean_distance[bright], distances[bright], rtol=0.12)


@pytest.mark.parametrize("thickness", [1.0, 2.0, 4.0])
@pytest.mark.parametrize(("pigment", "amount"), PIGMENTS)
def test_a_sheet(pigment, amount, thickness):
    stack = filled(pigment, amount, thickness)
    exact, shown = (lamina.solve(one, "preview") for one in (stack, as_interior(stack, thickness)))
    assert apart(stack.seen(exact.reflectance(0.7)), shown.reflectance(0.7)) < 2.6
    assert apart(stack.seen(exact.transmittance(0.7)), shown.transmittance(0.7)) < 6.0


def test_any_anisotropy():
    """Beyond the range of the tables, a similar medium stands in."""
    for g in (-0.4, 0.95):
        stack = filled("melanin", 0.1, g=g)
        exact, shown = (lamina.solve(one, "preview") for one in (stack, as_interior(stack, np.inf, g=g)))
        assert apart(stack.seen(exact.reflectance(0.7)), shown.reflectance(0.7)) < 1.6


def test_the_color_of_the_light():
    """Under a lamp of another color the same medium has other coefficients, and water stays nearly white."""
    warm = Stack(filled("oxyhemoglobin", 0.02).layers, wavelengths=lamina.WAVELENGTHS, illuminant="A")
    day, lamp = (lamina.interior_of_stack(one)[0].palette[0] for one in (filled("oxyhemoglobin", 0.02), warm))
    assert lamp.sigma_a[0] < day.sigma_a[0]
    (water,) = lamina.interior_of_stack(filled("water", 1.0))[0].palette
    assert max(water.sigma_a) < 4e-4 and np.allclose(water.sigma_s, 2.0, rtol=0.01)


@pytest.mark.parametrize("top", [(), (Interface(1.4, 0.3),)])
def test_nodes_have_the_color_of_the_spectrum(top):
    """Layers of two pigments: exit albedo and mean distance by channel."""
    deep = Medium(pigment="oxyhemoglobin", amount=0.02, sigma_s=2.0, thickness=np.inf, phase=HenyeyGreenstein(0.6))
    stack = Stack([*top, Medium(pigment="melanin", amount=0.3, sigma_s=3.0, thickness=0.1), deep])
    beam = lamina.searchlight(stack, quality="preview")
    on_top = 0.0
    if top:
        on_top = lamina.solve(Stack(top), "preview").reflectance(1.0)
    albedo = stack.seen(beam.reflectance - on_top) / (1.0 - on_top)
    inputs = lamina.subsurface_nodes(stack, quality="preview")
    assert np.allclose(inputs.albedo, albedo, rtol=2e-3) and inputs.color.shape == (3,)
    assert np.all(np.diff(inputs.distance) < 0.0)  # red light travels farthest


@pytest.mark.parametrize("base", [None, Lambert(0.5)])
def test_the_portal_has_the_color_of_the_spectrum(base):
    stack = Stack(filled("oxyhemoglobin", 0.02, 8.0).layers, base, wavelengths=lamina.WAVELENGTHS)
    portal, exact = lamina.portal_tables(stack, "preview"), lamina.searchlight(stack, quality="preview")
    assert portal.views.shape[1] == 3
    assert apart(portal.albedo, stack.seen(exact.reflectance)) < 1.6


def test_a_half_space_is_a_deep_layer():
    blood = lamina.pigments.absorption("oxyhemoglobin", 0.02)
    deep = Stack([Interface(1.4)], HalfSpace(sigma_s=2.0, sigma_a=blood, phase=HenyeyGreenstein(0.6)))
    layer = Stack([Interface(1.4), Medium(sigma_s=2.0, sigma_a=blood, thickness=np.inf, phase=HenyeyGreenstein(0.6))])
    assert lamina.interior_of_stack(deep)[0].hash == lamina.interior_of_stack(layer)[0].hash
