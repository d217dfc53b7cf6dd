# SPDX-License-Identifier: GPL-3.0-or-later
"""The standard problem, twice: Cycles' volume path tracing against the baked plane of the same stack."""

import dataclasses
import math

import comparison
import cycles_render
import extension
import numpy as np
import output
import picture

from . import exact, light, scene, view


@dataclasses.dataclass(frozen=True)
class Quality:
    """A square picture of `size` pixels; each seed is a separate render."""

    size: int
    seeds: int
    samples_volume: int  # of one seed
    samples_baked: int


QUALITIES = {
    "tiny": Quality(96, 8, 16, 8),
    "small": Quality(320, 16, 12, 4),
    "final": Quality(480, 32, 64, 8),
}
FINE = 300  # number of rays across the picture that is enough for its mean
BLOCK = 8
SPAN = 0.10
EXPOSURE = 1.3
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def run(out, quality, stack_path, say):
    """Render, compare, write slab.png and slab.json into `out`. Returns (files, verdict, True if they agree).

    quality: a key of QUALITIES; stack_path: a stack JSON, or None for the standard problem.
    """
    stack = scene.load_stack(stack_path or scene.STACK)
    setting = QUALITIES[quality]
    pixels = view.pixels(setting.size)
    say(f"slab: {setting.size} x {setting.size} pixels, {setting.seeds} seeds")
    material, lut = extension.bake("slab", stack, say=lambda text: say(f"bake: {text}"))
    baked, seconds_baked = _render("baked", stack, material, setting, setting.samples_baked, say)
    truth, seconds_truth = _render("volume", stack, None, setting, setting.samples_volume, say)
    result = comparison.compare(truth, baked, pixels.region, lut.report)
    truth, baked = truth.mean(axis=0), baked.mean(axis=0)
    facts = {
        **result.facts(),
        "seconds_truth": seconds_truth,
        "seconds_baked": seconds_baked,
        "seconds_bake": lut.report["seconds"],
        **_against_exact(stack, setting.size, pixels.region, baked),
        "quality": quality,
        **dataclasses.asdict(setting),
        "smallest_cosine": view.SMALLEST_COSINE,
        "stack": stack,
    }
    png, table = out / "slab.png", out / "slab.json"
    _draw(png, facts, result, truth, baked, pixels.region)
    output.save_json(table, facts)
    return (png, table), result.verdict(), result.agree


def _render(body, stack, material, setting, samples, say):
    stage = scene.build(stack, body, material)
    scene.set_quality(stage, setting.size, samples)
    return cycles_render.render_seeds(stage, setting.seeds, lambda text: say(f"{body}: {text}"))


def _against_exact(stack, size, region, baked):
    """A third comparison: the scattering function itself, without path tracing and without a fit."""
    import lamina  # the extension's wheel: not there before the extension is installed

    scattering = lamina.solve(lamina.Stack.from_json(stack))
    expected = exact.picture(scattering, size, subdivide=-(-FINE // size))[region]
    return {
        "mean_exact": float(expected.mean()),
        "rms_baked_against_exact": math.sqrt(np.mean((baked[region] - expected) ** 2)),
    }


def _draw(path, facts, result, truth, baked, region):
    shown = [picture.block_means(image @ LUMINANCE, region, BLOCK) for image in (baked, truth)]
    seeds = facts["seeds"]
    mean = result.mean_truth
    picture.save(
        path,
        ("One slab, twice", _describe(facts["stack"])),
        [
            ("Volume, path traced",
             _effort(seeds * facts["samples_volume"], facts["seconds_truth"], result.noise_truth),
             picture.tone(truth, EXPOSURE)),
            ("Baked plane",
             _effort(seeds * facts["samples_baked"], facts["seconds_baked"], result.noise_baked),
             picture.tone(baked, EXPOSURE)),
        ],
        ("Difference", f"(baked - volume) / volume, {BLOCK} x {BLOCK} pixel means",
         shown[0] / shown[1] - 1.0),
        SPAN,
        [
            (f"Mean radiance: volume {mean:.4f} \u00b1 {result.sigma_truth:.4f}, "
             f"baked {result.mean_baked:.4f}, exact {facts['mean_exact']:.4f}", False),
            (f"{result.mean_baked / mean - 1.0:+.2%} apart; {result.allowed / mean:.2%} allowed "
             f"(noise {result.noise / mean:.2%}, fit {result.fit_error:.2%})", False),
            (f"Compared where the view cosine is at least {view.SMALLEST_COSINE:g}. No denoising.", True),
        ],
    )


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


def _effort(samples, seconds, noise):
    return f"{samples} samples, {seconds:.0f} s, noise {noise:.1%}"
