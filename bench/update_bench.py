# SPDX-License-Identifier: GPL-3.0-or-later
"""Updates: wall clock from a changed property to the updated image's pixels, all threads, in Blender.

    python bench/update_bench.py [--repeats 40] [--extension ZIP] [--out build/bench/update.json]

The limit is 33 ms for three layers, RGB, over a Lambert base. Blender's own timer, which does not run in the
background, would add up to 4 ms. The stages are those of the last bake, done again for its progress.
"""

import importlib
import statistics
import sys
import time

import in_blender

LIMIT = 33.0  # ms from a changed property to updated pixels
CALLS = 100
CALLS_LIMITS = {"changed properties, noted": 1000.0, "colours, asked for again": 500.0}  # ms for all calls
STAGES = {"Solving": "solve", "Evaluating": "solve", "Choosing": "fit", "Fitting": "fit"}  # by a text's first word


class Stages:
    """A bake's progress, which adds up the ms of each stage: a stage lasts from its text to the next text."""

    def __init__(self):
        self.spent, self._stage, self._since = dict.fromkeys(STAGES.values(), 0.0), None, time.perf_counter()

    def __call__(self, _fraction, text):
        now = time.perf_counter()
        if self._stage is not None:
            self.spent[self._stage] += 1e3 * (now - self._since)
        self._stage, self._since = STAGES.get(text.partition(" ")[0]), now


def measure(repeats, say):
    import bpy
    from bake_bench import STACKS

    addon, rows = importlib.import_module(in_blender.extension.PACKAGE), []
    update = addon.baking.update
    for name, stack in STACKS.items():
        material = bpy.data.materials.new(name)
        addon.editing.stack_io.assign_stack(material, stack)
        addon.baking.bake_job.bake_material(material, "preview")
        times, pixels = [], []
        for step in range(repeats + 3):
            start = time.perf_counter()
            material.lamina.layers[0].g = 0.3 + 0.001 * step
            job = started_bake(update)
            job.wait()  # Blender's main thread would not wait here
            before = time.perf_counter()
            update.poll()
            end = time.perf_counter()
            if step >= 3:
                times.append(1e3 * (end - start))
                pixels.append(1e3 * (end - before))
        update.stop()
        rows.append({"stack": name, "median ms": statistics.median(times),
                     "p95 ms": statistics.quantiles(times, n=20)[-1], "min ms": min(times),
                     **stages_of(job.stack, job.lut, repeats), "pixels ms": statistics.median(pixels),
                     "of limit": statistics.median(times) / LIMIT})
        say(name)
    return rows + measure_calls(addon, material)


def started_bake(update):
    """The bake that begins after a change. On a slow machine the picture of the result is drawn before it."""
    update.poll()
    while not hasattr(update.running(), "lut"):
        update.running().wait()
        update.poll()
    return update.running()


def stages_of(stack, lut, repeats):
    """Median ms of the stages of a bake with the closures of `lut`."""
    import lamina

    found = []
    for _ in range(repeats):
        found.append(Stages())
        lamina.bake(stack, lut.header["quality"], progress=found[-1], closures=lut.closures)
    return {f"{stage} ms": statistics.median(one.spent[stage] for one in found) for stage in found[0].spent}


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
        addon.baking.update.stop()
        rows.append({"stack": f"{CALLS} {name}", "median ms": statistics.median(times), "min ms": min(times),
                     "of limit": statistics.median(times) / limit})
    return rows


if __name__ == "__main__":
    sys.exit(in_blender.main("update", __doc__.split("\n\n")[0], {"repeats": 40}, measure))
