# SPDX-License-Identifier: GPL-3.0-or-later
"""The two pictures of the slab demo: baked plane against exact scattering function, and against path-traced volume."""

import math

import numpy as np
import picture

from . import light, view

BLOCK = 8
SPAN = 0.10
EXPOSURE = 1.3
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
COMPARED = (f"Compared where the view cosine is at least {view.SMALLEST_COSINE:g}. No denoising.", True)


def save_first(path, facts, estimate, baked, expected, pixels):
    """Write baked plane, exact scattering function and their difference; all (size, size, 3), linear radiance.

    facts: the numbers of the captions, as in slab.json; estimate: the comparison.Estimate of the baked plane; pixels:
    view.Pixels of the picture.
    """
    # The exact scattering function says nothing about the sky, whose radiance is known.
    above = (pixels.mu_o < 0.0)[..., None]
    expected = np.where(above, light.sky_radiance(-pixels.mu_o), expected)
    exact_mean = facts["mean_exact"]
    picture.save(
        path,
        ("One slab, baked", _describe(facts["stack"])),
        [
            ("Baked plane", _baked_effort(facts, estimate.noise), picture.tone(baked, EXPOSURE)),
            ("Exact scattering function", "solved, neither path traced nor fitted", picture.tone(expected, EXPOSURE)),
        ],
        _difference("exact", baked, expected, pixels.region),
        SPAN,
        [
            (f"Mean radiance: baked {estimate.mean:.5f} \u00b1 {estimate.sigma:.5f}, "
             f"exact {exact_mean:.5f}", False),
            (f"{estimate.mean / exact_mean - 1.0:+.2%} apart; error of the fit {facts['fit_error']:.2%}", False),
            COMPARED,
        ],
    )


def save_comparison(path, facts, result, truth, baked, region):
    """Write volume, baked plane and their difference; pictures (size, size, 3), region (size, size).

    facts: the numbers of the captions, as in slab.json; result: the comparison.Comparison of both.
    """
    mean = result.mean_truth
    picture.save(
        path,
        ("One slab, twice", _describe(facts["stack"])),
        [
            ("Volume, path traced",
             _effort(facts["seeds"] * facts["samples_volume"], facts["seconds_truth"], result.noise_truth),
             picture.tone(truth, EXPOSURE)),
            ("Baked plane", _baked_effort(facts, result.noise_baked), picture.tone(baked, EXPOSURE)),
        ],
        _difference("volume", baked, truth, region),
        SPAN,
        [
            (f"Mean radiance: volume {mean:.4f} \u00b1 {result.sigma_truth:.4f}, "
             f"baked {result.mean_baked:.4f}, exact {facts['mean_exact']:.4f}", False),
            (f"{result.mean_baked / mean - 1.0:+.2%} apart; {result.allowed / mean:.2%} allowed "
             f"(noise {result.noise / mean:.2%}, fit {result.fit_error:.2%})", False),
            COMPARED,
        ],
    )


def _difference(name, baked, truth, region):
    means = [picture.block_means(image @ LUMINANCE, region, BLOCK) for image in (baked, truth)]
    return "Difference", f"(baked - {name}) / {name}, {BLOCK} x {BLOCK} pixel means", means[0] / means[1] - 1.0


def _describe(stack):
    layers = [
        f"Albedo {layer['albedo']}, optical thickness {layer['tau']}, {_phase(layer['phase'])}"
        for layer in stack["layers"]
    ]
    base = stack.get("base")
    ground = f"on {base['kind']} ground" if base else "with nothing below"
    sun = f"Sun {math.degrees(light.SUN_ELEVATION):.0f}\u00b0 high, ahead, and sky."
    return f"{'; '.join(layers)}; {ground}. {sun}"


def _phase(phase):
    return f"Henyey-Greenstein g {phase['g']}" if phase["kind"] == "hg" else phase["kind"]


def _baked_effort(facts, noise):
    return _effort(facts["seeds"] * facts["samples_baked"], facts["seconds_baked"], noise)


def _effort(samples, seconds, noise):
    return f"{samples} samples, {seconds:.0f} s, noise {noise:.1%}"
