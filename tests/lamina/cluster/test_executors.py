# SPDX-License-Identifier: GPL-3.0-or-later
"""Any executor of concurrent.futures computes parts, with the bytes of one process. No Dask is needed."""

import threading
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest
from dust_meshes import plate, torus
from map_meshes import slab_with_uvs
from needs_embree import with_embree

import lamina
from lamina import (
    ArgumentError,
    Cancelled,
    EndMaterial,
    HenyeyGreenstein,
    Interior,
    Lamp,
    Medium,
    Stack,
    distributed,
    dust,
)
from lamina.common.parts import each_part
from lamina.common.progress import silent, stepper
from lamina.maps import part_folder

SLAB = Stack([Medium([0.9, 0.8, 0.6], 2.0, HenyeyGreenstein(0.5))])
MARBLE = Stack([Medium(sigma_s=2.0, sigma_a=0.02, thickness=5.0)])
SOLID, UVS = slab_with_uvs(0.5)
DARK = Interior.uniform(EndMaterial(0.5, 1.0))
SUN = [Lamp((0.3, 0.2, 1.0))]


@pytest.fixture(scope="module", params=[ThreadPoolExecutor, ProcessPoolExecutor])
def executor(request):
    with request.param(2) as workers:
        yield workers


def test_estimates_and_bakes(executor):
    found = distributed.estimate(executor, SLAB, 0.5, 0.6, 1.0, samples=200_000, seed=3)
    assert found == lamina.estimate(SLAB, 0.5, 0.6, 1.0, samples=200_000, seed=3)
    given = {"samples": 140_000, "seed": 1, "r": [0.5, 2.0], "q": [1.0]}
    assert distributed.estimate_searchlight(executor, MARBLE, **given) == lamina.estimate_searchlight(MARBLE, **given)
    assert distributed.bakes(executor, [SLAB], "preview") == [lamina.bake(SLAB, "preview")]


@with_embree
def test_walks_and_dust(executor):
    found = distributed.light_in_mesh(executor, SOLID, DARK, SUN, samples=50, parts=3)
    alone = lamina.light_in_mesh(SOLID, DARK, SUN, samples=50)
    assert found.lamps == alone.lamps and found.sky == alone.sky
    mesh, ground, settings = torus(ripple=0.3), plate(8, 3.0, -0.6), dust.Settling(amount=1.0, rays=16)
    found, = distributed.settle_each(executor, [mesh], [ground], settings)
    assert found.tau.tobytes() == dust.settle(mesh, occluders=[ground], settings=settings).tau.tobytes()


@with_embree
def test_images_in_passes_that_a_folder_keeps(executor, monkeypatch, tmp_path):
    """A run that stops in the middle continues on the executor; previews come in their order."""
    monkeypatch.setattr(part_folder, "SAMPLES_PER_PART", 100)
    shown = []
    how = {"uvs": UVS, "size": 6, "samples": 32, "seed": 5}
    alone = lamina.lit_images(SOLID, DARK, SUN, **how, preview=lambda _: None)

    def stop(image):
        shown.append(image)
        raise Cancelled

    with pytest.raises(Cancelled):
        lamina.lit_images(SOLID, DARK, SUN, **how, folder=tmp_path, spread=executor, preview=stop)
    kept = {path: path.stat().st_mtime_ns for path in tmp_path.glob("part-*.npz")}
    assert kept and [one.done for one in shown] == [1 / 8]
    found = lamina.lit_images(SOLID, DARK, SUN, **how, folder=tmp_path, spread=executor, preview=shown.append)
    assert found.lamps.tobytes() == alone.lamps.tobytes() and found.sky.tobytes() == alone.sky.tobytes()
    assert [one.done for one in shown[1:]] == [1 / 8, 1 / 4, 1 / 2]
    assert all(path.stat().st_mtime_ns == time for path, time in kept.items())


def test_the_sequence_of_results_is_that_of_the_parts():
    """The first part ends last; each is kept as soon as it is there."""
    second_is_kept, kept = threading.Event(), []

    def call(part, _step=silent):
        return second_is_kept.wait(10) and part if part == "first" else part

    def keep(part, result):
        kept.append((part, result))
        second_is_kept.set()

    with ThreadPoolExecutor(2) as workers:
        assert each_part(call, ["first", "second"], silent, workers, keep) == ["first", "second"]
    assert kept == [("second", "second"), ("first", "first")]


def test_progress_errors_and_cancel_of_parts():
    told = []
    found = each_part(lambda part, step: step(0.5, "half") or part, [1, 3], lambda *one: told.append(one),
                      work=lambda part: part)
    assert found == [1, 3] and told == [(0.125, "half"), (0.625, "half")]
    with ThreadPoolExecutor(1) as workers:
        with pytest.raises(ZeroDivisionError):
            each_part(lambda part: 1 / part, [0, 1], silent, workers)
        with pytest.raises(Cancelled, match="the work was cancelled"):
            each_part(np.sqrt, [1, 2], stepper("the work", None, lambda: True), workers)
    for call in (lamina.lit_images, lamina.relightable_images):
        with pytest.raises(ArgumentError, match="spread = 3: must be an executor of concurrent.futures or None"):
            call(SOLID, DARK, samples=1, spread=3)
