# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames after which a baked interior is cheaper than Cycles' volume: veined marble under sun and sky, CPU seconds of
all threads, everything at 1 % noise of a pixel.

    python bench/frames_bench.py [--size 48] [--extension ZIP] [--out build/bench/frames.json]

The time of a bake or a frame at 1 % noise is its measured time times its squared noise, in units of 1 %. A render has a
start that does not depend on its samples; it is measured, and left out of all frames.
"""

import math
import sys
import time

import in_blender

NOISE = 0.01
SEEDS = 4
STEP_RATE = 0.1  # of Cycles' steps through the volume
WALKS = {"relightable": 96, "lit": 48}  # samples per texel
# By method, (many samples, few samples): their difference is timed.
SAMPLES = {"volume": (12, 4), "stock": (48, 16), "relightable": (48, 16), "lit": (32, 8)}
NAMES = {"volume": "Cycles' volume", "stock": "Random Walk, stock", "relightable": "Lamina, Relightable",
         "lit": "Lamina, Lit to the camera"}


def measure(size, say):
    """Rows by method, the volume first."""
    import bpy
    from marble import bodies, interiors, methods, surfaces, veins, view

    body, pattern = bodies.slab(), veins.Veins()
    region = view.region(body, body.tree(), size)
    mesh = body.mesh()
    mesh.materials.append(veins.material(pattern))
    thing = bpy.data.objects.new(body.name, mesh)
    scene = methods.scene_of(body, thing)
    stone, voxels = _timed(lambda: interiors.Stone(scene, thing, veins.WHITE, veins.VEIN, body.voxels,
                                                   body.texels(size)))
    rows = []
    for name, direction in (("relightable", "ALL"), ("lit", "CAMERA")):
        found, bake = _timed(lambda name=name, direction=direction: stone.show(name.upper(), direction, WALKS[name], 1))
        say(f"{NAMES[name]}: {bake:.1f} CPU-s, noise {found.noise:.1%}")
        rows.append(_row(name, _frame(scene, size, region, name), voxels + bake * (found.noise / NOISE) ** 2))
    mesh.materials[0] = surfaces.stock(mesh, stone.interior, body.vertices)
    rows.append(_row("stock", _frame(scene, size, region, "stock"), voxels))
    say(NAMES["stock"])
    methods.show_volume(scene, mesh, pattern, STEP_RATE)
    rows.insert(0, _row("volume", _frame(scene, size, region, "volume"), 0.0))
    for row in rows[1:]:
        saved = rows[0]["frame, CPU-s"] - row["frame, CPU-s"]
        row["break-even, frames"] = math.ceil(row["bake, CPU-s"] / saved) if saved > 0.0 else None
    return rows


def _row(name, frame, bake):
    return {"name": NAMES[name], "bake, CPU-s": bake, "frame, CPU-s": frame}


def _frame(scene, size, region, name):
    """CPU seconds of one frame at NOISE."""
    import cycles_render
    from marble import differences, methods

    def rendered(samples):
        cycles_render.unbiased(scene, size, size, samples, methods.BOUNCES)
        return _timed(lambda: cycles_render.render_seeds(scene, SEEDS)[0])

    rendered(1)
    many, few = SAMPLES[name]
    (pictures, longer), (_, shorter) = rendered(many), rendered(few)
    one = math.sqrt(SEEDS) * differences.noise(pictures, region)  # of one picture
    seconds = (longer - shorter) / SEEDS * many / (many - few)
    return seconds * max(one / NOISE, math.sqrt(1.0 / many)) ** 2


def _timed(work):
    began = time.process_time()
    found = work()
    return found, time.process_time() - began


if __name__ == "__main__":
    sys.exit(in_blender.main("frames", __doc__.split("\n\n")[0], {"size": 48}, measure))
