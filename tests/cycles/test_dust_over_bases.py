# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust of varying thickness over every kind of base, on the virtual goniophotometer: at each thickness within the error
that the report gives for this row, and at thickness 0 equal to the clean base.

Specular reflection by smooth boundaries is a delta, which a sun of angle 0 does not show. Its weights are compared with
Fresnel's reflectance and the dust's attenuation in the table, see
test_the_mirror_image_fades_as_the_dust_attenuates."""

import dataclasses
import math

import baked_samples
import bpy
import goniophotometer
import numpy as np
import pytest
from baked_samples import MIXTURE_RMS, PROMISE_FACTOR
from measured_tables import facets, measured

from lamina import Conductor, HalfSpace, HenyeyGreenstein, Interface, Isotropic, Lambert, Medium, Stack
from lamina.kinds.table import SHAPE, Strip

BRONZE = {"eta": [0.336, 0.5555, 0.948], "k": [3.091, 2.372, 2.012]}
LARGEST = 8.0
# Dust of the presets; its albedo is for color [.5, .46, .4], given directly so that it is not solved for each base.
DUST = Medium(albedo=[0.9, 0.88, 0.84], tau=LARGEST, phase=HenyeyGreenstein(0.3), varying=True)
TINT = Medium(albedo=0.1, tau=[0.6, 2.0, 2.5], phase=Isotropic())
BASES = {
    "lambert": ([], Lambert([0.8, 0.5, 0.3])),
    "dark lambert": ([], Lambert([0.05, 0.02, 0.01])),
    "textured lambert": ([], Lambert([0.5, 0.3, 0.1], textured=True)),
    "lacquer over lambert": ([Interface(ior=1.5), TINT], Lambert([0.3, 0.05, 0.04])),
    "lacquer over rough conductor": ([Interface(ior=1.5)], Conductor(alpha=0.2, **BRONZE)),
    "rough conductor": ([], Conductor(alpha=0.2, **BRONZE)),
    "smooth conductor": ([], Conductor(**BRONZE)),
    "half-space": ([], HalfSpace([0.9, 0.7, 0.4], HenyeyGreenstein(0.4))),
    "measured": ([], measured(*(facets(0.2, 0.3, diffuse) for diffuse in (0.05, 0.1, 0.3)))),
}
# Metals with lobes take a minute at final quality; the report gives the expected errors at either quality.
QUALITY = {"lacquer over rough conductor": "preview", "rough conductor": "preview", "measured": "preview"}
THICKNESSES = (0.0, 0.1, 0.5, 2.0, 8.0)

VIEWS = baked_samples.gauss_views(3)
LIGHTS = baked_samples.about_the_mirror_direction(VIEWS, 3, 6, 3.0)
DENSE = baked_samples.about_the_mirror_direction(VIEWS, 32, 48, 4.0)
# Weights are linear between columns, and between rows, where the report gives the measured error.
BETWEEN_COLUMNS = baked_samples.INTERPOLATION


@pytest.fixture(scope="module")
def tables(addon):
    """{base: its sample, at the largest thickness}."""
    made = {}
    for name, (layers, base) in BASES.items():
        made[name] = baked_samples.make_sample(addon, name, Stack([DUST, *layers], base), VIEWS,
                                               QUALITY.get(name, "final"))
    yield made
    for sample in made.values():
        bpy.data.materials.remove(sample.material)


@pytest.fixture(scope="module")
def samples(tables):
    """{(base, thickness): sample}."""
    made = {}
    for name, sample in tables.items():
        for tau in THICKNESSES:
            row = baked_samples.row_of(sample.lut, tau)
            one = baked_samples.at_row(sample, row, f"{name}, {tau:g}")
            made[name, tau] = dataclasses.replace(one, colour=_colour(sample))
    yield made
    for sample in made.values():
        bpy.data.materials.remove(sample.material)


@pytest.fixture(scope="module")
def readings(samples):
    return baked_samples.under_the_sun(list(samples.values()), "reflection", "top", LIGHTS)


PAIRS = [(name, tau) for name in BASES for tau in THICKNESSES]


@pytest.fixture(params=PAIRS, ids=lambda pair: f"{pair[0]}, {pair[1]:g}")
def sample(request, samples):
    return samples[request.param]


def _colour(sample):
    base = sample.exact.stack.base
    return tuple(base.reflectance) if getattr(base, "textured", False) else None


def _between_rows(sample):
    """The largest error that the report gives between rows near this thickness, or the general limit for preview
    tables, whose report does not measure it."""
    told = sample.lut.report.get("tau_error")
    if sample.row == int(sample.row):
        return 0.0
    return told["worst"] if told is not None else baked_samples.INTERPOLATION


def test_radiance_is_the_fitted_mixture(sample, readings):
    rms = sample.mixture_rms(readings[sample.name, "reflection", "top"], "reflection", "top", LIGHTS)
    assert np.nanmax(rms) <= MIXTURE_RMS, rms


def test_radiance_is_as_near_to_the_exact_function_as_the_report_says(sample, readings, record_property):
    reading = readings[sample.name, "reflection", "top"]
    promised = sample.promised("reflection", "top")
    with np.errstate(invalid="ignore", divide="ignore"):
        _, whole = sample.errors(reading, "reflection", "top", LIGHTS, DENSE)
    whole = np.where(_is_black(sample), 0.0, whole)
    record_property("measured", VIEWS.mean(whole))
    record_property("promised", VIEWS.mean(promised))
    record_property("between_rows", (sample.lut.report.get("tau_error") or {}).get("mean"))
    record_property("between_rows_worst", (sample.lut.report.get("tau_error") or {}).get("worst"))
    allowed = np.hypot(PROMISE_FACTOR * promised, BETWEEN_COLUMNS) + _between_rows(sample)
    assert np.all(whole <= allowed), whole / allowed


def _is_black(sample):
    """True if only a mirror image is visible: a clean smooth metal."""
    return DENSE.norm2(sample.slices("reflection", "top", DENSE)) == 0.0


@pytest.mark.parametrize("name", BASES)
def test_thickness_0_is_the_clean_base(addon, tables, samples, name):
    """Row 0 of the table equals the bake of the stack without its dust, closure by closure, and so does Cycles'
    result."""
    layers, base = BASES[name]
    # A stack of no layers is a layer of thickness 0.
    stack = Stack(layers or [dataclasses.replace(DUST, tau=0.0, varying=False)], base)
    lut = tables[name].lut
    clean = baked_samples.make_sample(addon, f"clean {name}", stack, VIEWS, lut.header["quality"])
    row = dict(zip(lut.closures, lut.weights[0, :, 0], strict=True))
    for closure, weights in zip(clean.lut.closures, clean.lut.weights[0, :, 0], strict=True):
        assert row.pop(closure, np.zeros_like(weights)) == pytest.approx(weights, rel=1e-6), closure
    others = [weights for closure, weights in row.items() if Strip.of(closure).role != SHAPE]
    assert not any(map(np.any, others)), "nothing else is there"
    shown = [clean.material, samples[name, 0.0].material]
    for mu_o, mu_i, dphi in ((0.9, 0.9, 0.1), (0.6, 0.5, 0.2), (0.3, 0.7, 2.0), (0.15, 0.2, 3.0)):
        one, other = goniophotometer.measure_many(shown, mu_o, mu_i, dphi, samples=1)
        assert other == pytest.approx(one, rel=1e-5, abs=1e-9)
    bpy.data.materials.remove(clean.material)


def test_the_mirror_image_fades_as_the_dust_attenuates(tables):
    """exp(-2 tau / mu) of the clean base's mirror image, at each row."""
    for name in ("lacquer over lambert", "lacquer over rough conductor", "smooth conductor"):
        lut = tables[name].lut
        strip = lut.weights[0, [one.startswith("mirror:") for one in lut.closures].index(True)]  # [row, column, c]
        tau = np.array(lut.header["axes"]["tau"]["values"])[:, None, None]
        mu = np.cos(np.linspace(0.0, math.pi / 2, 64))[:61, None]
        expected = strip[0, :61] * np.exp(-2.0 * tau / mu)
        assert strip[:, :61] == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(("given", "shown"), [(-3.0, 0.0), (20.0, LARGEST), (float("inf"), LARGEST)])
def test_thickness_is_clamped(samples, given, shown):
    for name in ("lambert", "smooth conductor"):
        sample = samples[name, shown]
        material = sample.material.copy()
        _feed(material, sample.lut, given)
        for mu_o, mu_i, dphi in ((0.7, 0.6, 0.8), (0.15, 0.9, 2.5)):
            seen = goniophotometer.measure_many([material, sample.material], mu_o, mu_i, dphi, samples=1)
            assert seen[0] == pytest.approx(seen[1], rel=1e-6, abs=1e-9)
        bpy.data.materials.remove(material)


def _feed(material, lut, value):
    """A Value node: the group's own input cannot hold numbers outside its range."""
    node = material.node_tree.nodes.new("ShaderNodeValue")
    node.outputs[0].default_value = value
    material.node_tree.links.new(node.outputs[0], baked_samples.group_node(material, lut).inputs["Thickness"])
