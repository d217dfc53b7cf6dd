# SPDX-License-Identifier: GPL-3.0-or-later
"""Mitsuba 3's volpath on a homogeneous slab or on a ball of voxels: paths per second and relative variance of a path.

    python bench/mitsuba_peer.py VARIANT PATHS RR_DEPTH REPEATS slab|ball      prints one line of JSON

Runs as a process of its own: an LLVM version too old for Mitsuba ends the process that loads it."""

import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
SLAB = (0.9, 2.0, 0.75)
MU = 0.5
PIXELS = 32
LLVM, SCALAR = "llvm_ad_rgb", "scalar_rgb"
LIBRARY = "DRJIT_LIBLLVM_PATH"


def measure(paths: int, rr_depths: tuple[int, ...], repeats: int, scene: str = "slab") -> list[dict]:
    """[{variant, value, variance: relative, of a path, paths_per_second: wall clock, all threads, and for LLVM
    compilation: seconds}] of a scene ("slab" or "ball"), for the scalar variant and, if the system has a working
    library, for LLVM. Each variant runs with the depth of its Russian roulette that makes it fastest."""
    runs = (_fastest(variant, paths, rr_depths, repeats, scene) for variant in (LLVM, SCALAR))
    return [run for run in runs if run is not None]


def _fastest(variant: str, paths: int, rr_depths: tuple[int, ...], repeats: int, scene: str) -> dict | None:
    """The run with the least variance per unit of time, or None if the variant does not work here."""
    for library in _llvm_libraries() if variant == LLVM else [None]:
        runs = []
        for depth in rr_depths:
            run, reason = _run(variant, library, paths, depth, repeats, scene)
            if run is None:
                print(f"bench: Mitsuba {variant} {library or ''}: {reason}", file=sys.stderr)
                break
            runs.append(run)
        else:
            return min(runs, key=lambda run: run["variance"] / run["paths_per_second"])
    if variant == SCALAR:
        raise RuntimeError("Mitsuba's scalar variant does not render: see above")
    print("bench: Mitsuba llvm_ad_rgb is left out: no LLVM library here works with it; Debian's package libllvm19 "
          "holds one", file=sys.stderr)
    return None


def _run(variant: str, library: Path | None, *arguments: int | str) -> tuple[dict | None, str]:
    """(the process's result or None, the reason). LLVM compiles its own kernels, without those of earlier processes."""
    with tempfile.TemporaryDirectory() as home:
        environment = {**os.environ, "HOME": home, **({LIBRARY: str(library)} if library else {})}
        call = [sys.executable, __file__, variant, *map(str, arguments)]
        done = subprocess.run(call, env=environment, capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return json.loads(done.stdout.splitlines()[-1]), ""
    return None, (done.stderr.strip().splitlines() or ["no reason given"])[0]


def _llvm_libraries() -> list[Path]:
    """The library given by the environment, otherwise those of the system, newest first."""
    if os.environ.get(LIBRARY):
        return [Path(os.environ[LIBRARY])]
    found: dict = {}
    for folder in ("/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib64"):
        for path in Path(folder).glob("libLLVM*.so*"):
            version = re.search(r"(\d+)", path.name.removeprefix("libLLVM"))
            if version:
                found.setdefault(int(version[1]), path)
    return [found[version] for version in sorted(found, reverse=True)]


def _slab_scene(mi) -> dict:
    """The slab under unit radiance from above, seen at cosine MU."""
    import lamina

    sys.path.insert(0, str(ROOT / "tests/lamina"))
    from mitsuba_scenes import slab

    stack = lamina.Stack([lamina.Medium(albedo=SLAB[0], tau=SLAB[1], phase=lamina.HenyeyGreenstein(SLAB[2]))])
    shapes, bottom = slab(stack)
    # The other hemisphere is black.
    black = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}}
    below = mi.ScalarTransform4f().translate([0.0, 0.0, bottom - 1.0]).scale(1e5)
    place = mi.ScalarTransform4f().look_at(origin=[5.0 * (1.0 - MU * MU) ** 0.5, 0.0, 5.0 * MU],
                                           target=[0.0, 0.0, 0.0], up=[0.1, 0.8, 0.6])
    return {**shapes, "lid": {"type": "rectangle", "to_world": below, "bsdf": black},
            "sensor": _sensor(place @ mi.ScalarTransform4f().scale(0.01), "luminance")}


def _ball_scene(mi) -> dict:
    """The veined ball under unit radiance from everywhere, seen along z."""
    import interior_bench
    import veined_ball

    vertices, triangles = veined_ball.mesh()
    extinction, albedo = veined_ball.coefficients()
    shape = mi.Mesh("ball", len(vertices), len(triangles))
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = vertices.ravel()
    parameters["faces"] = triangles.ravel()
    parameters.update()
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "ball.ply")
        shape.write_ply(path)
        radius = veined_ball.RADIUS
        box = mi.ScalarTransform4f().translate([-radius] * 3).scale(2.0 * radius)
        grids = {name: {"type": "gridvolume", "grid": mi.VolumeGrid(np.ascontiguousarray(grid.swapaxes(0, 2))),
                        "to_world": box, "raw": True, "filter_type": "trilinear"}
                 for name, grid in (("sigma_t", extinction[..., None]), ("albedo", albedo))}
        ball = mi.load_dict({"type": "ply", "filename": path, "bsdf": {"type": "null"},
                             "interior": {"type": "heterogeneous", **grids}})
    half = interior_bench.HALF
    place = mi.ScalarTransform4f().look_at(origin=[0.0, 0.0, 3.0 * radius], target=[0.0, 0.0, 0.0], up=[0.0, 1.0, 0.0])
    return {"ball": ball, "sensor": _sensor(place @ mi.ScalarTransform4f().scale([half, half, 1.0]), "rgb")}


def _sensor(place, pixel_format: str) -> dict:
    return {"type": "orthographic", "to_world": place,
            "film": {"type": "hdrfilm", "width": PIXELS, "height": PIXELS, "rfilter": {"type": "box"},
                     "pixel_format": pixel_format},
            "sampler": {"type": "independent"}}


def render(variant: str, paths: int, rr_depth: int, repeats: int, name: str) -> dict:
    """The light of a scene, in images of independent pixels."""
    import drjit as dr
    import mitsuba as mi

    mi.set_variant(variant)
    described = {"slab": _slab_scene, "ball": _ball_scene}[name](mi)
    scene = mi.load_dict({
        "type": "scene", **described,
        "light": {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}},
        "integrator": {"type": "volpath", "max_depth": -1, "rr_depth": rr_depth},
    })
    spp = -(-paths // PIXELS**2)
    images, seconds = [], []
    dr.set_flag(dr.JitFlag.KernelHistory, True)
    for seed in range(repeats + 1):
        started = time.perf_counter()
        image = np.array(mi.render(scene, spp=spp, seed=seed), dtype=float).ravel()
        if seed > 0:  # The first render compiles the kernels, which the others reuse.
            images.append(image)
            seconds.append(time.perf_counter() - started)
    value = float(np.mean(images))
    found = {"variant": variant, "value": value, "variance": _variance(np.array(images), name) * spp / value**2,
             "paths_per_second": spp * PIXELS**2 / min(seconds)}
    if variant == LLVM:
        found["compilation"] = sum(kernel.get("backend_time", 0.0) for kernel in dr.kernel_history()) / 1000.0
    return found


def _variance(images: np.ndarray, name: str) -> float:
    """The variance of a pixel. All pixels of the slab have one mean; of the ball, images are compared."""
    return float(np.var(images, ddof=1) if name == "slab" else np.mean(np.var(images, axis=0, ddof=1)))


if __name__ == "__main__":
    print(json.dumps(render(sys.argv[1], *(int(text) for text in sys.argv[2:5]), sys.argv[5])))
