# SPDX-License-Identifier: GPL-3.0-or-later
"""Settling of dust: rays per second beside a bare Embree loop; seconds and memory for a million points of a mesh of 871
thousand faces with 256 rays each. LAMINA_BENCH_MESH: a PLY file (y up) in place of the generated mesh."""

import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from lamina import dust, ply

OCCLUSION = Path(__file__).resolve().parent.parent / "build/native-bench/bench_occlusion"
POINTS = 1_000_000
AROUND = 1320  # 871,200 faces
RAYS = 256
SPREAD = math.radians(35.0)


def mesh(around):
    """(name, mesh with z up). `around`: faces along the tube of the generated mesh."""
    path = os.environ.get("LAMINA_BENCH_MESH")
    if path:
        loaded = ply.load(path)
        return Path(path).name, dust.Mesh(loaded.vertices[:, [0, 2, 1]] * [1.0, -1.0, 1.0], loaded.triangles)
    return "knotted tube", knot(around, around // 4)


def knot(around, across):
    """A tube along a trefoil knot, with scales: faces that overhang, fold and shade each other."""
    t = 2.0 * np.pi * np.arange(around) / around
    line = np.column_stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)])
    along = np.roll(line, -1, axis=0) - np.roll(line, 1, axis=0)
    along /= np.linalg.norm(along, axis=1)[:, None]
    side = np.cross(along, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side, axis=1)[:, None]
    up = np.cross(side, along)
    v = 2.0 * np.pi * np.arange(across) / across
    radius = 0.45 + 0.03 * np.abs(np.sin(60 * t))[:, None] * np.abs(np.sin(12 * v))[None]
    offset = np.cos(v)[None, :, None] * side[:, None] + np.sin(v)[None, :, None] * up[:, None]
    vertices = (line[:, None] + radius[..., None] * offset).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = i * across + j, (i + 1) % around * across + j
    c, d = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
    corners = [np.stack(k, -1).reshape(-1, 3) for k in ((a, b, c), (a, c, d))]
    return dust.Mesh(vertices, np.vstack(corners))


def surface_points(surface, count, seed=1):
    """Points distributed at random over the area, sorted by face as texels are."""
    rng = np.random.default_rng(seed)
    corners = surface.vertices[surface.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    face = np.sort(rng.choice(len(area), count, p=area / area.sum()))
    a, b = rng.uniform(size=(2, count))
    a, b = np.where(a + b > 1.0, [1.0 - a, 1.0 - b], [a, b])
    shares = np.column_stack([1.0 - a - b, a, b])
    return dust.Points(np.einsum("nk,nkc->nc", shares, corners[face]),
                       np.einsum("nk,nkc->nc", shares, vertex_normals(surface)[surface.triangles[face]]))


def vertex_normals(surface):
    """Of unit length; each face counts by its area."""
    corners = surface.vertices[surface.triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(surface.vertices)
    for corner in range(3):
        np.add.at(normals, surface.triangles[:, corner], faces)
    return normals / np.linalg.norm(normals, axis=1)[:, None]


def measure(points=POINTS, around=AROUND):
    """Rows of {what, Mrays/s, seconds, ...}. `points`: of the complete run."""
    if dust.available():
        print(dust.available())
        return []
    rows = []
    name, surface = mesh(around)
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    scale = 0.5 * np.linalg.norm(high - low)
    few = surface_points(surface, min(points, 20_000))

    def placed(positions):  # where single precision is finest
        return ((positions - 0.5 * (low + high)) / scale).astype(np.float32)

    with tempfile.NamedTemporaryFile(suffix=".bin") as file:
        np.array([len(surface.vertices), len(surface.triangles), len(few.positions)], np.uint64).tofile(file)
        placed(surface.vertices).tofile(file)
        surface.triangles.astype(np.uint32).tofile(file)
        placed(few.positions).tofile(file)
        (few.normals / np.linalg.norm(few.normals, axis=1)[:, None]).astype(np.float32).tofile(file)
        file.flush()
        for threads in (1, 0):
            done = subprocess.run([OCCLUSION, file.name, str(SPREAD), str(threads)], check=True, capture_output=True,
                                  text=True)
            found = json.loads(done.stdout)
            rows.append({"name": f"{name}, {len(surface.triangles):,} faces, {threads or 'all'} threads",
                         "settling, Mrays/s": found["dust"] * 1e-6, "bare Embree, Mrays/s": found["bare"] * 1e-6,
                         "settling/bare": found["ratio"], "rays that hit": found["hit"]})
    # Peak memory is measured for a complete process, so this measurement has a process of its own.
    done = subprocess.run([sys.executable, __file__, str(points), str(around)], check=True, capture_output=True,
                          text=True)
    return [*rows, json.loads(done.stdout)]


def whole_run(count, around):
    import resource

    name, surface = mesh(around)
    points = surface_points(surface, count)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    found = dust.settle(surface, points, settings=dust.Settling(rays=RAYS, spread=SPREAD)).statistics
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(json.dumps({"name": f"{name}, {found.points:,} points x {RAYS} rays, all threads (limit 60 s, 2 GiB)",
                      "settling, Mrays/s": found.rays_per_second * 1e-6, "seconds": found.seconds,
                      "peak MiB": peak / 1024, "of it before": before / 1024, "rays traced": found.rays,
                      "mean tau": found.mean}))


if __name__ == "__main__":
    whole_run(*map(int, sys.argv[1:]))
