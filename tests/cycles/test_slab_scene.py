# SPDX-License-Identifier: GPL-3.0-or-later
"""The slab demo: its volume agrees with the exact scattering function, and its verdict is reliable.

Seeds are fixed, and Cycles gives the same pixels for the same seed, so no test here depends on chance.
"""

import dataclasses
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from z_limit import z_limit

import lamina

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "demo_scenes"))

import comparison  # noqa: E402
import cycles_render  # noqa: E402
from slab import exact, light, scene, view  # noqa: E402

SIZE = 64
FAMILY_RISK = 1e-3  # of a false alarm among all values that one test compares
BANDS = 3

COLOURED = {
    "schema": 1,
    "layers": [
        {"kind": "medium", "albedo": [0.9, 0.6, 0.3], "tau": [0.5, 1.0, 0.25], "phase": {"kind": "hg", "g": -0.3}},
        {"kind": "medium", "albedo": 0.8, "tau": 0.7, "phase": {"kind": "rayleigh"}},
    ],
    "base": {"kind": "lambert", "reflectance": [0.2, 0.5, 0.8]},
}


def _render(stack, seeds, samples, size=SIZE):
    stage = scene.build(stack, "volume")
    scene.set_quality(stage, size, samples)
    return cycles_render.render_seeds(stage, seeds)[0]


def _bands(pictures, region):
    """Means over BANDS x BANDS parts of the picture, shape (..., parts, 3)."""
    height, width = region.shape
    masks = []
    for rows in np.array_split(np.flatnonzero(region.any(axis=1)), BANDS):
        for columns in np.array_split(np.arange(width), BANDS):
            mask = np.zeros_like(region)
            mask[np.ix_(rows, columns)] = True
            masks.append(mask & region)
    return np.stack([pictures[..., mask, :].mean(axis=-2) for mask in masks], axis=-2)


@pytest.mark.parametrize(
    ("stack", "precision"), [(scene.load_stack(), 0.02), (COLOURED, 0.02)], ids=["standard", "coloured"]
)
def test_the_volume_is_the_exact_scattering_function(stack, precision):
    region = view.pixels(SIZE).region
    seeds = 16
    rendered = _bands(_render(stack, seeds, 32), region)
    expected = _bands(exact.picture(lamina.solve(lamina.Stack.from_json(stack)), SIZE, subdivide=5), region)
    sigma = rendered.std(axis=0, ddof=1) / np.sqrt(seeds)
    assert np.all(sigma < precision * expected), "too noisy to say anything"
    z = (rendered.mean(axis=0) - expected) / sigma
    assert np.abs(z).max() < z_limit(z.size, FAMILY_RISK, seeds - 1)


@pytest.mark.parametrize(
    ("name", "value"), [("VOLUME_BOUNCES", 2 * scene.VOLUME_BOUNCES), ("HALF_WIDTH", scene.HALF_WIDTH / 20.0)]
)
def test_neither_bounces_nor_edges_matter(monkeypatch, name, value):
    region = view.pixels(32).region
    before = _render(scene.load_stack(), 1, 64, size=32)[0][region].mean()
    monkeypatch.setattr(scene, name, value)
    after = _render(scene.load_stack(), 1, 64, size=32)[0][region].mean()
    assert after == pytest.approx(before, rel=1e-4)


def test_the_sky_is_what_the_numbers_say():
    rays = view.pixels(SIZE)
    sky = rays.mu_o < -0.02
    # The volume's box ends below the horizon, so these pixels see the world alone.
    rendered = _render(scene.load_stack(), 1, 16)[0][sky]
    assert rendered == pytest.approx(light.sky_radiance(-rays.mu_o[sky]), rel=5e-3)


def test_the_demo_makes_its_files_and_the_two_slabs_agree(demo, tmp_path):
    facts, printed = demo("slab")
    last = printed.strip().splitlines()[-1]
    # The picture that needs no volume is there before the first line on the volume's render.
    first, volume = printed.index("slab_baked.png is written: baked"), printed.index("volume: seed")
    assert first < volume
    assert "slab.png" in last and "slab.json" in last and " agree" in last
    noise = np.hypot(facts["sigma_truth"], facts["sigma_baked"])
    assert abs(facts["mean_baked"] - facts["mean_truth"]) < 3 * noise + facts["fit_error"] * facts["mean_truth"]
    assert abs(facts["mean_truth"] - facts["mean_exact"]) < 4 * facts["sigma_truth"]
    assert facts["sigma_truth"] < 0.005 * facts["mean_truth"]
    for key in ("rms_difference", "seconds_truth", "seconds_baked"):
        assert facts[key] > 0
    for name in ("slab.png", "slab_baked.png"):
        with Image.open(tmp_path / name) as picture:
            assert picture.width > 3 * facts["size"]


def _pair(factor, seed=0):
    """Noisy renders (seeds, h, w, 3) of radiance 1, and of `factor`."""
    random = np.random.default_rng(seed)
    truth, baked = 1.0 + 0.1 * random.standard_normal((2, 8, 20, 20, 3))
    return truth, baked * factor


def test_a_standard_error_is_that_of_the_mean_over_seeds():
    """Many sets of renders whose pixels share a deviation per seed: the spread of their means is the standard error."""
    random = np.random.default_rng(3)
    seeds, sets = 8, 2000
    shared = random.standard_normal((sets, seeds, 1, 1))
    estimates = [comparison.estimate(1.0 + 0.01 * (of_set + 0.1 * random.standard_normal((seeds, 20, 3))))
                 for of_set in shared]
    spread = np.std([one.mean for one in estimates])
    claimed = np.sqrt(np.mean([one.sigma**2 for one in estimates]))
    # A variance from n values has the relative standard error sqrt(2 / (n - 1)), a root half of that.
    sigma = 0.5 * np.sqrt(2 / (sets - 1) + 2 / (sets * (seeds - 1)))
    assert abs(claimed / spread - 1.0) < z_limit(1, FAMILY_RISK) * sigma


REPORT = {"fit_error": 0.03, "worst_slice": {"error": 0.06}}
EVERYWHERE = np.ones((20, 20), bool)


@pytest.mark.parametrize(("factor", "agree"), [(1.0, True), (1.02, True), (0.98, True), (1.05, False), (0.9, False)])
def test_the_verdict_follows_the_numbers(factor, agree):
    result = comparison.compare(*_pair(factor), EVERYWHERE, REPORT)
    assert result.agree is agree
    assert ("DO NOT AGREE" in result.verdict()) is not agree


def test_pixels_that_differ_under_equal_means_do_not_agree():
    truth, baked = _pair(1.0)
    baked[:, :, :10] += 0.2
    baked[:, :, 10:] -= 0.2
    result = comparison.compare(truth, baked, EVERYWHERE, REPORT)
    assert abs(result.mean_baked - result.mean_truth) < result.allowed
    assert not result.agree
    assert result.rms_without_noise == pytest.approx(0.2, rel=0.05)


def test_not_a_number_never_agrees():
    truth, baked = _pair(1.0)
    baked[0, 0, 0, 0] = np.nan
    assert not comparison.compare(truth, baked, EVERYWHERE, REPORT).agree
    one = comparison.compare(*_pair(1.0), EVERYWHERE, REPORT)
    assert not dataclasses.replace(one, rms_without_noise=float("nan")).agree


@pytest.mark.parametrize("change", [{"base": {"kind": "half-space"}}, {"layers": [{"kind": "interface"}]}])
def test_what_cycles_volumes_lack_is_refused_in_a_sentence(change):
    with pytest.raises(ValueError, match="kind = "):
        scene.build({**scene.load_stack(), **change}, "volume")
