# SPDX-License-Identifier: GPL-3.0-or-later
"""The portal beside Cycles' Random Walk on a sphere under a sun: errors, CPU time, and variance at equal time.

    python bench/portal_bench.py [--samples 256] [--repeats 3] [--cases N] [--extension ZIP]
        [--out build/bench/portal.json]

References are those of the tests. Errors are free of noise: the mean over pairs of renders of the product of their
errors. Times are the least of the renders, without the start of a render.
"""

import importlib
import itertools
import math
import sys
import time

import in_blender
import numpy as np

# The sphere, its references and the materials are those of the tests.
sys.path[:0] = [str(in_blender.ROOT / "tests/cycles"), str(in_blender.ROOT / "tests")]

OUTPUTS = ("RELIGHTABLE", "PORTAL")  # Relightable is Random Walk with the right inputs
MEDIA = {"portal_sphere": "isotropic", "portal_sphere_boundary": "isotropic, index 1.4",
         "portal_sphere_forward": "g .8"}
FEW = 16  # part of the samples that the subtracted start of a render has
# Forward scattering is noisier.
MORE = {"portal_sphere_forward": 2}


def measure(samples, repeats, cases, say):
    """Rows of the first `cases`, by medium and mean free path: the portal's times and variances relative to Random
    Walk's."""
    import lit_sphere

    addon, rows = importlib.import_module(in_blender.extension.PACKAGE), []
    for name, path in list(lit_sphere.BLOCKS)[:cases]:
        found = {}
        for number, kind in enumerate(OUTPUTS):
            found[kind] = _measured(addon, lit_sphere, name, path, kind, samples * MORE.get(name, 1), repeats, number)
        walk, portal = found.values()
        rows.append({
            "medium": MEDIA[name], "mean free path": float(path), "rms": portal["rms"], "energy": portal["energy"],
            "rms, Random Walk": walk["rms"], "energy, Random Walk": walk["energy"],
            "time": portal["seconds"] / walk["seconds"],
            "variance at equal time": portal["seconds"] * portal["variance"] / walk["seconds"] / walk["variance"],
        })
        say(f"{MEDIA[name]}, mean free path {path}")
    return rows


def _measured(addon, lit_sphere, name, path, kind, samples, repeats, number):
    import lateral_material

    material = lateral_material.make(addon, lit_sphere.stack(name, path), kind)

    def prepare(scene):
        addon.baking.volume_bounces.provide(scene, material)

    def rendered(count, seed):
        began = time.process_time()
        picture = lit_sphere.pixels(material, count, seed, prepare)
        return picture, time.process_time() - began

    rendered(1, 1)
    pictures, seconds = [], []
    for seed in range(repeats):
        picture, longer = rendered(samples, 10 * number + seed + 1)
        seconds.append(longer - rendered(samples // FEW, seed + 1)[1])
        pictures.append(picture)
    truth = lit_sphere.BLOCKS[name, path]
    apart = [lit_sphere.blocks_of(picture) - truth for picture in pictures]
    square = np.mean([np.mean(first * second) for first, second in itertools.combinations(apart, 2)])
    return {
        "rms": math.copysign(math.sqrt(abs(square)), square) / truth.mean(),
        "energy": float(np.mean(apart) / truth.mean()),
        "seconds": min(seconds),
        "variance": float(np.mean(np.var(pictures, axis=0, ddof=1))),
    }


if __name__ == "__main__":
    sys.exit(in_blender.main("portal", __doc__.split("\n\n")[0], {"samples": 256, "repeats": 3, "cases": 1000},
                             measure))
