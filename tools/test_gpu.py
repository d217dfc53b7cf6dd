# SPDX-License-Identifier: GPL-3.0-or-later
"""Twelve materials, rendered by Cycles on the CPU and on a GPU, and compared.

    python tools/test_gpu.py [--size 96] [--samples 128] [--device OPTIX] [--extension ZIP]

Each material is rendered twice on the CPU, and once on the GPU with a third seed. The two renders of the CPU give the
noise of blocks of 8 x 8 pixels. The check of a material fails if the mean of the GPU's picture is off by more than four
standard errors and .2 %, or if its blocks scatter by half more than the noise. Without a GPU that Cycles can use, the
script says so and succeeds. `--device CPU` compares the CPU with itself, which tests the comparison.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "demo_scenes"))

import extension  # noqa: E402

KINDS = ("OPTIX", "CUDA", "HIP", "ONEAPI", "METAL")
# Tinted, rough and smooth coats, with cones and with lobes that move; halos; a sheet; media.
PRESETS = ("candy-apple-paint", "lacquered-copper", "dusty-lacquer", "dusty-bronze", "frosted-glass", "skin-light")
OVERLAYS = ("house-dust", "varnish", "rain-drops")  # over a Principled BSDF with inputs
LATERAL = ("RELIGHTABLE", "PORTAL", "VOLUME")  # of a body of marble
MARBLE = {"schema": 1, "layers": [
    {"kind": "interface", "ior": 1.5},
    {"kind": "medium", "sigma_s": [2.19, 2.62, 3.0], "sigma_a": [0.0021, 0.0041, 0.0071], "thickness": "inf"}]}
UNIT = 0.05  # metres of a Blender unit, so that light travels visibly in the body
BLOCK, MEAN, SIGMAS, SCATTER = 8, 0.002, 4.0, 1.5


def device_kind(wanted):
    """The kind of GPU that Cycles finds and now uses, "CPU" if that is wanted, or None."""
    import bpy

    if wanted == "CPU":
        return wanted
    preferences = bpy.context.preferences.addons["cycles"].preferences
    for kind in (wanted,) if wanted else KINDS:
        try:
            preferences.compute_device_type = kind
        except TypeError:  # a kind that this build of Blender does not have
            continue
        preferences.get_devices()
        found = [device for device in preferences.devices if device.type == kind]
        for device in preferences.devices:
            device.use = device in found
        if found:
            return kind
    return None


def materials(stage):
    """{name: (material, True for a sheet)}."""
    import bpy
    from presets import scene

    import lamina

    presets, layer_list, stack_io, lateral_job = (extension.part(name) for name in (
        "editing.presets", "editing.layer_list", "editing.stack_io", "baking.lateral_job"))
    found = {}
    for name in (*PRESETS, *OVERLAYS):
        material = scene.below(name)
        presets.apply(material, name)
        extension.part("baking.bake_job").bake_material(material, "preview")
        stack = lamina.presets.load(name)
        found[name] = material, stack.base is None and name not in OVERLAYS
        if stack.varying is not None:
            scene.wire_dust(material)
    stage.unit_settings.scale_length = UNIT
    for output in LATERAL:
        material = bpy.data.materials.new(output)
        layer_list.add_stack(material)
        stack_io.assign_stack(material, lamina.Stack.from_json(MARBLE))
        lateral_job.make(material, stage, "preview", output)
        found[f"marble, {output.lower()}"] = material, False
    return found


def blocks(pixels):
    """Means over blocks of pixels, [block, channel]."""
    rows, columns = (size // BLOCK * BLOCK for size in pixels.shape[:2])
    split = pixels[:rows, :columns].reshape(rows // BLOCK, BLOCK, columns // BLOCK, BLOCK, 3)
    return split.mean(axis=(1, 3)).reshape(-1, 3)


def compared(first, second, other):
    """(relative difference of the means, its standard error, scatter of the blocks relative to the noise)."""
    one, two, theirs = (blocks(pixels) for pixels in (first, second, other))
    noise = (one - two) / np.sqrt(2.0)
    scale, mean = one.mean(), 0.5 * (one + two)
    error = np.sqrt(1.5 * np.mean(noise**2) / noise.size) / scale
    # The mean of two renders and a third one differ by 3/2 of the variance of one
    scatter = np.sqrt(np.mean((theirs - mean) ** 2) / (1.5 * np.mean(noise**2)))
    return float((theirs - mean).mean() / scale), float(error), float(scatter)


def check(size, samples, kind):
    """Prints a line for each material. Returns the names of those that differ."""
    import cycles_render
    from dragon import settling
    from presets import scene

    stage, solid, _ = scene.build()
    settling.settle_on(solid, 1.0, rays=64)
    shown, wrong = materials(stage), []
    for name, (material, is_sheet) in shown.items():
        scene.show(stage, material, is_sheet)
        cycles_render.unbiased(stage, size, size, samples, bounces=12)
        # Both devices clamp alike, and rare bright paths would hide a difference
        stage.cycles.sample_clamp_direct, stage.cycles.sample_clamp_indirect = 20.0, 2.0
        first, second = (cycles_render.render(stage, seed)[0] for seed in (1, 2))
        stage.cycles.device = "CPU" if kind == "CPU" else "GPU"
        mean, error, scatter = compared(first, second, cycles_render.render(stage, 3)[0])
        is_right = abs(mean) <= max(SIGMAS * error, MEAN) and scatter <= SCATTER
        wrong += [] if is_right else [name]
        print(f"{name:24} mean {mean:+.3%} +- {error:.3%}, blocks {scatter:.2f} of the noise"
              f"{'' if is_right else '  DIFFERS'}", flush=True)
    return wrong


def main(argv=None):
    parser = argparse.ArgumentParser(description="Twelve materials on the CPU and on a GPU.")
    parser.add_argument("--size", type=int, default=96)
    parser.add_argument("--samples", type=int, default=128)
    parser.add_argument("--device", choices=(*KINDS, "CPU"), help="default: the first kind that Cycles finds")
    parser.add_argument("--extension", type=Path, help="extension zip (default: the newest in build/extension/)")
    arguments = parser.parse_args(argv)
    try:
        zip_path = arguments.extension or extension.newest_zip(ROOT / "build/extension")
        with extension.isolate(), extension.installed(zip_path):
            kind = device_kind(arguments.device)
            if kind is None:
                print("lamina: no comparison with a GPU: Cycles finds none that it can use here")
                return 0
            print(f"CPU against {kind}, {arguments.size} x {arguments.size} pixels, {arguments.samples} samples")
            wrong = check(arguments.size, arguments.samples, kind)
    except extension.ExtensionMissingError as error:
        print(f"test_gpu: {error}", file=sys.stderr)
        return 1
    print(f"differ: {', '.join(wrong)}" if wrong else "all twelve agree within the noise")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
