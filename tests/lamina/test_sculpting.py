# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/sculpting: closed surfaces, turned outwards, and the files of the demo scenes are what the code makes."""

import gzip
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from sculpting import __main__ as command  # noqa: E402
from sculpting import cup, dragon, isosurface, shells, splines  # noqa: E402

ROUGHLY = (3.2, 1.8)  # mm: a grid that is quick


@pytest.fixture(scope="module")
def rough_dragon():
    return dragon.build(*ROUGHLY)


def _uses_of_edges(quads, triangles):
    """How many faces each edge has, and how many run along it in its one direction."""
    starts = np.concatenate([quads.ravel(), triangles.ravel()])
    ends = np.concatenate([np.roll(quads, -1, axis=1).ravel(), np.roll(triangles, -1, axis=1).ravel()])
    count = int(starts.max()) + 1
    key = np.minimum(starts, ends) * count + np.maximum(starts, ends)
    _, number, uses = np.unique(key, return_inverse=True, return_counts=True)
    return uses, np.bincount(number.ravel(), starts < ends)


def _volume(vertices, quads, triangles):
    three = np.concatenate([triangles, quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    a, b, c = (vertices[three[:, k]] for k in range(3))
    return np.sum(np.einsum("ij,ij->i", a, np.cross(b, c))) / 6.0


def _is_closed(quads, triangles):
    """Whether each edge has two faces, turned alike."""
    uses, forth = _uses_of_edges(quads, triangles)
    return np.all(uses == 2) and np.all(forth == 1)


def test_the_dragon_is_closed(rough_dragon):
    vertices, quads, triangles = rough_dragon
    assert np.isfinite(vertices).all() and _is_closed(quads, triangles)
    assert len(np.unique(np.concatenate([quads.ravel(), triangles.ravel()]))) == len(vertices)
    assert _volume(*rough_dragon) > 0.0


def test_the_dragon_is_the_same_each_time(rough_dragon):
    first, second = (command.packed(*made) for made in (rough_dragon, dragon.build(*ROUGHLY)))
    assert first == second


def test_each_shell_is_turned_outwards():
    for shell in (shells.spike((1, 2, 3), (0, 1, 1), (3, 0, 0), 10, 2),
                  shells.sheet(np.stack([*np.meshgrid(range(5), range(7), indexing="ij"), np.zeros((5, 7))], -1), 0.5),
                  shells.swept(splines.curve([(0, 0, 0), (1, 5, 2), (3, 9, 2)], (0, 0, 1), np.full((3, 2), 1.0)))):
        assert _is_closed(*shell[1:]) and _volume(*shell) > 0.0


def test_the_surface_of_a_ball():
    radius = 7.0
    box = [(-8.0,) * 3, (8.0,) * 3]
    vertices, triangles = isosurface.mesh(lambda points, reach: np.linalg.norm(points, axis=1) - radius, box, 0.5)
    none = np.empty((0, 4), int)
    assert _is_closed(none, triangles)
    assert np.linalg.norm(vertices, axis=1) == pytest.approx(radius, abs=0.02)
    assert _volume(vertices, none, triangles) == pytest.approx(4.0 / 3.0 * np.pi * radius**3, rel=0.01)
    normals = isosurface.normals(vertices, triangles)
    assert np.sum(normals * vertices, axis=1) / radius == pytest.approx(1.0, abs=0.01)


def test_surfaces_stay_closed_where_signs_alternate():
    noise = np.random.default_rng(1).normal(size=(40, 40, 40))

    def distance(points, reach):
        return noise[tuple(np.clip(np.round(points).astype(int) + 8, 0, 39).T)]

    _, triangles = isosurface.mesh(distance, [(0,) * 3, (16,) * 3], 1.0)
    assert len(triangles) > 1000 and _is_closed(np.empty((0, 4), int), triangles)


def test_the_file_of_the_cup_is_what_the_code_makes():
    """Coordinates are compared as numbers: other processors may round differently."""
    there, made = (gzip.decompress(data).partition(b"end_header\n") for data in (
        (ROOT / "demo_scenes/marble/cup.ply.gz").read_bytes(), command.packed(*cup.build())))
    assert there[0] == made[0]
    count = 3 * int(made[0].split(b"element vertex ")[1].split()[0])
    points, others = (np.frombuffer(body, "<f4", count) for _, _, body in (there, made))
    np.testing.assert_allclose(points, others, atol=1e-3)
    assert there[2][4 * count :] == made[2][4 * count :]
