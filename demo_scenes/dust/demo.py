# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust, twice: a thin shell of volume around painted bodies, path traced, and the baked varying layer."""

import dataclasses

import comparison
import cycles_render
import extension
import numpy as np
import output
import picture

from . import scene, shell


@dataclasses.dataclass(frozen=True)
class Quality:
    """A picture `width` pixels wide; each seed is a separate render."""

    width: int
    seeds: int
    samples_shell: int  # of one seed
    samples_baked: int


QUALITIES = {
    "tiny": Quality(96, 8, 8, 4),
    "small": Quality(256, 8, 6, 3),
    "final": Quality(640, 16, 64, 16),
}
BLOCK = 8
COMPARED = 4
SPAN = 0.10
EXPOSURE = 1.1
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def run(out, quality, stack_path, say):
    """Render, compare, write dust.png and dust.json into `out`. Returns (files, verdict, True if they agree).

    quality: a key of QUALITIES; stack_path: a stack JSON of one varying medium on a Lambert base, or None.
    """
    stack = scene.load_stack(stack_path or scene.STACK)
    setting = QUALITIES[quality]
    say(f"dust: {setting.width} x {scene.height_of(setting.width)} pixels, {setting.seeds} seeds")
    material, lut = extension.bake("dust", stack, say=lambda text: say(f"bake: {text}"))
    thickness = extension.part("nodes.thickness")
    thickness.wire_thickness(material, "value").socket.default_value = scene.TAU
    baked, seconds_baked, seen = _render("baked", stack, material, setting, setting.samples_baked, say)
    truth, seconds_truth, _ = _render("shell", stack, None, setting, setting.samples_shell, say)
    report = _at_thickness(lut.report)
    results = {name: _compare(truth, baked, seen.compared[name], report, curved=name == "sphere")
               for name in shell.SHAPES}
    facts = {
        "bodies": {name: result.facts() for name, result in results.items()},
        "tau": scene.TAU,
        "shell_thickness": scene.THICKNESS,
        "curvature": scene.CURVATURE,
        "tau_error": lut.report.get("tau_error"),
        "seconds_truth": seconds_truth,
        "seconds_baked": seconds_baked,
        "seconds_bake": lut.report["seconds"],
        "quality": quality,
        **dataclasses.asdict(setting),
        "smallest_cosine": scene.SMALLEST_COSINE,
        "stack": stack,
    }
    png, table = out / "dust.png", out / "dust.json"
    _draw(png, facts, results, truth.mean(axis=0), baked.mean(axis=0), seen)
    output.save_json(table, facts)
    verdict = "; ".join(f"{name}: {result.verdict('shell')}" for name, result in results.items())
    return (png, table), verdict, all(result.agree for result in results.values())


def _at_thickness(report):
    """The report's fit error of the rows near the shown thickness, in the form for `comparison`."""
    rows = report["row_errors"]
    mean, worst = (float(np.interp(scene.TAU, rows["tau"], rows[key])) for key in ("mean", "worst"))
    return {"fit_error": mean, "worst_slice": {"error": worst}}


def _compare(truth, baked, region, report, curved):
    """Compares means over COMPARED x COMPARED pixels: single pixels of the shell are too noisy."""
    inside = picture.blocks(region[None, ..., None].astype(float), COMPARED).min(axis=0)[..., 0] == 1.0
    return comparison.compare(picture.blocks(truth, COMPARED), picture.blocks(baked, COMPARED), inside, report,
                              scene.CURVATURE if curved else 0.0)


def _render(body, stack, material, setting, samples, say):
    stage = scene.build(stack, body, material)
    scene.set_quality(stage, setting.width, samples)
    seen = scene.pixels(stage, setting.width) if body == "baked" else None
    return *cycles_render.render_seeds(stage, setting.seeds, lambda text: say(f"{body}: {text}")), seen


def _draw(path, facts, results, truth, baked, seen):
    region = np.any(list(seen.compared.values()), axis=0)
    shown = [picture.block_means(image @ LUMINANCE, region, BLOCK) for image in (baked, truth)]
    layer, seeds = facts["stack"]["layers"][0], facts["seeds"]
    notes = []
    for name, result in results.items():
        mean = result.mean_truth
        geometry = f", curvature {result.geometry_error:.1%}" if result.geometry_error else ""
        notes.append((f"{name.capitalize()}: {result.mean_baked / mean - 1.0:+.2%} apart, {result.allowed / mean:.2%} "
                      f"allowed (noise {result.noise / mean:.2%}, fit {result.fit_error:.2%}{geometry})", False))
    notes.append((f"Compared away from edges, where the view cosine is at least {scene.SMALLEST_COSINE:g}. "
                  "No denoising.", True))
    noise = {key: np.mean([getattr(result, key) for result in results.values()])
             for key in ("noise_truth", "noise_baked")}
    picture.save(
        path,
        ("Dust, twice", f"Optical thickness {facts['tau']}, albedo {layer['albedo']}, Henyey-Greenstein "
                        f"g {layer['phase'].get('g', 0.0)}, on paint; sun and sky."),
        [
            (f"Shell of volume, {facts['shell_thickness']:g} thick",
             _effort(seeds * facts["samples_shell"], facts["seconds_truth"], noise["noise_truth"]),
             picture.tone(truth, EXPOSURE)),
            ("Baked dust", _effort(seeds * facts["samples_baked"], facts["seconds_baked"], noise["noise_baked"]),
             picture.tone(baked, EXPOSURE)),
        ],
        ("Difference", f"(baked - shell) / shell, {BLOCK} x {BLOCK} pixel means", shown[0] / shown[1] - 1.0),
        SPAN,
        notes,
    )


def _effort(samples, seconds, noise):
    return f"{samples} samples, {seconds:.0f} s, block noise {noise:.1%}"
