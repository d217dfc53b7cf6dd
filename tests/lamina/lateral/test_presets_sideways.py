# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets in millimetres: the list of these presets, mean distances compared with diffusion theory, and the channel
with the largest distance."""

import functools
import math

import numpy as np
import pytest

import lamina
from lamina import HalfSpace, Interface, Lambert, Medium, Stack, presets
from lamina.material.millimetres import has_lengths

PRESETS = [entry.id for entry in presets.entries() if entry.has_lengths]
# Too slow for this test: dark liquids with forward peaks take seconds each, a clear pond 250 mm deep takes minutes.
COSTLY = {"espresso", "mint-mocha", "silted-pond"}


def in_channel(value, index):
    """The JSON of a stack, with each list of three channels replaced by the value of one channel."""
    if isinstance(value, dict):
        return {key: in_channel(part, index) for key, part in value.items()}
    if isinstance(value, list) and len(value) == 3 and all(isinstance(part, float | int) for part in value):
        return value[index]
    return [in_channel(part, index) for part in value] if isinstance(value, list) else value


def one_channel(id, index):
    return Stack.from_json(in_channel(presets.load(id).to_json(), index))


@functools.cache
def solved(id, index):
    return lamina.searchlight(one_channel(id, index), quality="preview")


def dipole(sigma_s, sigma_a, ior):
    """(reflectance, mean distance in mm) of a half-space with isotropic scattering, from the dipole of Jensen,
    Marschner, Levoy and Hanrahan (2001), integrated over the distance. The light enters below the boundary."""
    sigma_t = sigma_s + sigma_a
    decay = math.sqrt(3.0 * sigma_a * sigma_t)
    inside = 0.0 if ior == 1.0 else -1.440 / ior**2 + 0.710 / ior + 0.668 + 0.0636 * ior
    real = 1.0 / sigma_t
    image = real * (1.0 + 4.0 / 3.0 * (1.0 + inside) / (1.0 - inside))
    r = np.geomspace(1e-4 * real, 60.0 / decay + 100.0 * real, 20001)
    density = np.zeros_like(r)
    for depth in (real, image):
        d = np.hypot(r, depth)
        density += depth * (1.0 + decay * d) * np.exp(-decay * d) / d**3
    density *= sigma_s / sigma_t / (4.0 * math.pi)
    flux = np.trapz(2.0 * math.pi * r * density, r)
    return flux, np.trapz(2.0 * math.pi * r**2 * density, r) / flux


def reduced(stack):
    """(sigma_s (1 - g), sigma_a, index) of a half-space below at most one boundary, None for other stacks."""
    if not isinstance(stack.base, HalfSpace) or any(isinstance(layer, Medium) for layer in stack.layers):
        return None
    if not hasattr(stack.base.phase, "g") and stack.base.phase.kind != "isotropic":
        return None
    g = getattr(stack.base.phase, "g", 0.0)
    return stack.base.sigma_s * (1.0 - g), stack.base.sigma_a, stack.layers[0].ior if stack.layers else 1.0


def test_what_scatters_sideways_has_lengths():
    assert {"marble-polished", "marble-honed", "whole-milk", "skim-milk", "cream", "skin-light", "skin-tan",
            "skin-three-layers", "skin-dark-three-layers", "candle-wax", "apple-flesh", "potato-flesh", "snow-fresh",
            "snow-old", "leaf", "waxy-leaf"} <= set(PRESETS)
    assert not {"gold", "soil-dry", "paper", "dusty-bronze"} & set(PRESETS)


@pytest.mark.parametrize(("stack", "expected"), [
    (Stack([Medium(sigma_s=1.0, sigma_a=0.1, thickness=2.0)]), True),
    (Stack([Interface(1.5)], HalfSpace(sigma_s=1.0, sigma_a=0.1)), True),
    (Stack([Interface(1.5)], HalfSpace(0.9)), False),
    (Stack([Medium(albedo=0.9, tau=1.0)], HalfSpace(sigma_s=1.0, sigma_a=0.1)), False),
    (Stack([Interface(1.5)], Lambert(0.5)), False),
])
def test_lengths_of_all_media(stack, expected):
    assert has_lengths(stack) is expected


@pytest.mark.parametrize(("number", "id"), [(n, id) for n, id in enumerate(PRESETS) if id not in COSTLY],
                         ids=lambda value: value if isinstance(value, str) else "")
def test_a_preset_by_diffusion_theory(number, id):
    """One channel of each preset. In bright half-spaces the dipole agrees within 10 % of the mean distance and .03 of
    the flux. Other stacks have the reflectance of the 1D solver."""
    index = number % 3
    beam, stack = solved(id, index), one_channel(id, index)
    reflectance, distance = beam.reflectance[0], beam.mean_distance[0]
    known = reduced(stack)
    if known is None or known[0] / (known[0] + known[1]) < 0.9:
        assert reflectance == pytest.approx(lamina.solve(stack, quality="preview").reflectance(1.0)[0], abs=1e-3)
        assert 0.0 < distance < math.inf
        return
    flux, expected = dipole(*known)
    mirrored = ((known[2] - 1.0) / (known[2] + 1.0)) ** 2
    assert reflectance - mirrored == pytest.approx(flux, abs=0.03)
    assert distance * reflectance / (reflectance - mirrored) == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize(("id", "order"), [
    ("marble-polished", "RGB"), ("whole-milk", "RGB"), ("skin-three-layers", "RGB"),
    ("snow-fresh", "BGR"), ("leaf", "GRB"),
])
def test_which_colour_travels_farthest(id, order):
    """Channels in order of decreasing distance. Red travels farthest in marble, milk and skin, blue in snow (ice
    absorbs red), green in a leaf."""
    distances = {name: solved(id, index).mean_distance[0] for index, name in enumerate("RGB")}
    assert "".join(sorted(distances, key=distances.get, reverse=True)) == order


def test_lengths_change_no_bake():
    """Snow and leaves in millimetres have the albedo and optical thickness of their earlier definitions."""
    leaf = presets.load("leaf")
    assert [leaf.optics(1, index) for index in range(3)] == [(0.25, 2.89), (0.686, 1.99), (0.184, 5.97)]
    assert [presets.load("snow-fresh").base.albedo_of(index) for index in range(3)] == [0.999986, 0.999995, 0.999998]
    assert [presets.load("snow-on-rock").optics(0, index)[1] for index in range(3)] == [60.0, 60.0, 60.0]
