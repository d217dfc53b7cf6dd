# SPDX-License-Identifier: GPL-3.0-or-later
"""Live editing: wall clock from a changed property to the updated image's pixels, all threads, in Blender.

Runs as a process of its own, because of bpy, and prints one JSON list. The limit is 33 ms for three layers, RGB, over a
Lambert base. Blender's own timer, which does not run in the background, would add up to 4 ms.
"""

import importlib
import json
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LIMIT = 33.0  # ms from a changed property to updated pixels
CALLS = 100
CALLS_LIMITS = {"changed properties, noted": 1000.0, "colours, asked for again": 500.0}  # ms for all calls


def enable():
    """The add-on of this clone, enabled in a Blender with a user folder of its own."""
    resources = Path(tempfile.mkdtemp(prefix="lamina-bench-"))
    os.environ["BLENDER_USER_RESOURCES"] = str(resources)
    (resources / "extensions/user_default").mkdir(parents=True)
    (resources / "extensions/user_default/lamina").symlink_to(ROOT / "addon", target_is_directory=True)
    import bpy  # noqa: F401, I001 (its scripts hold addon_utils)
    import addon_utils

    return addon_utils.enable("bl_ext.user_default.lamina", default_set=True)


class Stages:
    """Adds up the running time of a module's functions, by stage."""

    def __init__(self, module, **stages):
        self.spent = {}
        for name, stage in stages.items():
            setattr(module, name, self._timed(getattr(module, name), stage))

    def _timed(self, function, stage):
        def timed(*arguments, **options):
            start = time.perf_counter()
            try:
                return function(*arguments, **options)
            finally:
                self.spent[stage] = self.spent.get(stage, 0.0) + time.perf_counter() - start

        return timed


def measure_in_blender(repeats=40):
    addon = enable()
    import bpy
    from bake_bench import STACKS

    solving = Stages(importlib.import_module("lamina.baking.bake"), solve_rows="solve", slices="solve", mix="fit",
                     mix_rows="fit")
    rows = []
    for name, stack in STACKS.items():
        material = bpy.data.materials.new(name)
        addon.editing.stack_io.assign_stack(material, stack)
        addon.baking.bake_job.bake_material(material, "preview")
        material.lamina.live = True
        times, parts = [], {"solve": [], "fit": [], "pixels": []}
        for step in range(repeats + 3):
            solving.spent.clear()
            start = time.perf_counter()
            material.lamina.layers[0].g = 0.3 + 0.001 * step
            addon.baking.live.poll()
            # Blender's main thread would not wait here.
            addon.baking.live.running().wait()
            before = time.perf_counter()
            addon.baking.live.poll()
            end = time.perf_counter()
            if step < 3:
                continue
            times.append(1e3 * (end - start))
            parts["pixels"].append(1e3 * (end - before))
            for stage in ("solve", "fit"):
                parts[stage].append(1e3 * solving.spent[stage])
        rows.append({"stack": name, "median ms": statistics.median(times),
                     "p95 ms": statistics.quantiles(times, n=20)[-1], "min ms": min(times),
                     **{f"{stage} ms": statistics.median(values) for stage, values in parts.items()},
                     "of limit": statistics.median(times) / LIMIT})
    return rows + measure_calls(addon, material)


def measure_calls(addon, material, repeats=5):
    """Calls on Blender's main thread while it draws the panel or moves a slider. None of them may bake or solve."""
    layer, colours = material.lamina.layers[0], addon.stack_json.solved_colours

    def change(step):
        layer.tau = 1.0 + 0.01 * step

    while colours.thick_colour(layer) is None:
        colours.look()
        time.sleep(0.001)
    rows, calls = [], (change, lambda step: colours.thick_colour(layer))
    for (name, limit), call in zip(CALLS_LIMITS.items(), calls, strict=True):
        times = []
        for _ in range(repeats):
            start = time.perf_counter()
            for step in range(CALLS):
                call(step)
            times.append(1e3 * (time.perf_counter() - start))
        addon.baking.live.stop()
        rows.append({"stack": f"{CALLS} {name}", "median ms": statistics.median(times), "min ms": min(times),
                     "of limit": statistics.median(times) / limit})
    return rows


def measure():
    import subprocess

    done = subprocess.run([sys.executable, __file__], check=True, capture_output=True, text=True)
    return json.loads(done.stdout.splitlines()[-1])


if __name__ == "__main__":
    print(json.dumps(measure_in_blender()))
    sys.stdout.flush()
    os._exit(0)  # bpy may hang at the interpreter's exit
