# SPDX-License-Identifier: GPL-3.0-or-later
"""Speed and noise of baked materials in Cycles, beside Cycles' own materials and the volume slab.

    python bench/render_bench.py [--size 128] [--repeats 5] [--quality final] [--extension ZIP]
        [--out build/bench/render.json]

The scene is the slab demo without its sky in view, under the same sun and sky. Every round renders each body in turn.
Times are CPU times of the process, all threads together, which other load on the machine affects least: (many samples)
- (few samples), which removes the start of a render. The result is the minimum over rounds, since other load only adds
time; the range is that of ratios within a round. Noise is the relative standard deviation of a pixel at SAMPLES
samples, from two seeds.
"""

import argparse
import math
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "demo_scenes"))

import extension  # noqa: E402
import output  # noqa: E402

from lamina.kinds.table import is_covered, strips_of  # noqa: E402

SAMPLES = 32  # number of samples for the noise
MANY, FEW = 64, 4  # samples of the two timed renders
DUSTY = {
    "schema": 1,
    "layers": [{"kind": "medium", "albedo": [0.95, 0.85, 0.6], "tau": 1.0, "phase": {"kind": "hg", "g": 0.6}}],
    "base": {"kind": "lambert", "reflectance": [0.5, 0.3, 0.1]},
}
COATED = {
    "schema": 1,
    "layers": [
        {"kind": "interface", "ior": 1.5, "alpha": 0.1},
        {"kind": "medium", "albedo": [0.9, 0.8, 0.6], "tau": 1.0, "phase": {"kind": "hg", "g": 0.6}},
    ],
    "base": {"kind": "lambert", "reflectance": [0.5, 0.3, 0.1]},
}
HALO = {  # dust that scatters forward, over polished metal
    "schema": 1,
    "layers": [{"kind": "medium", "albedo": [0.8, 0.7, 0.55], "tau": 0.1, "phase": {"kind": "hg", "g": 0.8}}],
    "base": {"kind": "conductor", "eta": 3.1, "k": 3.3},
}
BASE_COLOUR = (0.8, 0.8, 0.8, 1.0)
# Dust and varnish on the Principled material of the comparison, by the inputs of the node group.
DUST = {"kind": "medium", "albedo": [0.9, 0.88, 0.84], "tau": 1.0, "phase": {"kind": "hg", "g": 0.6}, "varying": True}
VARNISH = {"kind": "interface", "ior": 1.5}
INPUTS = {"": [], ", color": ["color"], ", all inputs": ["color", "metallic", "roughness"]}
PRINCIPLED = "Principled"


def principled(**inputs):
    """A Principled BSDF; inputs by socket name, _ for a space."""
    return _single_node("ShaderNodeBsdfPrincipled", {"Base Color": BASE_COLOUR, **_named(inputs)})


def diffuse():
    return _single_node("ShaderNodeBsdfDiffuse", {"Color": BASE_COLOUR})


def scenes(stack, quality):
    """({name: scene}, {name: LUT} of the baked ones)."""
    from slab import scene

    bodies, luts = {}, {}
    for name, layers in (("slab", stack), ("dusty", DUSTY), ("coated", COATED), ("halo", HALO)):
        for basis in ("standard", "accurate"):
            title = f"Lamina, {name}, {basis}"
            material, luts[title] = extension.bake(title, layers, quality, basis=basis)
            bodies[title] = ("baked", material)
    for name, layer in (("dust", DUST), ("varnish", VARNISH)):
        for words, inputs in INPUTS.items():
            title = f"Lamina, {name} on Principled{words}"
            base = {"kind": "principled", "color": list(BASE_COLOUR[:3]), "roughness": 0.5, "inputs": inputs}
            material, luts[title] = extension.bake(title, {"schema": 1, "layers": [layer], "base": base}, quality)
            bodies[title] = ("baked", material)
    bodies |= {
        PRINCIPLED: ("baked", principled()),
        "Principled, coat and sheen": ("baked", principled(Coat_Weight=1.0, Sheen_Weight=1.0)),
        "Diffuse": ("baked", diffuse()),
        "Volume slab": ("volume", None),
    }
    return {name: scene.build(stack, *body) for name, body in bodies.items()}, luts


def prepare(stage, size):
    """Unbiased settings, and a picture cropped to the slab, because sky pixels take almost no time."""
    from slab import scene, view

    scene.set_quality(stage, size, MANY)
    rows = np.flatnonzero(view.pixels(size).region.all(axis=1))
    stage.render.use_border = stage.render.use_crop_to_border = True
    stage.render.border_min_x, stage.render.border_max_x = 0.0, 1.0
    stage.render.border_min_y, stage.render.border_max_y = 0.0, (size - rows[0]) / size


def measure(stages, repeats, say):
    """{name: (CPU seconds of each round, pixels, relative noise)}."""
    seconds, noise, pixels = {name: [] for name in stages}, {}, {}
    for name, stage in stages.items():
        noise[name], pixels[name] = _noise(stage)
    for k in range(repeats):
        for name, stage in stages.items():
            many, few = (_seconds(stage, samples, k) for samples in (MANY, FEW))
            seconds[name].append(many - few)
        say(f"round {k + 1} of {repeats}")
    return {name: (np.array(seconds[name]), pixels[name], noise[name]) for name in stages}


def table(measured):
    """A list of rows (dicts), in the order of `measured`."""
    reference = measured[PRINCIPLED]
    rows = []
    for name, (seconds, pixels, noise) in measured.items():
        ratios = seconds / reference[0]
        ratio = float(seconds.min() / reference[0].min())
        rows.append({
            "material": name,
            "million_samples_per_cpu_second": pixels * (MANY - FEW) / float(seconds.min()) / 1e6,
            "time_over_principled": ratio,
            "time_over_principled_least": float(ratios.min()),
            "time_over_principled_most": float(ratios.max()),
            "noise": noise,
            # Noise falls with the square root of the number of samples.
            "time_to_equal_noise_over_principled": ratio * (noise / reference[2]) ** 2,
        })
    return rows


def show(rows):
    """The rows as text."""
    lines = [
        f"{'':40} {'M samples/':>11} {'time over':>22} {'noise at':>12} {'time over Principled':>21}",
        f"{'':40} {'CPU-second':>11} {'Principled (range)':>22} {SAMPLES:4} samples {'at equal noise':>21}",
    ]
    for row in rows:
        spread = f"{row['time_over_principled_least']:.2f}..{row['time_over_principled_most']:.2f}"
        lines.append(
            f"{row['material']:40} {row['million_samples_per_cpu_second']:11.2f} "
            f"{row['time_over_principled']:8.2f} {'(' + spread + ')':>13} {row['noise']:12.1%} "
            f"{row['time_to_equal_noise_over_principled']:21.2f}"
        )
    return "\n".join(lines)


def main(argv=None):
    parser = argparse.ArgumentParser(description="Time and noise of the baked material in Cycles.")
    parser.add_argument("--size", type=int, default=128)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--quality", choices=("preview", "final"), default="final", help="of the bakes")
    parser.add_argument("--extension", type=Path, help="extension zip (default: the newest in build/extension/)")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "bench" / "render.json")
    arguments = parser.parse_args(argv)
    try:
        zip_path = arguments.extension or extension.newest_zip(ROOT / "build/extension")
        with extension.isolate(), extension.installed(zip_path):
            from slab import scene

            stack = scene.load_stack()
            stages, luts = scenes(stack, arguments.quality)
            for stage in stages.values():
                prepare(stage, arguments.size)
            rows = table(measure(stages, arguments.repeats, lambda text: print(text, flush=True)))
    except extension.ExtensionMissingError as error:
        print(f"render_bench: {error}", file=sys.stderr)
        return 1
    facts = {
        "samples": SAMPLES, "size": arguments.size, "repeats": arguments.repeats, "stack": stack,
        "rows": [row | _facts(luts.get(row["material"])) for row in rows],
    }
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    output.save_json(arguments.out, facts)
    print(show(rows))
    for name, lut in luts.items():
        print(f"{name}: {_facts(lut)['closures']} closures, fit error {lut.report['fit_error']:.2%}")
    print(f"wrote {arguments.out}")
    return 0


def _facts(lut):
    """The columns that describe a table; empty for materials that are not baked."""
    if lut is None:
        return {}
    # All strips of one closure are added before the closure is evaluated; those of a metal stay apart, except below an
    # interface.
    strips = strips_of(lut.header)
    apart = not is_covered(strips)
    drawn = {(apart and strip.metal, strip.closure) for strip in strips if strip.is_weight}
    return {"closures": len(drawn), "fit_error": lut.report["fit_error"], "ids": lut.closures}


def _noise(stage):
    """(relative standard deviation of a pixel's luminance at SAMPLES, rms; number of pixels)."""
    import cycles_render

    stage.cycles.samples = SAMPLES
    # Green is used in place of luminance; the seeds differ from those of the timed renders.
    first, second = (cycles_render.render(stage, seed)[0][..., 1] for seed in (1001, 1002))
    relative = (first - second) / ((first + second) / 2.0)
    return math.sqrt(np.mean(relative**2) / 2.0), first.size


def _seconds(stage, samples, seed):
    import cycles_render

    stage.cycles.samples = samples
    start = time.process_time()
    cycles_render.render(stage, seed)
    return time.process_time() - start


def _single_node(kind, inputs):
    import bpy
    import node_tree

    material = bpy.data.materials.new(kind)
    tree = node_tree.of(material)
    tree.nodes.clear()
    node = tree.nodes.new(kind)
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def _named(inputs):
    return {name.replace("_", " "): value for name, value in inputs.items()}


if __name__ == "__main__":
    sys.exit(main())
