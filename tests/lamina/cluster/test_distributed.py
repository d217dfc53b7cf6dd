# SPDX-License-Identifier: GPL-3.0-or-later
"""A cluster of worker processes on this machine gives the bytes of one process, also if a worker is killed."""

import sys

import numpy as np
import pytest
from needs_embree import with_embree

import lamina
from lamina import ArgumentError, Cancelled, HenyeyGreenstein, Medium, Stack, distributed

pytest.importorskip("distributed", reason="Dask is not installed: there is no cluster to test")

SLAB = Stack([Medium([0.9, 0.8, 0.6], 2.0, HenyeyGreenstein(0.5))])
MARBLE = Stack([Medium(sigma_s=2.0, sigma_a=0.02, thickness=5.0)])
CORNERS = np.array([[x, y, z] for x in (0, 5) for y in (0, 5) for z in (0, 5)], float)
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
TRIANGLES = np.array([t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))])


def test_an_estimate_has_the_bytes_of_one_process_though_a_worker_is_killed(client, a_worker_killed):
    seen = []
    with a_worker_killed(lambda share, _text: share > 0.0) as killer:
        found = distributed.estimate(client, SLAB, 0.5, 0.6, 1.0, samples=3_000_000, seed=3, parts=12,
                                     progress=lambda share, text: (seen.append(share), killer(share, text)))
    assert seen == sorted(seen) and seen[0] == 0.0 and seen[-1] == 1.0
    alone = lamina.estimate(SLAB, 0.5, 0.6, 1.0, samples=3_000_000, seed=3)
    assert found == alone and found.value.tobytes() == alone.value.tobytes()


def test_a_searchlight(client):
    given = {"samples": 200_000, "seed": 1, "r": [0.5, 2.0], "q": [1.0]}
    assert distributed.estimate_searchlight(client, MARBLE, **given) == lamina.estimate_searchlight(MARBLE, **given)


@with_embree
def test_walks_in_a_mesh(client):
    solid = lamina.Solid(CORNERS, TRIANGLES)
    interior, _ = lamina.interior_of_stack(Stack([Medium(sigma_s=1.0, sigma_a=0.1, thickness=1.0)]))
    given = {"points": [[2.5, 2.5, 5.0], [1.0, 1.0, 5.0], [2.0, 3.0, 0.0]],
             "normals": [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]], "samples": 100}
    found, alone = (call(solid, interior, **given) for call in (
        lambda *a, **k: distributed.walk_in_mesh(client, *a, **k), lamina.walk_in_mesh))
    assert found.albedo == alone.albedo and found.mean_distance == alone.mean_distance
    lamps = [lamina.Lamp((0, 0, 1))]
    found = distributed.light_in_mesh(client, solid, interior, lamps, **given)
    alone = lamina.light_in_mesh(solid, interior, lamps, **given)
    assert found.lamps == alone.lamps and found.sky == alone.sky


@with_embree
@pytest.mark.parametrize("kind", ["relightable", "lit"])
def test_images_of_an_interior_though_a_worker_is_killed(client, a_worker_killed, tmp_path, kind):
    solid = lamina.Solid(CORNERS, TRIANGLES)
    interior, _ = lamina.interior_of_stack(Stack([Medium(sigma_s=1.0, sigma_a=0.5, thickness=1.0)]))
    given = {"samples": 20_000, "seed": 5}
    make, arrays = lamina.relightable_images, lambda found: (found.inputs.color, found.inputs.radius)
    if kind == "lit":
        make, arrays = lamina.lit_images, lambda found: (found.lamps, found.sky)
        given["lamps"] = [lamina.Lamp((0, 0, 1))]
    # The progress is polled, and may miss the second part.
    with a_worker_killed(lambda _share, text: text.startswith("Part") and not text.startswith("Part 1 of")) as progress:
        found = make(solid, interior, folder=tmp_path, progress=progress, spread=distributed.spread(client), **given)
    assert len(list(tmp_path.glob("part-*.npz"))) > 2
    for one, other in zip(arrays(found), arrays(make(solid, interior, threads=1, **given)), strict=True):
        assert one.tobytes() == other.tobytes()


@with_embree
def test_a_cancelled_map_keeps_its_parts(client, tmp_path):
    solid = lamina.Solid(CORNERS, TRIANGLES)
    interior, _ = lamina.interior_of_stack(Stack([Medium(sigma_s=1.0, sigma_a=0.5, thickness=1.0)]))

    def parts():
        return list(tmp_path.glob("part-*.npz"))

    with pytest.raises(Cancelled):
        lamina.relightable_images(solid, interior, samples=20_000, folder=tmp_path, spread=distributed.spread(client),
                                  cancel=lambda: len(parts()) >= 2)
    assert len(parts()) >= 2
    with pytest.raises(ArgumentError, match="client = 'tcp"):
        distributed.spread("tcp://127.0.0.1:1")


def test_bakes_in_their_order(client):
    stacks = [SLAB, "gold", Stack([Medium(0.5, 1.0)])]
    tables = distributed.bakes(client, stacks, "preview")
    assert tables == [lamina.bake(stack, "preview") for stack in stacks]


def test_cancel_and_errors(client):
    with pytest.raises(Cancelled, match="the estimate was cancelled"):
        distributed.estimate(client, SLAB, 0.5, 0.6, samples=2_000_000, parts=64, cancel=iter([False, True]).__next__)
    with pytest.raises(ArgumentError, match="method = 'guess': must be"):
        distributed.estimate(client, SLAB, 0.5, 0.6, method="guess", samples=100_000)
    with pytest.raises(ArgumentError, match="client = 3: must be a synchronous distributed.Client"):
        distributed.estimate(3, SLAB, 0.5, 0.6)
    with pytest.raises(ArgumentError, match="parts = 0: must be a whole number from 1 to 4096"):
        distributed.estimate(client, SLAB, 0.5, 0.6, parts=0)
    with pytest.raises(ArgumentError, match="stacks = 'gold': must be a list"):
        distributed.bakes(client, "gold")
    with type(client)(client.cluster) as closed:
        pass
    with pytest.raises(ArgumentError, match="client = .*: is closed, or has lost its scheduler"):
        distributed.estimate(closed, SLAB, 0.5, 0.6)


def test_without_dask_one_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(lamina.ExtraMissing, match='^lamina.distributed needs distributed, .*: pip install'):
        distributed.estimate(None, SLAB, 0.5, 0.6)
