# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks in meshes: parts, threads, progress, cancelling and files."""

import numpy as np
import pytest
from walk_meshes import box, sphere

import lamina
from lamina import EndMaterial, Interior, Lamp, ShardError, Surface

SOLID = sphere(1.0, 2)
INTERIOR = Interior.uniform(EndMaterial((1.0, 2.0, 4.0), 0.1, 0.5))
HOW = {"surface": Surface(1.3), "samples": 300, "seed": 3}
LAMPS = [Lamp((0.0, 1.0, 2.0), 0.2)]


def same(one, other):
    for name in ("albedo", "mean_distance") if hasattr(one, "albedo") else ("lamps", "sky"):
        np.testing.assert_array_equal(getattr(one, name).value, getattr(other, name).value)
        np.testing.assert_array_equal(getattr(one, name).stderr, getattr(other, name).stderr)


@pytest.mark.parametrize("lamps", [None, LAMPS])
def test_merged_parts_are_the_whole_to_the_last_bit(lamps, tmp_path):
    parts = []
    for number in (3, 1, 2):
        path = tmp_path / f"{number}.npz"
        lamina.walk_part(SOLID, INTERIOR, (number, 3), lamps, threads=1, **HOW).save(path)
        parts.append(lamina.WalkPart.load(path))
    whole = lamina.walk_in_mesh(SOLID, INTERIOR, threads=2, **HOW) if lamps is None else \
        lamina.light_in_mesh(SOLID, INTERIOR, lamps, threads=2, **HOW)
    same(lamina.merge_walks(parts), whole)


def test_points_of_other_seeds_differ():
    one, other = (lamina.walk_in_mesh(SOLID, INTERIOR, samples=50, seed=seed).albedo.value for seed in (0, 1))
    assert not (one == other).any()
    assert len(np.unique(one[:, 0])) == len(one)


@pytest.mark.parametrize(("change", "words"), [
    ({"seed": 4}, "parts.1.: seed = 4 but 3 in parts.0."),
    ({"samples": 301}, "samples = 301 but"),
    ({"surface": Surface(1.4)}, "surface = .1.4"),
    ({"interior": Interior.uniform(EndMaterial(1.0))}, "interior = "),
    ({"solid": lamina.Solid(SOLID.vertices, SOLID.triangles[::-1])}, "solid = "),
    ({"lamps": LAMPS}, "kind = 'light' but 'exits'"),
])
def test_parts_of_other_runs(change, words):
    def part(number, solid=SOLID, interior=INTERIOR, **more):
        return lamina.walk_part(solid, interior, (number, 2), **{**HOW, "samples": 20, **more})

    with pytest.raises(ShardError, match=words):
        lamina.merge_walks([part(1), part(2, **{"samples": 20, **change})])


def test_missing_parts_and_damaged_files(tmp_path):
    parts = [lamina.walk_part(SOLID, INTERIOR, (number, 3), samples=10) for number in (1, 3)]
    with pytest.raises(ShardError, match="part 2 of 3 is missing"):
        lamina.merge_walks(parts)
    with pytest.raises(ShardError, match="part 1 of 3 is given twice"):
        lamina.merge_walks([parts[0], parts[0]])
    path = tmp_path / "part.npz"
    parts[0].save(path)
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(ShardError, match="part.npz: not a whole part of walks"):
        lamina.WalkPart.load(path)
    bad = lamina.WalkPart(parts[0].job, (1, 3), (parts[0].arrays[0][:-1], *parts[0].arrays[1:]))
    bad.save(path)
    with pytest.raises(ShardError, match="moments has the shape .*: must be finite numbers of shape"):
        lamina.WalkPart.load(path)


def test_progress_and_cancel():
    told = []
    lamina.walk_in_mesh(SOLID, INTERIOR, samples=2000, progress=lambda fraction, text: told.append(fraction))
    assert told == sorted(told) and told[-1] == 1.0 and len(told) > 4
    # Cancelling works in the middle of the walks of a single point.
    corner = ([SOLID.vertices[0]], [SOLID.vertices[0]])
    with pytest.raises(lamina.Cancelled):
        lamina.walk_in_mesh(SOLID, INTERIOR, *corner, samples=10**9, progress=lambda fraction, text: told.append(text),
                            cancel=lambda: told[-1] == "65,536 walks")


def test_a_hollow_and_overlapping_parts():
    """An inner box with reversed faces is a cavity; two overlapping boxes give the same result as their union."""
    outer, inner = box((-2, -2, -2), (2, 2, 2)), box((-1, -1, -1), (1, 1, 1))
    hollow = lamina.Solid(np.vstack([outer.vertices, inner.vertices]),
                          np.vstack([outer.triangles, inner.triangles[:, ::-1] + 8]))
    clear = Interior.uniform(EndMaterial(0.0, 1.0))
    down = lamina.walk_in_mesh(hollow, clear, [[0.1, 0.2, 2.0]], [[0, 0, 1]], [0, 0, 1], samples=4)
    assert down.mean_distance.value[0, 0] == pytest.approx(1.0, rel=1e-5)  # distance to the cavity
    halves = [box((-2, -2, -2), (2, 2, 0.3)), box((-2, -2, -0.3), (2, 2, 2))]
    union = lamina.Solid(np.vstack([one.vertices for one in halves]),
                         np.vstack([halves[0].triangles, halves[1].triangles + 8]))
    through = lamina.walk_in_mesh(union, clear, [[0.1, 0.2, 2.0]], [[0, 0, 1]], [0, 0, 1], samples=40000)
    assert through.mean_distance.value[0, 0] == pytest.approx(4.0, rel=1e-5)
    assert abs(through.albedo.value[0, 0] - np.exp(-4.0)) < 4.0 * through.albedo.stderr[0, 0]
