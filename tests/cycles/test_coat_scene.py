# SPDX-License-Identifier: GPL-3.0-or-later
"""A coat of modelled glass, path traced with caustics, agrees with the exact scattering function and the baked coat.

Seeds are fixed, and Cycles gives the same pixels for the same seed, so no test here depends on chance.
"""

import sys
from pathlib import Path

import baked_samples
import bpy
import numpy as np
import pytest
from z_limit import z_limit

import lamina

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "demo_scenes"))

import cycles_render  # noqa: E402
from coat import exact, geometry, light, scene  # noqa: E402

COSINES = (0.95, 0.7, 0.4, 0.15)
AZIMUTH = 0.2  # of the cap, from straight ahead
SEEDS, SIZE, SAMPLES = 8, 16, 64
FAMILY_RISK = 1e-3  # of a false alarm among all values that one test compares
# Light lost by Cycles' sampling of rough glass: R + T of the glass alone, seen from air, is up to .3 % smaller than the
# exact sum (alpha .3).
LOST = {"smooth": 1e-3, "rough": 5e-3}
SKIES = {"even": (1.0, 1.0), "cap": (light.CAP, light.SKY)}


def _measure(stack, body, sky, material=None, samples=SAMPLES):
    """(means, standard errors) for all COSINES, each (views, 3)."""
    results = []
    for mu_o in COSINES:
        stage = scene.instrument(stack, body, mu_o, AZIMUTH, *SKIES[sky], material)
        scene.set_quality(stage, SIZE, samples)
        seen = cycles_render.render_seeds(stage, SEEDS)[0].mean(axis=(1, 2))
        bpy.data.scenes.remove(stage)
        results.append((seen.mean(axis=0), seen.std(axis=0, ddof=1) / np.sqrt(SEEDS)))
    return np.moveaxis(np.array(results), 1, 0)


def _exact(stack, sky):
    scattering = lamina.solve(lamina.Stack.from_json(stack))
    if sky == "even":
        return scattering.reflectance(np.array(COSINES))
    return exact.radiance(scattering, COSINES, np.full(len(COSINES), AZIMUTH))


@pytest.mark.parametrize("sky", list(SKIES))
@pytest.mark.parametrize("name", list(scene.STACKS))
def test_modelled_glass_is_the_exact_scattering_function(name, sky):
    """Z-scores, once the little that Cycles' own glass loses is allowed for."""
    stack = scene.load_stack(scene.STACKS[name])
    seen, sigma = _measure(stack, "glass", sky)
    expected = _exact(stack, sky)
    assert np.all(sigma < 0.01 * expected), "too noisy to say anything"
    beyond = np.maximum(np.abs(seen - expected) - LOST[name] * expected, 0.0)
    assert (beyond / sigma).max() < z_limit(beyond.size, FAMILY_RISK, SEEDS - 1), seen / expected - 1.0


@pytest.mark.parametrize("name", list(scene.STACKS))
def test_the_baked_coat_is_the_exact_scattering_function(name, addon):
    stack = scene.load_stack(scene.STACKS[name])
    sample = baked_samples.make_sample(
        addon, f"{name} coat", lamina.Stack.from_json(stack), baked_samples.gauss_views(3))
    for sky in SKIES:
        seen, sigma = _measure(stack, "baked", sky, sample.material)
        expected = _exact(stack, sky)
        # An even sky weighs albedos, which are fitted exactly; a cap is a part of the slice.
        fit = 3.6e-3 if sky == "even" else sample.lut.report["worst_slice"]["error"]
        assert np.all(np.abs(seen - expected) <= fit * expected + 5.0 * sigma), (sky, seen / expected - 1.0)
    bpy.data.materials.remove(sample.material)


def test_the_width_of_the_glass_lets_no_light_leak(monkeypatch):
    stack = scene.load_stack(scene.STACKS["smooth"])
    before = _measure(stack, "glass", "even")[0]
    monkeypatch.setattr(geometry, "HALF_WIDTH", geometry.HALF_WIDTH / 2.0)
    assert _measure(stack, "glass", "even")[0] == pytest.approx(before, rel=3e-3)


@pytest.mark.parametrize(("change", "field"), [
    ({"base": {"kind": "black"}}, "base.kind"),
    ({"layers": []}, "layers"),
    ({"layers": [{"kind": "interface", "ior": [1.4, 1.5, 1.6]}]}, "layers\\[0\\].ior"),
])
def test_what_cycles_glass_lacks_is_refused_in_a_sentence(change, field):
    with pytest.raises(ValueError, match=field):
        scene.build({**scene.load_stack(scene.STACKS["smooth"]), **change}, "glass")
