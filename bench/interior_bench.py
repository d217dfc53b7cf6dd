# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks in a mesh with voxels, against Mitsuba's volpath on the same mesh and voxels: the light that leaves towards a
distant viewer under a white sky, as time to 1 % standard error of a texel."""

import time

import mitsuba_peer
import numpy as np
import veined_ball

import lamina

TEXELS = 32  # along each side of the square that the viewer sees
HALF = 7.0  # mm, half the square's side
SAMPLES = 64
ERROR = 0.01
THREADS = 2
PATHS = 1 << 15
RR_DEPTHS = (50, 1000)


def measure(repeats: int = 2, paths: int = PATHS, samples: int = SAMPLES) -> list[dict]:
    """Lamina's row and Mitsuba's, with `samples` of a texel and that many `paths`."""
    ours = lamina_row(samples)
    rows = [ours]
    for run in mitsuba_peer.measure(paths, RR_DEPTHS, repeats, "ball"):
        seconds = run["variance"] / ERROR**2 / run["paths_per_second"]
        rows.append({"name": f"Mitsuba {run['variant']}, volpath", "ms a texel": 1e3 * seconds,
                     "times": 1e3 * seconds / ours["ms a texel"], "paths/s": run["paths_per_second"],
                     "relative variance": run["variance"], "value": run["value"]})
    return rows


def lamina_row(samples: int) -> dict:
    vertices, triangles = veined_ball.mesh()
    extinction, albedo = veined_ball.coefficients()
    corner = [veined_ball.RADIUS] * 3
    interior = lamina.Interior.of_coefficients(extinction[..., None] * albedo, extinction[..., None] * (1.0 - albedo),
                                               [-x for x in corner], corner)
    points = texel_points()
    began = time.perf_counter()
    found = lamina.walk_in_mesh(lamina.Solid(vertices, triangles), interior, points, points / veined_ball.RADIUS,
                                (0.0, 0.0, 1.0), samples=samples, threads=THREADS)
    seconds = time.perf_counter() - began
    value, error = found.albedo.value, found.albedo.stderr
    walks = 3 * samples  # a sample has three paths
    variance = float(np.mean(error**2) * walks / np.mean(value) ** 2)
    paths = walks * len(points) / seconds
    return {"name": "Lamina, walk_in_mesh", "ms a texel": 1e3 * variance / ERROR**2 / paths, "times": 1.0,
            "paths/s": paths, "relative variance": variance, "value": float(np.mean(value)),
            "Mcollisions/s": 1e-6 * found.count.collisions / seconds}


def texel_points() -> np.ndarray:
    """Points of the ball at the centres of the viewer's texels."""
    x, y = np.meshgrid(*[HALF * ((2.0 * np.arange(TEXELS) + 1.0) / TEXELS - 1.0)] * 2)
    return np.stack([x, y, np.sqrt(veined_ball.RADIUS**2 - x**2 - y**2)], axis=-1).reshape(-1, 3)
