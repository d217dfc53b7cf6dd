# SPDX-License-Identifier: GPL-3.0-or-later
"""A smooth and a rough coat, each twice: a painted slab of glass, path traced with caustics, and the baked plane."""

import dataclasses

import comparison
import cycles_render
import extension
import numpy as np
import output
import picture
from slab import view

from . import exact, scene


@dataclasses.dataclass(frozen=True)
class Quality:
    """A square picture of `size` pixels; each seed is a separate render."""

    size: int
    seeds: int
    samples_glass: int  # of one seed
    samples_baked: int


QUALITIES = {
    "tiny": Quality(96, 8, 16, 8),
    "small": Quality(240, 8, 8, 3),
    "final": Quality(480, 16, 64, 16),
}
BLOCK = 8
COMPARED = 4
EXACT_RAYS = 48  # across the picture
SPAN = 0.10
EXPOSURE = 1.0
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def run(out, quality, stack_path, say):
    """Render, compare, write coat.png and coat.json into `out`. Returns (files, verdict, True if they agree).

    quality: a key of QUALITIES; stack_path: a stack JSON of one interface on a Lambert base, in place of both coats.
    """
    setting = QUALITIES[quality]
    paths = scene.STACKS if stack_path is None else {"given": stack_path}
    say(f"coat: {setting.size} x {setting.size} pixels, {setting.seeds} seeds")
    region = view.pixels(setting.size).region
    facts, rows, verdicts = {}, [], []
    for name, path in paths.items():
        fact, row, result = _compare(name, scene.load_stack(path), setting, region, say)
        facts[name] = fact
        rows.append(row)
        verdicts.append((f"{name}: {result.verdict('glass')}", result.agree))
    png, table = out / "coat.png", out / "coat.json"
    picture.save_rows(png, ("A coat, twice", "Painted glass and the baked plane under a grey "
                            "sky with a bright round cap. No denoising."), rows, SPAN)
    output.save_json(table, {"quality": quality, **dataclasses.asdict(setting), "coats": facts})
    return (png, table), "; ".join(text for text, _ in verdicts), all(agree for _, agree in verdicts)


def _compare(name, stack, setting, region, say):
    """(facts, a row of the picture, the Comparison) of one coat."""
    material, lut = extension.bake(f"{name} coat", stack, say=lambda text: say(f"bake: {text}"))
    baked, seconds_baked = _render("baked", stack, material, setting, setting.samples_baked, say)
    truth, seconds_truth = _render("glass", stack, None, setting, setting.samples_glass, say)
    # Single pixels of the glass are too noisy to compare.
    inside = picture.blocks(region[None, ..., None], COMPARED).min(axis=0)[..., 0] == 1.0
    result = comparison.compare(picture.blocks(truth, COMPARED), picture.blocks(baked, COMPARED), inside, lut.report)
    truth, baked = truth.mean(axis=0), baked.mean(axis=0)
    expected = _exact(stack)
    facts = {
        **result.facts(),
        "mean_exact": float(expected.mean()),
        "seconds_truth": seconds_truth,
        "seconds_baked": seconds_baked,
        "seconds_bake": lut.report["seconds"],
        "stack": stack,
    }
    shown = [picture.block_means(image @ LUMINANCE, region, BLOCK) for image in (baked, truth)]
    mean, layer = result.mean_truth, stack["layers"][0]
    seeds = setting.seeds
    row = (
        [
            (f"Glass, alpha {layer.get('alpha', 0.0)}",
             _effort(seeds * setting.samples_glass, seconds_truth, result.noise_truth), picture.tone(truth, EXPOSURE)),
            ("Baked plane", _effort(seeds * setting.samples_baked, seconds_baked, result.noise_baked),
             picture.tone(baked, EXPOSURE)),
        ],
        ("Difference", f"(baked - glass) / glass, {BLOCK} x {BLOCK} pixel means", shown[0] / shown[1] - 1.0),
        [
            (f"Mean: glass {mean:.4f} \u00b1 {result.sigma_truth:.4f}, baked {result.mean_baked:.4f}, "
             f"exact {expected.mean():.4f}", False),
            (f"{result.mean_baked / mean - 1.0:+.2%} apart; {result.allowed / mean:.2%} allowed "
             f"(noise {result.noise / mean:.2%}, fit {result.fit_error:.2%})", False),
        ],
    )
    return facts, row, result


def _render(body, stack, material, setting, samples, say):
    stage = scene.build(stack, body, material)
    scene.set_quality(stage, setting.size, samples)
    return cycles_render.render_seeds(stage, setting.seeds, lambda text: say(f"{body}: {text}"))


def _exact(stack):
    """A third comparison: the scattering function itself, for enough rays for the picture's mean."""
    import lamina  # the extension's wheel: not there before the extension is installed

    rays = view.pixels(EXACT_RAYS)
    scattering = lamina.solve(lamina.Stack.from_json(stack))
    # view.Pixels measures dphi against light from the azimuth of the slab demo's sun, where the cap stands here.
    return exact.radiance(scattering, rays.mu_o[rays.region], rays.dphi[rays.region])


def _effort(samples, seconds, noise):
    return f"{samples} samples, {seconds:.0f} s, noise {noise:.1%}"
