# SPDX-License-Identifier: GPL-3.0-or-later
"""Dust from a cluster has the bytes of one process, for any number of parts and though a worker is killed."""

import dataclasses

import numpy as np
import pytest
from dust_meshes import box, plate, sphere, torus
from needs_embree import with_embree

from lamina import ArgumentError, Cancelled, distributed, dust
from lamina.dust import Mesh, Settling

pytest.importorskip("distributed", reason="Dask is not installed: there is no cluster to test")
pytestmark = with_embree

RING, GROUND, CUBE = torus(ripple=0.3), plate(40, 3.0, -0.6), box((-0.2, -0.2, 0.5), (0.2, 0.2, 0.9))
LOST = Mesh(np.vstack([RING.vertices, [[9.0, 9.0, 9.0]]]), RING.triangles)  # with a vertex that no face has
SETTINGS = {
    "one side": Settling(amount=2.0, rays=64),
    "two sides": Settling(amount=1.0, rays=48, two_sided=True, coverage=0.6, wind=(0.3, 0.1, 0.0)),
    "nothing slides": Settling(amount=1.0, rays=16, concavity=0.0, spread=0.0),
}


def require_same(found, alone):
    for name in ("tau", "arrived", "back", "vertices", "corners"):
        one, other = getattr(found, name), getattr(alone, name)
        assert one is other is None or one.tobytes() == other.tobytes(), name
    assert (found.settings, found.seed) == (alone.settings, alone.seed)
    one, other = (dataclasses.replace(dust.statistics, seconds=0.0) for dust in (found, alone))
    assert one == other


@pytest.mark.parametrize("settings", SETTINGS)
@pytest.mark.parametrize("parts", [1, 2, 7, None])
def test_one_mesh_in_any_number_of_parts(client, settings, parts):
    texts, given = [], {"settings": SETTINGS[settings], "seed": 11}
    found, = distributed.settle_each(client, [LOST], [GROUND, CUBE], parts=parts, **given,
                                     progress=lambda _, text: texts.append(text))
    require_same(found, dust.settle(LOST, occluders=[GROUND, CUBE], **given))
    assert found.tau.max() > 0.5
    calls = 1 + (8 if parts is None else parts)  # four parts for each of the two threads; one call traces the grains
    assert texts[-1] == f"{calls} of {calls} parts"


def test_not_more_parts_than_points(client):
    texts = []
    found, = distributed.settle_each(client, [CUBE], parts=4000, progress=lambda _, text: texts.append(text))
    require_same(found, dust.settle(CUBE))
    assert texts[-1] == f"{len(found.tau) + 1} of {len(found.tau) + 1} parts"


def test_a_large_mesh_though_a_worker_is_killed(client, a_worker_killed, recwarn):
    mesh, given = sphere(300, 600), {"settings": Settling(amount=1.0, rays=64), "seed": 3}
    with a_worker_killed(lambda share, _text: share > 0.0) as progress:
        found, = distributed.settle_each(client, [mesh], [GROUND], parts=24, progress=progress, **given)
    require_same(found, dust.settle(mesh, occluders=[GROUND], **given))
    assert not [one for one in recwarn if "large graph" in str(one.message)]  # Dask's advice from 10 MB on


def test_several_meshes_are_in_each_others_way_and_share_the_parts(client):
    texts, settings = [], Settling(amount=2.0)
    small, large = plate(2), plate(40, 1.0, 0.3)
    found = distributed.settle_each(client, [small, large, RING], settings=settings,
                                    progress=lambda _, text: texts.append(text))
    for one, mesh, others in zip(found, (small, large, RING), ([large, RING], [small, RING], [small, large]),
                                 strict=True):
        require_same(one, dust.settle(mesh, occluders=others, settings=settings))
    assert found[0].tau.max() < found[1].tau.max()  # the large plate is above the small one
    # Eight parts, by 9, 1681 and 4608 points of 6298, at least one each; and three calls that trace grains.
    assert texts[-1] == "12 of 12 parts"


def test_cancel_and_errors(client):
    said = []
    with pytest.raises(Cancelled, match="the dust was cancelled"):
        distributed.settle_each(client, [sphere(200, 400)], progress=lambda _, text: said.append(text),
                                cancel=lambda: bool(said) and "reading" not in said[-1])
    with pytest.raises(dust.DustError, match=r"surfaces\[1\] = int: must be a lamina.dust.Mesh"):
        distributed.settle_each(client, [CUBE, 3])
    with pytest.raises(ArgumentError, match="parts = 0: must be a whole number from 1 to 4096"):
        distributed.settle_each(client, [CUBE], parts=0)
    with pytest.raises(ArgumentError, match=r"surfaces = .*: must be a list of meshes"):
        distributed.settle_each(client, CUBE)
    assert distributed.settle_each(client, []) == []
