# SPDX-License-Identifier: GPL-3.0-or-later
"""Coated materials and sheets on the virtual goniophotometer: ten stacks with boundaries, seen from three
directions each, and in a white furnace.

Rough boundaries have lobes that are too sharp for a uniform rule over the hemisphere, so lights are dense about the
mirror direction. A mirror image is a delta, which a sun of angle 0 does not show; the furnace measures it."""

import dataclasses
import json
from pathlib import Path

import baked_samples
import bpy
import goniophotometer
import numpy as np
import pytest
from baked_samples import FURNACE_ERROR, INTERPOLATION, MIXTURE_RMS, PROMISE_FACTOR

import lamina

ROOT = Path(__file__).resolve().parents[2]
STACKS = json.loads((ROOT / "tests/data/gonio_coated_stacks.json").read_text())
COLOURS = {"red": (0.8, 0.2, 0.05), "white": (1.0, 1.0, 1.0), "black": (0.0, 0.0, 0.0)}
ROW = 20.5  # of thickness, at which the varying dust is seen

VIEWS = baked_samples.gauss_views(3)
LIGHTS = baked_samples.about_the_mirror_direction(VIEWS, 3, 6, 3.0)
FINEST = baked_samples.about_the_mirror_direction(VIEWS, 200, 200, 6.0)
CURVED = "halo over black lacquer"  # the albedos of its closures bend between two columns of the table
DENSE = baked_samples.about_the_mirror_direction(VIEWS, 24, 40, 4.0)


def _names():
    for data in STACKS:
        textured = (data["base"] or {}).get("textured")
        yield from (f"{data['id']}, {colour}" for colour in COLOURS) if textured else (data["id"],)


NAMES = list(_names())


@pytest.fixture(scope="module")
def samples(addon):
    def samples_of(name, stack):
        sample = baked_samples.make_sample(addon, name, stack, VIEWS)
        if stack.varying is not None:
            return [baked_samples.at_row(sample, ROW)]
        if getattr(stack.base, "textured", False):
            return [_coloured(sample, f"{name}, {colour}", COLOURS[colour]) for colour in COLOURS]
        return [sample]

    yield from baked_samples.made(STACKS, samples_of, NAMES)


def _coloured(sample, name, colour):
    material = sample.material.copy()
    baked_samples.group_node(material, sample.lut).inputs["Base Color"].default_value = (*colour, 1.0)
    stack = sample.exact.stack
    exact = lamina.solve(lamina.Stack(stack.layers, dataclasses.replace(stack.base, reflectance=colour)))
    return dataclasses.replace(sample, name=name, material=material, exact=exact, colour=colour)


@pytest.fixture(scope="module")
def readings(samples):
    found = {}
    for kind, side in (("reflection", "top"), ("reflection", "bottom"), ("transmission", "top"),
                       ("transmission", "bottom")):
        seen = [one for one in samples if (kind, side) in one.parts and (side == "top" or one.is_sheet)]
        found |= baked_samples.under_the_sun(seen, kind, side, LIGHTS)
    return found


@pytest.fixture(params=NAMES)
def sample(request, samples):
    return samples[NAMES.index(request.param)]


def _parts(sample):
    """Back faces of a stack on a base look like its front: see test_baked_material."""
    return [(kind, side) for kind, side in sample.parts if side == "top" or sample.is_sheet]


def test_radiance_is_the_fitted_mixture(sample, readings):
    for kind, side in _parts(sample):
        rms = sample.mixture_rms(readings[sample.name, kind, side], kind, side, LIGHTS)
        assert rms.max() <= MIXTURE_RMS, (kind, side, rms)


def test_every_view_and_channel_keeps_its_promise(sample, readings):
    """For a base colour of the stack's own: a table over black and one over light from the base are fitted, and the
    report holds their sum at that colour."""
    if sample.colour is not None:
        pytest.skip("the report is for the stack's own base colour")
    for kind, side in _parts(sample):
        _, whole = sample.errors(readings[sample.name, kind, side], kind, side, LIGHTS, DENSE)
        allowed = np.hypot(PROMISE_FACTOR * sample.promised(kind, side), INTERPOLATION)
        assert np.all(whole <= allowed), (kind, side, whole / allowed)


def test_white_furnace_is_the_exact_albedo(sample, furnace):
    """Mirror images included; of a sheet, R + T. Between two columns Fresnel's reflectance is not linear, and in one
    stack the closures' albedos are not linear either."""
    for side in ("top", "bottom") if sample.is_sheet else ("top",):
        mean, sigma = furnace[sample.name, side]
        exact = sample.albedo(side)
        assert np.all(sigma < sample.furnace_sigma * exact), "too noisy to say anything"
        table = sample.mixture_albedo(side, FINEST) if sample.name == CURVED else sample.albedo_between_columns(side)
        allowed = baked_samples.STRAYED if sample.is_sheet else FURNACE_ERROR * exact
        assert np.all(np.abs(mean - table) <= allowed), (side, mean - table)
        assert np.all(np.abs(table - exact) <= INTERPOLATION * exact), (side, table / exact - 1.0)


def test_base_colour_follows_the_pixels_of_a_texture(samples):
    """One material on three patches side by side, each under its own pixel."""
    coloured = [one for one in samples if one.colour is not None]
    material = coloured[0].material.copy()
    image = bpy.data.images.new("base colour", len(coloured), 1, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(np.ravel([(*one.colour, 1.0) for one in coloured]).astype(np.float32))
    image.pack()
    _colour_by_position(material, image, coloured[0].lut)
    for view, mu_o in enumerate(VIEWS.mu.tolist()):
        mu_i, dphi = LIGHTS.mu[view, 10], LIGHTS.dphi[view, 10]
        seen = goniophotometer.measure_many([material] * len(coloured), mu_o, mu_i, dphi, samples=1)
        expected = [one.mixture("reflection", "top", LIGHTS)[view, 10] for one in coloured]
        assert seen == pytest.approx(np.array(expected), rel=MIXTURE_RMS, abs=1e-7)
    bpy.data.materials.remove(material)
    bpy.data.images.remove(image)


def _colour_by_position(material, image, lut):
    """The image across the patches, which are of unit width along y."""
    tree = material.node_tree
    place = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"], place.inputs[0])
    across = tree.nodes.new("ShaderNodeMath")
    across.operation = "DIVIDE"
    tree.links.new(place.outputs[1], across.inputs[0])
    across.inputs[1].default_value = image.size[0]
    corner = tree.nodes.new("ShaderNodeCombineXYZ")
    tree.links.new(across.outputs[0], corner.inputs[0])
    corner.inputs[1].default_value = 0.5
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.interpolation = image, "Closest"
    tree.links.new(corner.outputs[0], texture.inputs[0])
    tree.links.new(texture.outputs["Color"], baked_samples.group_node(material, lut).inputs["Base Color"])
