# SPDX-License-Identifier: GPL-3.0-or-later
"""The standard problem, twice: Cycles' volume path tracing against the baked plane of the same stack."""

import dataclasses
import math

import comparison
import cycles_render
import extension
import numpy as np
import output

from . import exact, pictures, scene, view


@dataclasses.dataclass(frozen=True)
class Quality:
    """A square picture of `size` pixels; each seed is a separate render."""

    size: int
    seeds: int
    samples_volume: int  # of one seed
    samples_baked: int


# "small": the noise of the mean (three standard errors) is about a twentieth of the fit's error, which is 4 %.
QUALITIES = {
    "tiny": Quality(96, 8, 16, 8),
    "small": Quality(320, 8, 8, 3),
    "final": Quality(480, 32, 64, 8),
}
FINE = 300  # number of rays across the picture that is enough for its mean


def run(out, quality, stack_path, say):
    """Render, compare, write slab_baked.png, slab.png and slab.json into `out`.

    The path-traced volume takes most of the time, so the picture without it, slab_baked.png, is written first.
    Returns (files, verdict, True if volume and baked plane agree). quality: a key of QUALITIES; stack_path: a stack
    JSON, or None for the standard problem.
    """
    stack = scene.load_stack(stack_path or scene.STACK)
    setting = QUALITIES[quality]
    pixels = view.pixels(setting.size)
    say(f"slab: {setting.size} x {setting.size} pixels, {setting.seeds} seeds")
    material, lut = extension.bake("slab", stack, say=lambda text: say(f"bake: {text}"))
    baked, seconds_baked = _render("baked", stack, material, setting, setting.samples_baked, say)
    estimate = comparison.estimate(baked[:, pixels.region])
    picture = baked.mean(axis=0)
    expected = _exact(stack, setting.size)
    facts = {
        "quality": quality,
        **dataclasses.asdict(setting),
        "smallest_cosine": view.SMALLEST_COSINE,
        "stack": stack,
        "seconds_bake": lut.report["seconds"],
        "seconds_baked": seconds_baked,
        "fit_error": float(lut.report["fit_error"]),
        "mean_exact": float(expected[pixels.region].mean()),
        "rms_baked_against_exact": math.sqrt(np.mean((picture - expected)[pixels.region] ** 2)),
    }
    first, png, table = out / "slab_baked.png", out / "slab.png", out / "slab.json"
    pictures.save_first(first, facts, estimate, picture, expected, pixels)
    say(f"{first.name} is written: baked {estimate.mean:.5f}, exact {facts['mean_exact']:.5f}")

    truth, seconds_truth = _render("volume", stack, None, setting, setting.samples_volume, say)
    result = comparison.compare(truth, baked, pixels.region, lut.report)
    facts = {**facts, **result.facts(), "seconds_truth": seconds_truth}
    pictures.save_comparison(png, facts, result, truth.mean(axis=0), picture, pixels.region)
    output.save_json(table, facts)
    return (first, png, table), result.verdict(), result.agree


def _render(body, stack, material, setting, samples, say):
    stage = scene.build(stack, body, material)
    scene.set_quality(stage, setting.size, samples)
    return cycles_render.render_seeds(stage, setting.seeds, lambda text: say(f"{body}: {text}"))


def _exact(stack, size):
    """The picture by the scattering function itself, without path tracing and without a fit."""
    import lamina  # the extension's wheel: not there before the extension is installed

    return exact.picture(lamina.solve(lamina.Stack.from_json(stack)), size, subdivide=-(-FINE // size))

